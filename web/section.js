// nevh: the live page's Poincare section, in which a click starts an orbit.
// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

const ENOUGH = 3000; // points of an orbit
let orbits = [], turning = false, sectionBox = null;

// A scene of two coordinates has one where it says none.
function withSection(text, found) {
  const [a, b] = found.coordinates;
  if (found.sections.length || found.coordinates.length !== 2 || found.balance) return text;
  return `${text}\n[sections]\nplane = when ${b.name} = 0, rising: ${a.name}, p_${a.name}\n`;
}
const section = () => scene.sections[S.section];
// The coordinate in whose plane the section is; -1: it shows something else.
const planeOf = (one) => scene.coordinates.findIndex((c) =>
  one.items[0] === c.name && one.items[1] === "p_" + c.name);
const clicks = (one) => planeOf(one) >= 0 &&
  scene.coordinates.length === (one.every ? 1 : 2);

async function restartSection() {
  orbits = [];
  sectionBox = null;
  if (S.section < 0) return;
  await launch(S.start || startOf(), true);
}
async function launch(start, clear) {
  const run = { scheme: S.schemes[0], gradient: S.gradient, h: S.dt };
  const { ok, message } = await ask({ ask: "launch", section: S.section, run, start, clear });
  at("message").textContent = ok ? "" : message;
  if (ok) orbits.push([]);
}
async function turnSection() {
  if (S.section < 0 || turning || held) return;
  turning = true;
  const before = orbits;
  const { ok, points } = await ask({ ask: "turn", steps: 100, most: ENOUGH });
  turning = false;
  if (!ok || before !== orbits) return;
  points.forEach((list, i) => orbits[i]?.push(...list));
}
// A start of the same energy where the plane was clicked.
async function clickSection(event) {
  const k = planeOf(section()), n = scene.coordinates.length, [a, b] = phase.under(event);
  if (!rows[0] || k < 0 || n > 2) return;
  if (n === 1) return launch([a, b], false);
  const answer = await ask({ ask: "seed", section: S.section, k, a, b, energy: rows[0][1],
    at: S.start || startOf() });
  if (answer.ok) return launch(answer.start, false);
  at("message").textContent = answer.message;
}
function growSection(x, y) {
  const box = sectionBox || [x, x, y, y];
  sectionBox = [Math.min(box[0], x), Math.max(box[1], x), Math.min(box[2], y),
    Math.max(box[3], y)];
}
// Room for what the first orbit reaches in the plane, and for all points.
function sectionRange() {
  const k = planeOf(section()), n = scene.coordinates.length, c = scene.coordinates[k];
  if (!sectionBox && k >= 0 && range()) {
    const { low, high } = range();
    growSection(sectionAt(low[k], c), low[n + k]);
    growSection(sectionAt(high[k], c), high[n + k]);
  }
  orbits.forEach((points) => {
    for (let i = points.done || 0; i < points.length; i += 2)
      growSection(sectionAt(points[i], c), points[i + 1]);
    points.done = points.length;
  });
  const [x0, x1, y0, y1] = sectionBox || [-1, 1, -1, 1];
  const dx = 0.08 * (x1 - x0) || 0.1, dy = 0.08 * (y1 - y0) || 0.1;
  return [x0 - dx, x1 + dx, y0 - dy, y1 + dy];
}
const sectionAt = (q, c) => c && c.period > 0 ? q - c.period * Math.round(q / c.period) : q;
// The start's orbit is the scheme's; those that were clicked have colours of no scheme.
const orbitColour = (i) => i ? ["#777", "#7b61c9", "#7a8b1f"][i % 3]
  : nevhColour(nevhLook(S.schemes[0]));
function drawSection() {
  const { items } = section(), k = planeOf(section()), c = scene.coordinates[k];
  phase.box = sectionRange();
  const pen = phase.begin(false);
  pen.save();
  phase.axes(nevhTicks(phase.box[0], phase.box[1]), nevhTicks(phase.box[2], phase.box[3]),
    items[0] + unit(c ? c.label : ""), items[1] + (c ? momentumUnit(c) : ""));
  orbits.forEach((points, i) => {
    pen.fillStyle = orbitColour(i);
    const size = (points.length < 400 ? 1.3 : 0.8) * nevhType;
    for (let j = 0; j < points.length; j += 2)
      pen.fillRect(phase.x(sectionAt(points[j], c)) - size, phase.y(points[j + 1]) - size,
        2 * size, 2 * size);
  });
  pen.restore();
}
