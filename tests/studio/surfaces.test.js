// Several surfaces of the room receive the lamps of the photo, in a real browser.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, test } from "node:test";
import { browse, changed, closeBrowser, folder, missing, open, picture, serve, state } from "./studio.js";

const skip = missing();
if (skip && process.env.CI) throw new Error(skip);
after(closeBrowser);

/** The names of the surfaces with lamps, and the one on which the user works. */
const surfaces = (page) =>
  page.evaluate(() => {
    const labels = [...document.querySelectorAll(".surfaces label")];
    return { names: labels.map((l) => l.textContent), chosen: labels.find((l) => l.querySelector("input").checked)?.textContent };
  });

/** Waits until the page shows the lamps of a surface. */
const shown = (page, name) =>
  page.waitForFunction((name) => {
    const { texture, lampsOf, luxOf } = document.body.dataset;
    return document.getElementById("surface").value === name && texture === lampsOf && texture === luxOf;
  }, name);

async function download(page, id) {
  const [file] = await Promise.all([page.waitForEvent("download"), page.locator(`#out-${id}`).click()]);
  return readFileSync(await file.path(), "utf8");
}

test("a wall has lamps beside the ceiling, each with its own pattern", { skip }, async (t) => {
  const server = await serve(t, folder());
  const page = await open(t, await browse(t), server.address);
  const ceiling = await state(page, "texture");
  assert.deepEqual((await surfaces(page)).names, []);
  await page.selectOption("#add-surface", "Back wall");
  let texture = await changed(page, "texture", ceiling);
  assert.deepEqual(await surfaces(page), { names: ["Back wall", "Ceiling"], chosen: "Back wall" });
  await page.locator("#lamps", { hasText: /On Ceiling: \d+ lamps/ }).waitFor();

  // The pattern of the wall is turned; that of the ceiling stays.
  await page.locator("#turn").fill("30");
  texture = await changed(page, "texture", texture);
  await page.waitForFunction(() => /stated error/.test(document.getElementById("room-status").textContent));
  await picture(page, "10-surfaces");
  await page.locator(".surfaces label", { hasText: "Ceiling" }).click();
  await page.waitForFunction((of) => document.body.dataset.texture === of, ceiling);
  assert.equal(await page.locator("#turn").inputValue(), "0");
  await page.locator("#lamps", { hasText: /On Back wall: \d+ lamps/ }).waitFor();
  await page.waitForFunction(() => document.body.dataset.last === "progress" || document.body.dataset.last === "idle");

  // Files have both, and so has the project.
  const rows = (await download(page, "csv")).trim().split("\n");
  const on = (name) => rows.filter((row) => row.endsWith(`,${name}`)).length;
  assert.ok(on("Ceiling") > 2 && on("Back wall") > 2 && on("Ceiling") + on("Back wall") === rows.length - 1);
  const project = JSON.parse(await download(page, "project"));
  assert.deepEqual([project.surface, project.others.map((o) => o.surface)], ["Ceiling", ["Back wall"]]);
  assert.ok(Math.abs(project.others[0].pattern.rotation - Math.PI / 6) < 1e-6);

  // Taken away, and brought back by undo; by keys too.
  await page.locator(".surfaces input:checked").focus();
  await page.keyboard.press("ArrowLeft");
  await page.waitForFunction(() => document.getElementById("surface").value === "Back wall");
  await page.locator("#remove-surface").click();
  await page.waitForFunction((of) => document.body.dataset.texture === of, ceiling);
  assert.deepEqual((await surfaces(page)).names, []);
  await page.locator("#undo").click();
  await page.waitForFunction((of) => document.body.dataset.texture === of, texture);
  assert.equal((await surfaces(page)).chosen, "Back wall");
  assert.deepEqual(page.problems, []);
});

test("surfaces in a small window, dark", { skip }, async (t) => {
  const server = await serve(t, folder());
  const page = await open(t, await browse(t, { colorScheme: "dark", viewport: { width: 390, height: 800 } }), server.address);
  const texture = await state(page, "texture");
  await page.selectOption("#add-surface", "Back wall");
  await changed(page, "texture", texture);
  await page.locator("#pattern").scrollIntoViewIfNeeded();
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `the page is ${wide} wide`);
  await picture(page, "10-surfaces-390-dark");
});
