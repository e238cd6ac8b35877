// Lamps of the photo that are moved, resized and turned, in a real browser.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, test } from "node:test";
import { browse, changed, closeBrowser, folder, missing, open, paint, picture, place, serve, state, STROKES } from "./studio.js";

const skip = missing();
if (skip && process.env.CI) throw new Error(skip);
after(closeBrowser);

/** The lamps of the photo as the page draws them. */
const shapes = async (page) => JSON.parse(await state(page, "shapes"));

/** Screen coordinates of a place in the photo, in pixels of the photo. */
async function onScreen(page, x, y) {
  const { width, height } = await page.evaluate(() => ({ ...document.getElementById("photo").dataset }));
  return place(page, x / Number(width), y / Number(height));
}

/** Paints the strokes, and chooses the tool; returns the index of the lamp on which the stroke for lights lies. */
async function begin(page) {
  for (const [tool, ...places] of STROKES) {
    const rounds = await state(page, "rounds");
    await changed(page, "rounds", rounds, () => paint(page, tool, ...places));
  }
  await page.waitForFunction(() => document.body.dataset.proposed === "" && document.body.dataset.last !== "masks");
  await lit(page);
  await page.keyboard.press("7");
  assert.ok(await page.locator("#tool-shape").isChecked());
  assert.match(await page.locator("#shape-size").innerText(), /no lamp/);
  const { width, height } = await page.evaluate(() => ({ ...document.getElementById("photo").dataset }));
  const on = [0.55 * Number(width), 0.4 * Number(height)];
  const far = (shape) => Math.hypot(shape.at[0] - on[0], shape.at[1] - on[1]);
  const all = await shapes(page);
  return all.indexOf(all.reduce((a, b) => (far(b) < far(a) ? b : a)));
}

/** Waits until the lamps of the room belong to the texture that is shown. */
const lit = (page) =>
  page.waitForFunction(() => {
    const { texture, lampsOf, last } = document.body.dataset;
    return texture && texture === lampsOf && (last === "progress" || last === "idle");
  });

/** The middle of a side of a lamp. */
const side = (shape, i) => [0, 1].map((k) => (shape.corners[2 * i + k] + shape.corners[(2 * i + 2 + k) % 8]) / 2);
const middle = (shape) => [0, 1].map((k) => [0, 2, 4, 6].reduce((sum, i) => sum + shape.corners[i + k] / 4, 0));

async function drag(page, from, by) {
  const [x, y] = await onScreen(page, ...from);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + by[0], y + by[1], { steps: 4 });
  await page.mouse.up();
}

