// The studio in a real browser: what a user does, from the photo to the files, and back from a project.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { createServer, request } from "node:http";
import { join } from "node:path";
import { after, test } from "node:test";
import {
  browse,
  changed,
  closeBrowser,
  folder,
  isThere,
  missing,
  open,
  paint,
  picture,
  place,
  serve,
  state,
  STROKES,
} from "./studio.js";

const skip = missing();
if (skip && process.env.CI) throw new Error(skip);

/** The server of the tests that need none of their own. */
const shared = { ends: [], after: (work) => shared.ends.push(work) };
let sharedServer = null;
const server = () => (sharedServer ??= serve(shared, folder()));
after(async () => {
  for (const end of shared.ends) await end();
  await closeBrowser();
});

/** Clicks a button that downloads, and returns the file's text or bytes. */
async function download(page, id, encoding) {
  const [file] = await Promise.all([page.waitForEvent("download"), page.locator(`#out-${id}`).click()]);
  return readFileSync(await file.path(), encoding);
}

/** The status of the server's answer to a request with headers that no page can set. */
function status(address, headers) {
  return new Promise((done, failed) => {
    const asked = request(address, { headers }, (answer) => {
      answer.resume();
      done(answer.statusCode);
    });
    asked.on("error", failed).end();
  });
}

/** Width and height of an EXR file, of its data window. */
function sizeOfExr(data) {
  const at = data.indexOf("dataWindow\0box2i\0") + "dataWindow\0box2i\0".length + 4;
  const [left, top, right, bottom] = [0, 4, 8, 12].map((i) => data.readInt32LE(at + i));
  return [right - left + 1, bottom - top + 1];
}

/** The codes of all warnings of the library. */
function warningCodes() {
  const text = readFileSync(new URL("../../bindings/python/luxfer/types.py", import.meta.url), "utf8");
  const body = /class WarningCode\(IntEnum\):(.*?)\nclass /s.exec(text)[1];
  return [...body.matchAll(/^    ([A-Z_]+) = \d+$/gm)].map((found) => found[1]);
}

/** Warnings whose advice by the library names functions, settings or matrices. */
const OF_PROGRAMS = new Set(
  ("FOCAL_ASSUMED VIEW_UNCERTAIN LAYOUT_UNCERTAIN PATTERN_UNCERTAIN NO_LATTICE NO_PATTERN UNREACHABLE MISSED_STROKES " +
    "IMPLAUSIBLE_SIZE FAR_FROM_ORIGIN").split(" "),
);

/** Paints the three strokes; each of them changes the masks, for which is waited if `isPatient`. */
async function paintAll(page, isPatient = true) {
  const before = await state(page, "rounds");
  for (const [tool, ...places] of STROKES) {
    const last = await state(page, "rounds");
    await paint(page, tool, ...places);
    if (isPatient) await changed(page, "rounds", last);
  }
  await changed(page, "rounds", before);
  await page.waitForFunction(() => document.body.dataset.strokes === "3" && document.body.dataset.proposed === "");
}

/** The results for the present strokes, once they are all there. */
async function settled(page) {
  await page.waitForFunction(
    () => document.body.dataset.last === "progress" || document.body.dataset.last === "idle",
  );
  return { masks: await state(page, "masks"), texture: await state(page, "texture") };
}

