// The tab for stylisation: the artwork on the ball, painted here or opened, and the picture that is painted like it.

import { ask, download, Problem, type Message } from "./api";
import { byId, make, notice, percent, seconds } from "./dom";
import { rgbPicture } from "./masks";

const SIZE: [number, number] = [320, 240];
const OWN = "own";
const EXAMPLES: [string, string][] = [
  ["paint", "Painted"],
  ["pen", "Pen"],
  ["stipple", "Stippled"],
];
/** Where the browser keeps the latest artwork of the user, of any tab. */
const KEPT = "luxfer-studio-artwork";
const MAX_UNDO = 30;
/** The keyboard's brush moves by this many pixels of the artwork. */
const KEY_STEP = 10;

export class Stylise {
  private readonly art = byId<HTMLCanvasElement>("artwork");
  private readonly result = byId<HTMLCanvasElement>("painting");
  private artwork = EXAMPLES[0][0];
  private past: ImageData[] = [];
  private last: [number, number] | null = null;
  private isSent = false; // whether this server has the user's own artwork
  private isShown = false;
  private cursor: [number, number] = [SIZE[0] / 2, SIZE[1] / 2]; // of the keyboard
  private isByKeys = false;
  send: (message: Message) => void = () => {};

  constructor(private readonly session: string) {
    for (const canvas of [this.art, this.result]) [canvas.width, canvas.height] = SIZE;
    byId("artworks").append(...EXAMPLES.map(([name, label]) => this.choice(name, label)), this.choice(OWN, "My own"));
    byId<HTMLInputElement>("artwork-file").onchange = (e) => {
      const file = (e.target as HTMLInputElement).files?.[0];
      if (file) void this.give(file, byId<HTMLInputElement>("artwork-sheet").checked);
    };
    byId("artwork-undo").onclick = () => this.undo();
    byId("artwork-clear").onclick = () => this.clear();
    byId("out-sheet").onclick = () => void this.keep("sheet");
    byId("out-painting").onclick = () => void this.keep("painting");
    this.art.onpointerdown = (e) => this.begin(e);
    this.art.onpointermove = (e) => this.move(e);
    this.art.onpointerup = this.art.onpointercancel = () => this.end();
    this.art.onkeydown = (e) => this.key(e);
    this.art.onfocus = () => this.showCursor();
    this.art.onblur = () => {
      this.end();
      this.showCursor();
    };
    byId("artwork-brush").addEventListener("input", () => this.showCursor());
    this.restore();
  }

  private choice(name: string, label: string): HTMLElement {
    const id = `artwork-${name}`;
    const input = make("input", { type: "radio", name: "artwork", value: name, id, checked: name === this.artwork });
    input.onchange = () => void this.choose(name);
    return make("label", {}, input, label);
  }

  /** The tab is opened or left; its work begins when it is opened. */
  show(isShown: boolean): void {
    const isNew = isShown && !this.isShown;
    this.isShown = isShown;
    if (isNew) this.ask();
  }

  /** The page has connected to a server, which may be a new one. */
  connected(): void {
    this.isSent = false;
    if (this.isShown) this.ask();
  }

  private async choose(name: string): Promise<void> {
    this.artwork = name;
    byId<HTMLInputElement>(`artwork-${name}`).checked = true;
    if (name === OWN) this.restore();
    this.past = [];
    this.changed();
    this.ask();
  }

  /** Requests the picture, after sending the user's own artwork to the server. */
  private ask(): void {
    if (!this.isShown) return;
    if (this.artwork === OWN && !this.isSent) return void this.giveCanvas();
    this.say("Waiting for the picture…");
    this.send({ type: "paint", artwork: this.artwork });
  }

  private say(text: string): void {
    byId("painting-status").textContent = text;
  }

  // -- artworks of the user

  private giveCanvas(): void {
    this.art.toBlob((blob) => blob && void this.give(blob, false));
  }

  private async give(file: Blob, isSheet: boolean): Promise<void> {
    try {
      const query = `artwork?session=${this.session}&sheet=${isSheet ? 1 : 0}`;
      const rgb = await ask<ArrayBuffer>(query, { method: "POST", body: file }, (answer) => answer.arrayBuffer());
      this.isSent = true;
      this.artwork = OWN;
      byId<HTMLInputElement>(`artwork-${OWN}`).checked = true;
      if (file instanceof File) rgbPicture(...SIZE, new Uint8Array(rgb), this.art);
      this.store();
      this.ask();
    } catch (problem) {
      notice(problem instanceof Problem ? problem.message : String(problem));
    }
  }

  /** Keeps the user's artwork in the browser, where it survives the server. */
  private store(): void {
    try {
      localStorage.setItem(KEPT, this.art.toDataURL());
    } catch {
      // the browser has no room left: the artwork is on the page only
    }
  }

