// Masks as pictures to lay over the photo.

import { ON_PHOTO } from "./palette";

export interface Masks {
  width: number;
  height: number;
  phases: string[];
  isLive: boolean;
}

/** The colour and the opacity of each mask. */
const COLOURS: Record<string, [number, number, number, number]> = {
  plane: [...bytes(ON_PHOTO["plane mask"].colour), 78],
  lights: [...bytes(ON_PHOTO["lights mask"].colour), 190],
};
const EDGE_ALPHA = 255;
/** Side of the stripes that mark a proposal, in pixels of the mask. */
const STRIPE = 6;

/** Red, green and blue of a colour such as #56b4e9. */
function bytes(colour: string): [number, number, number] {
  return [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16)) as [number, number, number];
}

/** The bits of a mask as bytes, with a border of zeros around it. */
function unpacked(bits: Uint8Array, width: number, height: number): Uint8Array {
  const row = Math.ceil(width / 8);
  const out = new Uint8Array((width + 2) * (height + 2));
  for (let y = 0; y < height; y++) {
    let to = (y + 1) * (width + 2) + 1;
    for (let x = 0; x < width; x++) out[to++] = (bits[y * row + (x >> 3)] >> (7 - (x & 7))) & 1;
  }
  return out;
}

/** A colour as a number whose bytes are red, green, blue and alpha in memory. */
function packed([red, green, blue]: readonly number[], alpha: number): number {
  return new Uint32Array(new Uint8Array([red, green, blue, alpha]).buffer)[0];
}

/** Draws a mask over the pixels of those before it: its edge is solid, and gaps make stripes. */
function drawMask(pixels: Uint32Array, mask: Uint8Array, width: number, height: number, look: Uint32Array): void {
  const [inner, edge, gap] = look;
  const row = width + 2;
  for (let y = 0; y < height; y++) {
    let at = (y + 1) * row + 1;
    for (let x = 0; x < width; x++, at++) {
      if (!mask[at]) continue;
      const isEdge = !(mask[at - 1] & mask[at + 1] & mask[at - row] & mask[at + row]);
      const isGap = Math.floor((x + y) / STRIPE) % 2 === 0;
      pixels[y * width + x] = isEdge ? edge : isGap ? gap : inner;
    }
  }
}

/** A picture of the masks in the bytes of a message. A proposed mask, which nobody has confirmed, is striped. */
export function maskPicture(masks: Masks, bits: Uint8Array, proposed: Set<string>): HTMLCanvasElement {
  const { width, height } = masks;
  const size = Math.ceil(width / 8) * height;
  const out = Object.assign(document.createElement("canvas"), { width, height });
  const context = out.getContext("2d")!;
  const image = context.createImageData(width, height);
  const pixels = new Uint32Array(image.data.buffer);
  masks.phases.forEach((phase, index) => {
    const [red, green, blue, alpha] = COLOURS[phase];
    const colour = (a: number) => packed([red, green, blue], a);
    const gap = proposed.has(phase) ? alpha / 5 : alpha;
    const look = Uint32Array.of(colour(alpha), colour(EDGE_ALPHA), colour(gap));
    drawMask(pixels, unpacked(bits.subarray(index * size), width, height), width, height, look);
  });
  context.putImageData(image, 0, 0);
  return out;
}

/** A canvas with the RGB bytes of a message. */
export function rgbPicture(
  width: number,
  height: number,
  rgb: Uint8Array,
  out?: HTMLCanvasElement,
): HTMLCanvasElement {
  const canvas = out ?? document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d")!;
  const image = context.createImageData(width, height);
  for (let from = 0, to = 0; from < 3 * width * height; from += 3, to += 4) {
    image.data[to] = rgb[from];
    image.data[to + 1] = rgb[from + 1];
    image.data[to + 2] = rgb[from + 2];
    image.data[to + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}