test("from photo and strokes to files, and back from the project", { skip }, async (t) => {
  const place = folder();
  const server = await serve(t, place);
  const browser = await browse(t);
  const page = await open(t, browser, server.address);

  // Without a stroke there are proposed masks, a lit room, and words that say so.
  assert.equal(await state(page, "proposed"), "plane lights");
  assert.match(await page.locator("#notes").innerText(), /Proposal/);
  assert.match(await page.locator("#room-status").innerText(), /stated error \d/);
  await page.locator("#lux dd").first().waitFor();
  assert.match(await page.locator("#lux").innerText(), /On a plane 0\.75 m above the floor, 0\.50 m from the walls\./);
  for (const name of ["lowest", "highest", "uniformity"])
    assert.match(await page.locator("#lux").innerText(), new RegExp(`${name}\\s+[\\d.]+( lx)? \\([\\d.]+ to [\\d.]+\\)`));
  await picture(page, "1-proposal");

  await paintAll(page);
  const made = await settled(page);
  const lamps = Number(await page.locator("#lamps-count").innerText());
  assert.ok(lamps >= 4, `${lamps} lamps`);
  await page.waitForFunction(() => /Planned: /.test(document.getElementById("planned").textContent));
  await page.locator("#show-grid").check();
  await page.locator("#show-lines").check();
  await picture(page, "2-painted");
  await page.locator("#show-grid").uncheck();
  await page.locator("#show-lines").uncheck();

  // Files.
  const csv = await download(page, "csv", "utf8");
  assert.equal(csv.trim().split("\n").length, lamps + 1);
  assert.equal((await download(page, "glb")).subarray(0, 4).toString(), "glTF");
  const exr = await download(page, "exr");
  assert.equal(exr.readUInt32LE(0), 20000630);
  assert.deepEqual(sizeOfExr(exr), [720, 480]);
  assert.equal((await download(page, "png")).subarray(1, 4).toString(), "PNG");
  assert.match(await download(page, "program", "utf8"), /strokes\.add\(phase/);
  assert.match(await download(page, "program-c", "utf8"), /luxfer_strokes_add\(/);
  assert.match(await download(page, "program-cpp", "utf8"), /luxfer::Strokes::create\(/);
  const project = await download(page, "project", "utf8");
  assert.equal(JSON.parse(project).strokes.length, 3);

  // Undo and redo.
  await changed(page, "strokes", "3", () => page.keyboard.press("Control+z"));
  assert.equal(await state(page, "strokes"), "2");
  await page.locator("#redo").click();
  assert.equal(await state(page, "strokes"), "3");
  await page.waitForFunction((masks) => document.body.dataset.masks === masks, made.masks);

  // A lamp is taken out of the room, by the list, and put back.
  await page.locator(".kind summary").first().click();
  await page.locator(".kind li button").first().click();
  await page.waitForFunction((n) => document.getElementById("lamps-count").textContent === String(n), lamps - 1);
  await page.getByRole("button", { name: "Put all back" }).click();
  await page.waitForFunction((n) => document.getElementById("lamps-count").textContent === String(n), lamps);

  // The project opens again, in another browser, with the same result.
  const file = join(place, "again.luxfer.json");
  writeFileSync(file, project);
  await page.close();
  const other = await open(t, await browse(t), server.address);
  await other.locator("#open").click();
  await other.locator("#files").setInputFiles(file);
  await other.waitForFunction((masks) => document.body.dataset.masks === masks, made.masks);
  await other.waitForFunction((texture) => document.body.dataset.texture === texture, made.texture);
  await other.waitForFunction((n) => document.getElementById("lamps-count").textContent === String(n), lamps);
  await other.waitForFunction((texture) => document.body.dataset.luxOf === texture, made.texture);
  assert.equal(await download(other, "csv", "utf8"), csv);
  assert.deepEqual([...page.problems, ...other.problems], []);
});

test("by keys alone", { skip }, async (t) => {
  const { address } = await server();
  const page = await open(t, await browse(t), address);
  const before = await state(page, "masks");
  // Tab reaches the photo; nothing is clicked in this test.
  for (let i = 0; i < 30 && (await page.evaluate(() => document.activeElement.id)) !== "photo"; i++)
    await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.id), "photo");
  const rounds = await state(page, "rounds");
  await page.keyboard.press("2");
  assert.ok(await page.locator("#tool-not-plane").isChecked());
  for (let i = 0; i < 22; i++) await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Space");
  for (let i = 0; i < 8; i++) await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Space");
  assert.equal(await state(page, "strokes"), "1");
  await changed(page, "rounds", rounds);
  await page.keyboard.press("Control+z");
  assert.equal(await state(page, "strokes"), "0");
  await page.waitForFunction((masks) => document.body.dataset.masks === masks, before);
  await page.keyboard.press("Shift+?");
  assert.ok(await page.locator("dialog[open]").isVisible());
  await page.keyboard.press("Escape");
  assert.ok(!(await page.locator("dialog").isVisible()));

  // The view of the room turns, and a new picture comes.
  for (let i = 0; i < 30 && (await page.evaluate(() => document.activeElement.id)) !== "room"; i++)
    await page.keyboard.press("Tab");
  const mean = await state(page, "mean");
  for (let i = 0; i < 5; i++) await page.keyboard.press("ArrowLeft");
  await changed(page, "mean", mean);
  assert.deepEqual(page.problems, []);
});

test("the grid of the plane: dragged by a corner and by keys, and back to the found one", { skip }, async (t) => {
  const { address } = await server();
  const page = await open(t, await browse(t), address);
  const original = await state(page, "texture");
  const [masks, found] = [await state(page, "masks"), await state(page, "vanishing")];
  assert.equal(await state(page, "grid"), "found");
  assert.ok(!(await page.locator("#grid-found").isVisible()));
  await page.locator("label:has(#tool-grid)").click();
  await picture(page, "5-grid");

  // The page states where the corners are; the first is dragged, and the grid then runs through where it was dropped.
  const corner = async (i) => (await state(page, "corners")).split(" ").map(Number).slice(2 * i, 2 * i + 2);
  const size = await page.evaluate(() => {
    const { width, height } = document.getElementById("photo").dataset;
    return [Number(width), Number(height)];
  });
  const before = await corner(0);
  const other = await corner(2);
  const [x, y] = await place(page, before[0] / size[0], before[1] / size[1]);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 12, y + 6, { steps: 3 });
  await picture(page, "5-grid-dragged");
  await page.mouse.up();
  await changed(page, "texture", original);
  assert.equal(await state(page, "grid"), "dragged");
  assert.notEqual(await state(page, "vanishing"), found);
  assert.equal(await state(page, "masks"), masks);
  assert.ok((await corner(0))[0] > before[0] + 1 && (await corner(0))[1] > before[1] + 0.5);
  assert.deepEqual(await corner(2), other);
  assert.equal(await state(page, "strokes"), "0");

  // By keys: the next corner, then a step.
  const vanishing = await state(page, "vanishing");
  await page.locator("#photo").focus();
  await page.keyboard.press("Space");
  await page.keyboard.press("ArrowUp");
  await changed(page, "vanishing", vanishing);
  await page.locator("#grid-found").click();
  await page.waitForFunction((texture) => document.body.dataset.texture === texture, original);
  assert.equal(await state(page, "grid"), "found");
  assert.equal(await state(page, "vanishing"), found);
  await page.locator("#undo").click();
  await page.waitForFunction(() => document.body.dataset.grid === "dragged");
  assert.deepEqual(page.problems, []);
});

