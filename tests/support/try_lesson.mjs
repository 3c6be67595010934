// Runs the first half minute of live pages, without a browser:
//
//     node try_lesson.mjs PAGE...
//
// Each page has one scene.  Where it says that the energy error of one scheme passes
// that of the other, it is to be so in half a minute of its speed, and not before the
// scheme that is passed has shown what its error is; with a step of a fortieth, the
// contrast, it is not so.  The speed shows some of the scene's steps in a second, and not
// thousands.
import { readFileSync } from "node:fs";
import { gunzipSync } from "node:zlib";
import { basename } from "node:path";
import { trial } from "./browser.mjs";

const { check, ended } = trial();
// The element of a page that is compressed, by the page's own decoder.
function unpacked(html, id) {
  const [decoder] = html.match(/const nevhBytes = [^]*?\n};\n/);
  const [, packed] = html.match(new RegExp(`id="${id}">(\\d+ [^<]*)<`));
  return gunzipSync(new Function(decoder + "return nevhBytes;")()(packed));
}
async function opened(html) {
  const [given] = JSON.parse(html.match(/id="given">\n([^]*?)\n<\/script>/)[1]);
  let answer;
  const take = new Function(unpacked(html, "engine") + "; return nevhEngine;")()(
    (message) => { answer = message; });
  const ask = async (request) => { await take(request); return answer; };
  await ask({ ask: "load", module: unpacked(html, "module") });
  const { ok, scene, message } = await ask({ ask: "open", name: given.name,
    text: given.text, changes: given.changes });
  if (!ok) throw new Error(message);
  return { ask, scene, given };
}
// The largest error of each scheme in each of 30 seconds, steps of dt.
async function half({ ask, scene, given }, dt) {
  const { schemes, faster } = given.lesson, gradient = scene.run.gradients[0] || "central4";
  const each = Math.max(1, Math.round(scene.run.rate * 2 ** faster / dt));
  await ask({ ask: "race", list: schemes.map((scheme) => ({ scheme, gradient, h: dt })) });
  const most = schemes.map(() => []);
  for (let second = 0; second < 30; second++) {
    const errors = schemes.map(() => 0);
    for (let left = each; left > 0;) {
      const { done, states, runs } = await ask({ ask: "go", steps: left, every: left });
      states.forEach((row, i) => {
        errors[i] = Math.max(errors[i], runs[i].ok ? row[3] : Infinity);
      });
      left -= done;
    }
    errors.forEach((v, i) => most[i].push(v));
  }
  return most;
}
const parted = ([kept, other]) => {
  const most = Math.max(...kept);
  return most < 1 && other.at(-1) > most;
};
for (const file of process.argv.slice(2)) {
  const page = await opened(readFileSync(file, "utf8")), { lesson } = page.given;
  const name = basename(file, ".html"), { rate, step } = page.scene.run;
  check(rate >= 1.5 * step && rate <= 2000 * step,
    `${name}: t grows by ${rate} a second, by steps of ${step}`);
  if (lesson.why) {
    console.log(`${name}: not here, ${lesson.why}`);
    continue;
  }
  const errors = await half(page, lesson.dt);
  const after = lesson.crossing / (page.scene.run.rate * 2 ** lesson.faster);
  const words = errors.map((list, i) => lesson.schemes[i] + " " +
    Math.max(...list).toExponential(1)).join(", ");
  console.log(`${name}: dt ${lesson.dt}, parts after ${after.toFixed(1)} s: ${words}`);
  check(errors.flat().every((v) => v < 1e3), `${name}: is unstable: ${words}`);
  check(parted(errors), `${name}: does not part: ${words}`);
  check(after <= 20, `${name}: parts after ${after} s`);
  if (after > 1)
    check(!parted(await half(page, lesson.dt / 40)), name + ": parts with short steps as well");
}
ended();
