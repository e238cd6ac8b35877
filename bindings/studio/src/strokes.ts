// Strokes: their look, and painting with mouse, pen, touch and keys.

import { ON_PHOTO } from "./palette";
import type { Kind, Stroke } from "./project";

export type Tool = Kind | "remove" | "grid" | "shape";

export interface ToolLook {
  tool: Tool;
  label: string;
  hint: string;
  colour: string;
  dashes: number[]; // of the line in the middle of the stroke: the kinds differ without their colours too
}

export const TOOLS: ToolLook[] = [
  { tool: "plane", label: "Plane", hint: "paint on the ceiling, or on another plane with lamps", ...ON_PHOTO.plane },
  { tool: "not-plane", label: "Not plane", hint: "paint on walls, floor and furniture", ...ON_PHOTO["not-plane"] },
  { tool: "light", label: "Light", hint: "paint on lamps that shine", ...ON_PHOTO.light },
  {
    tool: "not-light",
    label: "Not light",
    hint: "paint on the ceiling beside the lamps",
    ...ON_PHOTO["not-light"],
  },
  { tool: "remove", label: "Take out", hint: "click a lamp of the photo", colour: "#ffffff", dashes: [] },
  {
    tool: "grid",
    label: "Grid",
    hint: "drag its corners onto a rectangle of the ceiling, such as tiles",
    colour: "#ffffff",
    dashes: [],
  },
  {
    tool: "shape",
    label: "Shape",
    hint: "click a lamp; drag it, its corners, its sides or its knob",
    colour: "#ffffff",
    dashes: [],
  },
];

export function lookOf(kind: Tool): ToolLook {
  return TOOLS.find((t) => t.tool === kind)!;
}

/** Points nearer than this to the one before, as a share of the brush, are left out. */
const STEP = 0.3;

/** A stroke that is being painted. */
export class Pen {
  stroke: Stroke | null = null;

  begin(kind: Kind, radius: number, x: number, y: number): void {
    this.stroke = { kind, radius: round(radius), points: [round(x), round(y)] };
  }

  /** Continues the stroke to a point; false if the point is too near to the one before. */
  extend(x: number, y: number): boolean {
    const stroke = this.stroke;
    if (!stroke) return false;
    const [px, py] = stroke.points.slice(-2);
    if (Math.hypot(x - px, y - py) < STEP * stroke.radius) return false;
    stroke.points.push(round(x), round(y));
    return true;
  }

  end(): Stroke | null {
    const out = this.stroke;
    this.stroke = null;
    return out;
  }
}

function round(value: number): number {
  return Math.round(10 * value) / 10;
}

/** Draws a stroke; `scale` is screen pixels for one pixel of the photo. */
export function drawStroke(context: CanvasRenderingContext2D, stroke: Stroke, scale: number): void {
  const look = lookOf(stroke.kind);
  const path = new Path2D();
  const p = stroke.points;
  path.moveTo(p[0], p[1]);
  if (p.length === 2) path.lineTo(p[0] + 1e-3, p[1]);
  for (let i = 2; i < p.length; i += 2) path.lineTo(p[i], p[i + 1]);
  context.lineCap = context.lineJoin = "round";
  context.setLineDash([]);
  context.globalAlpha = 0.45;
  context.strokeStyle = look.colour;
  context.lineWidth = 2 * stroke.radius;
  context.stroke(path);
  context.globalAlpha = 1;
  context.strokeStyle = "#000000";
  context.lineWidth = 4 / scale;
  context.stroke(path);
  context.setLineDash(look.dashes.map((d) => d / scale));
  context.strokeStyle = look.colour;
  context.lineWidth = 2 / scale;
  context.stroke(path);
  context.setLineDash([]);
}
