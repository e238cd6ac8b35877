// The lamps of the room: a plan of the ceiling, and a list kind by kind; any can be taken out and put back.

import type { Message } from "./api";
import { byId, make, short } from "./dom";
import { rgbPicture } from "./masks";
import { ON_PLAN } from "./palette";
import type { Added } from "./project";
import type { Spot } from "./room_view";
import { dot, type Rectangle } from "./surface";

export interface Lamp {
  kind: number;
  position: [number, number, number];
  axis: [number, number, number];
  normal: [number, number, number];
  size: [number, number];
  flux: number;
  cct: number;
  added: number | null; // index among the lamps that the user has added
}

type Range = [number, number];

/** Where the intervals come from. */
const WHY =
  "All lamps of the kind lie within. Size: the error of the photo's scale, and one texel. " +
  "Light and colour: the noise of the solution; the white balance of the photo is taken as right";

export type Zone = [number, number, number, number];

/** A zone goes this far beyond its lamp, in metres. */
const BEYOND = 0.02;
/** A drag of fewer pixels is a click. */
const CLICK = 5;
/** The largest factor of a kind of lamp, and the step of its slider, in percent. */
const MAX_MIX = 200;
const MIX_STEP = 5;

export class LampList {
  private readonly box = byId("lamps");
  private lamps: Lamp[] = [];
  private surface: Rectangle | null = null;
  private texture: HTMLCanvasElement | null = null;
  private zones: Zone[] = [];
  private error = 0;
  private kinds: Record<string, { size: [Range, Range]; cct: Range }> = {}; // bounds of the lamps of each kind
  private others: { surface: string; lamps: number; flux: number }[] = []; // the lamps of other surfaces
  private fromTexture = new DOMMatrix(); // from shares of the texture to metres on the surface
  private mix: Record<string, number> = {};
  private added: Added[] = [];
  private isAdding = false; // the next click on the plan adds a lamp
  private adding = 0; // the kind of this lamp
  private isHeld = false; // a slider is being dragged, which a new list would take away
  onMix: (mix: Record<string, number>) => void = () => {};
  onShift: (du: number, dv: number) => void = () => {};
  onAdded: (added: Added[]) => void = () => {};
  onZones: (zones: Zone[]) => void = () => {};
  onShow: (spots: Spot[]) => void = () => {};

  setTexture(message: Message, rgb: Uint8Array): void {
    this.surface = message.surface as unknown as Rectangle;
    this.texture = rgbPicture(message.width, message.height, rgb); // drawn when its lamps come
  }

  setLamps(message: Message): void {
    this.lamps = message.list;
    this.error = message.error;
    this.kinds = message.kinds;
    this.others = message.others;
    const [[a, c, e], [b, d, f]] = message.to_texture as number[][];
    this.fromTexture = new DOMMatrix([a, b, c, d, e, f]).inverse();
    this.draw();
  }

  setProject({ zones, mix, added }: { zones: Zone[]; mix: Record<string, number>; added: Added[] }): void {
    this.zones = zones;
    this.added = added;
    this.mix = mix;
    this.draw();
  }

  /** The lamp's box on the surface, in metres from its corner. */
  private zoneOf(lamp: Lamp): Zone {
    const s = this.surface!;
    const from = lamp.position.map((x, i) => x - s.origin[i]);
    const [u, v] = [dot(from, s.u_axis), dot(from, s.v_axis)];
    const [cos, sin] = [Math.abs(dot(lamp.axis, s.u_axis)), Math.abs(dot(lamp.axis, s.v_axis))];
    const [a, b] = [lamp.size[0] / 2, lamp.size[1] / 2];
    const [du, dv] = [a * cos + b * sin + BEYOND, a * sin + b * cos + BEYOND];
    return [u - du, v - dv, u + du, v + dv].map((x) => Math.round(1000 * x) / 1000) as Zone;
  }

  private takeOut(lamps: Lamp[]): void {
    if (!lamps.length) return;
    this.onShow([]);
    const own = new Set(lamps.map((l) => l.added));
    const rest = lamps.filter((l) => l.added === null);
    if (rest.length < lamps.length) this.onAdded(this.added.filter((_, i) => !own.has(i)));
    if (rest.length) this.onZones([...this.zones, ...rest.map((l) => this.zoneOf(l))]);
  }

  private draw(): void {
    if (this.isHeld) return;
    const focus = this.box.contains(document.activeElement) ? document.activeElement!.id : "";
    this.fill();
    if (focus) document.getElementById(focus)?.focus();
  }

