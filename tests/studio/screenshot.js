// Takes the guide's picture of the studio:  node screenshot.js FOLDER

import { mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import {
  browse,
  changed,
  closeBrowser,
  folder,
  missing,
  open,
  paint,
  serve,
  state,
  STROKES,
} from "./studio.js";

const out = resolve(process.argv[2]);
const reason = missing();
if (reason) {
  console.log(`the guide has no picture of the studio: ${reason}`);
  process.exit(0);
}
const ends = [];
const job = { after: (work) => ends.push(work) };
try {
  const server = await serve(job, folder(), [], false);
  const page = await open(job, await browse(job, { viewport: { width: 1440, height: 900 } }), server.address);
  for (const [tool, ...places] of STROKES) {
    await changed(page, "rounds", await state(page, "rounds"), () => paint(page, tool, ...places));
  }
  await page.selectOption("#compare", "white");
  // A picture of the full size, after the first small one.
  await page.waitForFunction(
    () =>
      !document.getElementById("label-before").hidden &&
      /Planned: \d/.test(document.getElementById("planned").textContent),
  );
  mkdirSync(out, { recursive: true });
  await page.screenshot({ path: join(out, "studio.png") });
} finally {
  for (const end of ends.reverse()) await end();
  await closeBrowser();
}
process.exit(0);
