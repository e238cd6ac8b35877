// Puts the parts of the page together: a change goes into the store, from there to the server, and
// results go to the parts.

import { ask, Connection, Problem, type Message, type Start } from "./api";
import { byId, hideNotice, make, notice, percent, seconds, short } from "./dom";
import { onKeys, showKeys } from "./keys";
import { LampList } from "./lamps";
import { LuxPanel } from "./lux";
import { maskPicture, rgbPicture, type Masks } from "./masks";
import { Notes } from "./notes";
import { Opener } from "./open";
import { showOut } from "./out";
import { PatternForm } from "./pattern";
import { PhotoView } from "./photo_view";
import { PLAIN_LAMPS, type Project, type Store, type Stroke } from "./project";
import { RoomTools } from "./room_tools";
import { RoomView } from "./room_view";
import type { Shape } from "./shapes";
import { TOOLS, type Tool } from "./strokes";
import { Stylise } from "./stylise";
import { shiftBy } from "./surface";
import { workOn } from "./surfaces";
import { Trade } from "./trade";

const STAGES: Record<string, string> = {
  view: "finding lines",
  lights: "finding plane and lights",
  unwarp: "straightening the plane",
  emission: "making the pattern",
  relight: "solving for the strength",
  render: "rendering",
  plan: "planning",
  compare: "rendering the light to compare with",
};

/** Tools whose hint stays after the first stroke. */
const WITH_HINT = new Set<Tool>(["remove", "grid", "shape"]);

/** Stages of the other tab; the last one ends its work. */
const OF_STYLISE = new Set(["guides", "painting", ""]);

/** Entries of the project that belong to a photo and mean nothing in another photo. */
const EMPTY_PHOTO = { strokes: [], removed: [], reshaped: [], grid: null };

/** Entries of the project that belong to a room and mean nothing in another room. */
const EMPTY_ROOM = { surface: null, ...PLAIN_LAMPS, others: [], lux_plane: { surface: null, height: 0.75 }, camera: null };

export class Page {
  readonly photo = new PhotoView();
  readonly room = new RoomView();
  readonly roomTools = new RoomTools(byId("room-tools"), this.room);
  readonly notes = new Notes();
  readonly lamps = new LampList();
  readonly pattern = new PatternForm();
  readonly trade = new Trade();
  readonly lux = new LuxPanel();
  readonly stylise: Stylise;
  readonly connection: Connection;
  private draft: Stroke | null = null;
  private compare = "off";
  private lastMasks: { masks: Masks; bits: Uint8Array } | null = null;
  private rounds = 0; // masks at the full size that have come
  private sent = new Map<number, number>(); // when each version was sent
  private autoExposure: number | null = null;
  private shapes: Shape[] = []; // the lamps of the photo as the server finds them

  constructor(
    readonly store: Store,
    readonly start: Start,
  ) {
    this.connection = new Connection(store.session);
    this.stylise = new Stylise(store.session);
    this.stylise.send = (message) => this.connection.say(message);
    this.connection.current = () => ({ project: this.withDraft(), compare: this.compare, draft: false });
    this.connection.onMessage = (message, payload) => this.take(message, payload);
    this.connection.onState = (isUp) => this.connected(isUp);
    store.onChange = (what) => this.changed(what);
    this.tools();
    this.tabs();
    this.listen();
    this.show();
    this.connection.open();
  }

  // -- changes go out

  private withDraft(): Project {
    const { project } = this.store;
    return this.draft ? { ...project, strokes: [...project.strokes, this.draft] } : project;
  }

  private send(isDraft: boolean): void {
    const version = this.connection.send({ project: this.withDraft(), compare: this.compare, draft: isDraft });
    this.sent.set(version, performance.now());
    if (this.sent.size > 50) this.sent.delete(this.sent.keys().next().value!);
  }

  private changed(what: string): void {
    this.show();
    if (what !== "exposure") this.send(false);
  }

