// The grid of the plane, dragged by its corners and sides where the lines of the photo are wrong.

import { drawVanishing, inPhoto, outlined, type View } from "./geometry";
import { ON_PHOTO } from "./palette";

type Point = [number, number];

/** Distance from a corner or a side within which a pointer grabs it, in pixels of the screen; larger for fingers. */
const GRAB_DISTANCE = { corner: 16, side: 9, finger: 1.6 };
const HANDLE = 8;
const CELLS = 4;
/** The proposed rectangle stays within this share of the photo on each side. */
const MARGIN = 0.04;
/** Corners may lie outside the photo by its size. */
const OUTSIDE = 1;

export class Grid {
  corners: Point[] = [];
  /** The corners that a drag moves; the keyboard moves one corner. */
  private held: number[] = [];
  private from: Point | null = null;
  private before: Point[] = [];
  selected = 0;
  onChange: (corners: number[]) => void = () => {};

  /** Takes the corners of the project, or proposes a rectangle where the library sees the plane. */
  set(corners: number[] | null, view: View | null, size: Point): void {
    if (this.from) return;
    this.corners = corners ? pairs(corners) : proposal(view, size);
  }

  get isHeld(): boolean {
    return this.from !== null;
  }

  /** Begins a drag of a corner, a side or the whole grid; false if the pointer is outside the grid. */
  begin(at: Point, scale: number, isFinger: boolean): boolean {
    const factor = (isFinger ? GRAB_DISTANCE.finger : 1) / scale;
    const far = this.corners.map((c) => Math.hypot(c[0] - at[0], c[1] - at[1]));
    const nearest = far.indexOf(Math.min(...far));
    if (far[nearest] <= GRAB_DISTANCE.corner * factor) this.held = [nearest];
    else {
      const sides = this.corners.map((c, i) => distance(at, c, this.corners[(i + 1) % 4]));
      const side = sides.indexOf(Math.min(...sides));
      if (sides[side] <= GRAB_DISTANCE.side * factor) this.held = [side, (side + 1) % 4];
      else if (isInside(at, this.corners)) this.held = [0, 1, 2, 3];
      else return false;
    }
    this.selected = this.held[0];
    this.from = at;
    this.before = this.corners;
    return true;
  }

  drag(at: Point, size: Point): void {
    if (this.from) this.move(this.held, at[0] - this.from[0], at[1] - this.from[1], size, this.before);
  }

  /** Ends a drag. */
  end(counts: boolean): void {
    if (!this.from) return;
    this.from = null;
    if (!counts) this.corners = this.before;
    else if (this.corners !== this.before) this.onChange(this.numbers);
  }

  /** Moves the selected corner by the keyboard. */
  step(dx: number, dy: number, size: Point): void {
    this.move([this.selected], dx, dy, size, this.corners);
    this.onChange(this.numbers);
  }

  next(): void {
    this.selected = (this.selected + 1) % 4;
  }

  /** Refuses corners that are not a rectangle in perspective. */
  private move(which: number[], dx: number, dy: number, size: Point, from: Point[]): void {
    const moved = from.map((c, i): Point => {
      if (!which.includes(i)) return c;
      return [dx, dy].map((d, k) => Math.min((1 + OUTSIDE) * size[k], Math.max(-OUTSIDE * size[k], c[k] + d))) as Point;
    });
    if (isConvex(moved, size)) this.corners = moved;
  }

  /** x and y of the corners, in the order of the project. */
  get numbers(): number[] {
    return this.corners.flat().map((x) => Math.round(100 * x) / 100);
  }

  draw(context: CanvasRenderingContext2D, size: Point, scale: number, isKeyboard: boolean): void {
    const [a, b, c, d] = this.corners.map((p) => [...p, 1]);
    const vanishing = [cross(cross(a, b), cross(c, d)), cross(cross(b, c), cross(d, a))].map(unit);
    drawVanishing(context, vanishing, size, scale);
    const to = homography(this.corners);
    const path = new Path2D();
    for (let i = 0; i <= CELLS; i++) {
      const at = i / CELLS;
      for (const [from, until] of [
        [to(at, 0), to(at, 1)],
        [to(0, at), to(1, at)],
      ]) {
        path.moveTo(...from);
        path.lineTo(...until);
      }
    }
    outlined(context, path, ON_PHOTO.grid.colour, ON_PHOTO.grid.dashes, scale);
    this.corners.forEach((corner, i) => {
      context.beginPath();
      context.arc(...corner, HANDLE / scale, 0, 2 * Math.PI);
      context.fillStyle = isKeyboard && i === this.selected ? "#1c1c1c" : "#ffffff";
      context.fill();
      context.lineWidth = 2.5 / scale;
      context.strokeStyle = isKeyboard && i === this.selected ? "#ffffff" : "#1c1c1c";
      context.stroke();
    });
  }
}

