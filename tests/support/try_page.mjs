// Tries the live page in a browser:
//
//     node try_page.mjs PROGRAM FOLDER
//
// FOLDER holds pages, and SCENE-SCHEME.csv: the last line of nevh run, whose state
// the page is to have after 100 steps.
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { addScheme, browse, trial } from "./browser.mjs";

const [program, folder] = process.argv.slice(2);
const { check, saved, ended } = trial();
const open = (scene, fragment) => browse(program, "file://" + folder + "/" + scene +
  ".html" + (fragment ? "#" + fragment : ""));
// Closed also where a try fails.
async function tried(scene, fragment, body) {
  const page = await open(scene, fragment);
  try {
    await body(page);
    await saved(page, `${basename(program)}-page-${scene}`);
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
// Of the table, all columns are seen.
const fits = async (page, name) => {
  const [needed, given] = await page.evaluate(`(() => { report(true);
    return [at("states").scrollWidth, at("states").parentElement.clientWidth]; })()`);
  check(needed <= given, `${name}: the table has ${needed} pixels in ${given}`);
};
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
        check(+run.t === line[0], `${scene}: t ${run.t} for ${line[0]}`);
        state.forEach((v, j) => check(v === line[1 + j],
          `${scene} ${run.scheme}: ${v} for ${line[1 + j]}`));
        check(+run.energy === line[line.length - 1],
          `${scene} ${run.scheme}: energy ${run.energy} for ${line[line.length - 1]}`);
      });
    });
}
await digits("pendulum", ["verlet", "rk4"], 0.0625);
await digits("kepler", ["verlet"], 0.03125);
await digits("double-pendulum", ["gauss4"], 0.015625);

// Two scenes in one page: one is chosen, and its address keeps the choice.
await tried("both", "", async (page) => {
  check(await page.until("steps > 5 && !at('scenes').hidden"), "no choice of scenes");
  const title = await page.evaluate("document.title");
  await page.evaluate(`(() => { const choice = at('scenes').lastChild;
    choice.value = 'kepler';
    choice.dispatchEvent(new Event('change')); })()`);
  check(await page.until("typeof given === 'object' && given.name === 'kepler' && steps > 5"),
    "the other scene does not run");
  check(await page.evaluate("document.title") !== title, "the title stays");
  check(await page.evaluate("fragment()").then((text) => /scene=kepler/.test(text)),
    "the address forgets the scene");
});

// Schemes may be added while it moves, several in a moment.
await tried("pendulum", "integrators=verlet", async (page) => {
  check(await page.until("steps > 5"), "one scheme does not move");
  await page.evaluate(addScheme + "; " + addScheme);
  check(await page.until("list.length === 3 && steps > 1", 20), "three schemes do not move");
  await page.evaluate(addScheme);
  check(await page.until("list.length === 4 && steps > 5", 20),
    "four schemes do not move: " + await page.evaluate("list.length + ', ' + steps"));
  check(await page.evaluate("histories.length === 4 && rows.every((r) => r[0] > 0)"),
    "a scheme that was added stands");
  // The limit of stability is not that of the step that is typed.
  await page.until("S.limited !== '' && S.limit > 0", 20);
  const limit = await page.evaluate("S.limit");
  await page.evaluate(`at("dt-number").value = 1e6;
    at("dt-number").dispatchEvent(new Event("change"))`);
  check(await page.until("S.dt === 1e6 && !busy", 20), "a long step is not taken");
  check(await page.evaluate("S.limit") === limit, "the limit follows the step");
});

