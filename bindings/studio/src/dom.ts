// Small helpers for the document.

/** The element with an id, of a given kind. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`there is no element ${id}`);
  return found as T;
}

type Props = Record<string, string | number | boolean | null | ((event: Event) => void)>;

/** Makes an element from its attributes, listeners (functions, such as onclick), and children. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  props: Props = {},
  ...inside: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const out = document.createElement(tag);
  for (const [name, value] of Object.entries(props)) {
    if (typeof value === "function") out.addEventListener(name.slice(2), value);
    else if (value === true) out.setAttribute(name, "");
    else if (value !== false && value !== null) out.setAttribute(name, String(value));
  }
  out.append(...inside);
  return out;
}

/** Formats a number with three significant digits. */
export function short(value: number): string {
  if (!Number.isFinite(value)) return "–";
  const digits = Math.abs(value) >= 100 ? 0 : Math.abs(value) >= 10 ? 1 : 2;
  return value.toFixed(digits);
}

export function percent(share: number): string {
  const value = 100 * share;
  return `${value.toFixed(Math.abs(value) < 10 ? 1 : 0)} %`;
}

export function seconds(value: number): string {
  if (value < 1) return `${Math.round(1000 * value)} ms`;
  if (value < 90) return `${value.toFixed(value < 10 ? 1 : 0)} s`;
  return value < 5400 ? `${Math.round(value / 60)} min` : `${(value / 3600).toFixed(1)} h`;
}

/** Calls a function at the next frame, and only once, however often it was requested. */
export function atNextFrame(work: () => void): () => void {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      work();
    });
  };
}

const dialog = () => byId<HTMLDialogElement>("dialog");

/** Shows a dialog, which Escape and its button close. */
export function showDialog(title: string, ...inside: (Node | string)[]): HTMLDialogElement {
  const out = dialog();
  out.replaceChildren(
    make("h2", {}, title),
    ...inside,
    make("p", { class: "end" }, make("button", { type: "button", onclick: () => out.close() }, "Close")),
  );
  if (!out.open) out.showModal();
  return out;
}

/** Shows a message above the page, until it is closed. */
export function notice(text: string, act?: { label: string; work: () => void }): void {
  const button = byId<HTMLButtonElement>("notice-act");
  byId("notice-text").textContent = text;
  button.hidden = !act;
  if (act) {
    button.textContent = act.label;
    button.onclick = () => {
      hideNotice();
      act.work();
    };
  }
  byId("notice-close").onclick = hideNotice;
  byId("notice").hidden = false;
}

export function hideNotice(): void {
  byId("notice").hidden = true;
}