  private show(): void {
    const { project } = this.store;
    this.photo.strokes = project.strokes;
    this.photo.removed = project.removed;
    this.photo.setGrid(project.grid);
    this.showShapes();
    byId("grid-found").hidden = !project.grid;
    this.photo.redraw();
    this.lamps.setProject(project);
    this.lux.setProject(project.lux_plane);
    this.pattern.show(project);
    this.trade.show(project.noise);
    if (project.camera) this.room.setCamera(project.camera, false);
    byId<HTMLButtonElement>("undo").disabled = !this.store.canUndo;
    byId<HTMLButtonElement>("redo").disabled = !this.store.canRedo;
    byId("names").textContent = `${project.photo.name} → ${project.room?.name ?? "generated room"}`;
    this.hint();
    document.body.dataset.strokes = String(project.strokes.length);
  }

  private listen(): void {
    const { store, photo, room } = this;
    photo.onDraft = (stroke) => {
      this.draft = stroke ? { ...stroke, points: [...stroke.points] } : null;
      this.send(stroke !== null); // work continues after a stroke is given up
    };
    photo.onStroke = (stroke) => {
      this.draft = null;
      store.change(`stroke ${store.project.strokes.length}`, { strokes: [...store.project.strokes, stroke] });
    };
    photo.onRemove = (at) => {
      const place = at.map((x) => Math.round(10 * x) / 10) as [number, number];
      const { removed, reshaped } = store.project;
      const moved = photo.shapes.changedAt(at); // a lamp is known by its place in the photo
      store.change(`remove ${removed.length}`, {
        removed: [...removed, moved?.at ?? place],
        reshaped: reshaped.filter((r) => r !== moved),
      });
    };
    photo.shapes.onChange = (reshaped, isStep) =>
      store.change(isStep ? "reshape" : `reshape ${performance.now()}`, { reshaped });
    photo.shapes.onSelect = (change) => this.showShape(change);
    byId("shape-restore").onclick = () => photo.shapes.restore();
    byId<HTMLInputElement>("shape-alike").onchange = (e) =>
      (photo.shapes.isForAlike = (e.target as HTMLInputElement).checked);
    photo.grid.onChange = (grid) => store.change("grid", { grid });
    byId("grid-found").onclick = () => store.change("grid found", { grid: null });
    room.onCamera = (camera) => store.change("camera", { camera });
    this.lamps.onZones = (zones) => store.change(`zones ${zones.length}`, { zones });
    this.lamps.onAdded = (added) => store.change(`added ${added.length}`, { added });
    this.lamps.onMix = (mix) => store.change("mix", { mix });
    this.lamps.onShift = (du, dv) =>
      store.change(`shift ${performance.now()}`, { pattern: shiftBy(du, dv).pattern(store.project.pattern, 0)! });
    this.lamps.onShow = (spots) => room.highlight(spots);
    this.pattern.onChange = (what, patch) => store.change(what, patch);
    this.roomTools.pattern = () => store.project.pattern;
    this.roomTools.onPattern = (what, pattern) => store.change(what, { pattern });
    this.roomTools.onSurface = (surface, before) => {
      const isLit = store.project.others.some((other) => other.surface === surface);
      const patch = isLit ? workOn(store.project, before, surface) : { surface, ...PLAIN_LAMPS };
      store.change("surface", patch);
    };
    this.roomTools.onRefused = notice;
    this.lux.onPlane = (plane) => store.change("plane", { lux_plane: plane });
    this.lux.onFactor = (factor) => {
      const white = Number((store.project.white * factor).toPrecision(4));
      store.change("white", { white: Math.min(1e6, Math.max(1e-3, white)) });
    };
    this.trade.onNoise = (noise) => store.change("noise", { noise });
    this.notes.onMarks = (marks) => {
      photo.marks = marks;
      photo.redraw();
    };
    const opener = new Opener({
      photo: (file) => this.open({ ...store.project, photo: file, ...EMPTY_PHOTO }),
      room: (file) => this.open({ ...store.project, ...EMPTY_ROOM, room: file }),
      project: (project) => this.open(project, true),
      demo: () => void this.openDemo(),
    });
    byId("open").onclick = () => void opener.show();
    showOut(store.session, () => void opener.show());
    byId("undo").onclick = () => store.undo();
    byId("redo").onclick = () => store.redo();
    byId("help").onclick = showKeys;
    byId<HTMLInputElement>("brush").oninput = (e) => photo.setBrush(Number((e.target as HTMLInputElement).value));
    for (const name of ["masks", "grid", "lines"] as const) {
      const box = byId<HTMLInputElement>(`show-${name}`);
      box.onchange = () => {
        photo.show[name] = box.checked;
        photo.redraw();
      };
    }
    byId<HTMLSelectElement>("compare").onchange = (e) => {
      this.compare = (e.target as HTMLSelectElement).value;
      room.compare(this.compare !== "off");
      this.send(false);
    };
    const exposure = byId<HTMLInputElement>("exposure");
    exposure.oninput = () => {
      const stops = Number(exposure.value);
      byId("exposure-out").textContent =
        stops === 0 ? "±0" : `${stops > 0 ? "+" : "−"}${Math.abs(stops).toFixed(1)} stops`;
      if (this.autoExposure === null) return;
      const value = stops === 0 ? null : this.autoExposure * 2 ** stops;
      store.note({ exposure: value });
      this.connection.expose(value ?? this.autoExposure);
    };
    this.keys(opener);
  }

