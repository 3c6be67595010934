// nevh: the live page: settings, requests to the worker, the clock, drawing.
// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

const at = (id) => document.getElementById(id);
const given = JSON.parse(at("given").textContent);
const PATIENCE = 5000; // milliseconds until a request is given up
const TRAIL = 3000;
const now = () => performance.now();

// ---- the worker ----
let worker, number = 0, module;
const waiting = new Map();

async function unpack() {
  const bytes = Uint8Array.from(atob(at("module").textContent.trim()),
    (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream()
    .pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}
async function startWorker() {
  module = module || await unpack();
  const text = at("engine").textContent +
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
      waiting.delete(mine);
      worker.terminate();
      await startWorker();
      resolve({ ok: false, broken: true, message: "This takes longer than " +
        PATIENCE / 1000 + " s, and was given up. Make H simpler." });
    }, PATIENCE);
    waiting.set(mine, { resolve, timer });
    worker.postMessage({ ...request, number: mine });
  });
}

// ---- settings ----
const S = {
  text: given.text, dt: given.dt || 0, schemes: given.integrators || [],
  gradient: (given.gradients || [""])[0], changes: given.changes || [],
  exact: false, disc: false, plane: 0, speed: 0, start: null,
};
let scene = null, list = [], rows = [], pictures = [], results = [];
let histories = [], trails = [], playing = false, busy = false, due = 0, ahead = 0;
let levels = null, seen = null, phaseBox = null, steps = 0, last = 0;

function readFragment() {
  const from = new URLSearchParams(location.hash.slice(1));
  const has = (name, use) => from.getAll(name).forEach(use);
  has("text", (v) => { S.text = v; });
  has("dt", (v) => { S.dt = +v > 0 ? +v : 0; });
  has("integrators", (v) => { S.schemes = v.split(",").slice(0, 4); });
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
  if (S.text !== given.text) to.append("text", S.text);
  to.append("dt", S.dt);
  to.append("integrators", S.schemes.join(","));
  to.append("gradient", S.gradient);
  for (const flag of ["exact", "disc"]) if (S[flag]) to.append(flag, "1");
  if (S.plane) to.append("plane", S.plane);
  if (S.speed) to.append("speed", S.speed);
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
  at("wrong").textContent = answer.ok ? "" : answer.message;
  return answer;
}
// Takes a scene, or says what is wrong with it and keeps the one before.
async function use(text, list) {
  const before = playing;
  playing = false;
  await quiet();
  const answer = await open(text, list);
  if (!answer.ok) {
    if (scene) await ask({ ask: "open", name: given.name, text: S.text,
      changes: S.changes });
    if (scene) await race();
    playing = before;
    return false;
  }
  Object.assign(S, { text, changes: list, start: null });
  scene = answer.scene;
  settle();
  show();
  await race();
  playing = before;
  return true;
}
// Settings that a scene asks for, where none are given.
function settle() {
  const run = scene.run, known = new Set(scene.integrators.map((i) => i.name));
  if (!S.dt) S.dt = Math.min(...run.dt.length ? run.dt : [0.01]);
  if (!S.limit) S.limit = 8 * S.dt;
  S.schemes = S.schemes.filter((name) => known.has(name));
  if (!S.schemes.length)
    S.schemes = contrast(run.integrators.filter((name) => known.has(name)));
  if (!S.schemes.length) S.schemes = ["midpoint", "rk4"];
  if (!S.gradient) S.gradient = run.gradients[0] || "central4";
  S.plane = Math.min(S.plane, scene.coordinates.length - 1);
}
// The first, and one that is not symplectic.
function contrast(names) {
  const other = names.find((name) => scene.integrators.some((i) =>
    i.name === name && i.symplectic === "no"));
  return other && other !== names[0] ? [names[0], other] : names.slice(0, 2);
}
const seconds = () => // of the orbit, in one second
  (scene.t_label === "s" ? 1 : 40 * (scene.run.dt[0] || S.dt)) * 2 ** S.speed;

