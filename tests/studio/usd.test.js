// A room in USD in a real browser: opened, lit, and saved as USD again. The server gets usd-core from the tests of USD.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { delimiter, join } from "node:path";
import { after, test } from "node:test";
import { browse, closeBrowser, folder, missing, open, picture, PYTHON, ROOT, serve, state } from "./studio.js";

/** The folder of usd-core; empty if it is not installed. */
function usdFolder() {
  const lib = join(ROOT, "target/peers/usd/lib");
  if (!existsSync(lib)) return "";
  const found = readdirSync(lib).map((name) => join(lib, name, "site-packages"));
  return found.find((path) => existsSync(join(path, "pxr"))) ?? "";
}

const skip = missing() || (usdFolder() ? false : "usd-core is not installed: run benches/peers/install.sh usd");
if (skip && process.env.CI) throw new Error(skip);
after(closeBrowser);

test("a room in USD is opened, lit and saved as USD", { skip }, async (t) => {
  process.env.PYTHONPATH = [usdFolder(), process.env.PYTHONPATH].filter(Boolean).join(delimiter);
  const place = folder();
  const room = join(place, "hall.usdz");
  const make = "import luxfer, luxfer.usd, sys; luxfer.usd.save(luxfer.Scene.demo(luxfer.Context(), 'target-room'), sys.argv[1])";
  execFileSync(PYTHON, ["-c", make, room], { cwd: join(ROOT, "bindings/python") });
  const server = await serve(t, join(place, "state"));
  const page = await open(t, await browse(t), server.address);
  await page.locator("#open").click();
  await page.locator("#files").setInputFiles(room);
  await page.waitForFunction(() => /hall\.glb/.test(document.getElementById("names").textContent));
  await page.waitForFunction(() => ["progress", "idle"].includes(document.body.dataset.last) && document.body.dataset.lampsOf);
  assert.equal(await page.locator("#surface").inputValue(), "Ceiling");
  assert.ok(Number(await page.locator("#lamps-count").innerText()) >= 4);
  await picture(page, "11-usd");
  const [file] = await Promise.all([page.waitForEvent("download"), page.locator("#out-usd").click()]);
  assert.match(file.suggestedFilename(), /\.usdz$/);
  const data = readFileSync(await file.path());
  assert.equal(data.subarray(0, 2).toString(), "PK"); // a .usdz is a zip
  assert.ok(data.includes(Buffer.from(".usdc")));
  assert.equal(await state(page, "strokes"), "0");

  // A file without its pictures: a message that says what to do.
  const part = join(place, "hall.usdc");
  execFileSync(PYTHON, ["-c", make, part], { cwd: join(ROOT, "bindings/python") });
  await page.locator("#open").click();
  await page.locator("#files").setInputFiles(part);
  await page.locator("#notice-text", { hasText: "save the room as one .usdz" }).waitFor();
  assert.match(await page.locator("#names").innerText(), /hall\.glb/);
});