  private keys(opener: Opener): void {
    const tick = (id: string) => () => byId<HTMLInputElement>(id).click();
    const brush = (by: number) => () => {
      const input = byId<HTMLInputElement>("brush");
      input.value = String(Number(input.value) + by);
      this.photo.setBrush(Number(input.value));
    };
    const light: Record<string, () => void> = {
      ...Object.fromEntries(TOOLS.map(({ tool }, i) => [String(i + 1), () => this.choose(tool)])),
      "Ctrl+z": () => this.store.undo(),
      "Ctrl+Shift+z": () => this.store.redo(),
      "Ctrl+y": () => this.store.redo(),
      "Ctrl+o": () => void opener.show(),
      "[": brush(-3),
      "]": brush(3),
      m: tick("show-masks"),
      g: tick("show-grid"),
      v: tick("show-lines"),
    };
    onKeys((key) => {
      if (key === "?") return showKeys;
      return this.isStylising ? { "Ctrl+z": () => this.stylise.undo() }[key] : light[key];
    });
  }

  private tools(): void {
    byId("tools").append(
      ...TOOLS.map(({ tool, label, hint, dashes }, index) => {
        const input = make("input", {
          type: "radio",
          name: "tool",
          value: tool,
          checked: index === 0,
          id: `tool-${tool}`,
        });
        input.onchange = () => this.choose(tool);
        const swatch = make("span", {
          class: `swatch ${tool}${dashes.length ? " off" : ""}`,
          "aria-hidden": "true",
        });
        return make("label", { title: `${hint} (${index + 1})` }, input, swatch, label);
      }),
    );
  }

  /** Light and Stylise: one of both parts of the page is shown. */
  private tabs(): void {
    const tabs = [byId("tab-light"), byId("tab-stylise")];
    const parts = [byId("light"), byId("stylise")];
    const choose = (chosen: number) => {
      if (chosen === 0 && this.isStylising) this.send(false); // its work goes on
      tabs.forEach((tab, i) => {
        tab.setAttribute("aria-selected", String(i === chosen));
        tab.tabIndex = i === chosen ? 0 : -1;
        parts[i].hidden = i !== chosen;
      });
      document.body.classList.toggle("stylising", chosen === 1);
      this.stylise.show(chosen === 1);
    };
    tabs.forEach((tab, i) => {
      tab.onclick = () => choose(i);
      tab.onkeydown = (event) => {
        if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
        choose(1 - i);
        tabs[1 - i].focus();
      };
    });
  }

  private get isStylising(): boolean {
    return !byId("stylise").hidden;
  }

  private choose(tool: Tool): void {
    byId<HTMLInputElement>(`tool-${tool}`).checked = true;
    this.photo.tool = tool;
    this.showShapes();
    this.hint();
  }

  /** Shows the hint of the tool until the user has painted. */
  private hint(): void {
    const { tool, label, hint } = TOOLS.find((t) => t.tool === this.photo.tool)!;
    byId("hint").textContent = `${label}: ${hint}`;
    byId("hint").hidden = this.store.project.strokes.length > 0 && !WITH_HINT.has(tool);
  }

