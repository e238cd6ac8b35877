// Lamps of the photo with handles: each can be moved, resized and turned on its plane.

import { inPhoto, onPlane, outlined, type View } from "./geometry";
import { ON_PHOTO } from "./palette";
import type { Reshaped } from "./project";

type Point = [number, number];

/** A lamp as the server finds it: a pixel on it, and the corners of its rectangle on the plane, in the photo. */
export interface Shape {
  at: Point;
  corners: number[];
}

/** A rectangle on the unwarped plane: its middle, its sides, and the direction of the first side. */
interface Rect {
  x: number;
  y: number;
  width: number;
  height: number;
  angle: number;
}

interface Lamp {
  shape: Shape;
  before: Rect;
  now: Rect;
  isChanged: boolean;
}

/** What a drag holds: the signs of a corner or of a side's middle, the whole lamp, or the knob that turns it. */
type Held = { sx: number; sy: number } | "lamp" | "knob";

/** Distance within which a pointer grabs a handle, in pixels of the screen; larger for fingers. */
const GRAB = 13;
const FINGER = 1.6;
const HANDLE = 6;
/** The knob stands this far from its side, in pixels of the screen. */
const KNOB = 26;
/** The least side of a lamp, as a share of its side before. */
const LEAST = 0.1;
/** Steps of the keyboard: of a side, and of the angle in radians. */
const KEY_SIZE = 1.05;
const KEY_TURN = Math.PI / 180;
/** Lamps are alike if their sides differ by less than this factor. */
const ALIKE = 1.3;

const CORNERS: Point[] = [
  [-1, -1],
  [1, -1],
  [1, 1],
  [-1, 1],
];
const SIDES: Point[] = [
  [0, -1],
  [1, 0],
  [0, 1],
  [-1, 0],
];

export class Shapes {
  private reshaped: Reshaped[] = [];
  private view: View | null = null;
  private lamps: Lamp[] = [];
  private selected = -1;
  private held: Held | null = null;
  private from: Point = [0, 0]; // on the plane
  private start: Rect[] = []; // all lamps at the beginning of a drag
  /** Whether all lamps of the size of the selected one change with it. */
  isForAlike = false;
  /** Steps by keys are undone together. */
  onChange: (reshaped: Reshaped[], isStep: boolean) => void = () => {};
  /** Says how the selected lamp differs from the photo: the ratios of its sides, and its angle; null without a lamp. */
  onSelect: (change: { sides: Point; angle: number } | null) => void = () => {};

  set(shapes: Shape[], reshaped: Reshaped[], view: View | null): void {
    if (this.held) return;
    Object.assign(this, { reshaped, view });
    this.lamps = [];
    if (view?.unwarped && view.to_photo)
      for (const shape of shapes) {
        const before = rectOf(shape.corners, view);
        const change = reshaped.find((r) => isInside(r.at, pairs(shape.corners)));
        this.lamps.push({ shape, before, now: change ? rectOf(change.after, view) : before, isChanged: !!change });
      }
    if (this.selected >= this.lamps.length) this.selected = -1;
    this.tell();
  }

  get isHeld(): boolean {
    return this.held !== null;
  }

  /** The corners of the lamps, for tests and for the tool that takes lamps out. */
  get outlines(): { at: Point; corners: number[]; isChanged: boolean }[] {
    return this.lamps.map((lamp) => ({ ...lamp.shape, corners: this.cornersOf(lamp.now), isChanged: lamp.isChanged }));
  }

  /** The change of the reshaped lamp at a place of the photo. */
  changedAt(at: Point): Reshaped | undefined {
    const lamp = this.lamps.find((l) => l.isChanged && isInside(at, pairs(this.cornersOf(l.now))));
    return lamp && this.reshaped.find((r) => isInside(r.at, pairs(lamp.shape.corners)));
  }

  /** Begins a drag of the selected lamp or one of its handles, or selects the lamp below the pointer. */
  begin(at: Point, scale: number, isFinger: boolean): boolean {
    const view = this.view;
    if (!view) return false;
    const reach = (GRAB * (isFinger ? FINGER : 1)) / scale;
    this.held = this.handleAt(at, reach, scale);
    if (!this.held) {
      const below = this.lamps.findIndex((lamp) => isInside(at, pairs(this.cornersOf(lamp.now))));
      if (below !== this.selected) this.selected = below;
      if (below >= 0) this.held = "lamp";
      this.tell();
    }
    if (!this.held) return false;
    this.from = onPlane(view, at);
    this.start = this.lamps.map((lamp) => lamp.now);
    return true;
  }

  private handleAt(at: Point, reach: number, scale: number): Held | null {
    const lamp = this.lamps[this.selected];
    if (!lamp) return null;
    const far = (p: Point) => Math.hypot(p[0] - at[0], p[1] - at[1]);
    if (far(this.knobOf(lamp.now, scale)) <= reach) return "knob";
    let best: Held | null = null;
    let least = reach;
    for (const [sx, sy] of [...CORNERS, ...SIDES]) {
      const distance = far(this.pointOf(lamp.now, sx, sy));
      if (distance < least) [best, least] = [{ sx, sy }, distance];
    }
    return best;
  }

