// nevh: the live page: settings, requests to the worker, the clock, drawing.
// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

const at = (id) => document.getElementById(id);
const all = JSON.parse(at("given").textContent); // scenes
const asked = new URLSearchParams(location.hash.slice(1)).get("scene");
const given = all.find((one) => one.name === asked) || all[0];
const PATIENCE = 5000; // milliseconds until a request is given up
const TRAIL = 3000, PATH = 800;
const SHOWN = 30; // seconds that the pictures have room for from the first on
const now = () => performance.now();

// ---- the worker ----
let worker, number = 0, module, engine;
const waiting = new Map();

async function startWorker() {
  module = module || await nevhUnpack("module").arrayBuffer();
  engine = engine || await nevhUnpack("engine").text();
  const text = engine +
    "\nonmessage = ((take) => (event) => take(event.data))" +
    "(nevhEngine((answer) => postMessage(answer)));";
  const address = URL.createObjectURL(new Blob([text],
    { type: "text/javascript" }));
  worker = new Worker(address);
  worker.onerror = (event) => { at("message").textContent = event.message; };
  worker.onmessage = ({ data }) => {
    const wait = waiting.get(data.number);
    waiting.delete(data.number);
    if (!wait) return;
    clearTimeout(wait.timer);
    wait.resolve(data);
  };
  return ask({ ask: "load", module });
}
function ask(request) {
  return new Promise((resolve) => {
    const mine = ++number;
    const timer = setTimeout(async () => {
      const lost = [...waiting.values()]; // all end with the worker
      waiting.clear();
      lost.forEach((wait) => clearTimeout(wait.timer));
      worker.terminate();
      await startWorker();
      lost.forEach((wait) => wait.resolve({ ok: false, broken: true,
        message: "This takes longer than " + PATIENCE / 1000 +
          " s, and was given up. Make H simpler." }));
    }, PATIENCE);
    waiting.set(mine, { resolve, timer });
    worker.postMessage({ ...request, number: mine });
  });
}

// ---- settings ----
const S = {
  text: given.text, dt: given.dt || 0, schemes: given.integrators || [],
  gradient: (given.gradients || [""])[0], changes: given.changes || [],
  exact: false, disc: false, plane: 0, speed: 0, start: null, section: -1, wall: false,
};
// Without settings, the page opens where the schemes part.
let lesson = given.lesson || null;
function takeLesson() {
  if (!S.schemes.length) S.schemes = lesson.schemes.slice();
  Object.assign(S, { dt: lesson.dt, speed: lesson.faster });
}
if (lesson) takeLesson();
let scene = null, list = [], rows = [], pictures = [], results = [];
let histories = [], trails = [], paths = [], playing = false, held = false, busy = false, due = 0;
let limiting = 0, ahead = [], extent = null, pulling = false, levels = null, seen = null, phaseBox = null, steps = 0, last = 0;

function readFragment() {
  const from = new URLSearchParams(location.hash.slice(1));
  const has = (name, use) => from.getAll(name).forEach(use);
  has("text", (v) => { S.text = v; lesson = null; });
  has("dt", (v) => { S.dt = +v > 0 ? +v : 0; S.speed = 0; });
  has("integrators", (v) => { S.schemes = v.split(",").slice(0, 4); });
  has("wall", () => { S.wall = true; });
  has("section", (v) => { S.section = parseInt(v, 10); });
  has("gradient", (v) => { S.gradient = v; });
  has("exact", () => { S.exact = true; });
  has("disc", () => { S.disc = true; });
  has("plane", (v) => { S.plane = Math.max(0, parseInt(v, 10) || 0); });
  has("speed", (v) => { S.speed = +v || 0; });
  has("with", (v) => v.split(",").forEach((e) => S.changes.push(["+", e])));
  has("without", (v) => v.split(",").forEach((e) => S.changes.push(["-", e])));
  has("set", (v) => S.changes.push(["=", v.replace(":", "=")]));
  has("start", (v) => S.changes.push(["@", v.replace(":", "=")]));
  has("test", (v) => { S.test = parseInt(v, 10); });
}
function fragment() {
  const to = new URLSearchParams();
  if (all.length > 1) to.append("scene", given.name);
  if (S.text !== given.text) to.append("text", S.text);
  to.append("dt", S.dt);
  to.append("integrators", S.schemes.join(","));
  to.append("gradient", S.gradient);
  if (S.section >= 0) to.append("section", S.section);
  for (const flag of ["exact", "disc", "wall"]) if (S[flag]) to.append(flag, "1");
  if (S.plane) to.append("plane", S.plane);
  if (S.speed || given.lesson?.faster) to.append("speed", S.speed);
  const names = { "+": "with", "-": "without", "=": "set", "@": "start" };
  for (const [mark, what] of changes())
    to.append(names[mark], what.replace("=", ":"));
  return "#" + to.toString();
}
// Changes of the scene, and of a start that was dragged.
function changes() {
  const list = S.changes.slice();
  if (S.start && scene)
    scene.coordinates.forEach((c, k) => {
      const n = scene.coordinates.length;
      list.push(["@", c.name + "=" + S.start[k]],
        ["@", "p_" + c.name + "=" + S.start[n + k]]);
    });
  return list;
}
function command() {
  const quoted = (v) => /^[\w.,=+-]+$/.test(v) ? v : "'" + v + "'";
  const names = { "+": "with", "-": "without", "=": "set", "@": "start" };
  const file = S.text === given.text ? given.name : "own.nevh";
  let text = "nevh compare " + quoted(file) + " --integrators " +
    S.schemes.join(",") + " --dt " + S.dt + " --gradient " + S.gradient;
  for (const [mark, what] of changes())
    text += " --" + names[mark] + " " + quoted(what);
  if (steps > 0) text += " --t-end " + rows[0]?.[0];
  return text + " --portable";
}