// ---- runs ----
async function race() {
  await quiet();
  const one = { gradient: S.gradient, h: S.dt };
  list = S.schemes.map((scheme, i) => ({ ...one, scheme, colour: i }));
  if (S.exact)
    list.push({ ...one, scheme: "taylor", tolerance: 1e-16, colour: -1 });
  if (S.disc) {
    const [dq, dp] = radii();
    S.schemes.forEach((scheme, i) => list.push({ ...one, scheme, colour: i,
      width: 256, k: S.plane, dq, dp }));
  }
  const answer = await ask({ ask: "race", list, start: S.start });
  if (!answer.ok) { at("message").textContent = answer.message; return; }
  steps = 0;
  due = 0;
  phaseBox = seen = levels = null;
  histories = list.map(() => new NevhHistory());
  trails = list.map(() => []);
  take(answer);
  results.forEach((r, i) => { list[i].area = rows[i]?.[1]; });
  pictures.forEach(widen);
  report(true);
}
const radii = () => {
  const c = scene.coordinates[S.plane], size = (v) => Math.abs(v) || 1;
  return [0.15 * Math.min(2, size(c.start[0])), 0.15 * Math.max(1, size(c.start[1]))];
};
function take(answer) {
  results = answer.runs;
  rows = answer.states;
  pictures = answer.pictures;
  (answer.samples || []).forEach((values, i) => {
    const long = 4 + 2 * scene.coordinates.length;
    for (let j = 0; j + long <= values.length; j += long)
      sample(i, values.subarray(j, j + long));
  });
  if (!answer.samples) rows.forEach((row, i) => row && sample(i, row));
  const failed = results.find((r) => r && r.message);
  at("message").textContent = failed ? failed.message : "";
}
function sample(i, row) {
  if (list[i].width > 1) return;
  histories[i].add(row[0], row[2]);
  const n = scene.coordinates.length, trail = trails[i];
  trail.push(row[4 + S.plane], row[4 + n + S.plane]);
  if (trail.length > 2 * TRAIL) trail.splice(0, trail.length - 2 * TRAIL);
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
  const passed = Math.min(100, time - last) / 1000;
  last = time;
  if (playing && scene) {
    due += passed * seconds() / S.dt;
    const whole = Math.floor(due);
    if (whole > 0 && !busy) {
      due -= whole;
      go(whole).then((done) => {
        if (done < whole && done > 0) due = 0; /* slower, not less exact */
      });
    }
  }
  if (scene && list.length) draw();
  frames++;
  requestAnimationFrame(frame);
}
let frames = 0;

// ---- drawing ----
const configuration = new NevhPlane(at("scene"), [8, 8, 8, 8]);
const errors = new NevhPlane(at("error"), [46, 36, 10, 22]);
const phase = new NevhPlane(at("phase"), [50, 36, 10, 22]);