/** What the page says of the illuminance, once it has another value. */
async function otherLux(page, before) {
  const mean = () => page.evaluate(() => document.getElementById("lux").dataset.mean);
  await page.waitForFunction((before) => document.getElementById("lux").dataset.mean !== before, before ?? "");
  return mean();
}

test("the lamps by hand: shift, turn, size, mix, mean, and another ceiling", { skip }, async (t) => {
  const { address } = await server();
  const page = await open(t, await browse(t), address);
  const offset = async () => [await page.locator("#across").inputValue(), await page.locator("#along").inputValue()];
  assert.deepEqual(await offset(), ["0", "0"]);

  // On the plan: the drag is a shift by its metres, 6 m over the width of the ceiling.
  const plan = await page.locator("#lamp-plan").boundingBox();
  let texture = await state(page, "texture");
  const original = texture;
  await page.mouse.move(plan.x + plan.width / 2, plan.y + plan.height / 2);
  await page.mouse.down();
  await page.mouse.move(plan.x + 0.6 * plan.width, plan.y + plan.height / 2, { steps: 3 });
  await page.mouse.up();
  texture = await changed(page, "texture", texture);
  const [across, along] = (await offset()).map(Number);
  assert.ok(Math.abs(across - 0.6) < 0.03 && Math.abs(along) < 0.03, `${across}, ${along}`);

  // On the ceiling in the room, and by keys.
  const room = await page.locator("#room").boundingBox();
  await page.locator("label:has(#room-tool-shift)").click();
  await page.mouse.move(room.x + 0.4 * room.width, room.y + 0.1 * room.height);
  await page.mouse.down();
  await page.mouse.move(room.x + 0.5 * room.width, room.y + 0.1 * room.height, { steps: 3 });
  await picture(page, "6-shift");
  await page.mouse.up();
  texture = await changed(page, "texture", texture);
  assert.notDeepEqual((await offset()).map(Number), [across, along]);
  await page.locator("label:has(#room-tool-turn)").click();
  await page.locator("#room").focus();
  await page.keyboard.press("ArrowRight");
  texture = await changed(page, "texture", texture);
  assert.equal(await page.locator("#turn").inputValue(), "1");
  await page.locator("label:has(#room-tool-size)").click();
  await page.locator("#room").focus();
  await page.keyboard.press("ArrowUp");
  texture = await changed(page, "texture", texture);
  assert.equal(await page.locator("#scale").inputValue(), "lamp");
  for (let i = 0; i < 4; i++) await page.locator("#undo").click();
  assert.deepEqual(await offset(), ["0", "0"]);
  await page.waitForFunction((of) => {
    const { lampsOf, luxOf, texture } = document.body.dataset;
    return texture === of && lampsOf === of && luxOf === of;
  }, original);
  const full = await otherLux(page);

  // A lamp is added where the plan is clicked, and taken out again.
  const count = async () => Number(await page.locator("#lamps-count").innerText());
  const lamps = await count();
  await page.locator(".kind summary").first().click();
  await page.getByRole("button", { name: "Add one" }).first().click();
  const free = { x: 0.27 * plan.width, y: 0.4 * plan.height };
  await page.locator("#lamp-plan").click({ position: free });
  await page.waitForFunction((n) => document.getElementById("lamps-count").textContent === String(n), lamps + 1);
  await picture(page, "6-added");
  await page.locator("#lamp-plan").click({ position: free });
  await page.waitForFunction((n) => document.getElementById("lamps-count").textContent === String(n), lamps);

  await page.waitForFunction((full) => document.getElementById("lux").dataset.mean === full, full);

  // Light: a kind at half, then the wanted mean.
  await page.locator(".dimmer input").first().fill("50");
  const dimmed = await otherLux(page, full);
  assert.ok(Number(dimmed) < 0.95 * Number(full), `${full} to ${dimmed} lx`);
  await page.locator("#lux-wish").fill("400");
  await page.locator("#lux-bring").click();
  const brought = await otherLux(page, dimmed);
  assert.ok(Math.abs(Number(brought) - 400) < 8, `${brought} lx`);
  await page.selectOption("#lux-plane", { label: "Table" });
  await otherLux(page, brought);
  assert.match(await page.locator("#lux").innerText(), /On the front of Table/);

  // A click on another candidate makes it the ceiling.
  await page.locator("label:has(#room-tool-choose)").click();
  await picture(page, "7-candidates");
  await page.locator("#room").focus();
  await page.keyboard.press("ArrowRight");
  assert.notEqual(await page.locator("#surface").inputValue(), "Ceiling");
  await page.mouse.click(room.x + 0.4 * room.width, room.y + 0.06 * room.height);
  assert.match(await page.locator("#surface").inputValue(), /Ceiling|White plaster/);
  assert.deepEqual(page.problems, []);
});