  private open(project: Project, isWhole = false): void {
    this.resetExposure();
    this.store.replace({
      ...project,
      exposure: isWhole ? project.exposure : null,
      plan: isWhole ? project.plan : null,
    });
    hideNotice();
  }

  private async openDemo(): Promise<void> {
    try {
      const start = await ask<Start>("start");
      this.open({ ...this.store.project, photo: start.project.photo, ...EMPTY_PHOTO });
    } catch (problem) {
      notice(String(problem instanceof Problem ? problem.message : problem));
    }
  }

  private resetExposure(): void {
    byId<HTMLInputElement>("exposure").value = "0";
    byId("exposure-out").textContent = "±0";
  }

  // -- results come in

  private connected(isUp: boolean): void {
    document.body.classList.toggle("down", !isUp);
    if (isUp) {
      this.stylise.connected();
      return hideNotice();
    }
    notice(
      "The studio has ended. Your strokes are kept in this browser: " +
        "start it again and open the address that it prints.",
    );
    this.busy("");
  }

  private busy(text: string): void {
    byId("busy").textContent = text;
    byId("busy").hidden = !text;
  }

  private take(message: Message, payload: Uint8Array): void {
    const on: Record<string, () => void> = {
      saved: () =>
        (byId("saved").textContent =
          `Saved ${new Date().toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" })}`),
      photo: () => this.takePhoto(message, payload),
      room: () => this.takeRoom(message),
      masks: () => this.takeMasks(message, payload),
      doubt: () => this.notes.setDoubt(message),
      shapes: () => (this.shapes = message.list),
      view: () => this.takeView(message),
      warnings: () => this.takeWarnings(message),
      texture: () => this.takeTexture(message, payload),
      lamps: () => {
        this.lamps.setLamps(message);
        this.roomTools.setLamps(message.list);
        document.body.dataset.lampsOf = document.body.dataset.texture;
      },
      lux: () => {
        this.lux.show(message);
        document.body.dataset.luxOf = document.body.dataset.texture;
      },
      picture: () => this.takePicture(message, payload),
      progress: () => this.roomStatus(`rendering, ${percent(message.share)}`),
      plan: () => {
        this.trade.setPlan(message);
        this.store.note({ plan: message.plan });
      },
      working: () => this.takeWorking(message.stage),
      idle: () => {
        this.busy("");
        document.body.classList.remove("stale");
        document.body.dataset.idle = String(message.version);
      },
      failed: () => this.fail(message),
      artwork: () => this.stylise.takeArtwork(message, payload),
      painting: () => this.stylise.takePainting(message, payload),
      "not-painted": () => this.stylise.fail(message.message),
    };
    document.body.dataset.last = message.type;
    on[message.type]?.();
  }

  private takeWorking(stage: string): void {
    if (OF_STYLISE.has(stage)) return this.stylise.takeWorking(stage);
    this.busy(stage === "render" || stage === "plan" ? "" : `${STAGES[stage] ?? stage}…`);
  }

  private fail(message: Message): void {
    this.busy("");
    document.body.dataset.idle = "failed";
    document.body.classList.add("stale");
    if (message.missing) {
      notice(`${message.message}: drop it on the page, or choose it.`, {
        label: "Choose it",
        work: () => byId("open").click(),
      });
    } else this.notes.fail(String(message.message));
  }

  /** Another photo: removes all notes on the former photo. */
  private takePhoto(message: Message, rgb: Uint8Array): void {
    this.photo.setPhoto(rgbPicture(message.width, message.height, rgb), message.full);
    this.photo.lamps = [];
    this.notes.clear();
    byId("photo-status").textContent = "";
  }

  private takeRoom(message: Message): void {
    this.pattern.setCandidates(message);
    this.roomTools.setCandidates(message.candidates);
    this.lux.setSurfaces(message.surfaces);
    this.lux.setProject(this.store.project.lux_plane);
    this.room.setCamera(message.camera, true);
    if (this.store.project.camera) this.room.setCamera(this.store.project.camera, false);
    void this.room
      .load(`room.glb?session=${this.store.session}&t=${Date.now()}`)
      .catch((problem) => notice(`The quick view of the room cannot be shown: ${problem.message}`));
    this.notes.setRoom(message);
  }