/** A rectangle of the plane that lies whole in the photo; without a plane, a rectangle like that of a ceiling ahead. */
export function proposal(view: View | null, [width, height]: Point): Point[] {
  const isIn = ([x, y]: Point) =>
    x > MARGIN * width && x < (1 - MARGIN) * width && y > MARGIN * height && y < (1 - MARGIN) * height;
  if (view?.unwarped && view.to_photo) {
    const [w, h] = view.unwarped;
    const seen: Point[] = [];
    for (let i = 0.5; i < 16; i++)
      for (let j = 0.5; j < 16; j++) {
        const at: Point = [(i / 16) * w, (j / 16) * h];
        if (isIn(inPhoto(view, at))) seen.push(at);
      }
    const middle = [0, 1].map((k) => seen.reduce((sum, p) => sum + p[k], 0) / seen.length);
    for (let share = 0.9; seen.length && share > 0.04; share *= 0.9) {
      const corners = [
        [-1, -1],
        [1, -1],
        [1, 1],
        [-1, 1],
      ].map(([x, y]) =>
        inPhoto(view, [middle[0] + (x * share * w) / 2, middle[1] + (y * share * h) / 2]),
      );
      if (corners.every(isIn)) return corners;
    }
  }
  return [
    [0.36, 0.3],
    [0.64, 0.3],
    [0.8, 0.1],
    [0.2, 0.1],
  ].map(([x, y]): Point => [x * width, y * height]);
}

function pairs(numbers: number[]): Point[] {
  return [0, 2, 4, 6].map((i): Point => [numbers[i], numbers[i + 1]]);
}

const cross = (a: number[], b: number[]): number[] => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

function unit(v: number[]): [number, number, number] {
  const length = Math.hypot(...v) || 1;
  return v.map((x) => x / length) as [number, number, number];
}

/** The map of the unit square to four corners. */
function homography([p0, p1, p2, p3]: Point[]): (u: number, v: number) => Point {
  const [dx1, dy1] = [p1[0] - p2[0], p1[1] - p2[1]];
  const [dx2, dy2] = [p3[0] - p2[0], p3[1] - p2[1]];
  const [sx, sy] = [p0[0] - p1[0] + p2[0] - p3[0], p0[1] - p1[1] + p2[1] - p3[1]];
  const below = dx1 * dy2 - dx2 * dy1;
  const g = (sx * dy2 - dx2 * sy) / below;
  const h = (dx1 * sy - sx * dy1) / below;
  return (u, v) => {
    const w = g * u + h * v + 1;
    return [0, 1].map(
      (k) => ((p1[k] - p0[k] + g * p1[k]) * u + (p3[k] - p0[k] + h * p3[k]) * v + p0[k]) / w,
    ) as Point;
  };
}

/** The turn at each corner, as an area. */
function turns(corners: Point[]): number[] {
  return corners.map((p, i) => {
    const [q, r] = [corners[(i + 1) % 4], corners[(i + 2) % 4]];
    return (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0]);
  });
}

/** Whether the turns at all corners have one sign and are clearly not zero. */
function isConvex(corners: Point[], size: Point): boolean {
  const least = 1e-4 * size[0] * size[1];
  const all = turns(corners);
  return all.every((t) => t > least) || all.every((t) => t < -least);
}

function isInside(at: Point, corners: Point[]): boolean {
  const signs = corners.map((p, i) => {
    const q = corners[(i + 1) % 4];
    return (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]) > 0;
  });
  return signs.every((s) => s === signs[0]);
}

/** The distance of a point from a side. */
function distance(at: Point, from: Point, to: Point): number {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const along = ((at[0] - from[0]) * dx + (at[1] - from[1]) * dy) / (dx * dx + dy * dy || 1);
  const t = Math.min(1, Math.max(0, along));
  return Math.hypot(at[0] - from[0] - t * dx, at[1] - from[1] - t * dy);
}