test("stylise: what is painted on the ball is painted on the picture", { skip }, async (t) => {
  const { address } = await server();
  const browser = await browse(t);
  const page = await open(t, browser, address, isThere);
  await page.locator("#tab-light").focus();
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => document.body.dataset.painting);
  const before = await state(page, "painting");
  const box = await page.locator("#artwork").boundingBox();
  await page.mouse.move(box.x + 0.4 * box.width, box.y + 0.4 * box.height);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 0.5 * box.height, { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction((b) => document.body.dataset.painting && document.body.dataset.painting !== b, before);
  assert.ok(await page.locator("#artwork-own").isChecked());
  await picture(page, "8-stylise");

  // By keys: a stroke, one that is given up, and undo.
  const art = () => page.evaluate(() => document.getElementById("artwork").toDataURL());
  const pointed = await art();
  await page.locator("#artwork").focus();
  await page.keyboard.press("Space");
  for (let i = 0; i < 5; i++) await page.keyboard.press("ArrowLeft");
  await picture(page, "8-stylise-keys");
  await page.keyboard.press("Escape");
  assert.equal(await art(), pointed);
  await page.keyboard.press("Space");
  for (let i = 0; i < 5; i++) await page.keyboard.press("ArrowDown");
  const last = await state(page, "painting");
  await page.keyboard.press("Space");
  assert.notEqual(await art(), pointed);
  await page.waitForFunction((b) => document.body.dataset.painting && document.body.dataset.painting !== b, last);
  await page.keyboard.press("Control+z");
  assert.equal(await art(), pointed);
  for (const width of [1440, 390]) {
    await page.setViewportSize({ width, height: 800 });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, `at ${width} pixels the page is ${wide} wide`);
  }
  const [file] = await Promise.all([page.waitForEvent("download"), page.locator("#out-painting").click()]);
  assert.equal(readFileSync(await file.path()).subarray(1, 4).toString(), "PNG");
  await page.locator("#artwork-file").setInputFiles({ name: "a.png", mimeType: "image/png", buffer: Buffer.from("x") });
  await page.locator("#notice-text", { hasText: "the artwork cannot be used" }).waitFor();
  assert.deepEqual(
    page.problems.filter((p) => !/400/.test(p)),
    [],
  );
  // The artwork is still there after the page has been loaded anew.
  await page.reload();
  await page.waitForFunction(() => document.getElementById("artwork-own")?.checked);
});

