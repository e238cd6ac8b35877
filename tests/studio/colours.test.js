// Whether people with any colour vision tell the marks of the page apart, computed from the colours that it draws with.

import assert from "node:assert/strict";
import { after, test } from "node:test";
import { browse, closeBrowser, folder, isThere, missing, open, serve } from "./studio.js";

const skip = missing();
if (skip && process.env.CI) throw new Error(skip);
after(closeBrowser);

/** Full dichromacy as matrices of linear RGB: Machado, Oliveira and Fernandes 2009, severity 1. */
const VISIONS = {
  full: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};
/** The least difference in CIELAB of marks that differ by colour alone; 2.3 is just noticeable side by side. */
const LEAST_DIFFERENCE = 15;
/** The least contrast of texts and of signs with their ground (WCAG 2.2, 1.4.3 and 1.4.11). */
const TEXT_CONTRAST = 4.5;
const SIGN_CONTRAST = 3;

function linear(colour) {
  const numbers = colour.startsWith("#")
    ? [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16))
    : colour.match(/[\d.]+/g).slice(0, 3).map(Number);
  return numbers.map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
}

/** A colour as somebody sees it, in linear RGB. */
function seen(colour, vision) {
  const [r, g, b] = linear(colour);
  const m = VISIONS[vision];
  return [0, 3, 6].map((i) => Math.min(1, Math.max(0, m[i] * r + m[i + 1] * g + m[i + 2] * b)));
}

const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

function lab([r, g, b]) {
  const [x, y, z] = [
    (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505,
    luminance([r, g, b]),
    (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089,
  ].map((t) => (t > 216 / 24389 ? Math.cbrt(t) : (t * 24389) / 27 / 116 + 16 / 116));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

function difference(a, b, vision) {
  const [p, q] = [a, b].map((colour) => lab(seen(colour, vision)));
  return Math.hypot(...p.map((x, i) => x - q[i]));
}

function contrast(a, b, vision) {
  const [low, high] = [a, b].map((colour) => luminance(seen(colour, vision))).sort((x, y) => x - y);
  return (high + 0.05) / (low + 0.05);
}

/** All pairs of marks that somebody could confuse, with the smallest difference over all visions. */
function confusable(marks, least) {
  const names = Object.keys(marks);
  const out = [];
  names.forEach((one, i) =>
    names.slice(i + 1).forEach((other) => {
      const [a, b] = [marks[one], marks[other]];
      if (a.form !== b.form || a.dashes.join() !== b.dashes.join()) return;
      for (const vision of Object.keys(VISIONS)) {
        const found = difference(a.colour, b.colour, vision);
        if (found < least) out.push(`${one} and ${other} with ${vision}: ${found.toFixed(1)}`);
      }
    }),
  );
  return out;
}

test("marks differ for every colour vision, and texts are legible in both themes", { skip }, async (t) => {
  const server = await serve(t, folder());
  const page = await open(t, await browse(t), server.address, isThere);
  const { photo, plan, map } = await page.evaluate(() => window.luxferMarks);
  assert.ok(Object.keys(photo).length >= 10);
  assert.deepEqual(confusable(photo, LEAST_DIFFERENCE), []);
  assert.deepEqual(confusable(plan, LEAST_DIFFERENCE), []);
  // The test can fail: red and green of equal form are confused.
  const naive = { plane: { ...photo.plane, colour: "#c06030" }, light: { ...photo.light, colour: "#809020" } };
  assert.notDeepEqual(confusable(naive, LEAST_DIFFERENCE), []);

  // The colours of the map of the illuminance rise in lightness for everybody.
  for (const vision of Object.keys(VISIONS)) {
    const steps = map.map((colour) => lab(seen(colour, vision))[0]);
    steps.slice(1).forEach((l, i) => assert.ok(l > steps[i] + 1, `step ${i + 1} of the map with ${vision}`));
  }

  // The swatches of the tools have the colours of the marks.
  const swatch = (tool) => page.evaluate((tool) => getComputedStyle(document.querySelector(`.swatch.${tool}`)).background, tool);
  for (const tool of ["plane", "not-plane", "light", "not-light"]) {
    const rgb = [1, 3, 5].map((at) => parseInt(photo[tool].colour.slice(at, at + 2), 16)).join(", ");
    assert.ok((await swatch(tool)).includes(`rgb(${rgb})`), tool);
  }

  for (const theme of ["light", "dark"]) {
    await page.selectOption("#theme", theme);
    const colours = await page.evaluate(() => {
      const probe = document.body.appendChild(document.createElement("span"));
      const read = (name) => ((probe.style.color = `var(--${name})`), getComputedStyle(probe).color);
      const names = ["page", "panel", "ink", "quiet", "control", "accent", "on-accent"];
      const out = Object.fromEntries(names.map((name) => [name, read(name)]));
      probe.remove();
      return out;
    });
    for (const vision of Object.keys(VISIONS)) {
      const check = (a, b, least) => {
        const found = contrast(colours[a], colours[b], vision);
        assert.ok(found >= least, `${a} on ${b}, ${theme}, ${vision}: ${found.toFixed(2)}`);
      };
      for (const ground of ["page", "panel"]) {
        check("ink", ground, TEXT_CONTRAST);
        check("quiet", ground, TEXT_CONTRAST);
        check("accent", ground, SIGN_CONTRAST);
      }
      check("ink", "control", TEXT_CONTRAST);
      check("on-accent", "accent", TEXT_CONTRAST);
    }
  }
});
