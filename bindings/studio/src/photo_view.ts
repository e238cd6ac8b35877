// The photo with its masks, strokes, lines and hints; painting on it.

import { atNextFrame, byId } from "./dom";
import { drawCross, drawMark, type Mark } from "./marks";
import type { Kind, Stroke } from "./project";
import { drawGrid, drawVanishing, type View } from "./geometry";
import { Grid } from "./grid";
import { Shapes } from "./shapes";
import { drawStroke, lookOf, Pen, type Tool } from "./strokes";

export interface Lamp {
  box: [number, number, number, number];
  area: number;
}

const ZOOM_STEP = 1.25;
const MAX_ZOOM = 16;
/** The keyboard's brush moves by this share of the photo's width, and with Shift by a fifth of that. */
const KEY_STEP = 0.02;

export class PhotoView {
  private readonly canvas = byId<HTMLCanvasElement>("photo");
  private picture: HTMLCanvasElement | null = null;
  private size: [number, number] = [1, 1];
  private zoom = 1;
  private centre: [number, number] = [0.5, 0.5]; // of the photo, as shares
  private readonly pen = new Pen();
  readonly grid = new Grid();
  readonly shapes = new Shapes();
  private readonly pointers = new Map<number, [number, number]>();
  private cursor: [number, number] | null = null;
  private isKeyboard = false;
  private isPenDown = false;
  masks: HTMLCanvasElement | null = null;
  strokes: Stroke[] = [];
  lamps: Lamp[] = [];
  removed: [number, number][] = [];
  marks: Mark[] = [];
  view: View | null = null;
  tool: Tool = "plane";
  show = { masks: true, grid: false, lines: false };
  private brushShare = 0.014;
  onDraft: (stroke: Stroke | null) => void = () => {};
  onStroke: (stroke: Stroke) => void = () => {};
  onRemove: (at: [number, number]) => void = () => {};
  readonly redraw = atNextFrame(() => this.draw());

  constructor() {
    new ResizeObserver(() => this.redraw()).observe(byId("photo-stage"));
    const c = this.canvas;
    c.addEventListener("pointerdown", (e) => this.down(e));
    c.addEventListener("pointermove", (e) => this.move(e));
    c.addEventListener("pointerup", (e) => this.up(e));
    c.addEventListener("pointercancel", (e) => this.up(e, true));
    c.addEventListener("pointerleave", () => this.leave());
    c.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
    c.addEventListener("keydown", (e) => this.key(e));
    c.addEventListener("blur", () => this.finish(false));
    c.addEventListener("contextmenu", (e) => e.preventDefault());
    byId("zoom-in").onclick = () => this.zoomBy(ZOOM_STEP);
    byId("zoom-out").onclick = () => this.zoomBy(1 / ZOOM_STEP);
    byId("zoom-fit").onclick = () => {
      this.zoom = 1;
      this.centre = [0.5, 0.5];
      this.redraw();
    };
  }

  setPhoto(picture: HTMLCanvasElement, size: [number, number]): void {
    this.picture = picture;
    this.size = size;
    this.masks = this.view = null;
    this.handles.forEach((h) => h.end(false));
    this.zoom = 1;
    this.centre = [0.5, 0.5];
    this.canvas.dataset.width = String(size[0]);
    this.canvas.dataset.height = String(size[1]);
    this.redraw();
  }

  /** The grid of the project, or else the grid that the library has found. */
  setGrid(corners: number[] | null): void {
    this.grid.set(corners, this.view, this.size);
    this.redraw();
  }

  /** The parts of the photo that have handles. */
  private get handles() {
    return [this.grid, this.shapes];
  }

  /** The brush's radius in thousandths of the photo's width. */
  setBrush(thousandths: number): void {
    this.brushShare = thousandths / 1000;
    this.redraw();
  }

  private get radius(): number {
    return this.brushShare * this.size[0];
  }

  // -- where things are

  /** Screen pixels for one pixel of the photo, and where the photo's corner is on the canvas. */
  private place(): { scale: number; left: number; top: number } {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const fit = Math.min(width / this.size[0], height / this.size[1]);
    const scale = fit * this.zoom;
    return {
      scale,
      left: width / 2 - this.centre[0] * this.size[0] * scale,
      top: height / 2 - this.centre[1] * this.size[1] * scale,
    };
  }