test("every warning of the library is shown, with advice for this page", { skip }, async (t) => {
  const { address } = await server();
  const page = await (await browse(t)).newPage();
  const codes = warningCodes();
  let give = null;
  await page.routeWebSocket(/\/ws/, (socket) => {
    socket.connectToServer().onMessage((message) => {
      const header = JSON.parse(message.subarray(4, 4 + message.readUInt32LE(0)).toString());
      if (!["warnings", "doubt", "room"].includes(header.type)) socket.send(message);
    });
    give = (header) => {
      const text = Buffer.from(JSON.stringify(header));
      const size = Buffer.alloc(4);
      size.writeUInt32LE(text.length);
      socket.send(Buffer.concat([size, text]));
    };
  });
  await page.goto(address);
  // A photo that arrives takes all notes away, so the messages wait until its light is there; no photo comes later.
  await page.waitForFunction(() => document.body.dataset.lampsOf);
  const list = codes.map((code, i) => ({
    code,
    stage: "lights",
    message: `message of ${code}`,
    advice: "call luxfer_own_advice",
    at: [5 * i, 10],
  }));
  give({ type: "warnings", list });
  await page.locator("#notes", { hasText: `Message of ${codes.at(-1)}` }).waitFor();
  const shown = await page.locator("#notes").innerText();
  for (const code of codes.filter((c) => c !== "PROPOSED"))
    assert.ok(shown.includes(`Message of ${code}`), `no note of ${code}`);
  assert.match(shown, /Proposal/);
  assert.equal(await page.locator("#notes-count").innerText(), String(codes.length));
  // Every advice that speaks of functions or settings has one for this page.
  for (const code of codes.filter((c) => OF_PROGRAMS.has(c))) {
    const note = page.locator("#notes li", { hasText: new RegExp(`Message of ${code}\\.`) });
    assert.ok(!(await note.innerText()).includes("luxfer_own_advice"), `the advice of ${code} is for programs`);
  }
});

