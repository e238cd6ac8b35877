// Tools on the room: turn the view, choose the ceiling, and lay the pattern of lamps by dragging it on the surface.

import { make } from "./dom";
import type { Lamp } from "./lamps";
import type { Pattern } from "./project";
import type { RoomView } from "./room_view";
import { dot, shiftBy, sizeBy, turnBy, type Rectangle, type Vector } from "./surface";

export type RoomTool = "view" | "choose" | "shift" | "turn" | "size";

export interface Candidate {
  name: string;
  kind: string;
  reason: string;
  score: number;
  place: Rectangle | null;
}

const TOOLS: [RoomTool, string, string][] = [
  ["view", "View", "Drag to turn the view"],
  ["choose", "Ceiling", "Click the surface that receives the lamps"],
  ["shift", "Shift", "Drag the lamps along the ceiling"],
  ["turn", "Turn", "Drag to turn the lamps about the middle of the ceiling"],
  ["size", "Size", "Drag outwards for larger lamps, inwards for smaller ones"],
];
/** Steps of the arrow keys: metres, radians, and a factor. */
const KEY_SHIFT = 0.05;
const KEY_TURN = Math.PI / 180;
const KEY_SIZE = 1.02;
/** Candidates with a smaller rectangle, in m², are only in the list, not on the picture. */
const MIN_AREA = 1;
/** A drag of fewer pixels is a click. */
const CLICK = 5;

interface Drag {
  from: [number, number]; // u and v where it began
  pattern: Pattern;
  length: number;
}

export class RoomTools {
  private tool: RoomTool = "view";
  private candidates: Candidate[] = [];
  private surface: Rectangle | null = null;
  private chosen = "";
  private lamps: Lamp[] = [];
  private drag: Drag | null = null;
  private change: ((at: [number, number]) => [number, number]) | null = null;
  private down: [number, number] = [0, 0];
  pattern: () => Pattern = () => {
    throw new Error("not set");
  };
  onPattern: (what: string, pattern: Pattern) => void = () => {};
  /** Chooses a surface; `before` is the present one. */
  onSurface: (name: string, before: string) => void = () => {};
  onRefused: (why: string) => void = () => {};

  constructor(
    box: HTMLElement,
    private readonly room: RoomView,
  ) {
    box.append(
      ...TOOLS.map(([tool, label, title], index) => {
        const id = `room-tool-${tool}`;
        const input = make("input", { type: "radio", name: "room-tool", value: tool, checked: index === 0, id });
        input.onchange = () => this.choose(tool);
        return make("label", { title }, input, label);
      }),
    );
    const frame = room.frame;
    frame.addEventListener("pointerdown", (e) => this.begin(e));
    frame.addEventListener("pointermove", (e) => this.move(e));
    frame.addEventListener("pointerup", (e) => this.end(e));
    frame.addEventListener("pointercancel", () => this.stop());
    room.onKey = (event) => this.key(event);
    room.drawOver = (context) => this.draw(context);
  }

  setCandidates(candidates: Candidate[]): void {
    this.candidates = candidates.filter((c) => c.place && c.place.size[0] * c.place.size[1] >= MIN_AREA);
    this.room.drawMarks();
  }

  setSurface(surface: Rectangle & { name: string }): void {
    this.surface = surface;
    this.chosen = surface.name;
    this.room.drawMarks();
  }

  setLamps(lamps: Lamp[]): void {
    this.lamps = lamps;
    if (!this.drag) this.change = null;
    this.room.drawMarks();
  }

  private choose(tool: RoomTool): void {
    this.tool = tool;
    this.stop();
    this.room.setTurning(tool === "view");
  }

  // -- pointers

  private begin(event: PointerEvent): void {
    this.down = [event.clientX, event.clientY];
    if (this.tool === "view" || this.tool === "choose" || !this.surface || event.button > 0) return;
    const from = this.room.onPlane(this.surface, event);
    if (!from) return;
    this.room.frame.setPointerCapture(event.pointerId);
    this.drag = { from, pattern: this.pattern(), length: this.lampLength() };
  }

  private move(event: PointerEvent): void {
    if (!this.drag || !this.surface) return;
    const to = this.room.onPlane(this.surface, event);
    if (to) this.change = this.motion(this.drag.from, to).preview;
    this.room.drawMarks();
  }

  private end(event: PointerEvent): void {
    const isClick = Math.hypot(event.clientX - this.down[0], event.clientY - this.down[1]) < CLICK;
    if (this.tool === "choose" && isClick) return this.pick(event);
    const { drag, surface } = this;
    this.drag = null;
    if (!drag || !surface) return;
    const to = this.room.onPlane(surface, event);
    if (!to || isClick) return this.stop();
    this.apply(this.motion(drag.from, to).pattern(drag.pattern, drag.length));
  }

  private stop(): void {
    this.drag = this.change = null;
    this.room.drawMarks();
  }

  private apply(pattern: Pattern | null): void {
    if (pattern) this.onPattern(this.tool, pattern);
    else {
      this.stop();
      this.onRefused("The size is set by the length of a whole lamp, and the edge of the ceiling cuts every lamp.");
    }
  }

  /** The motion of a drag on the surface, and the pattern that results. */
  private motion(from: [number, number], to: [number, number]) {
    const surface = this.surface!;
    const [mu, mv] = [surface.size[0] / 2, surface.size[1] / 2];
    const angle = Math.atan2(to[1] - mv, to[0] - mu) - Math.atan2(from[1] - mv, from[0] - mu);
    const far = (p: [number, number]) => Math.max(0.05, Math.hypot(p[0] - mu, p[1] - mv));
    const by = Math.min(5, Math.max(0.2, far(to) / far(from)));
    if (this.tool === "shift") return shiftBy(to[0] - from[0], to[1] - from[1]);
    return this.tool === "turn" ? turnBy(angle, surface) : sizeBy(by, surface);
  }