// It moves, alone, and stops and goes by keys; formulas are changed, and wrong
// ones are refused with the place.
await tried("pendulum", "", async (page) => {
  check(await page.until("steps > 5"), "nothing moves");
  await page.key(" ", "Space", " ");
  const stood = await page.evaluate("quiet().then(() => steps)");
  await new Promise((resolve) => setTimeout(resolve, 300));
  check(await page.evaluate("steps") === stood, "space does not pause");
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
  check(await page.evaluate(`(() => { const line = at("wrong").firstChild;
    return line.scrollWidth <= line.parentNode.clientWidth; })()`), "a sentence is cut");
  await type("gravity", "9*phi^2/2");
  check(await page.until("at('wrong').textContent === '' && /9\\*phi/.test(S.text)"),
    "the formula is not taken");
  await page.evaluate("setPlaying(true)");
  check(await page.until("steps > 5"), "the new one does not move");
  check(await page.evaluate("playing && at('status').offsetHeight < 2"),
    "shows words of before while it plays");
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
// The page opens on its lesson; a step that is typed is taken; a scheme of one's own runs
// and is measured at once, and wrong weights are refused with the sum; a new name becomes
// a parameter; the title says what was changed.
await tried("pendulum", "", async (page) => {
  check(await page.until("steps > 2 && at('lesson').textContent"), "no lesson");
  check(await page.evaluate("S.dt === lesson.dt && /rk4 .*verlet/.test(lessonText())"),
    "opens elsewhere");
  check(await page.evaluate("errorBox[1] - errorBox[0] >= SHOWN * seconds() * 0.99 && " +
    "phaseBox[3] > 6.2"), "axes have no room for half a minute, and the separatrix");
  const mine = (weights) => page.evaluate(`(async () => { setPlaying(false);
    at("weights").value = ${JSON.stringify(weights)}; await runMine();
    return at("wrong-own").textContent; })()`);
  check(/0\.8333/.test(await mine("kick = 1/6, 2/3\ndrift = 1/2, 1/2")), "takes wrong weights");
  check(await mine("kick = 1/6, 2/3, 1/6\ndrift = 1/2, 1/2") === "", "refuses weights");
  check(await page.until("/order 2, symplectic: yes.*energy error/.test(factsText())"),
    "no facts: " + await page.evaluate("factsText()"));
  check(await page.evaluate("!/own formulas/.test(titleText())"), "other formulas");
  await page.evaluate(`(() => { document.querySelector("#effects input[name=gravity]").value =
    "-m*g*l*cos(phi) + kk*phi^2/9"; at("formulas").requestSubmit(); })()`);
  check(await page.until("!at('missing').hidden"), "offers no parameter");
  await page.evaluate(`(() => { at("missing").querySelector("input").value = "0.5";
    at("missing").requestSubmit(); })()`);
  check(await page.until("/kk = 0.5/.test(S.text) && at('missing').hidden"), "no parameter kk");
  // An effect that is typed can be switched off; what is wrong with it is named.
  const add = (name, formula) => page.evaluate(`(() => { at("new-name").value = "${name}";
    at("new-formula").value = "${formula}"; at("formulas").requestSubmit(); })()`);
  await add("stiff", "phi^");
  check(await page.until("/phi\\^/.test(at('wrong').textContent)"), "takes phi^ as an effect");
  await add("stiff", "stiffness*phi^4");
  check(await page.until("/stiffness/.test(at('missing').textContent)"), "asks for no stiffness");
  await page.evaluate(`(() => { at("missing").querySelector("input").value = "0.2";
    at("missing").requestSubmit(); })()`);
  check(await page.until("scene.equations.some((e) => e.name === 'stiff' && e.on)"),
    "does not add the effect");
  await page.evaluate(`document.querySelector("[aria-label='effect stiff is on']").click()`);
  check(await page.until("scene.equations.some((e) => e.name === 'stiff' && !e.on)"),
    "does not switch the effect off");
  check(await page.until("/own formulas/.test(document.title)"), "the title stays");
  await page.evaluate(`(() => { at("dt-number").value = "0.0125";
    at("dt-number").onchange(); at("wall").click(); })()`);
  check(await page.until("S.dt === 0.0125 && rows.length > 0"), "takes no step");
  check(await page.evaluate("getComputedStyle(at('effects').closest('.panels')).display")
    === "none", "controls stay on the wall");
  await page.evaluate("at('wall').focus()");
  await page.key("Escape");
  check(await page.until("!document.body.classList.contains('wall')", 5),
    "Escape does not leave the wall");
  check(await page.evaluate("document.querySelector('#effects input[name=gravity]').clientWidth")
    > 150, "a formula has no room");
  check(await page.evaluate("!/Poincar/.test(at('tries').textContent)"),
    "offers a section of one degree of freedom");
});
// A click in a section starts an orbit of the same energy; elsewhere there is none.
await tried("henon-heiles", "section=0", async (page) => {
  check(await page.until("orbits.length === 1 && orbits[0].length > 20"), "no section");
  const click = (y, p) => page.evaluate(`(async () => { drawSection();
    const box = at("phase").getBoundingClientRect();
    await clickSection({ clientX: box.left + phase.x(${y}), clientY: box.top + phase.y(${p}) });
    return at("message").textContent; })()`);
  check(await click(0.1, 0.1) === "", "starts no orbit");
  check(await page.until("orbits.length === 2 && orbits[1].length > 20"), "no second orbit");
  check(await page.evaluate("Math.hypot(orbits[1][0] - 0.1, orbits[1][1] - 0.1) < 0.5"),
    "another orbit");
  check(/no orbit/.test(await click(0.1, 3)), "starts where the energy does not allow it");
  const alike = await page.evaluate(`(() => { const { pen } = phase, used = new Set();
    pen.fillRect = () => used.add(pen.fillStyle);
    drawSection();
    delete pen.fillRect;
    return NEVH_COLOURS.flat().filter((colour) => used.has(colour.toLowerCase())); })()`);
  check(alike.length === 1, "orbits that are clicked look like schemes: " + alike);
});
// How many steps are asked for at a time changes no bit; a disc keeps its area.
await tried("pendulum", "integrators=verlet,rk4,euler&disc=1&dt=0.0625", async (page) => {
  check(await page.until("rows.length === 6"), "no disc");
  const states = async (chunk) => {
    await page.evaluate("setPlaying(false)");
    await page.evaluate(`(async () => { await race();
      for (let left = 240, done; left > 0; left -= done) {
        done = await go(Math.min(left, ${chunk}));
        if (!done) throw new Error("takes no steps: " + at("message").textContent);
      } })()`);
    return page.evaluate("JSON.stringify(rows.map((row) => Array.from(row)))");
  };
  const one = await states(1), many = await states(240);
  check(one === many, "chunks of steps change the orbit");
  const ratio = (i) => page.evaluate(`Math.abs(rows[${i}][1] / list[${i}].area)`);
  check(Math.abs(await ratio(3) - 1) < 0.01, "verlet's area changes: " + await ratio(3));
  check(Math.abs(await ratio(5) - 1) > 0.1, "euler's area stays: " + await ratio(5));
  await fits(page, "pendulum");
});
await tried("fput", "integrators=verlet,symplectic-euler-a,euler&disc=1", async (page) => {
  check(await page.until("steps > 5"), "nothing moves");
  await fits(page, "fput");
});

// The button "Areas": the disc is resolved for ten seconds, and is as the sentence says.
await tried("kepler", "", async (page) => {
  check(await page.until("steps > 5"), "nothing moves");
  await page.evaluate(`[...at("tries").querySelectorAll("button")]
    .find((one) => one.textContent === "Areas").click()`);
  check(await page.until("list.length === 4 && rows[0][0] >= 10 * seconds()"), "no disc");
  const [kept, other] = await page.evaluate(`setPlaying(false); quiet().then(() =>
    [2, 3].map((i) => areaText(rows[i], list[i].area)))`);
  check(/ratio (1\.0|0\.9[5-9])/.test(kept), "a disc of verlet: " + kept);
  check(/ratio 0\.[0-8]/.test(other), "a disc of euler: " + other);
  check(await page.evaluate("/with euler it changes/.test(at('lesson').textContent)"),
    "the sentence");
});

// A telephone: nothing is wider; all controls have names; keys move them; the
// address holds what was set; where motion is not wanted nothing moves.
{
  const page = await browse(program, `file://${folder}/kepler.html`, {
    size: [360, 800], still: true });
  try {
    check(await page.until("rows.length > 0 && S.limit > 0"), "kepler does not start");
    check(await page.evaluate("document.documentElement.scrollWidth") <= 360,
      "the page is wider than a telephone");
    await new Promise((resolve) => setTimeout(resolve, 500));
    check(await page.evaluate("steps") === 0, "moves where motion is not wanted");
    const nameless = await page.evaluate(`Array.from(document.querySelectorAll(
      "button,input,select,textarea,canvas")).filter((e) => !(e.textContent.trim() ||
      e.getAttribute("aria-label") || e.labels?.length)).map((e) => e.id).join(" ")`);
    check(nameless === "", "controls without a name: " + nameless);
    // Before it moves, the plane has the size over which H varies, and its ticks,
    // between which a start is, are told apart.
    const ticks = await page.evaluate(`nevhTicks(phaseBox[0], phaseBox[1]).map((v, i,
      all) => nevhNumber(v, all))`);
    check(ticks.length > 1 && new Set(ticks).size === ticks.length,
      "ticks alike: " + ticks);
    check(await page.evaluate("phaseBox[1] - phaseBox[0] > 0.01 && " +
      "phaseBox[3] - phaseBox[2] > 0.01"), "an empty plane");
    check(await page.evaluate(`[0.40001, 0.40002, 0.40003].map((v, i, all) =>
      nevhNumber(v, all)).join(" ")`) === "0.40001 0.40002 0.40003", "ticks alike");
    await page.evaluate("at('command').scrollIntoView()");
    check(await page.evaluate(`["command", "states"].every((id) =>
      at(id).scrollWidth <= at(id).parentElement.clientWidth)`),
    "the command, or the table, is cut");
    const dt = await page.evaluate("S.dt");
    await page.evaluate("at('dt').focus()");
    await page.key("ArrowRight");
    check(await page.until(`S.dt > ${dt}`), "an arrow moves no slider");
    await page.key("End");
    check(await page.until("Math.abs(S.dt / S.limit - 1) < 1e-3"),
      "the end is not the limit");
    check(await page.evaluate("Math.abs(S.limit - 0.3578) < 0.01"),
      "the limit of Verlet steps is " + await page.evaluate("S.limit"));
    await page.evaluate("at('phase').focus()");
    const x = await page.evaluate("rows[0][4]");
    await page.key("ArrowRight");
    check(await page.until(`rows[0][4] !== ${x}`), "an arrow moves no start");
    await page.evaluate("at('share').click()");
    const shared = await page.evaluate("location.hash");
    check(/dt=/.test(shared) && /start=x/.test(shared), "shares " + shared);
    await page.evaluate("window.left = true; location.reload()");
    check(await page.until("typeof left === 'undefined' && typeof fragment === 'function'"
      + " && typeof rows !== 'undefined' && rows.length > 0"), "no reload");
    check(await page.evaluate("fragment()") === shared, "reads other settings than it shares: " + await page.evaluate("fragment()"));
    // A body, and a point of the plane, are where they were dropped, also after
    // moves in between.
    await page.evaluate("setPlaying(false)");
    const dragged = async (id, plane, from, path) => {
      const [x, y] = await page.evaluate(`(() => {
        at("${id}").scrollIntoView({ block: "center" }); draw();
        const box = at("${id}").getBoundingClientRect();
        return [box.left + ${plane}.x(${from[0]}), box.top + ${plane}.y(${from[1]})];
      })()`);
      const [right, down] = path.at(-1);
      const wanted = await page.evaluate(
        `${plane}.under({ clientX: ${x + right}, clientY: ${y + down} })`);
      await page.pointer("mousePressed", x, y);
      for (const [to, below] of path) {
        await page.pointer("mouseMoved", x + to, y + below);
        await new Promise((resolve) => setTimeout(resolve, 300));
      }
      await page.pointer("mouseReleased", x + right, y + down);
      check(await page.until("!pulling"), "a drag does not end");
      return wanted;
    };
    const near = (a, b) => Math.abs(a - b) < 2e-3;
    const path = [[10, 30], [25, -20], [-20, 40]];
    let to = await dragged("scene", "configuration", ["pictures[0][0]",
      "pictures[0][1]"], path);
    let start = await page.evaluate("S.start");
    check(start && near(start[0], to[0]) && near(start[1], to[1]),
      `a body dropped at ${to} starts at ${start}`);
    to = await dragged("phase", "phase", ["rows[0][4]", "rows[0][6]"], path);
    start = await page.evaluate("S.start");
    check(start && near(start[0], to[0]) && near(start[2], to[1]),
      `a state dropped at ${to} starts at ${start}`);
    // A drag that the browser takes over, as for scrolling, ends; fingers scroll the
    // page over pictures in which nothing is dragged.
    const [right, down] = await page.evaluate(`(() => { const box =
      at("phase").getBoundingClientRect();
      return [box.left + box.width / 2, box.top + box.height / 2]; })()`);
    await page.pointer("mousePressed", right, down);
    check(await page.until("pulling"), "is not dragged");
    await page.evaluate("at('phase').dispatchEvent(new PointerEvent('pointercancel'))");
    check(await page.until("!pulling", 10), "a drag that is taken over does not end");
    await page.pointer("mouseReleased", right, down);
    check(await page.evaluate(`["scene", "error"].every((id) =>
      getComputedStyle(at(id)).touchAction === "auto")`), "pictures do not scroll");
    await saved(page, `${basename(program)}-page-narrow`);
    check(page.faults.length === 0, "kepler: console: " + page.faults.join("; "));
  } finally {
    await page.close();
  }
}
// Two coordinates without a picture are drawn as a point of their plane.
await tried("henon-heiles", "", async (page) => {
  check(await page.until("paths[0] && paths[0][0] && paths[0][0].length > 20"),
    "draws no path");
  const off = await page.evaluate(`(() => { setPlaying(false); return Math.hypot(
    pictures[0][0] - rows[0][4], pictures[0][1] - rows[0][5]); })()`);
  check(off === 0, "draws another point, off by " + off);
  // The curves of the errors cross where the lesson says so.
  const { falls, crossing, said } = await page.evaluate(`(async () => {
    await quiet();
    while (rows[0][0] < 1.2 * lesson.crossing + seconds()) await go(20);
    const lines = [];
    errors.line = (points) => lines.push(points);
    drawErrors();
    delete errors.line;
    const [kept, other] = lines;
    const below = (i) => !(other[i + 1] > kept[i + 1]);
    let last = 0;
    for (let i = 0; i < kept.length; i += 2) if (below(i)) last = i;
    return { falls: kept.some((v, i) => i % 2 && v < kept[i - 2]), crossing: kept[last],
      said: lesson.crossing }; })()`);
  check(!falls, "the curve of the largest error falls");
  check(Math.abs(crossing / said - 1) < 0.1, `the curves cross at ${crossing}, not ${said}`);
});
// One coordinate without a picture is drawn against time; a pendulum that stands on its
// head is shown about the top, in one piece, over levels of all that is shown.
await tried("kapitza", "", async (page) => {
  check(await page.until("steps > 60"), "nothing moves");
  await page.evaluate("setPlaying(false); quiet()");
  // The next frame draws the last states.
  check(await page.until("configuration.box[1] >= rows[0][0] && " +
    "configuration.box[2] > 2.8 && configuration.box[3] < 3.5"),
  "does not draw phi against time");
  check(await page.until("phaseBox[0] > Math.PI/2 && phaseBox[1] < 3*Math.PI/2"),
    "the plane does not show the top");
  // A box that is asked for while the levels of another are made.
  await page.evaluate(`askLevels(phaseBox.slice()); phaseBox[3] += 100;
    askLevels(phaseBox.slice())`);
  check(await page.until("!asking && levels.some((v, i) => i % 2 && v > 50)"),
    "no levels of the later box");
  check(await page.evaluate("!at('scenes').checkVisibility()"),
    "offers scenes where there is one");
  check(await page.evaluate("/● verlet .*■/.test(at('legend').textContent)"),
    "no legend: " + await page.evaluate("at('legend').textContent"));
  check(/levels of H at t = 0:/.test(await page.evaluate(
    "at('phase-caption').textContent")), "levels are not said to be those of the start");
  check(await page.evaluate("momentumUnit(scene.coordinates[0])") === " (J s)",
    "the momentum has no unit");
  await page.evaluate("at('share').click()");
  check(await page.until("at('shared').textContent", 10), "does not say what it shares");
});
// What is drawn of a scene in which no energy is kept is said; small momenta fill their axis.
await tried("damped", "", async (page) => {
  check(await page.until("steps > 20"), "nothing moves");
  check(await page.evaluate("at('word').textContent") === "balance error", "another word");
  check(/levels of H, without friction/.test(await page.evaluate(
    "at('phase-caption').textContent")), "levels are not said to be without friction");
  check(await page.until("phaseBox[3] - phaseBox[2] < 2e-10"), "an axis of nothing");
});
// A turn takes some seconds, also where steps are short.
await tried("kepler-0.9", "speed=0", async (page) => {
  check(await page.until("steps > 5"), "nothing moves");
  const turn = await page.evaluate("2 * Math.PI / seconds()");
  check(turn > 2 && turn < 8, "a turn takes " + turn + " s");
});
// The steps of twenty minutes of frames take no more memory than those of one: what is
// kept is thinned when it is full, so the heap rises and falls by 0.6 MB.
await tried("pendulum", "speed=3&integrators=verlet,rk4,euler,gauss4", async (page) => {
  check(await page.until("steps > 5"), "nothing moves");
  await page.evaluate("setPlaying(false)");
  const frames = (count) => page.evaluate(`(async () => { await quiet();
    for (let left = ${count}; left > 0;) { left -= await go(Math.min(left, 120));
      draw(); } })()`);
  const size = async () => [await page.heap(),
    await page.evaluate("document.querySelectorAll('*').length")];
  await frames(3600);
  const [heap, elements] = await size();
  await frames(72000);
  const [more, after] = await size();
  console.log("heap " + heap + ", later " + more);
  check(after === elements, `${after} elements, ${elements} before`);
  check(more < heap + 800000, `${more} bytes, ${heap} before`);
});
ended();