function widen(picture) {
  if (!picture || !picture.length) return;
  let box = seen || [Infinity, -Infinity, Infinity, -Infinity], i = 0;
  for (const part of scene.parts) {
    for (let j = 0; j + 1 < part.count; j += 2, i += 2) {
      const x = picture[i], y = picture[i + 1];
      if (!Number.isFinite(x + y)) continue;
      box = [Math.min(box[0], x), Math.max(box[1], x),
        Math.min(box[2], y), Math.max(box[3], y)];
    }
    i += part.count % 2;
  }
  seen = box;
}
function drawConfiguration() {
  const b = seen || [-1, 1, -1, 1];
  const reach = Math.max(b[1] - b[0], b[3] - b[2], 1e-9) / 2;
  const cx = (b[0] + b[1]) / 2, cy = (b[2] + b[3]) / 2;
  const fix = scene.parts.some((p) => p.kind === "rod");
  const far = fix ? Math.max(...b.map(Math.abs)) * 1.12 : reach * 1.15;
  configuration.box = fix ? [-far, far, -far, far]
    : [cx - far, cx + far, cy - far, cy + far];
  const pen = configuration.begin(true);
  for (let i = list.length - 1; i >= 0; i--)
    if (pictures[i] && pictures[i].length) drawParts(pen, i);
}
function drawParts(pen, i) {
  const picture = pictures[i], colour = list[i].colour;
  pen.save();
  pen.strokeStyle = pen.fillStyle = nevhColour(colour);
  pen.globalAlpha = i === 0 ? 1 : 0.75;
  pen.lineWidth = i === 0 ? 3 : 2;
  pen.setLineDash(colour < 0 ? [4, 4] : NEVH_DASHES[i % 4]);
  let from = 0;
  for (const part of scene.parts) {
    const v = picture.subarray(from, from + part.count);
    if (part.kind === "rod") configuration.line(v);
    else configuration.mark(v[0], v[1], colour, i === 0 ? 8 : 7);
    from += part.count;
  }
  pen.restore();
}
function drawErrors() {
  let low = 1e-17, high = 1e-16, first = 0, end = 1e-9;
  histories.forEach((h) => h.most.forEach((v, i) => {
    if (Number.isFinite(v)) high = Math.max(high, v);
    end = Math.max(end, h.t[i]);
  }));
  if (histories[0]?.t.length) first = histories[0].t[0];
  high = Math.min(1e4, high * 2);
  errors.box = [first, Math.max(end, first + 20 * S.dt), Math.log10(low),
    Math.ceil(Math.log10(high))];
  const pen = errors.begin(false), powers = [];
  const by = Math.ceil((errors.box[3] - errors.box[2]) / 6);
  for (let v = Math.ceil(errors.box[3]); v > errors.box[2]; v -= by)
    powers.push(v);
  pen.save();
  errors.axes(nevhTicks(errors.box[0], errors.box[1]), powers,
    "t" + unit(scene.t_label), "|energy error|", (v) => "1e" + v);
  histories.forEach((h, i) => {
    if (list[i].width > 1) return;
    const points = [];
    h.t.forEach((t, j) => points.push(t, Math.log10(Math.max(h.most[j], low))));
    pen.strokeStyle = nevhColour(list[i].colour);
    pen.lineWidth = 1.6;
    pen.setLineDash(list[i].colour < 0 ? [4, 4] : NEVH_DASHES[i % 4]);
    errors.line(points);
  });
  pen.restore();
}
const unit = (label) => label ? " (" + label + ")" : "";

// The part of the plane that is shown grows with the first orbit.
function choosePhaseBox() {
  const c = scene.coordinates[S.plane], trail = trails[0] || [];
  let [q0, q1, p0, p1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let i = 0; i < trail.length; i += 2) {
    q0 = Math.min(q0, wrapped(trail[i], c)); q1 = Math.max(q1, wrapped(trail[i], c));
    p0 = Math.min(p0, trail[i + 1]); p1 = Math.max(p1, trail[i + 1]);
  }
  if (list[0] && rows[0] && !(q1 >= q0)) [q0, q1, p0, p1] = [-1, 1, -1, 1];
  if (c.period > 0) { q0 = -c.period / 2; q1 = c.period / 2; }
  const dq = Math.max(q1 - q0, 1e-3 * Math.abs(q0), 1e-9), dp = Math.max(p1 - p0,
    1e-3 * Math.abs(p0), 1e-9);
  const inside = phaseBox && q0 >= phaseBox[0] && q1 <= phaseBox[1] &&
    p0 >= phaseBox[2] && p1 <= phaseBox[3];
  if (inside) return;
  phaseBox = [q0 - (c.period > 0 ? 0 : 0.25 * dq), q1 + (c.period > 0 ? 0 : 0.25 * dq),
    p0 - 0.3 * dp, p1 + 0.3 * dp];
  if (scene.coordinates.length === 1) askLevels(phaseBox.slice());
}
const wrapped = (q, c) => c.period > 0
  ? q - c.period * Math.round(q / c.period) : q;
