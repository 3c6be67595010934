// A page in a headless browser, without a network; for tests of pages.  Needs node,
// and no packages.
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename } from "node:path";
import { chromium } from "./chromium.mjs";
import { firefox } from "./firefox.mjs";

// Opens `address`; size: [width, height]; still: little motion is wanted; paper: as it
// is printed, in Chromium alone.  The result has
//   evaluate(text)  the value of an expression, awaited
//   until(text, seconds)  waits until an expression is true, which it returns
//   key, pointer    events of input
//   picture()       PNG as base64
//   heap()          bytes that the scripts' objects have, after garbage collection
//   faults          messages of errors in the console, and uncaught ones
//   requests        addresses that were asked for
//   close()
export async function browse(program, address, { size = [1280, 900],
  still = false, paper = false } = {}) {
  const folder = mkdtempSync(tmpdir() + "/nevh-browser.");
  const drive = /firefox/.test(basename(program)) ? firefox : chromium;
  const remove = () => {
    try { // its helpers may write for a while
      rmSync(folder, { recursive: true, force: true, maxRetries: 20 });
    } catch (error) {
      console.log("not removed: " + error.message);
    }
  };
  const page = await drive(program, folder, address, { size, still, paper })
    .catch((error) => { remove(); throw error; });
  return {
    ...page,
    async until(expression, seconds = 120) {
      for (let i = 0; i < seconds * 20; i++) {
        if (await page.evaluate(expression).catch(() => false)) return true;
        await new Promise((resolve) => setTimeout(resolve, 50));
      }
      return false;
    },
    async close() {
      await page.close();
      remove();
    },
  };
}

// Evaluated in a live page: chooses one scheme more, if there is room for it.
export const addScheme = `(() => {
  const menu = [...document.querySelectorAll("#schemes select")].at(-1);
  if (menu.value) return;
  menu.value = [...menu.options].map((option) => option.value)
    .find((name) => name && !S.schemes.includes(name));
  menu.dispatchEvent(new Event("change"));
})()`;

// What a program that tries pages counts, and says at its end; saved() keeps a picture
// in the folder $NEVH_PICTURES, where there is one, to be looked at.
export function trial() {
  let wrong = 0;
  return {
    check(fine, what) {
      if (fine) return;
      wrong++;
      console.log("wrong: " + what);
    },
    async saved(page, name) {
      const folder = process.env.NEVH_PICTURES;
      if (folder) writeFileSync(folder + "/" + name + ".png",
        Buffer.from(await page.picture(), "base64"));
    },
    ended() {
      console.log(wrong + " wrong");
      process.exit(wrong ? 1 : 0);
    },
  };
}
