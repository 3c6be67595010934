// nevh: what the live page draws: a canvas in units of a plane, its axes, the
// configuration, orbits over levels of H, errors by time.
// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// A look is a number: of the integrator in the table of pictures, or of its name.
const NEVH_DASHES = [[], [12, 5], [3, 3], [14, 4, 3, 4], [20, 6]];
function nevhLook(name) {
  const known = NEVH_LOOKS.indexOf(name);
  let number = 2166136261;
  for (const byte of new TextEncoder().encode(name))
    number = Math.imul(number ^ byte, 16777619) >>> 0;
  return known >= 0 ? known : NEVH_LOOKS.length + number % 64;
}
const nevhDark = matchMedia("(prefers-color-scheme: dark)");
function nevhColour(look) {
  if (look >= 0) return NEVH_COLOURS[look % NEVH_COLOURS.length][+nevhDark.matches];
  const name = look === "fore" ? "--fore" : "--ghost";
  if (!nevhColours.has(name)) nevhColours.set(name, getComputedStyle(
    document.documentElement).getPropertyValue(name).trim());
  return nevhColours.get(name);
}
// Looked up once, and again in another theme.
const nevhColours = new Map();
nevhDark.addEventListener("change", () => nevhColours.clear());

// A canvas with a box [x0, x1, y0, y1] of the plane.
let nevhType = 1; // times usual letters
class NevhPlane {
  constructor(canvas, margins) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.margins = margins;
    this.box = [-1, 1, -1, 1];
  }
  // Begins a drawing.  `alike`: both directions have one unit.
  begin(alike) {
    const at = this.canvas.getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    const w = Math.max(1, Math.round(at.width * ratio));
    const h = Math.max(1, Math.round(at.height * ratio));
    if (this.canvas.width !== w || this.canvas.height !== h)
      Object.assign(this.canvas, { width: w, height: h });
    this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.pen.clearRect(0, 0, at.width, at.height);
    [this.left, this.bottom, this.right, this.top] =
      this.margins.map((margin) => margin * nevhType);
    this.width = at.width - this.left - this.right;
    this.height = at.height - this.top - this.bottom;
    const [x0, x1, y0, y1] = this.box;
    let sx = this.width / (x1 - x0), sy = this.height / (y1 - y0);
    if (alike) sx = sy = Math.min(sx, sy);
    Object.assign(this, { sx, sy, x0, x1, y0, y1,
      ox: this.left + (this.width - sx * (x1 - x0)) / 2,
      oy: this.top + (this.height + sy * (y1 - y0)) / 2 });
    this.fore = nevhColour("fore");
    return this.pen;
  }
  x(v) { return this.ox + (v - this.x0) * this.sx; }
  y(v) { return this.oy - (v - this.y0) * this.sy; }
  // The point of the plane under the pointer.
  under(event) {
    const at = this.canvas.getBoundingClientRect();
    return [(event.clientX - at.left - this.ox) / this.sx + this.x0,
      (this.oy - event.clientY + at.top) / this.sy + this.y0];
  }
  line(points, step = 2) {
    const pen = this.pen;
    pen.beginPath();
    let open = false;
    for (let i = 0; i + 1 < points.length; i += step) {
      const x = points[i], y = points[i + 1];
      if (!Number.isFinite(x) || !Number.isFinite(y)) { open = false; continue; }
      if (open) pen.lineTo(this.x(x), this.y(y));
      else pen.moveTo(this.x(x), this.y(y));
      open = true;
    }
    pen.stroke();
  }
  // Two points each.
  segments(points) {
    const pen = this.pen;
    pen.beginPath();
    for (let i = 0; i < points.length; i += 4) {
      pen.moveTo(this.x(points[i]), this.y(points[i + 1]));
      pen.lineTo(this.x(points[i + 2]), this.y(points[i + 3]));
    }
    pen.stroke();
  }
  mark(x, y, look, usual) {
    const pen = this.pen, a = this.x(x), b = this.y(y), size = usual * nevhType;
    const letter = look < 0 ? "○" : NEVH_MARKS[look % NEVH_MARKS.length];
    pen.beginPath();
    if ("■□".includes(letter)) pen.rect(a - size, b - size, 2 * size, 2 * size);
    else if ("▲△".includes(letter)) {
      pen.moveTo(a, b - 1.2 * size);
      pen.lineTo(a + 1.2 * size, b + size);
      pen.lineTo(a - 1.2 * size, b + size);
    } else if ("◆◇".includes(letter)) {
      pen.moveTo(a, b - 1.4 * size);
      pen.lineTo(a + 1.4 * size, b);
      pen.lineTo(a, b + 1.4 * size);
      pen.lineTo(a - 1.4 * size, b);
    } else if (letter === "×") {
      pen.moveTo(a - size, b - size);
      pen.lineTo(a + size, b + size);
      pen.moveTo(a + size, b - size);
      pen.lineTo(a - size, b + size);
    } else pen.arc(a, b, size, 0, 7);
    if (letter !== "×") pen.closePath();
    "●■▲◆".includes(letter) ? pen.fill() : pen.stroke();
  }
  axes(xs, ys, xlabel, ylabel, yText) {
    const pen = this.pen, bottom = this.top + this.height;
    pen.save();
    pen.font = 12 * nevhType + "px system-ui,sans-serif";
    pen.fillStyle = pen.strokeStyle = this.fore;
    pen.globalAlpha = 0.75;
    pen.lineWidth = 1;
    pen.strokeRect(this.left, this.top, this.width, this.height);
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const v of xs) {
      pen.fillText(nevhNumber(v, xs), this.x(v), bottom + 5);
      pen.fillRect(this.x(v), bottom, 1, 4);
    }
    pen.fillText(xlabel, this.left + this.width / 2, bottom + 5 + 14 * nevhType);
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const v of ys) {
      pen.fillText(yText ? yText(v) : nevhNumber(v, ys), this.left - 5, this.y(v));
      pen.fillRect(this.left - 4, this.y(v), 4, 1);
    }
    pen.textAlign = "left";
    pen.textBaseline = "bottom";
    pen.fillText(ylabel, 4, this.top - 9 * nevhType);
    pen.restore();
    pen.beginPath();
    pen.rect(this.left, this.top, this.width, this.height);
    pen.clip();
  }
}

