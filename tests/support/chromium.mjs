// A page in headless Chromium, by the DevTools protocol over a pipe; for tests of
// pages.
import { spawn } from "node:child_process";

export async function chromium(program, folder, address, { size, still, paper }) {
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
  await call("Emulation.setEmulatedMedia", { media: paper ? "print" : "", features: [
    { name: "prefers-reduced-motion", value: still ? "reduce" : "" }] });
  await call("Network.emulateNetworkConditions", { offline: true, latency: 0,
    downloadThroughput: -1, uploadThroughput: -1 });
  await call("Page.navigate", { url: address });
  const evaluate = async (expression) => {
    const { result, exceptionDetails } = await call("Runtime.evaluate",
      { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ||
      exceptionDetails.text);
    return result.value;
  };
  return {
    evaluate, faults, requests,
    async key(key, code = key, text = undefined) {
      await call("Input.dispatchKeyEvent", { type: "keyDown", key, code, text });
      await call("Input.dispatchKeyEvent", { type: "keyUp", key, code });
    },
    pointer: (type, x, y) => call("Input.dispatchMouseEvent", { type, x, y,
      button: "left", buttons: type === "mouseReleased" ? 0 : 1, clickCount: 1 }),
    picture: async () => (await call("Page.captureScreenshot",
      { captureBeyondViewport: false })).data,
    async heap() {
      await call("HeapProfiler.collectGarbage");
      return (await call("Runtime.getHeapUsage")).usedSize;
    },
    async close() {
      child.kill();
      await ended;
    },
  };
}