test("by touch, in windows of any size, light and dark", { skip }, async (t) => {
  const { address } = await server();
  const browser = await browse(t, { colorScheme: "dark", hasTouch: true, viewport: { width: 800, height: 900 } });
  const page = await open(t, browser, address);
  const before = await state(page, "rounds");
  await page.locator("label:has(#tool-not-plane)").tap();
  const [x, y] = await place(page, 0.5, 0.95);
  await changed(page, "rounds", before, () => page.touchscreen.tap(x, y));
  assert.equal(await state(page, "strokes"), "1");
  const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  assert.equal(await background(), "rgb(23, 25, 28)");
  for (const [width, height] of [
    [1920, 1080],
    [1440, 900],
    [1024, 768],
    [390, 800],
  ]) {
    await page.setViewportSize({ width, height });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, `at ${width} pixels the page is ${wide} wide`);
    for (const id of ["photo", "room", "noise", "out-glb"]) {
      const box = await page.locator(`#${id}`).boundingBox();
      assert.ok(
        box && box.width > 20 && box.x >= 0 && box.x + box.width <= width + 1,
        `${id} at ${width}: ${JSON.stringify(box)}`,
      );
    }
    await picture(page, `3-dark-${width}`);
  }
  await page.selectOption("#theme", "light");
  assert.equal(await background(), "rgb(244, 244, 242)");
  await page.reload();
  await page.waitForFunction(() => document.body.dataset.texture);
  assert.equal(await background(), "rgb(244, 244, 242)");
});

test("by pen: a stroke is wider if the pen is pressed", { skip }, async (t) => {
  const { address } = await server();
  const page = await open(t, await browse(t), address);
  await page.locator("label:has(#tool-not-plane)").click();
  const input = await page.context().newCDPSession(page);
  for (const [force, y] of [
    [0.1, 0.88],
    [0.9, 0.96],
  ]) {
    const [x0, y0] = await place(page, 0.3, y);
    const event = { button: "left", buttons: 1, clickCount: 1, pointerType: "pen", force };
    await input.send("Input.dispatchMouseEvent", { ...event, type: "mousePressed", x: x0, y: y0 });
    await input.send("Input.dispatchMouseEvent", { ...event, type: "mouseMoved", x: x0 + 60, y: y0 });
    await input.send("Input.dispatchMouseEvent", { ...event, type: "mouseReleased", x: x0 + 60, y: y0 });
  }
  await page.waitForFunction(() => document.body.dataset.strokes === "2");
  const [light, strong] = await page.evaluate(() => {
    const mine = localStorage.getItem(`luxfer-studio/${sessionStorage.getItem("luxfer-studio-session")}`);
    return JSON.parse(mine).project.strokes.map((stroke) => stroke.radius);
  });
  assert.ok(strong > 2 * light, `radii ${light} and ${strong}`);
});

test("two users at once", { skip }, async (t) => {
  const { address } = await server();
  const [one, two] = await Promise.all([
    open(t, await browse(t), address),
    open(t, await browse(t), address),
  ]);
  for (const [page, strokes] of [
    [one, STROKES.slice(0, 2)],
    [two, STROKES.slice(2)],
  ]) {
    const before = await state(page, "rounds");
    for (const [tool, ...places] of strokes) await paint(page, tool, ...places);
    await changed(page, "rounds", before);
  }
  assert.notEqual(await state(one, "masks"), await state(two, "masks"));
  assert.equal(await state(one, "strokes"), "2");
  assert.equal(await state(two, "strokes"), "1");
});

