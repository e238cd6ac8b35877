// Keys of the whole page, and the list of all keys.

import { make, showDialog } from "./dom";

const KEYS: [string, string][] = [
  ["1 2 3 4 5 6 7", "plane, not plane, light, not light, take out, grid, shape"],
  ["[ and ]", "smaller and larger brush"],
  ["Ctrl+Z, Ctrl+Shift+Z", "undo, redo"],
  ["Ctrl+O", "open"],
  ["M, G, V", "masks, grid, vanishing lines"],
  ["?", "these keys"],
  ["Photo: arrow keys", "move the brush, with Shift in small steps"],
  ["Photo: Space", "start and end a stroke (Escape: no stroke)"],
  ["Photo: Enter", "a dot"],
  ["Photo, Grid: arrow keys", "move a corner of the grid; Space: the next corner"],
  ["Photo, Shape: Space", "the next lamp; Delete: as it is in the photo"],
  ["Photo, Shape: arrow keys", "move the lamp; with Shift: its width and its length; , and . turn it"],
  ["Photo: + and −", "zoom"],
  ["Stylise: arrow keys", "move the brush, with Shift in small steps"],
  ["Stylise: Space, Enter", "start and end a stroke (Escape: no stroke), a dot"],
  ["Room: arrow keys", "turn the view; with another tool, choose the ceiling, or shift, turn or size the lamps"],
  ["Room: + and −", "move the view"],
  ["Room: Home", "the room's own view"],
];

export function showKeys(): void {
  showDialog(
    "Keys",
    make(
      "dl",
      { class: "keys" },
      ...KEYS.flatMap(([keys, what]) => [make("dt", {}, make("kbd", {}, keys)), make("dd", {}, what)]),
    ),
    make(
      "p",
      {},
      "Two fingers or the wheel zoom the photo, the right mouse button moves it. A pen paints wider when pressed.",
    ),
  );
}

/** Calls the action of a key, unless somebody types. */
export function onKeys(actionOf: (key: string) => (() => void) | undefined): void {
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    const isText = target instanceof HTMLInputElement && ["number", "text"].includes(target.type);
    if (isText || target instanceof HTMLSelectElement || document.querySelector("dialog[open]")) return;
    const control = event.ctrlKey || event.metaKey;
    const name = `${control ? "Ctrl+" : ""}${control && event.shiftKey ? "Shift+" : ""}${event.key.toLowerCase()}`;
    const action = actionOf(name);
    if (!action || event.altKey) return;
    event.preventDefault();
    action();
  });
}