  drag(at: Point): void {
    if (!this.held || !this.view) return;
    const to = onPlane(this.view, at);
    const rect = this.start[this.selected];
    this.change(this.held === "knob" ? turned(rect, to) : dragged(rect, this.held, this.from, to, this.least()));
  }

  /** Ends a drag. */
  end(counts: boolean): void {
    if (!this.held) return;
    this.held = null;
    const isMoved = this.lamps.some((lamp, i) => lamp.now !== this.start[i]);
    if (counts && isMoved) this.keep(false);
    else this.lamps.forEach((lamp, i) => (lamp.now = this.start[i]));
    this.tell();
  }

  /** Handles a key; false if it means nothing here. `step` is a step in pixels of the photo. */
  key(event: KeyboardEvent, [dx, dy]: Point): boolean {
    if (event.key === " " || event.key === "Enter") {
      if (this.lamps.length) this.selected = (this.selected + 1) % this.lamps.length;
      this.tell();
      return true;
    }
    const lamp = this.lamps[this.selected];
    if (!lamp || !this.view) return false;
    if (event.key === "Delete" || event.key === "Backspace") {
      this.restore();
      return true;
    }
    const turn = { ",": -1, ".": 1 }[event.key];
    if (!dx && !dy && !turn) return false;
    const { now } = lamp;
    this.start = this.lamps.map((l) => l.now);
    const middle = inPhoto(this.view, [now.x, now.y]);
    if (turn) this.change({ ...now, angle: now.angle + turn * KEY_TURN });
    else if (event.shiftKey)
      this.change({
        ...now,
        width: now.width * KEY_SIZE ** Math.sign(dx),
        height: now.height * KEY_SIZE ** -Math.sign(dy),
      });
    else {
      const [x, y] = onPlane(this.view, [middle[0] + dx, middle[1] + dy]);
      this.change({ ...now, x, y });
    }
    this.keep(true);
    this.tell();
    return true;
  }

  get isChanged(): boolean {
    return this.lamps[this.selected]?.isChanged ?? false;
  }

  /** Gives the selected lamp, or all that are alike, the shape that it has in the photo. */
  restore(): void {
    const group = this.group();
    this.lamps.forEach((lamp, i) => {
      if (group.includes(i)) Object.assign(lamp, { now: lamp.before, isChanged: false });
    });
    this.report(false);
    this.tell();
  }

  private least(): Point {
    const { before } = this.lamps[this.selected];
    return [LEAST * before.width, LEAST * before.height];
  }

  /** The indices of the lamps that change together. */
  private group(): number[] {
    const of = this.lamps[this.selected]?.before;
    if (!of) return [];
    if (!this.isForAlike) return [this.selected];
    const near = (a: number, b: number) => a < ALIKE * b && b < ALIKE * a;
    return this.lamps.flatMap(({ before }, i) =>
      near(before.width, of.width) && near(before.height, of.height) ? [i] : [],
    );
  }

  /** Gives the selected lamp another rectangle, and lamps that are alike the same change. */
  private change(to: Rect): void {
    const from = this.lamps[this.selected].before;
    for (const i of this.group()) {
      const { before } = this.lamps[i];
      this.lamps[i].now =
        i === this.selected
          ? to
          : {
              x: before.x + to.x - from.x,
              y: before.y + to.y - from.y,
              width: (before.width * to.width) / from.width,
              height: (before.height * to.height) / from.height,
              angle: before.angle + to.angle - from.angle,
            };
    }
    this.tell();
  }

  private keep(isStep: boolean): void {
    this.lamps.forEach((lamp, i) => (lamp.isChanged ||= lamp.now !== this.start[i]));
    this.report(isStep);
  }

  private report(isStep: boolean): void {
    this.onChange(
      this.lamps
        .filter((lamp) => lamp.isChanged)
        .map(({ shape, now }) => {
          const known = this.reshaped.find((r) => isInside(r.at, pairs(shape.corners)));
          return { at: known?.at ?? shape.at, before: shape.corners, after: this.cornersOf(now) };
        }),
      isStep,
    );
  }

  private tell(): void {
    const lamp = this.lamps[this.selected];
    if (!lamp) return this.onSelect(null);
    const { now, before } = lamp;
    this.onSelect({ sides: [now.width / before.width, now.height / before.height], angle: now.angle - before.angle });
  }

  // -- where things are in the photo

  private pointOf(rect: Rect, sx: number, sy: number): Point {
    return inPhoto(this.view!, inside(rect, sx, sy));
  }

  private cornersOf(rect: Rect): number[] {
    return CORNERS.flatMap(([sx, sy]) => this.pointOf(rect, sx, sy)).map((x) => Math.round(100 * x) / 100);
  }

