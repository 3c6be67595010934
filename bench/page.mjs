// How fast live pages are in a headless browser, a row for each:
//
//     node bench/page.mjs PROGRAM PAGE...
//
// bytes of the page, seconds from its opening until it has moved, and frames a
// second over ten seconds with four schemes (goals: 300 000, 0.5, 60).  A headless browser
// draws by the processor alone.  PROGRAM is chromium or firefox.
// SPDX-License-Identifier: GPL-3.0-or-later
import { statSync } from "node:fs";
import { basename, resolve } from "node:path";
import { addScheme, browse } from "../tests/support/browser.mjs";

const [program, ...files] = process.argv.slice(2);
const SECONDS = 10, SCHEMES = 4;
const pause = (seconds) => new Promise((done) => setTimeout(done, 1e3 * seconds));
console.log("page                          bytes  first motion s  frames a second  schemes");
for (const file of files) {
  const page = await browse(program, "file://" + resolve(file));
  try {
    if (!await page.until("typeof steps === 'number' && steps > 0", 20))
      throw new Error(file + " does not move");
    const first = await page.evaluate("performance.now() / 1e3");
    for (let count = 0; count < SCHEMES; count++)
      await page.evaluate(addScheme), await pause(0.5);
    const count = await page.evaluate("list.length");
    const before = await page.evaluate("frames"), began = Date.now();
    await pause(SECONDS);
    const drawn = await page.evaluate("frames") - before;
    console.log(basename(file, ".html").padEnd(26) + String(statSync(file).size).padStart(9) +
      first.toFixed(2).padStart(16) +
      (drawn / (Date.now() - began) * 1e3).toFixed(1).padStart(17) +
      String(count).padStart(9));
  } finally {
    await page.close();
  }
}
