// What the browser tests share: a studio server, Chromium, and what a user does on the page.

import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdtempSync, mkdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

export const ROOT = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
export const PYTHON = process.env.LUXFER_STUDIO_PYTHON ?? join(ROOT, "target/peers/studio/bin/python");
const CHROMIUM = process.env.LUXFER_CHROMIUM ?? "/usr/bin/chromium";
/** Screenshots go here if it is set. */
const PICTURES = process.env.LUXFER_STUDIO_PICTURES;
/** Waits end with what they wait for; this is only when to give up, on a machine that does much else. */
const WAIT_MS = 90_000;
const FLAGS = [
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--use-gl=angle",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
];

/** Why the tests cannot run here; empty if they can. */
export function missing() {
  if (!existsSync(PYTHON)) return `there is no ${PYTHON}: run benches/peers/install.sh studio`;
  if (!existsSync(CHROMIUM)) return `there is no ${CHROMIUM}`;
  if (!existsSync(join(ROOT, "bindings/python/luxfer/studio/static/index.html")))
    return "the page has not been built: run make studio";
  return false;
}

/** A folder that is deleted when all tests have ended, and with them the servers that use it. */
export function folder() {
  const out = mkdtempSync(join(tmpdir(), "luxfer-studio-test-"));
  process.on("exit", () => rmSync(out, { recursive: true, force: true, maxRetries: 5 }));
  return out;
}

const photos = mkdtempSync(join(tmpdir(), "luxfer-studio-photo-"));
process.on("exit", () => rmSync(photos, { recursive: true, force: true }));
const PHOTO = join(photos, "office.png");
const MAKE_PHOTO = `import luxfer, sys
luxfer.DemoPhoto(luxfer.Context()).run(width=300, height=200, samples=6).image("picture").save(sys.argv[1])`;

/** A small generated photo, made once. */
function photo() {
  if (!existsSync(PHOTO)) execFileSync(PYTHON, ["-c", MAKE_PHOTO, PHOTO], { cwd: join(ROOT, "bindings/python") });
  return PHOTO;
}

/** Starts a server; `address` is what it prints. */
export async function serve(test, state, args = [], isSmall = true) {
  if (isSmall) args = [photo(), ...args];
  const server = spawn(PYTHON, ["-m", "luxfer.studio", "--no-browser", "--port", "0", "--state", state, ...args], {
    cwd: join(ROOT, "bindings/python"),
    stdio: ["ignore", "pipe", "inherit"],
  });
  const ended = new Promise((done) => server.once("exit", done));
  test.after(async () => {
    server.kill("SIGKILL");
    await ended;
  });
  const address = await new Promise((done, failed) => {
    let text = "";
    server.stdout.on("data", (part) => {
      text += part;
      const found = /http:\S+/.exec(text);
      if (found) done(found[0]);
    });
    ended.then((code) => failed(new Error(`the studio has ended with ${code}: ${text}`)));
  });
  return { address, port: new URL(address).port, kill: async () => (server.kill("SIGKILL"), ended) };
}

let chromiumOfAll = null;

/** Windows with a profile of their own, of the one Chromium of all tests. */
export async function browse(test, options = {}) {
  chromiumOfAll ??= chromium.launch({ executablePath: CHROMIUM, args: FLAGS });
  const browser = await (await chromiumOfAll).newContext({ viewport: { width: 1440, height: 900 }, ...options });
  browser.setDefaultTimeout(WAIT_MS);
  test.after(() => browser.close());
  return browser;
}

/** Ends Chromium, after the last test. */
export async function closeBrowser() {
  await (await chromiumOfAll)?.close();
}

const isLit = () => document.body.dataset.texture && document.body.dataset.noise;
/** The page has its first results; those of the light need not be waited for. */
export const isThere = () => document.body.dataset.last;

/** A page of the studio, whose errors fail the test. */
export async function open(test, browser, address, isReady = isLit) {
  const page = await browser.newPage();
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  page.problems = errors;
  await page.goto(address);
  await page.waitForFunction(isReady);
  return page;
}

/** Canvas coordinates of a place in the photo, given as shares of its size. */
export async function place(page, x, y) {
  return page.evaluate(
    ([x, y]) => {
      const canvas = document.getElementById("photo");
      const box = canvas.getBoundingClientRect();
      const [w, h] = [Number(canvas.dataset.width), Number(canvas.dataset.height)];
      const scale = Math.min(box.width / w, box.height / h);
      return [box.left + box.width / 2 + (x - 0.5) * w * scale, box.top + box.height / 2 + (y - 0.5) * h * scale];
    },
    [x, y],
  );
}

/** Paints a stroke along places in the photo. */
export async function paint(page, tool, ...places) {
  await page.locator(`label:has(#tool-${tool})`).click();
  const points = [];
  for (const [x, y] of places) points.push(await place(page, x, y));
  await page.mouse.move(...points[0]);
  await page.mouse.down();
  for (const point of points.slice(1)) await page.mouse.move(...point, { steps: 6 });
  await page.mouse.up();
}

/** Waits until something that the page states in its body has another value. */
export async function changed(page, name, before, work) {
  await work?.();
  await page.waitForFunction(([name, before]) => document.body.dataset[name] !== before, [name, before]);
  return state(page, name);
}

export const state = (page, name) => page.evaluate((name) => document.body.dataset[name] ?? "", name);

/** Keeps a picture of the page, if pictures are wanted. */
export async function picture(page, name) {
  if (!PICTURES) return;
  mkdirSync(PICTURES, { recursive: true });
  await page.screenshot({ path: join(PICTURES, `${name}.png`) });
}

/** Counts what a user does from now on: clicks, and keys outside of text. */
export async function countActions(page) {
  await page.evaluate(() => {
    window.actions = { clicks: 0, keys: 0 };
    addEventListener("pointerdown", () => window.actions.clicks++, true);
    addEventListener("keydown", () => window.actions.keys++, true);
  });
}

/** Strokes on the generated photo: what they mark, and places as shares of its size. */
export const STROKES = [
  ["plane", [0.15, 0.25], [0.4, 0.14]],
  ["not-plane", [0.2, 0.95], [0.7, 0.93]],
  ["light", [0.5, 0.39], [0.62, 0.41]],
];