let asking = false;
async function askLevels(box) {
  if (asking || !rows[0]) return;
  asking = true;
  const nx = 72, ny = 54;
  const answer = await ask({ ask: "levels", at: rows[0].slice(4), k: S.plane,
    box, nx, ny });
  asking = false;
  if (!answer.ok) return;
  const finite = Array.from(answer.values).filter(Number.isFinite)
    .sort((a, b) => a - b);
  levels = [];
  for (let i = 1; i < 14; i++)
    levels.push(nevhContour(answer.values, nx, ny, box,
      finite[Math.floor(finite.length * i / 14)]));
}
function drawPhase() {
  const c = scene.coordinates[S.plane];
  choosePhaseBox();
  phase.box = phaseBox;
  const pen = phase.begin(false);
  pen.save();
  phase.axes(nevhTicks(phaseBox[0], phaseBox[1]), nevhTicks(phaseBox[2],
    phaseBox[3]), c.name + unit(c.label), "p_" + c.name);
  pen.strokeStyle = phase.fore;
  pen.globalAlpha = 0.22;
  pen.lineWidth = 1;
  for (const points of levels || [])
    for (let i = 0; i < points.length; i += 4)
      phase.line(points.slice(i, i + 4));
  pen.globalAlpha = 1;
  for (let i = list.length - 1; i >= 0; i--)
    if (rows[i]) list[i].width > 1 ? drawDisc(pen, i, c) : drawOrbit(pen, i, c);
  pen.restore();
}
function drawOrbit(pen, i, c) {
  const points = [], trail = trails[i], n = scene.coordinates.length;
  let before = NaN;
  for (let j = 0; j < trail.length; j += 2) {
    const q = wrapped(trail[j], c);
    if (c.period > 0 && Math.abs(q - before) > c.period / 2)
      points.push(NaN, NaN);
    points.push(q, trail[j + 1]);
    before = q;
  }
  pen.strokeStyle = pen.fillStyle = nevhColour(list[i].colour);
  pen.lineWidth = 1.4;
  pen.setLineDash(list[i].colour < 0 ? [4, 4] : []);
  phase.line(points);
  phase.mark(wrapped(rows[i][4 + S.plane], c), rows[i][4 + n + S.plane],
    list[i].colour, 5);
}
function drawDisc(pen, i, c) {
  const n = scene.coordinates.length, w = list[i].width;
  pen.fillStyle = nevhColour(list[i].colour);
  for (let j = 0; j < w; j++)
    phase.mark(wrapped(rows[i][4 + S.plane * w + j], c),
      rows[i][4 + (n + S.plane) * w + j], 0, 1.4);
}
let told = 0;
function draw() {
  drawConfiguration();
  drawErrors();
  drawPhase();
  report(false);
}

// ---- text ----
const digits = (v, count = 6) => Number.isFinite(v) ? v.toPrecision(count) : "";
function report(atOnce) {
  const body = at("states").tBodies[0];
  const lines = S.schemes.length + S.exact;
  while (body.rows.length > lines) body.deleteRow(-1);
  while (body.rows.length < lines) {
    const row = body.insertRow();
    for (let j = 0; j < 5; j++) row.insertCell();
  }
  for (let i = 0; i < lines; i++) {
    const cells = body.rows[i].cells, row = rows[i], r = list[i];
    const disc = list.findIndex((o) => o.width > 1 && o.scheme === r.scheme);
    const name = (r.colour < 0 ? "○ exact" : NEVH_MARKS[i] + " " + r.scheme);
    const values = [name, row ? digits(row[0]) : "", row ? digits(row[1], 9) : "",
      row ? row[2].toExponential(2) : "refused",
      disc >= 0 && rows[disc] ? digits(rows[disc][1], 5) + " (×" +
        digits(rows[disc][1] / list[disc].area, 5) + ")" : ""];
    values.forEach((v, j) => {
      if (cells[j].textContent !== v) cells[j].textContent = v;
    });
    cells[0].style.color = nevhColour(r.colour);
  }
  if (!atOnce && (playing ? now() - told < 5000 : told > 0)) return;
  told = now();
  at("status").textContent = spoken();
  at("command").textContent = command();
}
function spoken() {
  if (!rows[0]) return "";
  const state = scene.coordinates.slice(0, 6).map((c, k) =>
    c.name + " = " + digits(rows[0][4 + k], 4)).join(", ");
  return steps + " steps, t = " + digits(rows[0][0], 4) + ": " + S.schemes[0] +
    " has " + state + ", energy error " + rows[0][2].toExponential(1) + ".";
}
