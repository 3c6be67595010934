// nevh: the live page's pictures, and the text that says what they show.
// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// ---- drawing ----
const configuration = new NevhPlane(at("scene"), [8, 8, 8, 24]);
const errors = new NevhPlane(at("error"), [46, 36, 18, 28]);
const margins = (...values) => { configuration.margins = values; };
const phase = new NevhPlane(at("phase"), [50, 36, 18, 28]);

function reach(x, y) {
  const box = seen || [Infinity, -Infinity, Infinity, -Infinity];
  if (Number.isFinite(x + y))
    seen = [Math.min(box[0], x), Math.max(box[1], x),
      Math.min(box[2], y), Math.max(box[3], y)];
}
// Room for all that a run will show, and which bodies will stay where they are.
let still = [];
function reachAhead({ low, high, whole }) {
  const n = scene.coordinates.length;
  still = [];
  for (let j = 0; j < scene.bobs; j++) {
    const [x0, y0] = low.slice(2 * n + 2 * j), [x1, y1] = high.slice(2 * n + 2 * j);
    reach(x0, y0);
    reach(x1, y1);
    still.push(whole && x0 === x1 && y0 === y1);
  }
}
function widen(picture) {
  if (!picture || !picture.length) return;
  let i = 0;
  for (const part of scene.parts) {
    for (let j = 0; j + 1 < part.count; j += 2, i += 2) {
      reach(picture[i], picture[i + 1]);
    }
    i += part.count % 2;
  }
}
function drawConfiguration() {
  if (!scene.parts.length) {
    margins(50, 36, 18, 28);
    return scene.coordinates.length === 1 ? drawMotion() : drawProfile();
  }
  margins(8, 8, 8, 24);
  const b = seen || [-1, 1, -1, 1];
  const reach = Math.max(b[1] - b[0], b[3] - b[2]) / 2 || 1;
  const cx = (b[0] + b[1]) / 2, cy = (b[2] + b[3]) / 2;
  const far = reach * 1.15;
  if (!pulling) configuration.box = [cx - far, cx + far, cy - far, cy + far];
  const pen = configuration.begin(true);
  pen.lineWidth = 1;
  pen.globalAlpha = 0.45;
  paths.forEach((own, i) => {
    pen.strokeStyle = nevhColour(list[i].colour);
    own.forEach((path) => configuration.line(path));
  });
  pen.globalAlpha = 1;
  for (let i = list.length - 1; i >= 0; i--)
    if (pictures[i] && pictures[i].length) drawParts(pen, i);
  if (rows[0]) stamp(pen);
}
const when = () => "t = " + +digits(rows[0]?.[0] ?? 0, 5) + after(scene.t_label);
function stamp(pen) {
  pen.font = 13 * nevhType + "px system-ui,sans-serif";
  pen.fillStyle = nevhColour("fore");
  pen.textAlign = "left";
  pen.textBaseline = "top";
  pen.fillText(when(), 8, 6);
  let [a, b] = [-99, -99];
  for (let i = 0, from = 0; i < scene.parts.length; from += scene.parts[i++].count) {
    const { name } = scene.parts[i];
    if (!name || scene.plain) continue;
    const x = configuration.x(pictures[0][from]) + 12;
    const y = configuration.y(pictures[0][from + 1]) - 18;
    if (Math.abs(x - a) < 50 && Math.abs(y - b) < 14) continue; // over another
    pen.fillText(name, x, y);
    [a, b] = [x, y];
  }
}
// Without a picture: the one coordinate against time.
function drawMotion() {
  const c = scene.coordinates[0];
  let box = [0, 20 * S.dt, Infinity, -Infinity];
  histories.forEach((h) => h.t.forEach((t, j) => {
    if (j === 0) box[0] = t;
    box[1] = Math.max(box[1], t);
    box[2] = Math.min(box[2], h.q[j]); box[3] = Math.max(box[3], h.q[j]);
  }));
  const room = 0.08 * (box[3] - box[2]) || 0.1 * Math.abs(box[3]) || 1;
  configuration.box = [box[0], later(...box), box[2] - room, box[3] + room];
  const pen = configuration.begin(false);
  pen.save();
  configuration.axes(nevhTicks(box[0], box[1]),
    nevhTicks(configuration.box[2], configuration.box[3]),
    "t" + unit(scene.t_label), c.name + unit(c.label));
  for (let i = list.length - 1; i >= 0; i--) {
    if (list[i].width > 1) continue;
    const h = histories[i], points = h.t.flatMap((t, j) => [t, h.q[j]]);
    dashed(pen, i);
    configuration.line(points);
    if (rows[i]) configuration.mark(rows[i][0], rows[i][4], list[i].colour, 5);
  }
  pen.restore();
}
const later = (from, to) => to + 0.03 * (to - from); // of the last mark
const dashOf = (look) => look < 0 ? [4, 4] : NEVH_DASHES[look % 5];
function dashed(pen, i) {
  pen.strokeStyle = pen.fillStyle = nevhColour(list[i].colour);
  pen.lineWidth = 1.6;
  pen.setLineDash(dashOf(list[i].colour));
}
// All coordinates, side by side.
function drawProfile() {
  const n = scene.coordinates.length;
  let most = profile;
  for (let k = 0; k < n && rows[0]; k++)
    most = Math.max(most, Math.abs(rows[0][4 + k]) || 0);
  profile = most;
  most = most || 1;
  configuration.box = [0.5, n + 0.5, -1.1 * most, 1.1 * most];
  const pen = configuration.begin(false);
  pen.save();
  configuration.axes(nevhTicks(1, n), nevhTicks(-1.1 * most, 1.1 * most),
    "number of the coordinate, at " + when(), "coordinate" + unit(scene.coordinates[0].label));
  for (let i = list.length - 1; i >= 0; i--) {
    if (!rows[i] || list[i].width > 1) continue;
    pen.strokeStyle = pen.fillStyle = nevhColour(list[i].colour);
    pen.lineWidth = 1.5;
    const points = [];
    for (let k = 0; k < n; k++) points.push(k + 1, rows[i][4 + k]);
    configuration.line(points);
    for (let k = 0; k < n && n <= 64; k++)
      configuration.mark(k + 1, rows[i][4 + k], list[i].colour, 4);
  }
  pen.restore();
}
let profile = 0;
function drawParts(pen, i) {
  const picture = pictures[i], colour = list[i].colour;
  pen.save();
  pen.strokeStyle = pen.fillStyle = nevhColour(colour);
  pen.globalAlpha = i === 0 ? 1 : 0.75;
  pen.lineWidth = i === 0 ? 3 : 2;
  pen.setLineDash(dashOf(colour));
  let from = 0, bob = 0;
  for (const part of scene.parts) {
    const v = picture.subarray(from, from + part.count);
    from += part.count;
    if (part.kind === "rod") configuration.line(v);
    else if (!still[bob++]) configuration.mark(v[0], v[1], colour, i === 0 ? 8 : 7);
    else if (i === 0) { // of no scheme
      pen.fillStyle = configuration.fore;
      configuration.mark(v[0], v[1], 0, 6);
      pen.fillStyle = nevhColour(colour);
    }
  }
  pen.restore();
}
// The axes stay; they grow by doubling, and by decades.
let errorBox = null;
function drawErrors() {
  let low = Infinity, high = 1e-16, first = 0, end = -Infinity;
  const expected = ahead.map((one) => one ? one.error : 0);
  const least = Math.min(...expected.filter((v) => v > 0));
  if (least < Infinity) { high = Math.max(...expected); low = least / 10; }
  histories.forEach((h) => h.most.forEach((v, i) => {
    if (Number.isFinite(v)) high = Math.max(high, v);
    if (v > 0) low = Math.min(low, v);
    end = Math.max(end, h.t[i]);
  }));
  if (histories[0]?.t.length) first = histories[0].t[0];
  high = Math.min(1e4, high * 2);
  low = Math.max(1e-17, Math.min(low, high / 1e3));
  const span = SHOWN * seconds(), own = errorBox ||
    [first, first + span, Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  while (end > own[1]) own[1] += own[1] - own[0];
  own[2] = Math.min(own[2], Math.floor(Math.log10(low)));
  own[3] = Math.max(own[3], Math.ceil(Math.log10(high)));
  errorBox = errors.box = own;
  const pen = errors.begin(false), powers = [];
  const by = Math.ceil((errors.box[3] - errors.box[2]) / 6);
  for (let v = Math.ceil(errors.box[3]); v > errors.box[2]; v -= by)
    powers.push(v);
  pen.save();
  errors.axes(nevhTicks(errors.box[0], errors.box[1]), powers,
    "t" + unit(scene.t_label), `|${errorWord()}|`, (v) => "1e" + v);
  histories.forEach((h, i) => {
    if (list[i].width > 1) return;
    let most = 0;
    const points = h.t.flatMap((t, j) => [t, Math.log10(most = Math.max(most, h.most[j]))]);
    dashed(pen, i);
    errors.line(points);
    pen.setLineDash([]);
    if (points.length) errors.mark(h.t.at(-1), points.at(-1), list[i].colour, 4);
  });
  pen.restore();
}
// The balance: H less what friction and a drive have given.
const errorWord = () => (scene.balance ? "balance" : "energy") + " error";
const unit = (label) => label ? " (" + label + ")" : "";
const after = (label) => label ? " " + label : "";
// What makes p dq/dt an energy, an angle being a number, where the scene has none.
function momentumUnit(c) {
  const parts = [scene.energy_label, scene.t_label, c.label];
  return unit(c.momentum || (parts.some((text) => !/^[^ /*^()]+$/.test(text)) ? ""
    : parts[0] + " " + parts[1] + (c.label === "rad" ? "" : "/" + c.label)));
}

// The part of the plane that is shown grows with the first orbit; before the first
// step it is of the size of the start.
let stood = false;
function choosePhaseBox() {
  const c = scene.coordinates[S.plane], trail = trails[0] || [];
  if (pulling && phaseBox) return;
  const own = trail.filter((_, i) => i % 2 === 0);
  turns = c.period > 0 && (!own.length || Math.max(...own) - Math.min(...own) > c.period / 2
    || scene.coordinates.length === 1 // levels fill the period
      && Math.abs(own[0] - c.period * Math.round(own[0] / c.period)) < 0.4 * c.period);
  let [q0, q1, p0, p1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let i = 0; i < trail.length; i += 2) {
    q0 = Math.min(q0, wrapped(trail[i], c)); q1 = Math.max(q1, wrapped(trail[i], c));
    p0 = Math.min(p0, trail[i + 1]); p1 = Math.max(p1, trail[i + 1]);
  }
  if (range()) {
    const n = scene.coordinates.length, { low, high } = range(), k = S.plane;
    turns = turns || c.period > 0 && high[k] - low[k] > c.period / 2;
    q0 = Math.min(q0, wrapped(low[k], c)); q1 = Math.max(q1, wrapped(high[k], c));
    p0 = Math.min(p0, low[n + k]); p1 = Math.max(p1, high[n + k]);
  }
  if (extent) { p0 = Math.min(p0, extent[0]); p1 = Math.max(p1, extent[1]); }
  if (list[0] && rows[0] && !(q1 >= q0)) [q0, q1, p0, p1] = [-1, 1, -1, 1];
  if (turns) { q0 = -c.period / 2; q1 = c.period / 2; }
  // Sizes are those of the data alone, but for states that do not move at all.
  const n = scene.coordinates.length, least = (from, q) => Math.max(1e-3 * Math.abs(q),
    (steps > 0 ? 1e-9 : 0.2) * Math.max(...(rows[0] || [0]).slice(from, from + n).map(Math.abs)));
  const dq = Math.max(q1 - q0, least(4, q0)) || 0.2;
  const dp = Math.max(p1 - p0, least(4 + n, p0)) || 0.2;
  const inside = phaseBox && stood === (steps === 0) && q0 >= phaseBox[0] && q1 <= phaseBox[1] &&
    p0 >= phaseBox[2] && p1 <= phaseBox[3];
  if (inside) return;
  stood = steps === 0;
  phaseBox = [q0 - (turns ? 0 : 0.15 * dq), q1 + (turns ? 0 : 0.15 * dq),
    p0 - 0.15 * dp, p1 + 0.15 * dp];
  if (scene.coordinates.length === 1) askLevels(phaseBox.slice());
}
// A coordinate with a period is shown within one of them, but where it stays near
// the end of that: a pendulum that swings about the top.
let turns = false;
const wrapped = (q, c) => turns
  ? q - c.period * Math.round(q / c.period) : q;
// Of one angle: momenta on the levels that go round, the lowest of which is the
// separatrix.
async function findExtent() {
  const c = scene.coordinates[0], one = range(), nx = 65, ny = 81;
  extent = null;
  if (scene.coordinates.length > 1 || !(c.period > 0) || !one || scene.balance) return;
  const p = 4 * Math.max(Math.abs(one.low[1]), Math.abs(one.high[1]));
  const from = (one.low[0] + one.high[0]) / 2 - c.period / 2;
  const { ok, values } = await ask({ ask: "levels", at: S.start || startOf(), k: 0,
    box: [from, from + c.period, -p, p], nx, ny });
  if (!ok || !(p > 0)) return;
  const over = (i) => Array.from({ length: ny }, (_, j) => values[j * nx + i]);
  let top = -Infinity; // of the lowest of H over each coordinate
  for (let i = 0; i < nx; i++) top = Math.max(top, Math.min(...over(i)));
  const inside = Array.from({ length: ny }, (_, j) => j).filter((j) =>
    values.subarray(j * nx, j * nx + nx).some((v) => v <= top));
  const momentum = (j) => -p + 2 * p * j / (ny - 1);
  if (inside.length && inside[0] > 0 && inside.at(-1) < ny - 1)
    extent = [momentum(inside[0]), momentum(inside.at(-1))];
}
let asking = false, boxAsked = null;
async function askLevels(box) {
  boxAsked = box;
  if (asking) return;
  asking = true;
  while (boxAsked && rows[0]) {
    const nx = 72, ny = 54, of = boxAsked;
    boxAsked = null;
    const answer = await ask({ ask: "levels", at: rows[0].slice(4), k: S.plane,
      box: of, nx, ny });
    if (!answer.ok) continue;
    const finite = Array.from(answer.values).filter(Number.isFinite)
      .sort((a, b) => a - b);
    levels = [];
    for (let i = 1; i < 14; i++)
      levels.push(...nevhContour(answer.values, nx, ny, of,
        finite[Math.floor(finite.length * i / 14)]));
  }
  asking = false;
}
function drawPhase() {
  if (S.section >= 0) return drawSection();
  const c = scene.coordinates[S.plane];
  choosePhaseBox();
  phase.box = phaseBox;
  const pen = phase.begin(false);
  pen.save();
  phase.axes(nevhTicks(phaseBox[0], phaseBox[1]), nevhTicks(phaseBox[2],
    phaseBox[3]), c.name + unit(c.label), "p_" + c.name + momentumUnit(c));
  pen.strokeStyle = phase.fore;
  pen.globalAlpha = 0.22;
  pen.lineWidth = 1;
  phase.segments(levels || []);
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
    if (turns && Math.abs(q - before) > c.period / 2)
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
let told = -Infinity, written = -Infinity, listed = -Infinity;
function draw() {
  drawConfiguration();
  drawErrors();
  drawPhase();
  report(false);
}

// ---- text ----
const digits = (v, count = 6) => Number.isFinite(v) ? v.toPrecision(count) : "";
function report(atOnce) {
  if (!atOnce && now() - listed < 100) return; // texts that nobody reads cost a layout
  listed = now();
  const body = at("states").tBodies[0];
  const lines = list.filter((run) => !(run.width > 1)).length;
  while (body.rows.length > lines) body.deleteRow(-1);
  while (body.rows.length < lines) {
    const row = body.insertRow();
    for (let j = 0; j < 5; j++) row.insertCell();
  }
  at("states").classList.toggle("bare", !S.disc);
  at("when").textContent = "The states at t = " + digits(rows[0]?.[0] ?? NaN) +
    " " + scene.t_label;
  for (let i = 0; i < lines; i++) {
    const cells = body.rows[i].cells, row = rows[i], r = list[i];
    const disc = list.findIndex((o) => o.width > 1 && o.scheme === r.scheme);
    const name = r.colour < 0 ? "exact" : r.scheme, mark = letterOf(name);
    const values = [mark.textContent + " " + name, row ? digits(row[1]) : "",
      row ? row[2].toExponential(2) : "refused",
      ahead[i] ? ahead[i].error.toExponential(1) : "",
      disc >= 0 && rows[disc] ? areaText(rows[disc], list[disc].area) : ""];
    values.forEach((v, j) => {
      if (cells[j].textContent !== v) j ? cells[j].textContent = v
        : cells[0].replaceChildren(mark, " " + name);
    });
  }
  if (!atOnce && now() - written < 250) return;
  showTitle();
  showLesson();
  const facts = factsText();
  if (at("facts").textContent !== facts) at("facts").textContent = facts;
  const due = ahead[0] ? "largest by t = " + timeText(ahead[0].t).replace(/ /g, "\u00a0") : "";
  if (at("due").textContent !== due) at("due").textContent = due;
  written = now();
  if (atOnce || now() - told > 5000 || !playing) {
    told = now();
    const text = spoken();
    if (at("status").textContent !== text) at("status").textContent = text;
  }
  // Lines end between options alone.
  at("command").replaceChildren(...command().split(/ (?=--)/).flatMap((text, i) =>
    [i ? " " : "", element("span", {}, text)]));
}
// Known to a third of what leaving out every second state changes, as a polygon's
// area is.
function areaText(row, first) {
  const size = Math.abs(row[1] / first), doubt = Math.abs(row[2] / first) / 3;
  if (!(doubt < 0.05)) return "too folded";
  return nevhNumber(row[1]) + ", ratio " + size.toFixed(doubt < 1e-3 ? 4 : 2);
}
function spoken() {
  if (!rows[0]) return "";
  const state = scene.coordinates.slice(0, 6).map((c, k) =>
    c.name + " = " + digits(rows[0][4 + k], 4)).join(", ");
  return steps + (steps === 1 ? " step" : " steps") + ", t = " + digits(rows[0][0], 4) + ": " + S.schemes[0] +
    " has " + state + ", " + errorWord() + " " + rows[0][2].toExponential(1) + ".";
}
