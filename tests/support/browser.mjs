// A page in headless Chromium, by the DevTools protocol over a pipe; for tests of
// pages.  Needs node, and no packages.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";

// Opens `address`; size: [width, height].  The result has
//   evaluate(text)  the value of an expression, awaited
//   key, pointer    events of input
//   picture()       PNG as base64
//   faults          messages of errors in the console, and uncaught ones
//   requests        addresses that were asked for
//   close()
export async function browse(program, address, size = [1280, 900], features = []) {
  const folder = mkdtempSync(tmpdir() + "/nevh-browser.");
  const child = spawn(program, ["--headless", "--no-sandbox", "--disable-gpu",
    "--disable-dev-shm-usage", "--no-first-run", "--user-data-dir=" + folder,
    "--remote-debugging-pipe", "about:blank"],
  { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"],
    env: { ...process.env, HOME: folder, XDG_CACHE_HOME: folder } });
  const waiting = new Map(), listeners = [];
  let number = 0, rest = "";
  const ended = new Promise((resolve) => child.once("exit", resolve));
  child.stdio[4].on("data", (bytes) => {
    const texts = (rest + bytes.toString("utf8")).split("\0");
    rest = texts.pop();
    for (const text of texts) {
      const message = JSON.parse(text);
      if (message.id) {
        const { resolve, reject } = waiting.get(message.id);
        waiting.delete(message.id);
        message.error ? reject(new Error(message.error.message))
          : resolve(message.result);
      } else listeners.forEach((hear) => hear(message));
    }
  });
  let sessionId;
  const call = (method, params = {}) => new Promise((resolve, reject) => {
    waiting.set(++number, { resolve, reject });
    child.stdio[3].write(JSON.stringify({ id: number, method, params,
      ...(sessionId ? { sessionId } : {}) }) + "\0");
  });
  const faults = [], requests = [];
  listeners.push(({ method, params }) => {
    if (method === "Runtime.exceptionThrown")
      faults.push(params.exceptionDetails.exception?.description ||
        params.exceptionDetails.text);
    if (method === "Runtime.consoleAPICalled" && params.type === "error")
      faults.push(params.args.map((a) => a.value || a.description).join(" "));
    if (method === "Log.entryAdded" && params.entry.level === "error")
      faults.push(params.entry.text);
    if (method === "Network.requestWillBeSent") requests.push(params.request.url);
  });
  const { targetInfos } = await call("Target.getTargets");
  const { targetId } = targetInfos.find((t) => t.type === "page");
  ({ sessionId } = await call("Target.attachToTarget", { targetId, flatten: true }));
  for (const domain of ["Page", "Runtime", "Log", "Network"])
    await call(domain + ".enable");
  await call("Emulation.setDeviceMetricsOverride", { width: size[0],
    height: size[1], deviceScaleFactor: 1, mobile: size[0] < 500 });
  if (features.length) await call("Emulation.setEmulatedMedia", { features });
  await call("Page.navigate", { url: address });
  const ready = (expression) => evaluate(expression).catch(() => false);
  const evaluate = async (expression) => {
    const { result, exceptionDetails } = await call("Runtime.evaluate",
      { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ||
      exceptionDetails.text);
    return result.value;
  };
  return {
    call, evaluate, faults, requests,
    // Waits until an expression is true.
    async until(expression, seconds = 30) {
      for (let i = 0; i < seconds * 20; i++) {
        if (await ready(expression)) return true;
        await new Promise((resolve) => setTimeout(resolve, 50));
      }
      return false;
    },
    async key(key, code = key, text = undefined) {
      await call("Input.dispatchKeyEvent", { type: "keyDown", key, code, text });
      await call("Input.dispatchKeyEvent", { type: "keyUp", key, code });
    },
    pointer: (type, x, y) => call("Input.dispatchMouseEvent", { type, x, y,
      button: "left", buttons: type === "mouseReleased" ? 0 : 1, clickCount: 1 }),
    picture: async () => (await call("Page.captureScreenshot",
      { captureBeyondViewport: false })).data,
    async close() {
      child.kill();
      await ended;
      try { // its helpers may write for a while
        rmSync(folder, { recursive: true, force: true, maxRetries: 20 });
      } catch (error) {
        console.log("not removed: " + error.message);
      }
    },
  };
}
