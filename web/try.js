// nevh: what the live page says of the scene and offers to try, a scheme of one's own,
// and parameters that are new.
// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// ---- the lesson ----
const timeText = (t) => +digits(t, 2) + after(scene.t_label);
function lessonText() {
  if (!lesson) return "";
  const [kept, other] = lesson.schemes, after = lesson.crossing / lessonRate(), word = errorWord();
  if (lesson.why === 0 && after < 0.5)
    return `At dt = ${lesson.dt} the ${word} of ${other} is the larger one from the ` +
      `start; that of ${kept} stays bounded.`;
  if (lesson.why === 0)
    return `The ${word} of ${other} grows and passes that of ${kept}, which stays ` +
      `bounded, at t = ${timeText(scene.run.t_start + lesson.crossing)}: after ` +
      `${Math.round(after)} s at this speed.`;
  if (lesson.why === 1)
    return `Not here: up to t = ${timeText(lesson.reached)} the ${word} of ${other} ` +
      `stays below that of ${kept}, at every step at which both work.`;
  if (lesson.why === 2)
    return `Not here: at no step does the ${word} of ${kept} stay bounded and small, ` +
      `so ${other} has nothing to pass.`;
  return `Whether ${other} passes ${kept} here would take too long to find out.`;
}
const lessonRate = () => scene.run.rate * 2 ** lesson.faster;
// True while its settings are those that the page shows.
const inLesson = () => lesson && S.dt === lesson.dt && !S.start &&
  lesson.schemes.every((name) => S.schemes.includes(name)) &&
  (lesson.why > 0 || S.speed === lesson.faster);

async function teach() {
  const other = S.schemes.find((name) => schemeOf(name)?.symplectic === "no") || "rk4";
  const answer = await ask({ ask: "lesson", schemes: [keeper(), other], gradient: S.gradient });
  if (!answer.ok) return sayWrong(answer.message);
  lesson = answer.lesson;
  S.start = null;
  S.schemes = [];
  takeLesson();
  showSchemes();
  showSliders();
  await race();
  setPlaying(true);
}
const keeper = () =>
  S.schemes.find((name) => schemeOf(name)?.symplectic === "yes") || "verlet";
const schemeOf = (name) => scene.integrators.find((one) => one.name === name);

// ---- things to try ----
// Each has words, what it sets, and what is to be seen then.
function tries() {
  const first = S.schemes[0], order = schemeOf(first)?.order, list = [
    ["Where the schemes part", "", teach],
    ["Half the step", `the error of ${first} falls to about 1/${2 ** order}`,
      () => set({ dt: +(S.dt / 2).toPrecision(4) })],
  ];
  if (S.limited && S.dt < S.limit)
    list.push(["A step too long", `${S.limited} is unstable at this dt`, () =>
      set({ dt: +(1.02 * S.limit).toPrecision(4), schemes: [S.limited] })]);
  if (scene.coordinates.length <= 3 && !scene.balance)
    list.push(["Areas", "a disc keeps its area with a symplectic scheme; with euler it changes",
      () => set({ disc: true, speed: Math.min(S.speed, 0), schemes: [keeper(), "euler"] })]);
  list.push(["Against the exact orbit",
    first + (scene.balance ? " is" : " keeps its energy, and is") + " out of step",
    () => set({ exact: true })]);
  const cut = scene.sections.findIndex((one) => one.items.length > 1 &&
    (one.every || scene.coordinates.length > 1));
  if (cut >= 0 && S.section < 0)
    list.push([scene.sections[cut].every ? "Stroboscope" : "Poincaré section",
      clicks(scene.sections[cut]) ? "a click in the plane starts an orbit" : "",
      () => set({ section: cut })]);
  for (const e of scene.equations.filter((one) => one.section === "effects").slice(1))
    list.push([(e.on ? "Without " : "With ") + e.name, "", () => use(S.text,
      [...S.changes.filter(([mark, what]) => !"+-".includes(mark) || what !== e.name),
        [e.on ? "-" : "+", e.name]]).then(() => setPlaying(true))]);
  return list.slice(0, 9);
}
async function set(settings) {
  Object.assign(S, settings);
  show();
  await race();
  setPlaying(true);
}
function showTries() {
  const known = tries().map(([words, why, act]) => {
    const made = element("button", { title: why }, words);
    made.onclick = () => { tried = why ? words + ": " + why + "." : ""; act(); };
    return made;
  });
  at("tries").replaceChildren("Try this: ", ...known);
}
let tried = "";
function showLesson() {
  const text = tried || (inLesson() ? lessonText() : "");
  if (at("lesson").textContent !== text) at("lesson").textContent = text;
}