  private fill(): void {
    byId("lamps-count").textContent = this.lamps.length ? String(this.lamps.length) : "";
    if (!this.surface || !this.texture) {
      this.box.replaceChildren(make("p", { class: "quiet" }, "No lamps yet."));
      return;
    }
    const kinds = new Map<number, Lamp[]>();
    for (const lamp of this.lamps) kinds.set(lamp.kind, [...(kinds.get(lamp.kind) ?? []), lamp]);
    const order = [...kinds].sort(([a], [b]) => (a || 1e9) - (b || 1e9));
    const total = this.lamps.reduce((sum, l) => sum + l.flux, 0);
    const open = new Set(
      [...this.box.querySelectorAll("details[open]")].map((d) => (d as HTMLElement).dataset.kind),
    );
    this.box.replaceChildren(
      this.plan(),
      make(
        "p",
        { class: "quiet" },
        this.isAdding
          ? "Click the place of the new lamp in the plan."
          : `${this.lamps.length} lamps, ${short(total)} lm in all (± ${short(100 * this.error)} %)`,
      ),
      ...order.flatMap(([kind, lamps]) => [
        this.kindBox(kind, lamps, open.has(String(kind))),
        this.dimmer(kind),
      ]),
      ...(this.zones.length ? [this.taken()] : []),
      ...this.others.map(({ surface, lamps, flux }) =>
        make("p", { class: "quiet" }, `On ${surface}: ${lamps} lamps, ${short(flux)} lm`),
      ),
    );
  }

  private kindBox(kind: number, lamps: Lamp[], isOpen: boolean): HTMLElement {
    const mean = (f: (l: Lamp) => number) => lamps.reduce((sum, l) => sum + f(l), 0) / lamps.length;
    const size = `${short(mean((l) => l.size[0]))} × ${short(mean((l) => l.size[1]))} m`;
    const title = kind ? `Kind ${letter(kind)}` : "Cut by the edge";
    return make(
      "details",
      { class: "kind", "data-kind": kind, open: isOpen },
      make(
        "summary",
        {},
        make("b", {}, title),
        ` · ${lamps.length} × ${size} · ${short(mean((l) => l.flux))} lm · ${kelvin(mean((l) => l.cct))} K`,
        this.bounds(kind, mean((l) => l.flux)),
      ),
      make(
        "p",
        { class: "row" },
        make("button", { type: "button", onclick: () => this.takeOut(lamps) }, `Take all ${lamps.length} out`),
        make("button", { type: "button", onclick: (e) => this.beginAdding(kind, e as MouseEvent) }, "Add one"),
      ),
      make("ul", {}, ...lamps.map((lamp) => this.row(lamp))),
    );
  }

  /** The 95 % intervals of a kind. */
  private bounds(kind: number, flux: number): HTMLElement {
    const found = this.kinds[kind];
    if (!found) return make("span");
    const [length, width] = found.size.map(([low, high]) => `${short(low)}–${short(high)}`);
    const [cold, hot] = found.cct.map(kelvin);
    const text = `95 %: ${length} × ${width} m · ± ${short(this.error * flux)} lm · ${cold}–${hot} K`;
    return make("span", { class: "bounds quiet", title: WHY }, text);
  }

  /** The next click on the plan adds a lamp of a kind; if a key starts this, the lamp is placed in the middle of the
   * ceiling. */
  private beginAdding(kind: number, event: MouseEvent): void {
    if (event.detail === 0) {
      const [width, height] = this.surface!.size;
      this.add(kind, [width / 2, height / 2]);
      return;
    }
    this.adding = kind;
    this.isAdding = true;
    this.draw();
  }

  private add(kind: number, at: [number, number]): void {
    this.isAdding = false;
    this.onAdded([...this.added, [kind, ...(at.map((x) => Math.round(1000 * x) / 1000) as [number, number])]]);
  }

  /** The factor of the light of a kind of lamp. */
  private dimmer(kind: number): HTMLElement {
    const value = Math.round(100 * (this.mix[kind] ?? 1));
    const out = make("output", { for: `mix-${kind}` }, `${value} %`);
    const slider = make("input", { type: "range", id: `mix-${kind}`, min: 0, max: MAX_MIX, step: MIX_STEP, value });
    slider.oninput = () => {
      out.textContent = `${slider.value} %`;
      const { [kind]: _, ...rest } = this.mix;
      this.onMix(slider.value === "100" ? rest : { ...rest, [kind]: Number(slider.value) / 100 });
    };
    slider.onpointerdown = () => (this.isHeld = true);
    slider.onpointerup = slider.onpointercancel = () => {
      this.isHeld = false;
      this.draw();
    };
    const label = make("span", {}, kind ? `Light of ${letter(kind)}` : "Light");
    return make("label", { class: "dimmer" }, label, slider, out);
  }

  private row(lamp: Lamp): HTMLElement {
    const [x, , z] = lamp.position;
    const show = () => this.onShow([{ position: lamp.position, label: "" }]);
    const hide = () => this.onShow([]);
    const text = `x ${x.toFixed(2)}, z ${z.toFixed(2)} m · ${short(lamp.flux)} lm`;
    const button = make(
      "button",
      {
        type: "button",
        onclick: () => this.takeOut([lamp]),
        onfocus: show,
        onblur: hide,
        "aria-label": `Take out the lamp at ${text}`,
      },
      "Take out",
    );
    return make("li", { onpointerenter: show, onpointerleave: hide }, make("span", {}, text), button);
  }

