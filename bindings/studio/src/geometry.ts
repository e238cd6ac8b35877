// Vanishing lines and the grid of the plane, drawn over the photo.

import { AXES, ON_PHOTO } from "./palette";

export interface View {
  vanishing: [number, number, number][]; // homogeneous pixels
  support: number[];
  errors: number[];
  focal: number;
  unwarped: [number, number] | null;
  to_photo: number[] | null; // from unwarped pixels to the photo's, row by row
  lens: [number, number, number]; // principal point, and radial distortion per square pixel
  pixel_size: number; // of an unwarped pixel, as a share of the camera's distance from the plane
  dragged: boolean; // the camera comes from the dragged grid
  distance: number | null; // of the camera from the plane, in metres
}

/** Lines of each fan meet the photo's border at this distance, as a share of its width. */
const FAN = 1 / 6;
const FINITE = 1e-9;

export function outlined(
  context: CanvasRenderingContext2D,
  path: Path2D,
  colour: string,
  dashes: number[],
  scale: number,
): void {
  context.setLineDash([]);
  context.strokeStyle = "#0008";
  context.lineWidth = 3 / scale;
  context.stroke(path);
  context.setLineDash(dashes.map((d) => d / scale));
  context.strokeStyle = colour;
  context.lineWidth = 1.3 / scale;
  context.stroke(path);
  context.setLineDash([]);
}

/** For each axis of the room, lines that run to its vanishing point. */
export function drawVanishing(
  context: CanvasRenderingContext2D,
  vanishing: [number, number, number][],
  [width, height]: [number, number],
  scale: number,
): void {
  const maxLength = 2 * Math.hypot(width, height);
  const step = FAN * width;
  vanishing.forEach(([x, y, w], axis) => {
    const path = new Path2D();
    const through: [number, number][] = [];
    for (let at = step / 2; at < width; at += step) through.push([at, 0], [at, height]);
    for (let at = step / 2; at < height; at += step) through.push([0, at], [width, at]);
    for (const [px, py] of through) {
      let [dx, dy] = Math.abs(w) > FINITE ? [x / w - px, y / w - py] : [x, y];
      const length = Math.hypot(dx, dy) || 1;
      dx /= length;
      dy /= length;
      const ahead = Math.abs(w) > FINITE ? Math.min(maxLength, length) : maxLength;
      path.moveTo(px, py);
      path.lineTo(px + dx * ahead, py + dy * ahead);
    }
    context.globalAlpha = 0.8;
    outlined(context, path, AXES[axis].colour, AXES[axis].dashes, scale);
    context.globalAlpha = 1;
  });
}

/** The plane's rectangle with a grid; if the distance is known, a square is one metre wide. */
export function drawGrid(context: CanvasRenderingContext2D, view: View, scale: number): void {
  if (!view.unwarped || !view.to_photo) return;
  const [width, height] = view.unwarped;
  const metre = view.distance ? 1 / (view.pixel_size * view.distance) : Math.max(width, height) / 8;
  const step = metre * Math.max(1, Math.ceil(Math.max(width, height) / metre / 40));
  const path = new Path2D();
  for (let x = 0; x <= width; x += step) line(path, view, [x, 0], [x, height]);
  for (let y = 0; y <= height; y += step) line(path, view, [0, y], [width, y]);
  line(path, view, [width, 0], [width, height]);
  line(path, view, [0, height], [width, height]);
  outlined(context, path, ON_PHOTO.grid.colour, ON_PHOTO.grid.dashes, scale);
}

/** Pieces of a line of the grid, which a lens with distortion bends. */
const PIECES = 12;

function line(path: Path2D, view: View, from: [number, number], to: [number, number]): void {
  const pieces = view.lens[2] ? PIECES : 1;
  for (let i = 0; i <= pieces; i++) {
    const t = i / pieces;
    const at = inPhoto(view, [from[0] + (to[0] - from[0]) * t, from[1] + (to[1] - from[1]) * t]);
    if (i) path.lineTo(...at);
    else path.moveTo(...at);
  }
}

/** The pixel of the photo that shows a point of the unwarped plane: a homography, then the distortion of the lens. */
export function inPhoto(view: View, [x, y]: [number, number]): [number, number] {
  const h = view.to_photo!;
  const w = h[6] * x + h[7] * y + h[8];
  const ideal: [number, number] = [(h[0] * x + h[1] * y + h[2]) / w, (h[3] * x + h[4] * y + h[5]) / w];
  const [cx, cy, bend] = view.lens;
  if (!bend) return ideal;
  // Newton's method for the root of s (1 - t s²) = 1.
  const [dx, dy] = [ideal[0] - cx, ideal[1] - cy];
  const t = Math.min(bend * (dx * dx + dy * dy), 4 / 27);
  let s = t < 0 ? 1 / (1 - t) : 1 + t + 3 * t * t;
  for (let i = 0; i < 7; i++) s -= (s * (1 - t * s * s) - 1) / (1 - 3 * t * s * s);
  return [cx + dx * s, cy + dy * s];
}

/** The place on the unwarped plane of a pixel of the photo: the inverse of inPhoto. */
export function onPlane(view: View, [x, y]: [number, number]): [number, number] {
  const [cx, cy, bend] = view.lens;
  const [dx, dy] = [x - cx, y - cy];
  const s = 1 - bend * (dx * dx + dy * dy);
  const [px, py] = [cx + s * dx, cy + s * dy];
  const [a, b, c, d, e, f, g, h, i] = view.to_photo!;
  const w = (d * h - e * g) * px + (b * g - a * h) * py + (a * e - b * d);
  return [
    ((e * i - f * h) * px + (c * h - b * i) * py + (b * f - c * e)) / w,
    ((f * g - d * i) * px + (a * i - c * g) * py + (c * d - a * f)) / w,
  ];
}