  private toPhoto(event: { clientX: number; clientY: number }): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    const { scale, left, top } = this.place();
    return [(event.clientX - box.left - left) / scale, (event.clientY - box.top - top) / scale];
  }

  private zoomBy(factor: number, at?: [number, number]): void {
    const before = at ?? [this.centre[0] * this.size[0], this.centre[1] * this.size[1]];
    const zoom = Math.min(MAX_ZOOM, Math.max(1, this.zoom * factor));
    const change = this.zoom / zoom;
    this.centre = [0, 1].map((i) => {
      const here = before[i] / this.size[i];
      return clamp(here + (this.centre[i] - here) * change, 0, 1);
    }) as [number, number];
    this.zoom = zoom;
    if (zoom === 1) this.centre = [0.5, 0.5];
    this.redraw();
  }

  private pan(dx: number, dy: number): void {
    if (this.zoom === 1) return;
    const { scale } = this.place();
    this.centre = [
      clamp(this.centre[0] - dx / scale / this.size[0], 0, 1),
      clamp(this.centre[1] - dy / scale / this.size[1], 0, 1),
    ];
    this.redraw();
  }

  // -- pointers

  private down(event: PointerEvent): void {
    if (!this.picture) return;
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    this.isKeyboard = false;
    if (this.pointers.size > 1 || event.button === 1 || event.button === 2) {
      this.finish(false); // two fingers move the photo
      return;
    }
    const at = this.toPhoto(event);
    if (this.tool === "remove") this.onRemove(at);
    else if (this.tool === "grid" || this.tool === "shape")
      this[this.tool === "grid" ? "grid" : "shapes"].begin(at, this.place().scale, event.pointerType === "touch");
    else {
      this.pen.begin(this.tool as Kind, this.radius * pressure(event), ...at);
      this.onDraft(this.pen.stroke);
    }
    this.cursor = at;
    this.redraw();
  }

  private move(event: PointerEvent): void {
    const before = this.pointers.get(event.pointerId);
    this.cursor = this.toPhoto(event);
    if (before) {
      if (this.pointers.size > 1) this.pinch(event, before);
      else if (this.handles.some((h) => h.isHeld)) this.handles.forEach((h) => h.drag(this.cursor!, this.size));
      else if (this.pen.stroke) {
        let isNew = false;
        for (const e of event.getCoalescedEvents?.() ?? [event])
          isNew = this.pen.extend(...this.toPhoto(e)) || isNew;
        if (isNew) this.onDraft(this.pen.stroke);
      } else if (event.buttons & 6) this.pan(event.clientX - before[0], event.clientY - before[1]);
      this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    }
    this.redraw();
  }

  /** Two fingers: their distance zooms, their middle moves. */
  private pinch(event: PointerEvent, before: [number, number]): void {
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)![1];
    const far = (p: number[]) => Math.hypot(p[0] - other[0], p[1] - other[1]);
    const now: [number, number] = [event.clientX, event.clientY];
    const middle = this.toPhoto({ clientX: (now[0] + other[0]) / 2, clientY: (now[1] + other[1]) / 2 });
    this.zoomBy(far(now) / Math.max(1, far(before)), middle);
    this.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
  }

  private up(event: PointerEvent, isCancelled = false): void {
    this.pointers.delete(event.pointerId);
    this.handles.forEach((h) => h.end(!isCancelled));
    if (this.pen.stroke) this.finish(!isCancelled);
    this.redraw();
  }

  private leave(): void {
    if (this.pointers.size === 0 && !this.isKeyboard) this.cursor = null;
    this.redraw();
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    this.zoomBy(Math.exp(-event.deltaY / 400), this.toPhoto(event));
  }

  /** Ends a stroke, and keeps or discards it. */
  private finish(counts: boolean): void {
    this.isPenDown = false;
    this.handles.forEach((h) => h.end(counts));
    const stroke = this.pen.end();
    if (stroke && counts) this.onStroke(stroke);
    else if (stroke) this.onDraft(null);
    this.redraw();
  }

  // -- keys

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || !this.picture) return;
    const step = KEY_STEP * this.size[0] * (event.shiftKey ? 0.2 : 1);
    const moves: Record<string, [number, number]> = {
      ArrowLeft: [-step, 0],
      ArrowRight: [step, 0],
      ArrowUp: [0, -step],
      ArrowDown: [0, step],
    };
    this.cursor ??= [this.size[0] / 2, this.size[1] / 2];
    if (this.tool === "shape") {
      const [dx, dy] = (moves[event.key] ?? [0, 0]).map((d) => d / 5) as [number, number];
      const isZoom = event.key === "+" || event.key === "-" || event.key === "=";
      if (isZoom) this.zoomBy(event.key === "-" ? 1 / ZOOM_STEP : ZOOM_STEP, this.cursor);
      else if (!this.shapes.key(event, [dx, dy])) return;
    } else if (this.tool === "grid" && (moves[event.key] || event.key === " " || event.key === "Enter")) {
      // A step is a fifth of a step of the brush, so that corners can be set exactly.
      const [dx, dy] = (moves[event.key] ?? [0, 0]).map((d) => d / 5);
      if (moves[event.key]) this.grid.step(dx, dy, this.size);
      else this.grid.next();
    } else if (moves[event.key]) {
      this.cursor = [0, 1].map((i) => clamp(this.cursor![i] + moves[event.key][i], 0, this.size[i])) as [
        number,
        number,
      ];
      if (this.isPenDown && this.pen.extend(...this.cursor)) this.onDraft(this.pen.stroke);
    } else if (event.key === " ") {
      if (this.tool === "remove") this.onRemove(this.cursor);
      else if (this.isPenDown) this.finish(true);
      else {
        this.isPenDown = true;
        this.pen.begin(this.tool as Kind, this.radius, ...this.cursor);
        this.onDraft(this.pen.stroke);
      }
    } else if (event.key === "Enter") {
      if (this.tool === "remove") this.onRemove(this.cursor);
      else if (!this.isPenDown) {
        this.pen.begin(this.tool as Kind, this.radius, ...this.cursor);
        this.finish(true);
      } else this.finish(true);
    } else if (event.key === "Escape" && this.isPenDown) this.finish(false);
    else if (event.key === "+" || event.key === "=") this.zoomBy(ZOOM_STEP, this.cursor);
    else if (event.key === "-") this.zoomBy(1 / ZOOM_STEP, this.cursor);
    else return;
    this.isKeyboard = true;
    event.preventDefault();
    this.redraw();
  }

  // -- drawing

  private draw(): void {
    const canvas = this.canvas;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    document.body.dataset.corners = this.grid.numbers.join(" ");
    document.body.dataset.shapes = JSON.stringify(this.shapes.outlines);
    const context = canvas.getContext("2d")!;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    if (!this.picture) return;
    const { scale, left, top } = this.place();
    context.setTransform(ratio * scale, 0, 0, ratio * scale, ratio * left, ratio * top);
    context.save();
    context.beginPath();
    context.rect(0, 0, ...this.size);
    context.clip();
    context.imageSmoothingEnabled = true;
    context.imageSmoothingQuality = "high";
    context.drawImage(this.picture, 0, 0, ...this.size);
    if (this.show.masks && this.masks) context.drawImage(this.masks, 0, 0, ...this.size);
    if (this.show.lines && this.view) drawVanishing(context, this.view.vanishing, this.size, scale);
    const isGridTool = this.tool === "grid";
    if (this.show.grid && this.view && !isGridTool) drawGrid(context, this.view, scale);
    for (const stroke of this.strokes) drawStroke(context, stroke, scale);
    if (this.pen.stroke) drawStroke(context, this.pen.stroke, scale);
    if (this.tool === "remove") this.drawLamps(context, scale);
    for (const at of this.removed) drawCross(context, at, 9 / scale);
    if (isGridTool) this.grid.draw(context, this.size, scale, this.isKeyboard);
    if (this.tool === "shape") this.shapes.draw(context, scale);
    context.restore();
    this.marks.forEach((mark) => drawMark(context, mark, scale));
    this.drawCursor(context, scale);
  }

  private drawLamps(context: CanvasRenderingContext2D, scale: number): void {
    for (const { box } of this.lamps) {
      for (const [colour, wide] of [
        ["#000", 4],
        ["#fff", 2],
      ] as const) {
        context.strokeStyle = colour;
        context.lineWidth = wide / scale;
        context.strokeRect(
          box[0] - 3 / scale,
          box[1] - 3 / scale,
          box[2] - box[0] + 6 / scale,
          box[3] - box[1] + 6 / scale,
        );
      }
    }
  }

  private drawCursor(context: CanvasRenderingContext2D, scale: number): void {
    if (!this.cursor || this.tool === "grid" || this.tool === "shape" || (this.isKeyboard && document.activeElement !== this.canvas)) return;
    const radius = this.tool === "remove" ? 6 / scale : Math.max(this.radius, 2 / scale);
    for (const [colour, wide] of [
      ["#000", 3],
      [lookOf(this.tool).colour, 1.5],
    ] as const) {
      context.strokeStyle = colour;
      context.lineWidth = wide / scale;
      context.beginPath();
      context.arc(...this.cursor, radius, 0, 2 * Math.PI);
      if (this.isKeyboard) {
        const far = radius + 8 / scale;
        context.moveTo(this.cursor[0] - far, this.cursor[1]);
        context.lineTo(this.cursor[0] + far, this.cursor[1]);
        context.moveTo(this.cursor[0], this.cursor[1] - far);
        context.lineTo(this.cursor[0], this.cursor[1] + far);
      }
      context.stroke();
    }
  }
}

/** A pen that is pressed harder paints wider; a mouse and a finger have one width. */
function pressure(event: PointerEvent): number {
  return event.pointerType === "pen" && event.pressure > 0 ? 0.5 + event.pressure : 1;
}

function clamp(value: number, low: number, high: number): number {
  return Math.min(high, Math.max(low, value));
}