  private takeMasks(message: Message, bits: Uint8Array): void {
    const masks: Masks = {
      width: message.width,
      height: message.height,
      phases: message.phases ?? ["plane", "lights"],
      isLive: message.live,
    };
    this.lastMasks = { masks, bits: bits.slice() };
    this.drawMasks();
    if (message.live) {
      const since = this.sent.get(message.version);
      if (since !== undefined) document.body.dataset.latency = `${Math.round(performance.now() - since)}`;
      return;
    }
    this.photo.lamps = message.lamps;
    this.rounds += 1;
    document.body.dataset.rounds = String(this.rounds);
    document.body.dataset.masks = message.digest;
    this.notes.fail("");
    const { plane, lights } = message.errors;
    const stated = [plane, lights].every((x) => typeof x === "number")
      ? `; stated error ${percent(plane)} of the plane, ${percent(lights)} of the lights`
      : "";
    byId("photo-status").textContent = `${message.lamps.length} lamps in the photo${stated}.`;
  }

  private drawMasks(): void {
    if (!this.lastMasks) return;
    const { masks, bits } = this.lastMasks;
    const painted = new Set(this.withDraft().strokes.map((s) => s.kind));
    const proposed = this.notes.proposed;
    if (masks.isLive && painted.has("plane") && painted.has("not-plane")) proposed.delete("plane");
    if (masks.isLive && painted.has("light")) proposed.delete("lights");
    this.photo.masks = maskPicture(masks, bits, proposed);
    this.photo.redraw();
  }

  private takeWarnings(message: Message): void {
    const before = [...this.notes.proposed].join();
    this.notes.setWarnings(message);
    document.body.dataset.proposed = [...this.notes.proposed].join(" ");
    if ([...this.notes.proposed].join() !== before) this.drawMasks();
  }

  private takeView(message: Message): void {
    this.photo.view = { ...(message as any), distance: null };
    this.photo.setGrid(this.store.project.grid);
    this.showShapes();
    document.body.dataset.grid = message.dragged ? "dragged" : "found";
    document.body.dataset.vanishing = message.vanishing.flat().map((x: number) => x.toFixed(4)).join(" ");
  }

  private showShapes(): void {
    this.photo.shapes.set(this.shapes, this.store.project.reshaped, this.photo.view);
    this.photo.redraw();
  }

  /** Says how the selected lamp differs from the lamp of the photo. */
  private showShape(change: { sides: [number, number]; angle: number } | null): void {
    byId("shape-row").hidden = this.photo.tool !== "shape";
    byId<HTMLButtonElement>("shape-restore").disabled = !this.photo.shapes.isChanged;
    const sides = change?.sides.map((x) => Math.round(100 * x)).join(" × ");
    const angle = change ? Math.round((change.angle * 180) / Math.PI) : 0;
    byId("shape-size").textContent = change ? `${sides} %${angle ? `, ${angle}°` : ""}` : "no lamp";
    this.photo.redraw();
  }

  private takeTexture(message: Message, payload: Uint8Array): void {
    this.lamps.setTexture(message, payload);
    this.roomTools.setSurface(message.surface);
    this.pattern.setEstimates(message);
    document.body.dataset.texture = message.digest;
    if (this.photo.view && Number.isFinite(message.distance)) this.photo.view.distance = message.distance;
    this.photo.redraw();
  }

  private takePicture(message: Message, rgb: Uint8Array): void {
    if (message.which === "after") {
      this.autoExposure = message.exposure;
      document.body.classList.remove("stale");
      this.trade.setPicture(message);
      const error = message.noise ?? message.bias;
      const stated = error === null ? "" : `, stated error ${percent(error)}`;
      this.roomStatus(
        message.done
          ? `Done${stated}, ${message.samples} paths per pixel, ${seconds(message.seconds)}`
          : `Preview${stated}`,
      );
      document.body.dataset.noise = String(error);
      document.body.dataset.mean = short(message.mean);
    }
    this.room.picture(message, rgb);
  }

  private shownStatus = "";
  private roomStatus(text: string): void {
    if (text.startsWith("rendering")) text = `${this.shownStatus} · ${text}`;
    else this.shownStatus = text;
    byId("room-status").textContent = text;
  }
}