// ---- scenes ----
async function open(text, list) {
  const answer = await ask({ ask: "open", name: given.name, text,
    changes: list });
  sayWrong(answer.ok ? "" : answer.message);
  if (!answer.ok) return answer;
  opened = withSection(text, answer.scene);
  return opened === text ? answer
    : ask({ ask: "open", name: given.name, text: opened, changes: list });
}
let opened = ""; // the text that the worker has
// Takes a scene, or says what is wrong with it and keeps the one before.
// wanted: a scheme of it that is to run.
async function use(text, list, wanted = []) {
  held = true;
  clearTimeout(limiting);
  await quiet();
  const answer = await open(text, list);
  if (!answer.ok) {
    if (scene) await ask({ ask: "open", name: given.name, text: opened,
      changes: S.changes });
    if (scene) await race();
    held = false;
    return false;
  }
  Object.assign(S, { text, changes: list, start: null,
    schemes: S.schemes.concat(wanted).slice(-4) });
  scene = answer.scene;
  settle();
  S.limit = S.limited = 0;
  show();
  await race();
  held = false;
  // Later, since a scene of many coordinates takes long for it.
  limiting = setTimeout(findLimit, 500);
  return true;
}
// Settings that a scene asks for, where none are given.
function settle() {
  const run = scene.run, known = new Set(scene.integrators.map((i) => i.name));
  if (!S.dt) S.dt = run.step;
  S.schemes = [...new Set(S.schemes)].filter((name) => known.has(name));
  if (!S.schemes.length)
    S.schemes = contrast(run.integrators.filter((name) => known.has(name)));
  if (!S.schemes.length) S.schemes = ["midpoint", "rk4"];
  if (!S.gradient) S.gradient = run.gradients[0] || "central4";
  S.plane = Math.min(S.plane, scene.coordinates.length - 1);
  if (!scene.sections[S.section]) S.section = -1;
}
// The first, and one that is not symplectic.
function contrast(names) {
  const other = names.find((name) => scene.integrators.some((i) =>
    i.name === name && i.symplectic === "no"));
  return other && other !== names[0] ? [names[0], other] : names.slice(0, 2);
}
// Of the orbit, in one second.
const seconds = () => scene.run.rate * 2 ** S.speed;

// The longest step that the schemes are stable with, which is the slider's end.
async function findLimit() {
  const h = scene.run.step;
  const { ok, steps } = await ask({ ask: "limit", h, schemes: S.schemes });
  const finite = ok ? steps.filter((v) => v > 0 && Number.isFinite(v)) : [];
  S.limit = finite.length ? Math.min(...finite) : 8 * h;
  S.limited = finite.length ? S.schemes[steps.indexOf(S.limit)] : "";
  showSliders();
}