  private restore(): void {
    const kept = localStorage.getItem(KEPT);
    if (!kept) return;
    const image = new Image();
    image.onload = () => {
      if (this.artwork !== OWN && this.isShown) return;
      this.context.drawImage(image, 0, 0, ...SIZE);
      this.artwork = OWN;
      byId<HTMLInputElement>(`artwork-${OWN}`).checked = true;
      this.isSent = false;
      this.ask();
    };
    image.src = kept;
  }

  // -- the brush

  private get context(): CanvasRenderingContext2D {
    return this.art.getContext("2d", { willReadFrequently: true })!;
  }

  private at(event: PointerEvent): [number, number] {
    const box = this.art.getBoundingClientRect();
    return [
      ((event.clientX - box.left) / box.width) * SIZE[0],
      ((event.clientY - box.top) / box.height) * SIZE[1],
    ];
  }

  private begin(event: PointerEvent): void {
    this.isByKeys = false;
    this.showCursor();
    this.art.setPointerCapture(event.pointerId);
    this.press(this.at(event));
  }

  private press(at: [number, number]): void {
    this.remember();
    this.last = at;
    this.stroke(at);
  }

  private move(event: PointerEvent): void {
    if (this.last && !this.isByKeys) this.stroke(this.at(event));
  }

  // -- the brush by keys

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = event.shiftKey ? KEY_STEP / 5 : KEY_STEP;
    const moves: Record<string, [number, number]> = {
      ArrowLeft: [-step, 0],
      ArrowRight: [step, 0],
      ArrowUp: [0, -step],
      ArrowDown: [0, step],
    };
    const by = moves[event.key];
    if (by) {
      this.cursor = this.cursor.map((x, i) => Math.min(SIZE[i], Math.max(0, x + by[i]))) as [number, number];
      if (this.last) this.stroke(this.cursor);
    } else if (event.key === " " || event.key === "Enter") {
      const isOver = this.last !== null;
      if (!isOver) this.press(this.cursor);
      if (isOver || event.key === "Enter") this.end();
    } else if (event.key === "Escape" && this.last) {
      this.last = null;
      this.context.putImageData(this.past.pop()!, 0, 0);
    } else return;
    this.isByKeys = true;
    event.preventDefault();
    this.showCursor();
  }

  /** Shows where the brush is, while keys move it. */
  private showCursor(): void {
    const ring = byId("artwork-cursor");
    ring.hidden = document.activeElement !== this.art || !this.art.matches(":focus-visible");
    const side = (Number(byId<HTMLInputElement>("artwork-brush").value) / SIZE[0]) * this.art.clientWidth;
    Object.assign(ring.style, {
      left: `${(100 * this.cursor[0]) / SIZE[0]}%`,
      top: `${(100 * this.cursor[1]) / SIZE[1]}%`,
      width: `${side}px`,
      height: `${side}px`,
    });
  }

  private stroke(to: [number, number]): void {
    const context = this.context;
    context.strokeStyle = byId<HTMLInputElement>("artwork-colour").value;
    context.lineWidth = Number(byId<HTMLInputElement>("artwork-brush").value);
    context.lineCap = "round";
    context.beginPath();
    context.moveTo(...this.last!);
    context.lineTo(to[0] + 1e-3, to[1]);
    context.stroke();
    this.last = to;
  }

  private end(): void {
    if (!this.last) return;
    this.last = null;
    this.painted();
  }

  private painted(): void {
    this.changed();
    this.store();
    this.giveCanvas();
  }

  private remember(): void {
    this.past.push(this.context.getImageData(0, 0, ...SIZE));
    if (this.past.length > MAX_UNDO) this.past.shift();
  }

  undo(): void {
    const before = this.past.pop();
    if (!before) return;
    this.context.putImageData(before, 0, 0);
    this.painted();
  }

  private clear(): void {
    this.remember();
    this.context.fillStyle = "#fff";
    this.context.fillRect(0, 0, ...SIZE);
    this.painted();
  }

  private changed(): void {
    byId<HTMLButtonElement>("artwork-undo").disabled = this.past.length === 0;
  }

  // -- results

  takeArtwork(message: Message, rgb: Uint8Array): void {
    if (this.artwork !== OWN) rgbPicture(message.width, message.height, rgb, this.art);
  }

  takePainting(message: Message, rgb: Uint8Array): void {
    rgbPicture(message.width, message.height, rgb, this.result);
    const state = message.done ? "Done" : "Preview";
    this.say(
      `${state}: ${seconds(message.seconds)}; the light of ball and picture differs by ` +
        `${percent(message.guide_error)}, and ${percent(message.used)} of the artwork are used.`,
    );
    document.body.dataset.painting = message.done ? message.digest : "";
  }

  takeWorking(stage: string): void {
    if (stage === "guides") this.say("Looking at the light of the scene…");
    if (stage === "painting") this.say("Painting…");
  }

  fail(message: string): void {
    this.say(`Failed: ${message}`);
  }

  private async keep(kind: string): Promise<void> {
    try {
      notice(`Saved ${await download(kind, this.session)}.`);
    } catch (problem) {
      notice(problem instanceof Problem ? problem.message : String(problem));
    }
  }
}
