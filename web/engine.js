// nevh: what the live page computes, in a worker: scenes are read and orbits
// advanced by the module, by numbers of steps, never by the clock.
// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// send(message, buffers) posts an answer; returns what takes requests.
function nevhEngine(send) {
  const BUDGET = 12; // milliseconds in which a request takes steps
  const AHEAD = 10, ORBITS = 11, SLOTS = 24; // after those that race
  let x, page = 0, n = 0, parts = 0, plain = false, runs = [], bobs = [], orbits = [];
  const numbers = (at, count) => new Float64Array(x.memory.buffer, at, count);

  function textOf(at) {
    const bytes = new Uint8Array(x.memory.buffer, at);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }
  function withTexts(texts, call) {
    const at = texts.map((text) => {
      const bytes = new TextEncoder().encode(text);
      const to = x.page_take(bytes.length + 1);
      if (!to) throw new Error("out of memory");
      const memory = new Uint8Array(x.memory.buffer, to, bytes.length + 1);
      memory.set(bytes);
      memory[bytes.length] = 0;
      return to;
    });
    const result = call(...at);
    at.forEach((memory) => x.page_release(memory));
    return result;
  }
  const fault = () => ({ ok: false, message: textOf(x.page_message(page)) });

  async function load({ module }) {
    // The C library refers to files, of which there are none: EBADF.
    const none = new Proxy({}, { get: () => () => 8 });
    const made = await WebAssembly.instantiate(module,
      { wasi_snapshot_preview1: none });
    x = (made.instance || made).exports;
    x._initialize();
    return { ok: true };
  }

  // A scene, changed: [["=", "g=1"], ["-", "drag"], ["@", "x=2"]].
  function open({ name, text, changes }) {
    if (page) x.page_close(page);
    runs = [];
    page = withTexts([name, text], (a, b) => x.page_open(a, b));
    if (!page) throw new Error("out of memory");
    if (x.page_status(page)) return fault();
    for (const [mark, what] of changes)
      if (withTexts([what], (at) =>
        x.page_change(page, mark.charCodeAt(0), at))) return fault();
    if (x.page_begin(page)) return fault();
    n = x.page_dof(page);
    orbits = [];
    limits.clear();
    const scene = JSON.parse(textOf(x.page_describe(page)));
    // Two coordinates without a picture are drawn as a point of their plane.
    plain = scene.parts.length === 0 && n === 2;
    scene.plain = plain;
    if (plain) scene.parts = [{ kind: "bob", count: 2 }];
    parts = scene.parts.reduce((sum, part) => sum + part.count, 0);
    bobs = [];
    let from = 0;
    for (const part of scene.parts) {
      if (part.kind === "bob" && bobs.length < 12) bobs.push(from);
      from += part.count;
    }
    scene.bobs = bobs.length;
    return { ok: true, scene };
  }
  // A state, and where its bodies are.
  function observed(row) {
    if (!bobs.length) return row;
    const shown = pictureOf(row);
    return [...row, ...bobs.flatMap((from) => [shown[from], shown[from + 1]])];
  }

  // Rows of numbers: t, energy, error, the largest |error| of the last steps, 2n of
  // the state.
  const state = (slot, width) =>
    numbers(x.page_state(page, slot), 4 + 2 * n * width);
  function pictureOf(row) {
    if (!parts) return [];
    if (plain) return row.slice(4, 6);
    const at = x.page_take(16 * n);
    numbers(at, 2 * n).set(row.subarray(4));
    const shown = numbers(x.page_picture(page, row[0], at), parts).slice();
    x.page_release(at);
    return shown;
  }

  // A disc is small beside the lengths over which H varies, so that 256 states resolve it.
  const radius = (i) => {
    const length = 0.03 * x.page_length(page, i);
    return length > 0 && length < Infinity ? length : 0.03;
  };
  function race({ start, list }) {
    if (start) numbers(x.page_start(page), 2 * n).set(start);
    const disc = list.find((r) => r.width > 1);
    const [dq, dp] = disc ? [radius(disc.k), radius(n + disc.k)] : [0, 0];
    runs = list.map((r, slot) => enter(slot, r, dq, dp)
      ? { ...fault(), width: 0 } : { ok: true, message: "", width: r.width || 1 });
    return { ok: true, runs: runs.map((r) => ({ ...r })), ...now() };
  }
  const enter = (slot, r, dq = 0, dp = 0) =>
    withTexts([r.scheme, r.gradient], (scheme, gradient) =>
      x.page_race(page, slot, scheme, gradient, r.h, r.tolerance || 1e-9,
        r.width || 1, r.k || 0, dq, dp));

  // What runs will reach in some steps, or in as many as a second lets them: [least, largest] of each number of the state
  // and of what is drawn of it, and the largest error.
  function ahead({ list, steps, start }) {
    if (start) numbers(x.page_start(page), 2 * n).set(start);
    const most = Math.max(1, Math.min(steps, Math.floor(6000 / n)));
    const every = Math.max(1, Math.floor(most / 1000));
    const found = list.map((r) => {
      if (enter(AHEAD, r)) return null;
      const began = performance.now();
      let low = null, high = null, error = 0, failed = 0, done = 0;
      for (; done < most && !failed && performance.now() - began < 1000; done += every) {
        const row = state(AHEAD, 1), seen = observed(row);
        low = low ? low.map((v, i) => Math.min(v, seen[i])) : [...seen];
        high = high ? high.map((v, i) => Math.max(v, seen[i])) : [...seen];
        error = Math.max(error, row[3]);
        failed = x.page_advance(page, AHEAD, every);
      }
      return { low: low.slice(4), high: high.slice(4), error, failed,
        whole: done >= most, t: state(AHEAD, 1)[0] };
    });
    x.page_leave(page, AHEAD);
    return { ok: true, found };
  }

  // ---- a section: an orbit is started where it is clicked ----
  // The start that has two coordinates of the plane at a and b.
  function seed({ section, k, a, b, energy, at }) {
    const memory = x.page_take(16 * n);
    numbers(memory, 2 * n).set(at);
    const failed = x.page_seed(page, section, k, a, b, energy, memory);
    const start = [...numbers(memory, 2 * n)];
    x.page_release(memory);
    return failed ? fault() : { ok: true, start };
  }
  // Orbits beyond the slots there are take the place of the oldest.
  function launch({ section, run, start, clear }) {
    if (clear) orbits = [];
    const slot = ORBITS + orbits.length % (SLOTS - ORBITS);
    const before = numbers(x.page_start(page), 2 * n).slice();
    numbers(x.page_start(page), 2 * n).set(start);
    const failed = enter(slot, run) || x.page_watch(page, slot, section);
    numbers(x.page_start(page), 2 * n).set(before);
    if (failed) return fault();
    orbits.forEach((o) => { if (o.slot === slot) o.ended = true; });
    orbits.push({ slot, ended: false, count: 0 });
    return { ok: true, number: orbits.length - 1 };
  }
  // Some steps of all of them: [x, y, ...] of each one's points.
  function turn({ steps, most }) {
    const began = performance.now(), points = orbits.map(() => []);
    while (orbits.some((o) => !o.ended) && performance.now() - began < BUDGET)
      orbits.forEach((o, i) => {
        if (o.ended) return;
        o.ended = x.page_advance(page, o.slot, steps) !== 0;
        points[i].push(...numbers(x.page_points(page), 2 * x.page_point_count(page)));
        o.count += x.page_point_count(page);
        o.ended = o.ended || o.count >= most;
      });
    return { ok: true, points, running: orbits.some((o) => !o.ended) };
  }
  function lesson({ schemes, gradient }) {
    const text = withTexts([...schemes, gradient], (kept, other, by) =>
      textOf(x.page_lesson(page, kept, other, by)));
    return { ok: true, lesson: JSON.parse(text) };
  }

  // The states as they are.
  function now() {
    const states = runs.map((r, slot) =>
      r.width ? state(slot, r.width).slice() : null);
    return {
      states,
      pictures: states.map((row, slot) =>
        row && runs[slot].width === 1 ? pictureOf(row) : null),
    };
  }

  // Up to `steps` steps of all runs, observed after each `every`; fewer where the
  // time is up.
  function go({ steps, every }) {
    const began = performance.now(), samples = runs.map(() => []);
    let done = 0;
    while (done < steps && (done === 0 || performance.now() - began < BUDGET)) {
      const count = Math.min(every, steps - done);
      runs.forEach((r, slot) => {
        if (!r.width || !r.ok) return;
        if (x.page_advance(page, slot, count)) Object.assign(r, fault());
        if (r.width === 1) samples[slot].push(...observed(state(slot, 1)));
      });
      done += count;
    }
    return { ok: true, done, busy: performance.now() - began,
      runs: runs.map((r) => ({ ...r })),
      samples: samples.map((rows) => new Float64Array(rows)), ...now() };
  }

  function levels({ at, k, box, nx, ny }) {
    const memory = x.page_take(16 * n);
    numbers(memory, 2 * n).set(at);
    const values = x.page_levels(page, memory, k, ...box, nx, ny);
    x.page_release(memory);
    return { ok: true, values: numbers(values, nx * ny).slice() };
  }

  // The picture of a state that is dragged.
  function picture({ at }) {
    const row = new Float64Array(4 + 2 * n);
    row.set(at, 4);
    return { ok: true, picture: pictureOf(row) };
  }

  // The largest step that each scheme is stable with, along the orbit.
  const limits = new Map();
  function limit({ h, schemes }) {
    const fastest = x.page_fastest(page, h);
    const steps = schemes.map((scheme) => {
      if (!limits.has(scheme))
        limits.set(scheme, withTexts([scheme], (at) => x.page_limit(page, at)));
      const most = limits.get(scheme); // 0: stable with no step
      return fastest > 0 && most > 0 ? most / fastest : NaN;
    });
    return { ok: true, steps };
  }

  const known = { limit, load, open, race, go, levels, picture, ahead, seed, launch,
    turn, lesson };
  return async function take(request) {
    let answer;
    try {
      answer = await known[request.ask](request);
    } catch (error) {
      answer = { ok: false, broken: true, message: error instanceof
        WebAssembly.RuntimeError ? "This takes more than the page has: memory, " +
        "or depth of the stack." : String(error.message || error) };
    }
    send({ ...answer, number: request.number });
  };
}