// ---- the title: true also of what was changed ----
function titleText() {
  const names = { "+": "with ", "-": "without ", "=": "", "@": "" };
  const list = S.changes.map(([mark, what]) => names[mark] + what.replace("=", " = "));
  if (cutSection(S.text, MINE)[1].trim() !== cutSection(given.text, MINE)[1].trim())
    list.unshift("own formulas");
  if (S.start) list.push(...scene.coordinates.slice(0, 3).flatMap((c, k) => [c.name + " = " +
    +digits(S.start[k], 3), "p_" + c.name + " = " +
    +digits(S.start[scene.coordinates.length + k], 3)]));
  return (scene.title || given.name) + (list.length ? ", now " + list.join(", ") : "");
}
function showTitle() {
  const text = titleText();
  if (at("title").textContent === text) return;
  at("title").textContent = text;
  document.title = text + " - nevh";
}

// ---- a scheme of one's own: [integrator mine] ----
const MINE = "[integrator mine]";
const KINDS = {
  "of kicks and drifts": "kick = 1/6, 2/3, 1/6\ndrift = 1/2, 1/2",
  "of a Runge-Kutta table": "a = 0, 0 ; 1, 0\nb = 1/2, 1/2",
  "of steps of another": "compose = verlet: 1.3512071919596577, -1.7024143839193153, " +
    "1.3512071919596577",
};
// The lines of a section, and the text without it.
function cutSection(text, head) {
  const lines = text.split("\n"), from = lines.findIndex((line) => line.trim() === head);
  if (from < 0) return ["", text];
  const next = lines.findIndex((line, i) => i > from && /^\s*\[/.test(line));
  const cut = lines.splice(from, (next < 0 ? lines.length : next) - from);
  return [cut.slice(1).join("\n").trim(), lines.join("\n")];
}
async function runMine() {
  const rest = cutSection(S.text, MINE)[1].replace(/\n*$/, "\n\n");
  const fine = await use(rest + MINE + "\n" + at("weights").value.trim() + "\n", S.changes,
    S.schemes.includes("mine") ? [] : ["mine"]);
  at("wrong-own").textContent = fine ? "" : at("wrong").textContent;
  if (!fine) sayWrong("");
}
function factsText() {
  const mine = schemeOf("mine"), i = S.schemes.indexOf("mine");
  if (!mine || !mine.own) return "";
  const found = i >= 0 ? ahead[i] : null;
  return `mine: order ${mine.order}, symplectic: ${mine.symplectic}, symmetric: ` +
    mine.symmetric + (mine.gradients ? `, ${mine.gradients} gradients a step` : "") +
    (mine.limit > 0 ? `, stable up to ω dt = ${+digits(mine.limit, 3)}` : "") +
    (found ? `. Largest ${errorWord()} up to t = ${timeText(found.t)}: ` +
      found.error.toExponential(1) : "") + "." +
    (mine.lacks ? ` For more: ${mine.lacks}.` : "");
}

// ---- a parameter that a formula names and the scene does not ----
function offerParameter(message) {
  const name = message.match(/the name (\w+) is not known/)?.[1];
  at("missing").hidden = !name;
  if (!name) return;
  const [label] = at("missing").children;
  label.firstChild.textContent = name + " =";
  at("missing").onsubmit = (event) => {
    event.preventDefault();
    const line = name + " = " + (label.lastChild.value.trim() || "1");
    const text = rewritten().split("\n");
    const from = text.findIndex((one) => one.trim() === "[parameters]");
    text.splice(from < 0 ? text.findIndex((one) => one.trim() === "[coordinates]") : from + 1,
      0, ...from < 0 ? ["[parameters]", line, ""] : [line]);
    use(text.join("\n"), S.changes);
  };
}
