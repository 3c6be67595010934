// A page in headless Firefox, by WebDriver BiDi; for tests of pages.
import { spawn } from "node:child_process";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { connect } from "./websocket.mjs";

const wait = (time) => new Promise((resolve) => setTimeout(resolve, time));

// What Firefox does of its own accord, and how much motion is wanted.
const preferences = (still) => [
  ["app.normandy.enabled", false], ["app.update.disabledForTesting", true],
  ["browser.safebrowsing.update.enabled", false],
  ["browser.shell.checkDefaultBrowser", false], ["browser.startup.page", 0],
  ["datareporting.policy.dataSubmissionEnabled", false],
  ["network.captive-portal-service.enabled", false],
  ["network.connectivity-service.enabled", false],
  ["toolkit.telemetry.server", ""], ["ui.prefersReducedMotion", still ? 1 : 0],
].map(([name, value]) => `user_pref("${name}", ${JSON.stringify(value)});\n`).join("");

// Keys that WebDriver names by characters of its own.
const KEYS = { ArrowLeft: "\uE012", ArrowUp: "\uE013", ArrowRight: "\uE014",
  ArrowDown: "\uE015", End: "\uE010", Home: "\uE011", PageUp: "\uE00E",
  PageDown: "\uE00F", Tab: "\uE004", Enter: "\uE007" };

// Bytes that scripts of files' pages have, by about:memory's reports.
const REPORT = `(async () => {
  for (const what of ["child-gc-request", "child-cc-request"])
    Services.obs.notifyObservers(null, what);
  await new Promise((resolve) => setTimeout(resolve, 1000));
  let sum = 0;
  await new Promise((resolve) => Cc["@mozilla.org/memory-reporter-manager;1"]
    .getService(Ci.nsIMemoryReporterManager).getReports((process, path, kind, units,
      amount) => {
      if (/^file/.test(process) && !/unused/.test(path) &&
        /js-main-runtime\\/(realms|zones)\\//.test(path)) sum += amount;
    }, null, resolve, null, false));
  return sum; })()`;

export async function firefox(program, folder, address, { size, still }) {
  writeFileSync(folder + "/user.js", preferences(still));
  const child = spawn(program, ["--headless", "--no-remote", "--profile", folder,
    "--remote-debugging-port=0", "--remote-allow-system-access", "about:blank"],
  { stdio: "ignore", env: { ...process.env, HOME: folder, XDG_CACHE_HOME: folder } });
  const ended = new Promise((resolve) => child.once("exit", resolve));
  const server = folder + "/WebDriverBiDiServer.json";
  for (let i = 0; i < 600 && !existsSync(server); i++) await wait(50);
  await wait(50);
  const { ws_port: port } = JSON.parse(readFileSync(server, "utf8"));
  const waiting = new Map(), faults = [], requests = [];
  const send = await connect(port, "/session", (text) => {
    const message = JSON.parse(text), { method, params } = message;
    if (method === "log.entryAdded" && params.level === "error")
      faults.push(params.text);
    else if (method === "network.beforeRequestSent")
      requests.push(params.request.url);
    if (!waiting.has(message.id)) return;
    const { resolve, reject } = waiting.get(message.id);
    waiting.delete(message.id);
    message.type === "error" ? reject(new Error(message.message))
      : resolve(message.result);
  });
  let number = 0;
  const call = (method, params = {}) => new Promise((resolve, reject) => {
    waiting.set(++number, { resolve, reject });
    send(JSON.stringify({ id: number, method, params }));
  });
  await call("session.new", { capabilities: {} });
  await call("session.subscribe", { events: ["log.entryAdded",
    "network.beforeRequestSent"] });
  const { contexts } = await call("browsingContext.getTree");
  const { context } = contexts[0];
  const run = async (expression, target) => {
    const { result, exceptionDetails } = await call("script.evaluate", { target,
      awaitPromise: true, expression: `(async () => JSON.stringify(await (0, eval)(${
        JSON.stringify(expression)})))()` });
    if (exceptionDetails) throw new Error(exceptionDetails.text);
    return result.value === undefined ? undefined : JSON.parse(result.value);
  };
  const act = (source) => call("input.performActions", { context,
    actions: [{ id: source.type, ...source }] });
  await call("browsingContext.setViewport", { context,
    viewport: { width: size[0], height: size[1] } });
  await call("emulation.setNetworkConditions", { contexts: [context],
    networkConditions: { type: "offline" } }).catch((error) =>
    console.log("Firefox leaves the network on: " + error.message));
  // Of Firefox's own window; its field for addresses has the focus at first.
  const window = { context: (await call("browsingContext.getTree",
    { "moz:scope": "chrome" })).contexts[0].context };
  await run("gBrowser.selectedBrowser.focus()", window);
  await call("browsingContext.navigate", { context, url: address, wait: "none" });
  return {
    evaluate: (expression) => run(expression, { context }), faults, requests,
    key: (key) => act({ type: "key", actions: ["keyDown", "keyUp"].map((type) =>
      ({ type, value: KEYS[key] || key })) }),
    pointer: (type, x, y) => act({ type: "pointer", actions: [
      { type: "pointerMove", x: Math.round(x), y: Math.round(y) },
      ...({ mousePressed: [{ type: "pointerDown", button: 0 }],
        mouseReleased: [{ type: "pointerUp", button: 0 }] }[type] || [])] }),
    picture: async () => (await call("browsingContext.captureScreenshot",
      { context })).data,
    heap: () => run(REPORT, window),
    async close() {
      child.kill();
      await ended;
    },
  };
}
