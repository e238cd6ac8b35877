// Masks as pictures to lay over the photo.

export interface Masks {
  width: number;
  height: number;
  phases: string[];
  isLive: boolean;
}

const COLOURS: Record<string, [number, number, number, number]> = {
  plane: [86, 180, 233, 78],
  lights: [240, 228, 66, 190],
};
const EDGE_ALPHA = 255;
/** Side of the stripes that mark a proposal, in pixels of the mask. */
const STRIPE = 6;

/** A picture of the masks in the bytes of a message. A proposed mask, which nobody has confirmed, is striped. */
export function maskPicture(masks: Masks, bits: Uint8Array, proposed: Set<string>): HTMLCanvasElement {
  const { width, height } = masks;
  const row = Math.ceil(width / 8);
  const out = Object.assign(document.createElement("canvas"), { width, height });
  const context = out.getContext("2d")!;
  const image = context.createImageData(width, height);
  masks.phases.forEach((phase, index) => {
    const [red, green, blue, alpha] = COLOURS[phase];
    const base = index * row * height;
    const at = (x: number, y: number) => (bits[base + y * row + (x >> 3)] >> (7 - (x & 7))) & 1;
    const isStriped = proposed.has(phase);
    for (let y = 0; y < height; y++) {
      for (let x = 0; x < width; x++) {
        if (!at(x, y)) continue;
        const isEdge =
          x === 0 ||
          y === 0 ||
          x === width - 1 ||
          y === height - 1 ||
          !at(x - 1, y) ||
          !at(x + 1, y) ||
          !at(x, y - 1) ||
          !at(x, y + 1);
        const isGap = isStriped && Math.floor((x + y) / STRIPE) % 2 === 0;
        const i = 4 * (y * width + x);
        image.data[i] = red;
        image.data[i + 1] = green;
        image.data[i + 2] = blue;
        image.data[i + 3] = isEdge ? EDGE_ALPHA : isGap ? alpha / 5 : alpha;
      }
    }
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