  private taken(): HTMLElement {
    const text = this.zones.length === 1 ? "1 place is kept free" : `${this.zones.length} places are kept free`;
    return make(
      "p",
      { class: "row" },
      text,
      make("button", { type: "button", onclick: () => this.onZones([]) }, "Put all back"),
    );
  }

  /** The ceiling from below, with its texture: a click takes a lamp out or puts it back, a drag moves the pattern. */
  private plan(): HTMLElement {
    const [width, height] = this.surface!.size;
    const canvas = make("canvas", { class: this.isAdding ? "plan adding" : "plan", id: "lamp-plan", role: "img" });
    canvas.setAttribute("aria-label", `Plan of the ceiling, ${short(width)} by ${short(height)} metres`);
    const scale = 2 * Math.min(300 / width, 220 / height);
    canvas.width = Math.max(1, Math.round(width * scale));
    canvas.height = Math.max(1, Math.round(height * scale));
    this.drawPlan(canvas.getContext("2d")!, scale, [0, 0]);
    canvas.title = "Drag the lamps; click one to take it out, or a free place to put it back";
    this.listen(canvas, scale);
    return canvas;
  }

  private drawPlan(context: CanvasRenderingContext2D, scale: number, [du, dv]: [number, number]): void {
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = "#111";
    context.fillRect(0, 0, context.canvas.width, context.canvas.height);
    context.setTransform(new DOMMatrix().scale(scale).translate(du, dv).multiply(this.fromTexture));
    context.drawImage(this.texture!, 0, 0, 1, 1);
    context.setTransform(1, 0, 0, 1, du * scale, dv * scale);
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.font = "bold 20px system-ui, sans-serif";
    for (const lamp of this.lamps) {
      const [u0, v0, u1, v1] = this.zoneOf(lamp).map((x) => x * scale);
      if (lamp.added !== null) {
        context.fillStyle = "#fff1dc"; // the texture of the pattern does not have it
        context.fillRect(u0, v0, u1 - u0, v1 - v0);
      }
      context.strokeStyle = ON_PLAN.lamp.colour;
      context.lineWidth = 2;
      context.strokeRect(u0, v0, u1 - u0, v1 - v0);
      if (lamp.kind) {
        context.lineWidth = 5;
        context.strokeStyle = "#000";
        context.strokeText(letter(lamp.kind), (u0 + u1) / 2, (v0 + v1) / 2);
        context.fillStyle = "#fff";
        context.fillText(letter(lamp.kind), (u0 + u1) / 2, (v0 + v1) / 2);
      }
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    for (const zone of this.zones) drawZone(context, zone.map((x) => x * scale) as Zone);
  }

  private listen(canvas: HTMLCanvasElement, scale: number): void {
    const [width, height] = this.surface!.size;
    const context = canvas.getContext("2d")!;
    const metres = (x: number, y: number): [number, number] => [
      (x / canvas.clientWidth) * width,
      (y / canvas.clientHeight) * height,
    ];
    let down: [number, number] | null = null;
    const shift = (e: PointerEvent) => metres(e.clientX - down![0], e.clientY - down![1]);
    canvas.onpointerdown = (event) => {
      down = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
      this.isHeld = true;
    };
    canvas.onpointermove = (event) => {
      if (down) this.drawPlan(context, scale, shift(event));
    };
    canvas.onpointercancel = () => this.release();
    canvas.onpointerup = (event) => {
      if (!down) return;
      const far = Math.hypot(event.clientX - down[0], event.clientY - down[1]);
      const [moved, at] = [shift(event), metres(event.offsetX, event.offsetY)];
      down = null;
      this.release(); // draws the plan anew, which ends this canvas
      if (far >= CLICK) this.onShift(...moved);
      else this.toggle(at);
    };
  }

  private release(): void {
    this.isHeld = false;
    this.draw();
  }

  /** Takes out the lamp at a place, or puts back the lamp that was taken out there. */
  private toggle(at: [number, number]): void {
    if (this.isAdding) return this.add(this.adding, at);
    const inside = ([u0, v0, u1, v1]: Zone) => at[0] >= u0 && at[0] <= u1 && at[1] >= v0 && at[1] <= v1;
    if (this.zones.some(inside)) this.onZones(this.zones.filter((z) => !inside(z)));
    else this.takeOut(this.lamps.filter((l) => inside(this.zoneOf(l))).slice(0, 1));
  }
}

function drawZone(context: CanvasRenderingContext2D, [u0, v0, u1, v1]: Zone): void {
  context.strokeStyle = ON_PLAN["free place"].colour;
  context.setLineDash(ON_PLAN["free place"].dashes);
  context.lineWidth = 2;
  context.strokeRect(u0, v0, u1 - u0, v1 - v0);
  context.beginPath();
  context.moveTo(u0, v0);
  context.lineTo(u1, v1);
  context.moveTo(u1, v0);
  context.lineTo(u0, v1);
  context.stroke();
  context.setLineDash([]);
}

function kelvin(value: number): number {
  return 10 * Math.round(value / 10);
}

function letter(kind: number): string {
  return kind <= 26 ? String.fromCharCode(64 + kind) : String(kind);
}
