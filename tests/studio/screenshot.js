// Takes the guide's picture of the studio:  node screenshot.js FOLDER
//
// Given a JPEG file too, it goes on to an accurate picture of the room, for the first screen of the README:
//
//   node tests/studio/screenshot.js out/screenshots docs/studio.jpg

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
const readme = process.argv[3] && resolve(process.argv[3]);
const reason = missing();
if (reason) {
  console.log(`the guide has no picture of the studio: ${reason}`);
  process.exit(0);
}
const ends = [];
const job = { after: (work) => ends.push(work) };
try {
  const server = await serve(job, folder(), [], false);
  const browser = await browse(job, { viewport: { width: 1440, height: 900 } });
  browser.setDefaultTimeout(600_000); // on a machine that does much else
  const page = await open(job, browser, server.address);
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
  if (readme) {
    await page.locator("#noise").fill("4"); // 5 % of noise
    // Both sides of the picture are done: the light to compare with comes last.
    const isDone = () =>
      /^Done/.test(document.getElementById("room-status").textContent) &&
      document.body.dataset.noise <= 0.05 &&
      document.body.dataset.last === "idle";
    await page.waitForFunction(isDone);
    await page.locator("#room-pane h2").click(); // nothing has the focus
    await page.mouse.move(5, 890);
    await page.screenshot({ path: readme, type: "jpeg", quality: 82 });
  }
} finally {
  for (const end of ends.reverse()) await end();
  await closeBrowser();
}
process.exit(0);
