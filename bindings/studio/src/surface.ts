// Surfaces of the room, and how the pattern of lamps changes when it is dragged on one.

import type { Pattern } from "./project";

export type Vector = [number, number, number];

/** A rectangle in the room; u and v run along its sides from its corner, in metres. */
export interface Rectangle {
  origin: Vector;
  u_axis: Vector;
  v_axis: Vector;
  normal: Vector;
  size: [number, number];
}

/** The effect of a drag on a point of the surface, for the preview, and on the pattern. */
export interface Motion {
  preview: (at: [number, number]) => [number, number];
  /** Needs the length of a whole lamp if it sets the size; null if no lamp is whole. */
  pattern: (before: Pattern, lamp: number) => Pattern | null;
}

export function dot(a: number[], b: number[]): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function shiftBy(du: number, dv: number): Motion {
  return {
    preview: ([u, v]) => [u + du, v + dv],
    pattern: (before) => {
      const [cos, sin] = [Math.cos(before.rotation), Math.sin(before.rotation)];
      const [x, y] = before.offset; // along the axes of the pattern
      return { ...before, offset: rounded([x + cos * du + sin * dv, y - sin * du + cos * dv]) };
    },
  };
}

/** Turns about the middle of the surface. */
export function turnBy(angle: number, surface: Rectangle): Motion {
  const [mu, mv] = [surface.size[0] / 2, surface.size[1] / 2];
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return {
    preview: ([u, v]) => [mu + cos * (u - mu) - sin * (v - mv), mv + sin * (u - mu) + cos * (v - mv)],
    pattern: (before) => {
      const rotation = Math.round(1e4 * wrapped(before.rotation + angle)) / 1e4;
      const [from, to] = [middle(surface, before.rotation), middle(surface, rotation)];
      return { ...before, rotation, offset: rounded([0, 1].map((i) => before.offset[i] + to[i] - from[i])) };
    },
  };
}

/** Enlarges about the middle of the surface. */
export function sizeBy(factor: number, surface: Rectangle): Motion {
  const [mu, mv] = [surface.size[0] / 2, surface.size[1] / 2];
  return {
    preview: ([u, v]) => [mu + factor * (u - mu), mv + factor * (v - mv)],
    pattern: (before, lamp) => {
      const isStated = before.scale === "lamp" || before.scale === "spacing";
      const length = (isStated ? before.length : lamp) * factor;
      if (length <= 0) return null;
      const half = middle(surface, before.rotation);
      const offset = rounded([0, 1].map((i) => half[i] - factor * (half[i] - before.offset[i])));
      return { ...before, scale: isStated ? before.scale : "lamp", length: Math.round(1e3 * length) / 1e3, offset };
    },
  };
}

/** The middle of the surface from the corner of the turned rectangle around it, where the pattern begins. */
function middle(surface: Rectangle, rotation: number): [number, number] {
  const [cos, sin] = [Math.abs(Math.cos(rotation)), Math.abs(Math.sin(rotation))];
  const [w, h] = surface.size;
  return [(w * cos + h * sin) / 2, (w * sin + h * cos) / 2];
}

function wrapped(angle: number): number {
  return angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
}

function rounded(offset: number[]): [number, number] {
  return offset.map((x) => Math.round(1e3 * x) / 1e3) as [number, number];
}
