// nevh: the live page's controls.
// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

const element = (name, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};

// The first line is a sentence, and wraps; those below it keep the caret's place.
function sayWrong(text) {
  const end = text.indexOf("\n") + 1 || text.length;
  at("wrong").replaceChildren(element("span", {}, text.slice(0, end)), text.slice(end));
  offerParameter(text);
}

// ---- what is shown of a scene ----
function show() {
  showTitle();
  at("source").textContent = scene.source;
  at("text").value = S.text;
  const names = scene.coordinates.map((c) => c.name);
  at("scene-caption").textContent = scene.plain
    ? names[1] + " over " + names[0] + ": drag the point to a new start."
    : scene.parts.length ? "The configuration" + (scene.parts.some((p) => p.kind === "bob")
      ? ": drag a body to a new start." : ".") : names.length === 1 ? names[0] + " against time."
    : "All coordinates, side by side.";
  at("word").textContent = errorWord();
  showView();
  showEffects();
  showSchemes();
  at("plane").replaceChildren(...scene.coordinates.map((c, k) =>
    new Option(c.name, k, false, k === S.plane)));
  at("plane-of").hidden = scene.coordinates.length === 1;
  at("exact").checked = S.exact;
  at("disc").checked = S.disc;
  at("gradient").value = S.gradient;
  showSliders();
  const mine = cutSection(S.text, MINE)[0];
  if (mine) at("weights").value = mine;
  setWall(S.wall);
}
// The plane, or a section.
function showView() {
  const one = section(), click = one && clicks(one), { length } = scene.coordinates;
  at("phase-caption").textContent = !one ? "Coordinate and momentum" +
    (length === 1 ? ", over levels of H" + (scene.timed ? " at t = " + scene.run.t_start : "") +
      (scene.friction ? ", without friction" : "") : "") + ": drag to a new start."
    : (one.every ? "Every " + +digits(one.every, 4) + after(scene.t_label)
      : "When " + one.left + " = " + one.right) + ", by " + S.schemes[0] +
      (click ? ": click to start an orbit" + (one.every ? "." : " of the same energy.") : ".");
  at("view").replaceChildren(new Option("phase plane", -1), ...scene.sections.map((s, i) =>
    s.items.length > 1 ? new Option("section: " + s.name, i) : ""));
  at("view").value = S.section;
  at("clear").hidden = !one;
  at("views").hidden = scene.sections.length === 0;
  at("phase").setAttribute("aria-label", one ? "Section" : "Phase plane");
}
function setWall(on) {
  S.wall = on;
  document.body.classList.toggle("wall", on);
  at("wall").setAttribute("aria-pressed", on);
  nevhType = on ? 1.7 : 1;
}
function showEffects() {
  const fields = [], numbers = [];
  for (const e of scene.equations) {
    if (e.section === "effects") {
      const on = element("input", { type: "checkbox", checked: e.on });
      on.setAttribute("aria-label", "effect " + e.name + " is on");
      on.onchange = () => use(S.text, [...S.changes.filter(([mark, what]) =>
        !"+-".includes(mark) || what !== e.name), [on.checked ? "+" : "-", e.name]])
        .then(show);
      const text = element("input", { type: "text", value: e.value, name: e.name,
        spellcheck: false });
      text.setAttribute("aria-label", "formula of " + e.name);
      fields.push(on, element("span", {}, e.name + " ="), text);
    } else if (e.section === "parameters" && /^[-+.\de]+$/i.test(e.value)) {
      const value = element("input", { type: "number", value: e.value, step: "any",
        size: 8 });
      value.style.width = "7rem";
      value.onchange = () => use(S.text, [...S.changes.filter(([mark, what]) =>
        mark !== "=" || what.split("=")[0] !== e.name),
      ["=", e.name + "=" + value.value]]);
      numbers.push(element("label", {}, e.name, value));
    }
  }
  at("effects").replaceChildren(...fields, ...another());
  at("parameters").replaceChildren(...numbers);
}
// Fields for one more effect.
function another() {
  const field = (id, label, hint) => {
    const made = element("input", { type: "text", id, placeholder: hint, spellcheck: false });
    made.setAttribute("aria-label", label);
    return made;
  };
  return [element("span", {}, "+"), field("new-name", "name of another effect", "name"),
    field("new-formula", "formula of another effect", "another term of H")];
}
// The mark of a scheme, in its colour.
function letterOf(name) {
  const look = name === "exact" ? -1 : nevhLook(name || "");
  const made = element("span", { className: "mark" }, !name ? "" : look < 0 ? "○"
    : NEVH_MARKS[look % NEVH_MARKS.length]);
  made.style.color = nevhColour(look);
  return made;
}
function showSchemes() {
  const many = S.schemes.length;
  const choose = (i) => {
    const menu = element("select");
    menu.setAttribute("aria-label", "scheme " + (i + 1));
    if (i > 0) menu.append(new Option("none", ""));
    for (const s of scene.integrators)
      menu.append(new Option(s.name + ", order " + s.order, s.name, false,
        s.name === S.schemes[i]));
    if (i >= many) menu.value = "";
    menu.onchange = () => {
      S.schemes[i] = menu.value;
      S.schemes = S.schemes.filter(Boolean);
      showSchemes();
      race().then(findLimit);
    };
    const mark = letterOf(S.schemes[i]);
    return element("label", {}, mark, menu);
  };
  at("legend").replaceChildren(...[...S.schemes, ...S.exact ? ["exact"] : []]
    .flatMap((name) => [letterOf(name), " " + name + " "]));
  at("schemes").replaceChildren(...Array.from({ length: Math.min(4, many + 1) },
    (_, i) => choose(i)));
}
// The slider goes by equal ratios, up to the limit.
const longest = () => Math.max(S.limit || 8 * S.dt, S.dt);
const stepOf = (value) => +(longest() * 10 ** (3 * (value / 100 - 1))).toPrecision(4);
function showSliders() {
  at("dt").value = 100 * (1 + Math.log10(S.dt / longest()) / 3);
  const words = "dt = " + nevhNumber(S.dt) + after(scene.t_label);
  if (document.activeElement !== at("dt-number")) at("dt-number").value = S.dt;
  at("dt-unit").textContent = scene.t_label;
  at("dt-text").textContent = S.limited ? S.limited + " is stable up to " +
    +S.limit.toPrecision(3) + after(scene.t_label) + " for small oscillations" : "";
  at("dt").setAttribute("aria-valuetext", words);
  at("speed").value = S.speed;
  at("speed-text").textContent = "t grows by " + nevhNumber(seconds()) +
    after(scene.t_label) + " per second";
}
function setPlaying(on) {
  playing = on;
  at("play").setAttribute("aria-pressed", on);
  at("play").textContent = on ? "Pause" : "Play";
  at("status").classList.toggle("heard", on); // what is seen moves on
  told = -Infinity;
}