  private knobOf(rect: Rect, scale: number): Point {
    const middle = this.pointOf(rect, 0, 0);
    const side = this.pointOf(rect, 1, 0);
    const length = Math.hypot(side[0] - middle[0], side[1] - middle[1]) || 1;
    const share = KNOB / scale / length;
    return [0, 1].map((k) => side[k] + share * (side[k] - middle[k])) as Point;
  }

  draw(context: CanvasRenderingContext2D, scale: number): void {
    if (!this.view) return;
    this.lamps.forEach((lamp, i) => {
      if (lamp.isChanged || lamp.now !== lamp.before)
        outlined(context, closed(lamp.shape.corners), ON_PHOTO["lamp before"].colour, ON_PHOTO["lamp before"].dashes, scale);
      if (i !== this.selected) outlined(context, closed(this.cornersOf(lamp.now)), ON_PHOTO.grid.colour, [], scale);
    });
    const lamp = this.lamps[this.selected];
    if (!lamp) return;
    const path = closed(this.cornersOf(lamp.now));
    path.moveTo(...this.pointOf(lamp.now, 1, 0));
    path.lineTo(...this.knobOf(lamp.now, scale));
    outlined(context, path, ON_PHOTO.light.colour, [], scale);
    for (const [sx, sy] of CORNERS) handle(context, this.pointOf(lamp.now, sx, sy), HANDLE / scale, true);
    for (const [sx, sy] of SIDES) handle(context, this.pointOf(lamp.now, sx, sy), (0.8 * HANDLE) / scale, true);
    handle(context, this.knobOf(lamp.now, scale), HANDLE / scale, false);
  }
}

/** A handle: a square that resizes, or a circle that turns. */
function handle(context: CanvasRenderingContext2D, [x, y]: Point, half: number, isSquare: boolean): void {
  context.beginPath();
  if (isSquare) context.rect(x - half, y - half, 2 * half, 2 * half);
  else context.arc(x, y, half, 0, 2 * Math.PI);
  context.fillStyle = "#ffffff";
  context.fill();
  context.lineWidth = half / 2.5;
  context.strokeStyle = "#1c1c1c";
  context.stroke();
}

/** The rectangle of a drag of a corner, a side or the whole lamp. The opposite corner or side stays. */
function dragged(rect: Rect, held: { sx: number; sy: number } | "lamp", from: Point, to: Point, least: Point): Rect {
  const move: Point = [to[0] - from[0], to[1] - from[1]];
  if (held === "lamp") return { ...rect, x: rect.x + move[0], y: rect.y + move[1] };
  const [cos, sin] = [Math.cos(rect.angle), Math.sin(rect.angle)];
  const { sx, sy } = held;
  const width = sx ? Math.max(least[0], rect.width + sx * (cos * move[0] + sin * move[1])) : rect.width;
  const height = sy ? Math.max(least[1], rect.height + sy * (cos * move[1] - sin * move[0])) : rect.height;
  const [du, dv] = [(sx * (width - rect.width)) / 2, (sy * (height - rect.height)) / 2];
  return { ...rect, width, height, x: rect.x + cos * du - sin * dv, y: rect.y + sin * du + cos * dv };
}

/** The rectangle whose first side points to a place. */
function turned(rect: Rect, to: Point): Rect {
  return { ...rect, angle: Math.atan2(to[1] - rect.y, to[0] - rect.x) };
}

function inside(rect: Rect, sx: number, sy: number): Point {
  const [cos, sin] = [Math.cos(rect.angle), Math.sin(rect.angle)];
  const [a, b] = [(sx * rect.width) / 2, (sy * rect.height) / 2];
  return [rect.x + cos * a - sin * b, rect.y + sin * a + cos * b];
}

function rectOf(corners: number[], view: View): Rect {
  const [a, b, c, d] = pairs(corners).map((p) => onPlane(view, p));
  return {
    x: (a[0] + b[0] + c[0] + d[0]) / 4,
    y: (a[1] + b[1] + c[1] + d[1]) / 4,
    width: Math.hypot(b[0] - a[0], b[1] - a[1]),
    height: Math.hypot(d[0] - a[0], d[1] - a[1]),
    angle: Math.atan2(b[1] - a[1], b[0] - a[0]),
  };
}

function pairs(numbers: number[]): Point[] {
  return [0, 2, 4, 6].map((i): Point => [numbers[i], numbers[i + 1]]);
}

function closed(corners: number[]): Path2D {
  const path = new Path2D();
  pairs(corners).forEach((p, i) => (i ? path.lineTo(...p) : path.moveTo(...p)));
  path.closePath();
  return path;
}

function isInside(at: Point, corners: Point[]): boolean {
  const signs = corners.map((p, i) => {
    const q = corners[(i + 1) % 4];
    return (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]) > 0;
  });
  return signs.every((s) => s === signs[0]);
}
