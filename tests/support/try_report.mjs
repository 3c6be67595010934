// Tries a report in a browser, and what moves in it:
//
//     node try_report.mjs PROGRAM FILE
import { basename } from "node:path";
import { browse, trial } from "./browser.mjs";

const [program, file] = process.argv.slice(2);
const { check, saved, ended } = trial();
const wait = (time) => new Promise((resolve) => setTimeout(resolve, time));

// In the page: the film's parts, and the step that its picture, its stamp, its errors,
// its cursor and its slider show, which is to be one; -1 where it is not.
const FILM = `(() => {
  const film = document.querySelector("figure:has(.stamp)");
  const part = (name) => film.querySelector(name);
  const data = JSON.parse(film.nextElementSibling.textContent);
  const shown = () => {
    const k = +part(".stamp").textContent.match(/^step (\\d+), /)[1];
    const wanted = "step " + k + ", t = " + (data.start + k*data.dt).toFixed(data.digits);
    const place = (a, e, names, j) => names.every((name, i) =>
      +e.getAttribute(name) === a[j + i]);
    const same = part(".stamp").textContent === wanted &&
      +part("input").value === k &&
      +part(".cursor").getAttribute("x1") === data.width * k / data.steps &&
      [...film.querySelectorAll(".orbit")].every((orbit, i) => {
        const l = Math.min(k, data.places[i].length / data.columns - 1);
        const a = data.places[i], o = l * data.columns;
        const trails = [...orbit.querySelectorAll("polyline")];
        const ways = [...orbit.querySelectorAll("path")];
        return film.querySelectorAll(".error")[i].textContent ===
            data.errors[i][l] + " %" &&
          [...orbit.querySelectorAll("line")].every((e, j) =>
            place(a, e, ["x1", "y1", "x2", "y2"], o + 4 * j)) &&
          [...orbit.querySelectorAll("circle")].every((e, j) =>
            place(a, e, ["cx", "cy"], o + 4 * data.rods + 2 * j) &&
            trails[j].getAttribute("points").trim().split(" ").at(-1) ===
              e.getAttribute("cx") + "," + e.getAttribute("cy") &&
            trails[j].getAttribute("points").trim().split(" ").length ===
              Math.min(l, data.trail) + 1 &&
            ways[j].getAttribute("d").trim().split(" ").length === l + 1);
      });
    return same ? k : -1;
  };
  window.film = { play: part("button"), bar: part("input"), shown,
    steps: data.steps, controls: part(".controls") };
})()`;

async function tried(name, options, body) {
  const page = await browse(program, "file://" + file, options);
  try {
    check(await page.until("document.readyState === 'complete'"), name + ": no page");
    await page.evaluate(FILM);
    await body(page, await page.evaluate("film.steps"));
    await page.evaluate("film.play.closest('figure').scrollIntoView()");
    await saved(page, `${basename(program)}-report-${name}`);
    check(await page.evaluate("document.documentElement.scrollWidth <= innerWidth"),
      name + ": the report is wider than its window");
    check(page.faults.length === 0, name + ": console: " + page.faults.join("; "));
    const far = page.requests.filter((r) => !/^(file|data):/.test(r));
    check(far.length === 0, name + ": requests " + far.join(" "));
  } finally {
    await page.close();
  }
}
const stands = async (page, step, what) => {
  await wait(300);
  const shown = await page.evaluate("film.shown()");
  check(shown === step, `${what}: step ${shown} for ${step}`);
};

// Names of lines of an order lie over no curve, which has a colour.
const CROSSED = `((svg, name) => {
  const box = name.getBoundingClientRect();
  return [...svg.querySelectorAll("path")].some((path) => {
    const stroke = getComputedStyle(path).stroke.match(/\\d+/g) || [0, 0, 0];
    if (Math.max(...stroke) - Math.min(...stroke) < 40) return false;
    const back = path.getScreenCTM().inverse();
    for (let x = box.left; x < box.right; x += 0.4)
      if (path.isPointInStroke(new DOMPoint(x, box.top + box.height / 2)
        .matrixTransform(back))) return true;
    return false;
  }); })`;