// ---- runs ----
// One after another, and no steps meanwhile.
async function race() {
  while (busy) await quiet();
  busy = true;
  await start().finally(() => { busy = false; });
}
// The runs before are drawn until all of the new ones is known.
async function start() {
  const one = { gradient: S.gradient, h: S.dt };
  const runs = S.schemes.map((scheme) => ({ ...one, scheme, colour: nevhLook(scheme) }));
  if (S.exact)
    runs.push({ ...one, scheme: "taylor", tolerance: 1e-16, colour: -1 });
  if (S.disc)
    S.schemes.forEach((scheme) => runs.push({ ...one, scheme, colour: nevhLook(scheme),
      width: 256, k: S.plane }));
  const begin = () => ask({ ask: "race", list: runs, start: S.start });
  const answer = await begin();
  if (!answer.ok) { at("message").textContent = answer.message; return; }
  if (!pulling) {
    const { ok, found, broken } = await ask({ ask: "ahead", list: runs.filter((r) =>
      !(r.width > 1)), steps: Math.ceil(SHOWN * seconds() / S.dt), start: S.start });
    ahead = ok ? found : [];
    if (broken) {
      await open(S.text, S.changes);
      await begin();
    }
    await findExtent();
    phaseBox = seen = levels = errorBox = null;
  }
  list = runs;
  steps = due = 0;
  profile = 0;
  histories = list.map(() => new NevhHistory());
  trails = list.map(() => []);
  paths = list.map(() => []);
  take(answer);
  results.forEach((r, i) => { list[i].area = rows[i]?.[1]; });
  pictures.forEach(widen);
  if (range() && !pulling) reachAhead(range());
  showTries();
  report(true);
  await restartSection();
}
// What the first scheme will reach, where it does not run away.
const range = () => ahead[0] && ahead[0].error < 1 ? ahead[0] : null;
function take(answer) {
  results = answer.runs;
  rows = answer.states;
  pictures = answer.pictures;
  (answer.samples || []).forEach((values, i) => {
    const long = 4 + 2 * scene.coordinates.length + 2 * scene.bobs;
    for (let j = 0; j + long <= values.length; j += long)
      sample(i, values.subarray(j, j + long));
  });
  if (!answer.samples) rows.forEach((row, i) => row && sample(i, row));
  const failed = results.find((r) => r && r.message);
  at("message").textContent = failed ? failed.message : "";
}
function sample(i, row) {
  if (list[i].width > 1) return;
  const n = scene.coordinates.length, trail = trails[i];
  histories[i].add(row[0], Math.max(row[3], Math.abs(row[2])), row[4 + S.plane],
    row[4 + n + S.plane]);
  trail.push(row[4 + S.plane], row[4 + n + S.plane]);
  if (trail.length > 2 * TRAIL) trail.splice(0, trail.length - 2 * TRAIL);
  for (let j = 0; j < scene.bobs && row.length > 4 + 2 * n; j++) {
    const path = paths[i][j] = paths[i][j] || [];
    const [x, y] = row.subarray(4 + 2 * n + 2 * j);
    if (i === 0) reach(x, y);
    // Points that are nearer than a pixel to the one before are left out.
    const size = seen ? Math.max(seen[1] - seen[0], seen[3] - seen[2]) : 0;
    const far = Math.hypot(x - path.at(-2), y - path.at(-1));
    if (far < size / 400) continue;
    path.push(x, y);
    if (path.length > PATH) path.splice(0, path.length - PATH);
  }
}
// Steps between observations: by the settings alone, so that what is plotted
// does not depend on the machine.
const every = () => Math.max(1, Math.ceil(seconds() / S.dt / 60 / 20));

async function go(count) {
  if (busy || !list.length) return 0;
  busy = true;
  const answer = await ask({ ask: "go", steps: count, every: every() });
  busy = false;
  if (!answer.ok) {
    at("message").textContent = answer.message;
    playing = false;
    if (answer.broken) await open(S.text, S.changes);
    return 0;
  }
  steps += answer.done;
  take(answer);
  pictures.forEach((picture, i) => i === 0 && widen(picture));
  return answer.done;
}
async function quiet() {
  while (busy) await new Promise((resolve) => setTimeout(resolve, 5));
}

// ---- the clock: elapsed time says only how many steps are due ----
function frame(time) {
  requestAnimationFrame(frame); // the next one comes whatever fails in this one
  const passed = Math.min(100, time - last) / 1000;
  last = time;
  if (playing && !held && scene) {
    due += passed * seconds() / S.dt;
    const whole = Math.floor(due);
    if (whole > 0 && !busy) {
      due -= whole;
      go(whole).then((done) => {
        if (done < whole && done > 0) due = 0; /* slower, not less exact */
      });
    }
  }
  if (scene && list.length) {
    turnSection();
    draw();
  }
  frames++;
}
let frames = 0;

