// Tries the live page in a browser:
//
//     node try_page.mjs PROGRAM FOLDER
//
// FOLDER holds pages, and SCENE-SCHEME.csv: the last line of nevh run, whose state
// the page is to have after 100 steps.
import { readFileSync } from "node:fs";
import { browse } from "./browser.mjs";

const [program, folder] = process.argv.slice(2);
let wrong = 0;
const check = (fine, what) => {
  if (fine) return;
  wrong++;
  console.log("wrong: " + what);
};
const open = (scene, fragment) => browse(program, "file://" + folder + "/" + scene +
  ".html" + (fragment ? "#" + fragment : ""));
// Closed also where a try fails.
async function tried(scene, fragment, body) {
  const page = await open(scene, fragment);
  try {
    await body(page);
    check(page.faults.length === 0, scene + ": console: " + page.faults.join("; "));
    const far = page.requests.filter((r) => !/^(file|blob|data):/.test(r));
    check(far.length === 0, scene + ": requests " + far.join(" "));
  } finally {
    await page.close();
  }
}
const result = async (page) => {
  check(await page.until("document.getElementById('result')"), "no result");
  return JSON.parse(await page.evaluate(
    "document.getElementById('result').textContent"));
};
// Twelve digits: the C libraries' functions differ in the last.
const near = (a, b, size) => Math.abs(a - b) <= 1e-12 * Math.max(1, size);

async function digits(scene, schemes, dt, columns) {
  await tried(scene, `test=100&dt=${dt}&integrators=${schemes.join(",")}`,
    async (page) => {
      const { runs, steps, message } = await result(page);
      check(steps === 100 && message === "", `${scene}: ${steps} steps, ${message}`);
      runs.forEach((run, i) => {
        const line = readFileSync(`${folder}/${scene}-${schemes[i]}.csv`, "utf8")
          .trim().split(",").map(Number);
        const state = run.state.map(Number);
        check(run.scheme === schemes[i], scene + ": schemes");
        check(near(+run.t, line[0], 1), `${scene}: t ${run.t} for ${line[0]}`);
        state.forEach((v, j) => check(near(v, line[1 + j], Math.abs(v)),
          `${scene} ${run.scheme}: ${v} for ${line[1 + j]}`));
        check(near(+run.energy, line[line.length - 1], Math.abs(run.energy)),
          `${scene} ${run.scheme}: energy ${run.energy} for ${line[line.length - 1]}`);
      });
    });
}
await digits("pendulum", ["verlet", "rk4"], 0.0625);
await digits("kepler", ["verlet"], 0.03125);
await digits("double-pendulum", ["gauss4"], 0.015625);

// It moves, alone, and stops and goes by keys; formulas are changed, and wrong
// ones are refused with the place.
await tried("pendulum", "", async (page) => {
  check(await page.until("steps > 5"), "nothing moves");
  await page.key(" ", "Space", " ");
  const stood = await page.evaluate("steps");
  await new Promise((resolve) => setTimeout(resolve, 300));
  check(await page.evaluate("steps") - stood <= 1, "space does not pause");
  await page.evaluate("at('step').focus()");
  await page.evaluate("at('step').click()");
  check(await page.until(`steps > ${stood}`), "no single step");
  const type = (name, text) => page.evaluate(`(() => {
    const field = document.querySelector('#effects input[name=${name}]');
    field.value = ${JSON.stringify(text)};
    at('formulas').requestSubmit(); })()`);
  await type("gravity", "-m*g*l*cos(phi) + * 2");
  check(await page.until("/:\\d+:\\d+: error/.test(at('wrong').textContent) && " +
    "/\\^/.test(at('wrong').textContent)"), "no caret");
  await type("gravity", "9*phi^2/2");
  check(await page.until("at('wrong').textContent === '' && /9\\*phi/.test(S.text)"),
    "the formula is not taken");
  await page.evaluate("setPlaying(true)");
  check(await page.until("steps > 5"), "the new one does not move");
  // Hostile ones end in a message, and the page goes on.
  for (const text of ["(".repeat(100000) + "phi" + ")".repeat(100000),
    "sum(i = 1..100000000, cos(i*phi))", "sqrt(-1 - phi^2)", "1/0*phi", "bessel_j0(phi)"]) {
    await type("gravity", text);
    check(await page.until("at('wrong').textContent + at('message').textContent"),
      "no message for " + text.slice(0, 30));
    console.log(text.slice(0, 30) + " -> " + (await page.evaluate(
      "at('wrong').textContent + at('message').textContent")).slice(0, 200));
    await type("gravity", "-m*g*l*cos(phi)");
    check(await page.until("at('wrong').textContent + at('message').textContent === ''"),
      "does not recover from " + text.slice(0, 30));
  }
});
console.log(wrong + " wrong");
process.exit(wrong ? 1 : 0);
