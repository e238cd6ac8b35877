// The illuminance on the work plane: numbers, and a plan in colours that every eye can order.

import type { Message } from "./api";
import { byId, make, short } from "./dom";

/** Cividis by Nuñez, Anderton and Renslow, at eleven steps: dark blue to yellow. */
const CIVIDIS = [
  "#00224e",
  "#083370",
  "#35456c",
  "#4f576c",
  "#666970",
  "#7d7c78",
  "#948e77",
  "#aea371",
  "#c8b866",
  "#e5cf52",
  "#fee838",
];
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

export function showLux(message: Message): void {
  if (message.problem) {
    byId("lux").replaceChildren(make("p", { class: "quiet" }, message.problem as string));
    delete byId("lux").dataset.mean;
    return;
  }
  const values = message.values as number[][];
  const { minimum, mean, maximum, error } = message as unknown as Record<string, number>;
  const numbers: [string, string][] = [
    ["mean", `${short(mean)} lx ± ${short(error)}`],
    ["lowest", `${short(minimum)} lx`],
    ["highest", `${short(maximum)} lx`],
    ["uniformity", mean > 0 ? short(minimum / mean) : "–"],
  ];
  byId("lux").replaceChildren(
    plan(values, message.size as [number, number], maximum),
    make(
      "dl",
      { class: "numbers" },
      ...numbers.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]),
    ),
    make(
      "p",
      { class: "quiet" },
      `On a plane ${short(message.height as number)} m above the floor, ` +
        `${distances(message.insets as number[])} from the walls. ± is 95 %.${
        message.inside ? ` ${message.inside} points lie inside of furniture and do not count.` : ""
      }`,
    ),
  );
  byId("lux").dataset.mean = String(mean);
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