test("a lamp is resized, moved and turned by the pointer, undone, and saved", { skip }, async (t) => {
  const server = await serve(t, folder());
  const page = await open(t, await browse(t), server.address);
  const index = await begin(page);
  const [original, before] = [await state(page, "texture"), (await shapes(page))[index]];

  // A click selects; then a side is dragged, and the opposite side stays.
  await page.mouse.click(...(await onScreen(page, ...before.at)));
  assert.match(await page.locator("#shape-size").innerText(), /^100 × 100 %$/);
  assert.equal(await state(page, "texture"), original);
  await picture(page, "5-shape");
  await drag(page, side(before, 1), [20, 4]);
  let texture = await changed(page, "texture", original);
  const wide = (await shapes(page))[index];
  assert.ok(wide.isChanged);
  const words = /^(\d+) × (\d+) %$/.exec(await page.locator("#shape-size").innerText());
  assert.ok(Number(words[1]) > 105 && Number(words[2]) === 100, words[0]);
  for (const i of [0, 1, 6, 7]) assert.ok(Math.abs(wide.corners[i] - before.corners[i]) < 0.1);
  await lit(page);
  await picture(page, "5-shape-wide");

  // The whole lamp, then its knob.
  await drag(page, middle(wide), [-12, 8]);
  texture = await changed(page, "texture", texture);
  const moved = (await shapes(page))[index];
  assert.ok(middle(moved)[0] < middle(wide)[0] - 1 && middle(moved)[1] > middle(wide)[1] + 1);
  const [from, to] = [await onScreen(page, ...middle(moved)), await onScreen(page, ...side(moved, 1))];
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const knob = [0, 1].map((k) => to[k] + (26 * (to[k] - from[k])) / length);
  await page.mouse.move(...knob);
  await page.mouse.down();
  await page.mouse.move(knob[0] - 4, knob[1] + 14, { steps: 4 });
  await page.mouse.up();
  texture = await changed(page, "texture", texture);
  assert.match(await page.locator("#shape-size").innerText(), / %, -?\d+°$/);
  await picture(page, "5-shape-turned");

  // Saved, undone, and done again.
  const [file] = await Promise.all([page.waitForEvent("download"), page.locator("#out-project").click()]);
  const saved = JSON.parse(readFileSync(await file.path(), "utf8"));
  assert.equal(saved.reshaped.length, 1);
  assert.deepEqual(saved.reshaped[0].before, before.corners);
  for (let i = 0; i < 3; i++) await page.locator("#undo").click();
  await page.waitForFunction((of) => document.body.dataset.texture === of, original);
  assert.ok(!(await shapes(page))[index].isChanged);
  for (let i = 0; i < 3; i++) await page.locator("#redo").click();
  await page.waitForFunction((of) => document.body.dataset.texture === of, texture);

  // Taken out, a reshaped lamp is gone from its new place.
  const now = (await shapes(page))[index];
  await page.locator("label:has(#tool-remove)").click();
  await page.mouse.click(...(await onScreen(page, ...middle(now))));
  await changed(page, "texture", texture);
  assert.ok(!(await shapes(page)).some((shape) => shape.isChanged));
  assert.deepEqual(page.problems, []);
});

test("lamps are reshaped by touch, all alike, and by keys", { skip }, async (t) => {
  const server = await serve(t, folder());
  const browser = await browse(t, { colorScheme: "dark", hasTouch: true, viewport: { width: 390, height: 800 } });
  const page = await open(t, browser, server.address);
  const index = await begin(page);
  let texture = await state(page, "texture");
  const before = (await shapes(page))[index];

  // By finger: a tap selects, a drag of a side changes all lamps of this size.
  await page.touchscreen.tap(...(await onScreen(page, ...before.at)));
  assert.match(await page.locator("#shape-size").innerText(), /^100 × 100 %$/);
  await page.locator("#shape-alike").check();
  const input = await page.context().newCDPSession(page);
  const [x, y] = await onScreen(page, ...side(before, 1));
  const touch = (type, ...points) => input.send("Input.dispatchTouchEvent", { type, touchPoints: points });
  await touch("touchStart", { x, y });
  for (let i = 1; i <= 4; i++) await touch("touchMove", { x: x + 3 * i, y: y + i });
  await touch("touchEnd");
  texture = await changed(page, "texture", texture);
  const count = (await shapes(page)).filter((shape) => shape.isChanged).length;
  assert.ok(count > 2, `${count} lamps have changed`);
  await picture(page, "5-shape-alike-390-dark");
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `the page is ${wide} wide`);

  // By keys: back to the photo's shape, then a step, a side and a turn of the next lamp.
  await page.locator("#photo").focus();
  await page.keyboard.press("Delete");
  texture = await changed(page, "texture", texture);
  assert.ok(!(await shapes(page)).some((shape) => shape.isChanged));
  await page.locator("#shape-alike").uncheck();
  await page.locator("#photo").focus();
  await page.keyboard.press("Space");
  for (const key of ["ArrowRight", "Shift+ArrowUp", "."]) await page.keyboard.press(key);
  await changed(page, "texture", texture);
  assert.match(await page.locator("#shape-size").innerText(), /^100 × 105 %, 1°$/);
  assert.equal((await shapes(page)).filter((shape) => shape.isChanged).length, 1);
  await page.keyboard.press("Control+z");
  await page.waitForFunction((of) => document.body.dataset.texture === of, texture);
  assert.deepEqual(page.problems, []);
});