// ---- formulas ----
// The scene's text, with other formulas for its effects.
function rewritten() {
  let section = "";
  const wanted = new Map(Array.from(at("effects").querySelectorAll(
    "input[type=text]"), (field) => [field.name, field.value]));
  const lines = [];
  for (const line of S.text.split("\n")) {
    const head = line.match(/^\s*\[(\w+)\]/);
    if (head) section = head[1];
    const known = section === "effects" && line.match(/^\s*([^=#]+?)\s*=/);
    if (known && wanted.has(known[1]) && before(known[1]) !== wanted.get(known[1]))
      lines.push(known[1] + " = " + wanted.get(known[1]));
    else lines.push(line);
  }
  const formula = at("new-formula").value.trim();
  if (formula) {
    const name = at("new-name").value.trim() || nameless();
    let to = lines.findIndex((line) => /^\s*\[effects\]/.test(line)) + 1;
    while (to < lines.length && /^\s*[^\s[]/.test(lines[to])) to++;
    lines.splice(to, 0, name + " = " + formula);
  }
  return lines.join("\n");
}
// A name that no effect has.
function nameless() {
  let count = 1;
  while (before("own" + count) !== undefined) count++;
  return "own" + count;
}
const before = (name) => scene.equations.find((e) => e.section === "effects" &&
  e.name === name)?.value;

// ---- drags: the coordinates that bring a body nearest to the pointer ----
async function pull(part, x, y) {
  const n = scene.coordinates.length, from = offsetOf(part);
  const state = (S.start || startOf()).slice();
  for (let round = 0; round < 6; round++) {
    const here = (await ask({ ask: "picture", at: state })).picture;
    const r = [x - here[from], y - here[from + 1]], g = [];
    for (let k = 0; k < n; k++) {
      const moved = state.slice(), by = 1e-5 * Math.max(1, Math.abs(state[k]));
      moved[k] += by;
      const there = (await ask({ ask: "picture", at: moved })).picture;
      g.push([(there[from] - here[from]) / by, (there[from + 1] - here[from + 1]) / by]);
    }
    // The smallest change of the coordinates: g'(g g' + tiny)^-1 r.
    let [a, b, d] = [0, 0, 0];
    for (const [u, v] of g) { a += u * u; b += u * v; d += v * v; }
    const tiny = 1e-6 * (a + d) + 1e-30;
    a += tiny; d += tiny;
    const det = a * d - b * b;
    const l = [(d * r[0] - b * r[1]) / det, (a * r[1] - b * r[0]) / det];
    g.forEach(([u, v], k) => {
      const change = u * l[0] + v * l[1];
      if (Number.isFinite(change)) state[k] += change;
    });
  }
  for (let k = n; k < 2 * n; k++) state[k] = startOf()[k];
  return state;
}
const startOf = () => [...scene.coordinates.map((c) => c.start[0]),
  ...scene.coordinates.map((c) => c.start[1])];
const offsetOf = (part) => scene.parts.slice(0, part).reduce((sum, p) =>
  sum + p.count, 0);

function bodyAt(x, y) {
  let best = -1, least = 28 / configuration.sx;
  scene.parts.forEach((part, i) => {
    if (part.kind !== "bob" || !pictures[0]) return;
    const from = offsetOf(i);
    const far = Math.hypot(pictures[0][from] - x, pictures[0][from + 1] - y);
    if (far < least) [best, least] = [i, far];
  });
  return best;
}
function restartAt(state) {
  S.start = state;
  return race().then(() => report(true));
}
function listenToDrags() {
  let body = -1, inPlane = false, moving = false, next = null;
  const drag = async () => { // one at a time, the latest place
    if (moving) return;
    moving = true;
    while (next) {
      const to = next;
      next = null;
      await restartAt(await to());
    }
    moving = false;
    end();
  };
  // What is seen stays where it is while something is dragged.
  const end = () => { pulling = moving || body >= 0 || inPlane; };
  at("scene").onpointerdown = (event) => {
    body = bodyAt(...configuration.under(event));
    if (body < 0) return;
    pulling = true;
    at("scene").setPointerCapture(event.pointerId);
  };
  at("scene").onpointermove = (event) => {
    if (body < 0) return;
    const place = configuration.under(event), part = body;
    setPlaying(false);
    next = () => pull(part, ...place);
    drag();
  };
  at("scene").onpointerup = at("scene").onpointercancel = () => { body = -1; end(); };
  // A finger elsewhere scrolls the page.
  at("scene").addEventListener("touchstart", (event) => {
    if (bodyAt(...configuration.under(event.touches[0])) >= 0) event.preventDefault();
  }, { passive: false });
  const toPlane = (event) => {
    if (S.section >= 0) return;
    const [q, p] = phase.under(event), state = (S.start || startOf()).slice();
    state[S.plane] = q;
    state[scene.coordinates.length + S.plane] = p;
    setPlaying(false);
    next = async () => state;
    drag();
  };
  at("phase").onpointerdown = (event) => {
    if (S.section >= 0) { clickSection(event); return; }
    inPlane = pulling = true;
    at("phase").setPointerCapture(event.pointerId);
    toPlane(event);
  };
  at("phase").onpointermove = (event) => { if (inPlane) toPlane(event); };
  at("phase").onpointerup = at("phase").onpointercancel = () => { inPlane = false; end(); };
}
// Arrows in a picture move the start: the coordinate, and its momentum.
function nudge(event) {
  const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1],
    ArrowDown: [0, -1] }[event.key];
  if (!way) return;
  event.preventDefault();
  const state = (S.start || startOf()).slice(), n = scene.coordinates.length;
  const box = phaseBox || [-1, 1, -1, 1];
  state[S.plane] += way[0] * (box[1] - box[0]) / 100;
  state[n + S.plane] += way[1] * (box[3] - box[2]) / 100;
  setPlaying(false);
  restartAt(state);
}

// ---- files ----
function save(name, type, text) {
  const link = element("a", { download: name,
    href: URL.createObjectURL(new Blob([text], { type })) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
function csv() {
  const name = scene.coordinates[S.plane].name;
  const lines = ["# " + command(), "# energy_error: the largest until the next row",
    `scheme,dt,t,${name},p_${name},energy_error`];
  histories.forEach((h, i) => h.t.forEach((t, j) => {
    if (!(list[i].width > 1))
      lines.push([list[i].scheme, S.dt, t, h.q[j], h.p[j], h.most[j]].join(","));
  }));
  return lines.join("\n") + "\n";
}

// ---- all of it ----
function listen() {
  at("play").onclick = () => setPlaying(!playing);
  at("step").onclick = () => { setPlaying(false);
    quiet().then(() => go(1)).then(() => report(true)); };
  at("restart").onclick = () => race();
  at("speed").oninput = () => { S.speed = +at("speed").value; showSliders(); };
  at("dt").oninput = () => {
    S.dt = stepOf(+at("dt").value);
    showSliders();
    race();
  };
  at("dt-number").onchange = () => {
    const dt = +at("dt-number").value;
    if (!(dt > 0)) { at("dt-number").value = S.dt; return; }
    S.dt = dt;
    race().then(showSliders);
  };
  at("view").onchange = () => { S.section = +at("view").value; showView(); restartSection(); };
  at("clear").onclick = restartSection;
  at("wall").onclick = () => setWall(!S.wall);
  at("kind").append(...Object.keys(KINDS).map((name) => new Option(name)));
  at("kind").onchange = () => { at("weights").value = KINDS[at("kind").value]; };
  at("kind").onchange();
  at("own").onsubmit = (event) => { event.preventDefault(); runMine(); };
  at("exact").onchange = () => { S.exact = at("exact").checked; showSchemes(); race(); };
  at("disc").onchange = () => { S.disc = at("disc").checked; race(); };
  at("plane").onchange = () => { S.plane = +at("plane").value; race(); };
  at("gradient").onchange = () => { S.gradient = at("gradient").value; race(); };
  at("formulas").onsubmit = (event) => {
    event.preventDefault();
    use(rewritten(), S.changes);
  };
  at("use").onclick = () => use(at("text").value, []);
  at("save").onclick = () => save("own.nevh", "text/plain", at("text").value);
  at("csv").onclick = () => save(given.name + ".csv", "text/csv", csv());
  at("share").onclick = () => {
    putFragment();
    const say = (text) => { at("shared").textContent = text; };
    const elsewhere = () => say("It is in the address bar.");
    navigator.clipboard ? navigator.clipboard.writeText(location.href)
      .then(() => say("Copied."), elsewhere) : elsewhere();
  };
  at("scene").onkeydown = at("phase").onkeydown = nudge;
  document.onkeydown = (event) => {
    if (event.key === "Escape") setWall(false);
    if (event.target.closest("input,textarea,select,button") || event.ctrlKey ||
      event.metaKey || event.altKey) return;
    const key = { " ": "play", s: "step", r: "restart", w: "wall" }[event.key.toLowerCase()];
    if (key) { event.preventDefault(); at(key).click(); }
  };
  listenToDrags();
  at("scenes").hidden = all.length < 2;
  const choice = at("scenes").lastChild;
  choice.append(...all.map((one) => new Option(one.name, one.name, false, one === given)));
  choice.onchange = () => {
    location.hash = new URLSearchParams({ scene: choice.value });
    location.reload();
  };
}
const putFragment = () => window.history.replaceState(null, "", fragment());

// #test=STEPS: takes them, and leaves what came of it in the page.
async function test() {
  let left = S.test;
  while (left > 0) {
    const done = await go(left);
    if (done === 0) break;
    left -= done;
  }
  draw();
  const text = (v) => v === undefined ? "" : String(v);
  document.body.append(element("pre", { id: "result" }, JSON.stringify({
    steps, message: at("message").textContent, wrong: at("wrong").textContent,
    runs: S.schemes.map((scheme, i) => ({ scheme, t: text(rows[i]?.[0]),
      energy: text(rows[i]?.[1]), error: text(rows[i]?.[2]),
      state: rows[i] ? Array.from(rows[i].slice(4), String) : [] })),
  })));
}
async function begin() {
  readFragment();
  const loaded = await startWorker();
  if (!loaded.ok) throw new Error(loaded.message);
  listen();
  let fine = await use(S.text, S.changes);
  if (!fine && (S.text !== given.text || S.changes.length)) {
    const why = at("wrong").textContent;
    await use(given.text, []);
    sayWrong(why);
  }
  window.nevhFirst = now();
  if (S.test >= 0) return test();
  requestAnimationFrame((time) => { last = time; frame(time); });
  setPlaying(!matchMedia("(prefers-reduced-motion: reduce)").matches);
}
begin().catch((error) => {
  at("message").textContent = "The page cannot start: " + error.message;
});