  /** Mean length of the whole lamps; 0 if no lamp is whole. */
  private lampLength(): number {
    const whole = this.lamps.filter((l) => l.kind > 0);
    return whole.length ? whole.reduce((sum, l) => sum + l.size[0], 0) / whole.length : 0;
  }

  /** Chooses the smallest candidate below the pointer. */
  private pick(event: PointerEvent): void {
    const box = this.room.frame.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const context = document.createElement("canvas").getContext("2d")!;
    const below = this.candidates.filter(
      (c) => c.place && context.isPointInPath(this.room.outline(corners(c.place)), x, y),
    );
    const area = (c: Candidate) => c.place!.size[0] * c.place!.size[1];
    below.sort((a, b) => area(a) - area(b) || b.score - a.score);
    if (below.length && below[0].name !== this.chosen) this.take(below[0].name);
  }

  // -- keys

  /** Handles a key of the tool; false if the view should handle it. */
  private key(event: KeyboardEvent): boolean {
    if (this.tool === "view" || !this.surface) return false;
    const arrows: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, -1],
      ArrowDown: [0, 1],
    };
    const step = arrows[event.key];
    if (!step) return false;
    if (this.tool === "choose") this.next(step[0] + step[1]);
    else {
      const along = step[0] || -step[1];
      const motion =
        this.tool === "shift"
          ? shiftBy(step[0] * KEY_SHIFT, step[1] * KEY_SHIFT)
          : this.tool === "turn"
            ? turnBy(along * KEY_TURN, this.surface)
            : sizeBy(KEY_SIZE ** along, this.surface);
      this.apply(motion.pattern(this.pattern(), this.lampLength()));
    }
    return true;
  }

  private next(by: number): void {
    const at = this.candidates.findIndex((c) => c.name === this.chosen);
    const count = this.candidates.length;
    if (count > 1) this.take(this.candidates[(at + by + count) % count].name);
  }

  /** Chooses a surface; takes effect before the next click or key. */
  private take(name: string): void {
    const before = this.chosen;
    this.chosen = name;
    this.onSurface(name, before);
    this.room.drawMarks();
  }

  // -- drawing

  private draw(context: CanvasRenderingContext2D): void {
    if (this.tool === "view") return;
    if (this.tool === "choose") return this.drawCandidates(context);
    if (!this.surface) return;
    outlined(context, this.room.outline(corners(this.surface)), [8, 5]);
    for (const lamp of this.lamps) outlined(context, this.room.outline(this.lampCorners(lamp)), []);
  }

  /** Draws each candidate with its rectangle and its name; the chosen candidate is filled. */
  private drawCandidates(context: CanvasRenderingContext2D): void {
    const taken: [number, number][] = [];
    for (const candidate of this.candidates) {
      if (!candidate.place) continue;
      const path = this.room.outline(corners(candidate.place));
      const isChosen = candidate.name === this.chosen;
      if (isChosen) {
        context.fillStyle = "#56b4e966";
        context.fill(path);
      }
      outlined(context, path, isChosen ? [] : [8, 5]);
      const { origin, u_axis, v_axis, size } = candidate.place;
      const middle = origin.map((x, i) => x + (size[0] / 2) * u_axis[i] + (size[1] / 2) * v_axis[i]) as Vector;
      const at = this.room.onScreen(middle);
      if (!at || taken.some(([x, y]) => Math.abs(x - at[0]) < 70 && Math.abs(y - at[1]) < 18)) continue;
      taken.push(at);
      label(context, candidate.name, at, isChosen);
    }
  }

  private lampCorners(lamp: Lamp): Vector[] {
    const surface = this.surface!;
    const [a, n] = [lamp.axis, lamp.normal];
    const across: Vector = [n[1] * a[2] - n[2] * a[1], n[2] * a[0] - n[0] * a[2], n[0] * a[1] - n[1] * a[0]];
    return [
      [-1, -1],
      [1, -1],
      [1, 1],
      [-1, 1],
    ].map(([i, j]) => {
      const at = lamp.position.map(
        (x, k) => x + (i * lamp.size[0] * a[k]) / 2 + (j * lamp.size[1] * across[k]) / 2 - surface.origin[k],
      );
      const uv: [number, number] = [dot(at, surface.u_axis), dot(at, surface.v_axis)];
      return toSpace(surface, this.change ? this.change(uv) : uv);
    });
  }
}

function toSpace({ origin, u_axis, v_axis }: Rectangle, [u, v]: [number, number]): Vector {
  return origin.map((x, i) => x + u * u_axis[i] + v * v_axis[i]) as Vector;
}

function corners(place: Rectangle): Vector[] {
  const [w, h] = place.size;
  return [
    [0, 0],
    [w, 0],
    [w, h],
    [0, h],
  ].map((at) => toSpace(place, at as [number, number]));
}

function outlined(context: CanvasRenderingContext2D, path: Path2D, dashes: number[]): void {
  for (const [colour, wide, pattern] of [
    ["#000", 4, []],
    ["#fff", 2, dashes],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = wide;
    context.setLineDash([...pattern]);
    context.stroke(path);
  }
  context.setLineDash([]);
}

function label(context: CanvasRenderingContext2D, text: string, [x, y]: [number, number], isChosen: boolean): void {
  context.font = `${isChosen ? "bold " : ""}13px system-ui, sans-serif`;
  const half = context.measureText(text).width / 2 + 6;
  context.fillStyle = isChosen ? "#0a5c91" : "#101214d0";
  context.fillRect(x - half, y - 10, 2 * half, 20);
  context.fillStyle = "#fff";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(text, x, y + 1);
}