test("a killed server loses no stroke", { skip }, async (t) => {
  const place = folder();
  const first = await serve(t, place);
  const browser = await browse(t);
  const page = await open(t, browser, first.address);
  await paintAll(page, false);
  const made = await state(page, "masks");
  await first.kill();
  await page.locator("#notice").waitFor();
  assert.match(await page.locator("#notice-text").innerText(), /ended.*strokes are kept/s);
  // What is painted without a server is kept too.
  await paint(page, "not-plane", [0.3, 0.1], [0.33, 0.12]);
  assert.equal(await state(page, "strokes"), "4");
  await page.close();

  const second = await serve(t, place, ["--port", first.port]);
  assert.equal(second.port, first.port);
  const again = await open(t, browser, second.address);
  assert.equal(await state(again, "strokes"), "4");
  assert.match(await again.locator("#notice-text").innerText(), /is back/);
  // The masks follow the stroke that the first server has not seen.
  assert.notEqual(made, "");
  assert.notEqual(await state(again, "masks"), made);
});

test("requests that are refused, and files that cannot be used", { skip }, async (t) => {
  const { address } = await server();
  const browser = await browse(t);
  const page = await open(t, browser, address, isThere);
  const wrong = await browser.newPage();
  const answer = await wrong.goto(address.replace(/\/[^/]+\/$/, "/wrong-token/"));
  assert.equal(answer.status(), 403);
  assert.match(await wrong.locator("body").innerText(), /token/);

  // A page of another origin can neither ask nor connect, though it knows the address.
  const foreign = createServer((_, out) => out.end("<!doctype html><title>foreign</title>"));
  await new Promise((done) => foreign.listen(0, "127.0.0.1", done));
  t.after(() => foreign.close());
  await wrong.goto(`http://127.0.0.1:${foreign.address().port}/`);
  const tried = await wrong.evaluate(async (address) => {
    const asked = await fetch(`${address}start`, { mode: "no-cors" }).then(
      () => "opaque",
      () => "refused",
    );
    const read = await fetch(`${address}start`).then(
      (a) => a.status,
      () => "refused",
    );
    const socket = await new Promise((done) => {
      const s = new WebSocket(`${address.replace("http", "ws")}ws?session=foreign01`);
      s.onopen = () => done("open");
      s.onerror = () => done("refused");
    });
    return { asked, read, socket };
  }, address);
  assert.deepEqual(tried, { asked: "refused", read: "refused", socket: "refused" });
  // The browser hides answers by itself, so the server is asked directly, as a browser asks for that page.
  const origin = `http://127.0.0.1:${foreign.address().port}`;
  assert.equal(await status(`${address}start`, {}), 200);
  assert.equal(await status(`${address}start`, { origin }), 403);
  assert.equal(await status(`${address}start`, { "sec-fetch-site": "cross-site" }), 403);

  await page.locator("#open").click();
  await page
    .locator("#files")
    .setInputFiles({ name: "broken.jpg", mimeType: "image/jpeg", buffer: Buffer.from("no photo") });
  await page.locator("#notice-text", { hasText: "broken.jpg cannot be read" }).waitFor();
  assert.equal(await state(page, "strokes"), "0");

  // A photo that shows nothing: a message gives advice, the picture is marked, and nothing is lost.
  const grey = await page.evaluate(() => {
    const canvas = Object.assign(document.createElement("canvas"), { width: 300, height: 200 });
    canvas.getContext("2d").fillStyle = "#888";
    canvas.getContext("2d").fillRect(0, 0, 300, 200);
    return canvas.toDataURL().split(",")[1];
  });
  await page.locator("#open").click();
  await page
    .locator("#files")
    .setInputFiles({ name: "grey.png", mimeType: "image/png", buffer: Buffer.from(grey, "base64") });
  await page.locator("#notes", { hasText: "use a photo that shows straight edges" }).waitFor();
  assert.match(await page.locator("body").getAttribute("class"), /stale/);
  await picture(page, "9-nothing");
  await page.locator("#undo").click();
  await page.waitForFunction(() => !document.body.classList.contains("stale"));
  assert.match(await page.locator("#names").innerText(), /office\.png/);
});