// Of each picture the variant for that width is shown, whose texts are large enough,
// lie within it, and over no other.
async function legible(page, look) {
  const faults = JSON.parse(await page.evaluate(`(() => {
    const faults = [], figures = [...document.querySelectorAll("figure.sized")];
    if (!figures.length) faults.push("no picture");
    for (const figure of figures) {
      const shown = [...figure.querySelectorAll("svg[role]")]
        .filter((svg) => svg.checkVisibility());
      if (shown.length !== 1 || !shown[0].classList.contains("${look}"))
        faults.push("other drawings than one that is ${look}");
      const box = shown[0].getBoundingClientRect();
      const texts = [...shown[0].querySelectorAll("text")]
        .filter((e) => e.textContent.trim())
        .map((e) => [e.textContent.trim(), e.getBoundingClientRect()]);
      for (const name of shown[0].querySelectorAll("text"))
        if (/^(order|slope) \\d/.test(name.textContent.trim()) &&
          ${CROSSED}(shown[0], name)) faults.push("crossed: " + name.textContent);
      texts.forEach(([text, a], i) => {
        if (Math.max(a.width, a.height) < 10)
          faults.push("small: " + text);
        if (a.left < box.left - 1 || a.right > box.right + 1 ||
          a.top < box.top - 1 || a.bottom > box.bottom + 1) faults.push("cut: " + text);
        for (const [other, b] of texts.slice(i + 1))
          if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 &&
            Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 4)
            faults.push(text + " over " + other);
      });
    }
    return JSON.stringify(faults); })()`));
  check(!faults.length, look + " pictures: " + faults.slice(0, 9).join("; "));
}

// On paper a picture stands on the page of its heading, and controls are left out.
if (!/firefox/.test(basename(program))) await tried("paper", { paper: true }, async (page) => {
  check(await page.evaluate(`[...document.querySelectorAll("h2")].every((e) =>
    getComputedStyle(e).breakAfter === "avoid" &&
    getComputedStyle(e.nextElementSibling).breakAfter === "avoid")`),
    "headings are on other pages than what they head");
  check(await page.evaluate(`[...document.querySelectorAll("svg[role]")].every((e) =>
    e.getBoundingClientRect().height < 500)`), "pictures fill pages");
  check(await page.evaluate("!film.bar.checkVisibility()"), "paper has a slider");
});
// It stands until it is asked to play, stops when it is asked to, and at its end.
await tried("wide", {}, async (page, steps) => {
  check(await page.evaluate("film.controls.checkVisibility()"), "has no controls");
  check(await page.evaluate(`getComputedStyle(film.controls).colorScheme ===
    getComputedStyle(document.documentElement).colorScheme`),
    "has light controls beside dark pictures");
  await legible(page, "broad");
  await stands(page, steps, "before it plays");
  await page.evaluate("film.play.focus()");
  await page.key("Enter", "Enter", "\r");
  check(await page.until("film.shown() > 3 && film.shown() < film.steps",
    10), "does not play");
  check(await page.evaluate("film.play.textContent") === "Pause", "cannot be stopped");
  await page.key("Enter", "Enter", "\r");
  const at = await page.evaluate("film.shown()");
  check(at > 3 && at < steps, "stops at " + at);
  await stands(page, at, "after it was stopped");
  check(await page.evaluate("film.play.textContent") === "Play", "cannot go on");
  await page.evaluate("film.bar.focus()");
  await page.key("Home");
  await stands(page, 0, "at the slider's beginning");
  await page.key("ArrowRight");
  await stands(page, 1, "an arrow after it");
  await page.key("End");
  await page.key("ArrowLeft");
  await stands(page, steps - 1, "an arrow before the end");
  await page.evaluate("film.play.click()");
  check(await page.until("film.play.textContent === 'Play'", 10), "does not end");
  await stands(page, steps, "at its end");
  await page.evaluate("film.play.click()");
  check(await page.until("film.shown() > 0 && film.shown() < film.steps", 10),
    "does not play again");
  await page.evaluate("film.bar.focus()");
  await page.key("Home");
  await stands(page, 0, "a slider that is moved while it plays");
});
// Where motion is not wanted, there is a slider alone.
await tried("still", { size: [360, 800], still: true }, async (page, steps) => {
  check(await page.evaluate("!film.play.checkVisibility() && film.bar.checkVisibility()"),
    "plays where motion is not wanted");
  await stands(page, steps, "where motion is not wanted");
  check(await page.evaluate(`(() => { const figure = film.play.closest("figure");
    return figure.scrollWidth <= figure.clientWidth; })()`), "the picture is cut");
  check(await page.evaluate(`[...film.play.closest("figure").querySelectorAll("text")]
    .every((e) => e.getBoundingClientRect().height > 10 &&
      e.getBoundingClientRect().right < innerWidth)`), "its text is small, or cut");
  await page.evaluate("film.bar.focus()");
  await page.key("Home");
  await page.key("ArrowRight");
  await stands(page, 1, "an arrow where motion is not wanted");
  await legible(page, "narrow");
});
ended();