// A few round numbers in a range.
function nevhTicks(from, to, most = 5) {
  const span = to - from;
  if (!(span > 0) || !Number.isFinite(span)) return [];
  const power = 10 ** Math.floor(Math.log10(span / most));
  const by = [1, 2, 5, 10].map((m) => m * power).find((s) => span / s <= most);
  const ticks = [];
  for (let i = Math.ceil(from / by); i * by <= to && ticks.length < 20; i++)
    ticks.push(i * by);
  return ticks;
}
// With as many digits as tell it from the others of some ticks.
function nevhNumber(v, ticks = []) {
  if (v === 0 || Math.abs(v) < 1e-300) return "0";
  const digits = ticks.length < 2 ? 4 : Math.min(16, Math.max(4,
    Math.ceil(Math.log10(Math.abs(v) / (ticks[1] - ticks[0]))) + 1));
  const small = Math.abs(v) < 1e-3 || Math.abs(v) >= 1e5;
  return small ? v.toExponential(digits > 4 ? digits - 1 : 1).replace(".0e", "e")
    .replace("e+", "e") : String(+v.toPrecision(digits));
}

// Lines where a grid of values has a level: points, two a line.
function nevhContour(values, nx, ny, box, level) {
  const [x0, x1, y0, y1] = box, out = [];
  const dx = (x1 - x0) / (nx - 1), dy = (y1 - y0) / (ny - 1);
  for (let j = 0; j + 1 < ny; j++)
    for (let i = 0; i + 1 < nx; i++) {
      const a = values[j * nx + i] - level, b = values[j * nx + i + 1] - level;
      const c = values[(j + 1) * nx + i + 1] - level;
      const d = values[(j + 1) * nx + i] - level;
      if (!Number.isFinite(a + b + c + d)) continue;
      const cut = [];
      if (a < 0 !== b < 0) cut.push(i + a / (a - b), j);
      if (b < 0 !== c < 0) cut.push(i + 1, j + b / (b - c));
      if (d < 0 !== c < 0) cut.push(i + d / (d - c), j + 1);
      if (a < 0 !== d < 0) cut.push(i, j + a / (a - d));
      for (let k = 0; k + 3 < cut.length; k += 4)
        out.push(x0 + cut[k] * dx, y0 + cut[k + 1] * dy,
          x0 + cut[k + 2] * dx, y0 + cut[k + 3] * dy);
    }
  return out;
}

// The largest |error| in each of at most 1200 spans of time, and the state in the
// plane at their beginnings.
class NevhHistory {
  constructor() {
    this.t = [];
    this.most = [];
    this.q = [];
    this.p = [];
    this.each = 1;
    this.left = 0;
  }
  add(t, error, q, p) {
    const size = Math.abs(error), last = this.t.length - 1;
    if (this.left > 0) {
      this.left--;
      if (!(this.most[last] >= size)) this.most[last] = size;
      return;
    }
    this.t.push(t);
    this.q.push(q);
    this.p.push(p);
    this.most.push(size);
    this.left = this.each - 1;
    if (this.t.length < 1200) return;
    this.most = this.most.map((v, i) => Math.max(v, this.most[i + 1] || 0));
    for (const name of ["t", "most", "q", "p"])
      this[name] = this[name].filter((_, i) => i % 2 === 0);
    this.each *= 2;
  }
}
