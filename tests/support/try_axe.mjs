// Looks for faults of access in pages:
//
//     node try_axe.mjs PROGRAM AXE FILE...
//
// AXE is axe.min.js of the package axe-core of npm, which tests do not need.
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { browse, trial } from "./browser.mjs";

const [program, axe, ...files] = process.argv.slice(2);
const { check, ended } = trial();
files.forEach((file) => readFileSync(file)); // a browser shows a page of its own instead
for (const file of files)
  for (const size of [[1280, 900], [360, 740]]) {
    const page = await browse(program, "file://" + file, { size });
    try {
      await page.until("document.readyState === 'complete' && document.title");
      await page.evaluate(readFileSync(axe, "utf8") + "; 0");
      const found = JSON.parse(await page.evaluate(
        "axe.run().then((r) => JSON.stringify(r.violations.map((v) => " +
        "v.id + ': ' + v.help + ': ' + v.nodes.map((n) => n.target).join(' '))))"));
      check(found.length === 0,
        [basename(file), size[0] + " pixels", ...found].join("\n  "));
    } finally {
      await page.close();
    }
  }
ended();
