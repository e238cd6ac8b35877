// The illuminance on the work plane: numbers, and a plan whose colours people with any colour vision can order.

import type { Message } from "./api";
import { byId, make, short } from "./dom";
import { CIVIDIS } from "./palette";
import type { LuxPlane } from "./project";

/** Numbers in the plan stand at least this far apart, in pixels of the screen. */
const NUMBER_STEP = 46;

export function colourAt(share: number): string {
  const at = Math.min(1, Math.max(0, share)) * (CIVIDIS.length - 1);
  const low = Math.min(CIVIDIS.length - 2, Math.floor(at));
  const mix = [1, 3, 5].map((i) => {
    const [a, b] = [CIVIDIS[low], CIVIDIS[low + 1]].map((c) => parseInt(c.slice(i, i + 2), 16));
    return Math.round(a + (b - a) * (at - low));
  });
  return `rgb(${mix.join(",")})`;
}

const DESK = "desk";
const DESK_HEIGHT = 0.75;

/** The illuminance: its plane, its numbers, and the field for another mean. */
export class LuxPanel {
  private readonly plane = make("select", { id: "lux-plane" });
  private readonly height = make("input", { type: "number", id: "lux-height", min: 0, max: 100, step: 0.05 });
  private readonly wish = make("input", {
    type: "number",
    id: "lux-wish",
    min: 1,
    max: 100000,
    step: "any",
    value: 500, // [convention: EN 12464-1, offices]
  });
  private readonly bring = make("button", { type: "button", id: "lux-bring", disabled: true }, "Set the mean");
  private readonly result = make("div", { class: "lux-result" });
  private readonly where = make("p", { class: "quiet" });
  private mean = 0;
  onPlane: (plane: LuxPlane) => void = () => {};
  /** Multiplies the light of all lamps. */
  onFactor: (factor: number) => void = () => {};

  constructor() {
    const small = (label: string, input: HTMLElement, unit = "") =>
      make("label", { class: "inline" }, label, input, unit);
    byId("lux").append(
      this.result,
      make("p", { class: "row" }, small("Plane ", this.plane), small("at ", this.height, " m")),
      make("p", { class: "row" }, small("Wanted mean ", this.wish, " lx"), this.bring),
      this.where,
    );
    this.bring.title = "Dims all lamps together, or brightens them, until this plane has the mean";
    this.plane.onchange = () => this.tell();
    this.height.onchange = () => this.tell();
    this.bring.onclick = () => {
      const wanted = Number(this.wish.value);
      if (wanted > 0 && this.mean > 0) this.onFactor(wanted / this.mean);
    };
  }

  private tell(): void {
    const surface = this.plane.value === DESK ? null : this.plane.value.slice(1);
    const stated = Number(this.height.value);
    const height = this.height.value !== "" && stated >= 0 && stated <= 100 ? stated : DESK_HEIGHT;
    this.onPlane({ surface, height });
  }

  /** The surfaces of the room, any of which can be the plane. */
  setSurfaces(names: string[]): void {
    this.plane.replaceChildren(
      make("option", { value: DESK }, "above the floor"),
      ...names.map((name) => make("option", { value: `/${name}` }, name)),
    );
  }

  setProject(plane: LuxPlane): void {
    this.plane.value = plane.surface === null ? DESK : `/${plane.surface}`;
    this.height.value = String(plane.height);
    this.height.closest("label")!.hidden = plane.surface !== null;
  }

  show(message: Message): void {
    byId("lux").dataset.mean = message.problem ? "" : String(message.mean);
    this.mean = message.problem ? 0 : (message.mean as number);
    this.bring.disabled = !(this.mean > 0);
    if (message.problem) {
      this.result.replaceChildren();
      this.where.textContent = message.problem as string;
      return;
    }
    const { minimum, mean, maximum, error } = message as unknown as Record<string, number>;
    const [lowest, highest] = [message.minimum_range as Range, message.maximum_range as Range];
    const uniformity: Range = [lowest[0] / (mean + error), lowest[1] / Math.max(mean - error, lowest[1])];
    const numbers: [string, string][] = [
      ["mean", `${short(mean)} lx ± ${short(error)}`],
      ["lowest", `${short(minimum)} lx ${between(lowest)}`],
      ["highest", `${short(maximum)} lx ${between(highest)}`],
      ["uniformity", mean > 0 ? `${short(minimum / mean)} ${between(uniformity)}` : "–"],
    ];
    this.result.replaceChildren(
      plan(message.values as number[][], message.size as [number, number], maximum),
      make(
        "dl",
        { class: "numbers" },
        ...numbers.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]),
      ),
    );
    this.where.textContent = words(message);
  }
}

type Range = [number, number];

function between([low, high]: Range): string {
  return `(${short(low)} to ${short(high)})`;
}

/** Describes the place of the plane, and the points that do not count. */
function words(message: Message): string {
  const inside = message.inside as number;
  const where = message.surface
    ? `On the front of ${message.surface as string}.`
    : `On a plane ${short(message.height as number)} m above the floor, ` +
      `${distances(message.insets as number[])} from the walls.`;
  const left = inside === 1 ? " 1 point lies" : ` ${inside} points lie`;
  return `${where} ± and brackets are 95 % intervals.${inside ? `${left} inside of furniture or in the dark, which does not count.` : ""}`;
}

/** The distances of the plane from the walls along both of its sides. */
function distances(insets: number[]): string {
  return `${[...new Set(insets.map(short))].join(" and ")} m`;
}

function plan(values: number[][], [width, depth]: [number, number], maximum: number): HTMLElement {
  const [rows, columns] = [values.length, values[0].length];
  const cell = Math.max(4, Math.floor(560 / columns));
  const canvas = make("canvas", { class: "plan", role: "img", width: cell * columns, height: cell * rows });
  canvas.setAttribute(
    "aria-label",
    `Plan of the illuminance, ${short(width)} by ${short(depth)} metres, up to ${short(maximum)} lux`,
  );
  const context = canvas.getContext("2d")!;
  const top = Math.max(1, maximum);
  const every = Math.max(2, Math.ceil((2 * NUMBER_STEP) / cell));
  values.forEach((row, y) => {
    row.forEach((value, x) => {
      context.fillStyle = colourAt(value / top);
      context.fillRect(x * cell, y * cell, cell, cell);
    });
  });
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.font = "20px system-ui, sans-serif";
  for (let y = Math.floor(every / 2); y < rows; y += every) {
    for (let x = Math.floor(every / 2); x < columns; x += every) {
      context.fillStyle = values[y][x] / top > 0.55 ? "#000" : "#fff";
      context.fillText(String(Math.round(values[y][x])), (x + 0.5) * cell, (y + 0.5) * cell);
    }
  }
  canvas.addEventListener("pointermove", (event) => {
    const x = Math.min(columns - 1, Math.floor((event.offsetX / canvas.clientWidth) * columns));
    const y = Math.min(rows - 1, Math.floor((event.offsetY / canvas.clientHeight) * rows));
    canvas.title = `${short(values[Math.max(0, y)][Math.max(0, x)])} lx`;
  });
  return canvas;
}
