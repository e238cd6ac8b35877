// The surfaces of the room that receive lamps. The project's own entries describe the one on which the user works.

import { make } from "./dom";
import { PLAIN_LAMPS, PLAIN_PATTERN, type Layout, type Project } from "./project";

type Patch = Partial<Project>;

function layoutOf(project: Project, surface: string): Layout {
  const { pattern, zones, mix, added } = project;
  return { surface, pattern, zones, mix, added };
}

/** Works on another surface. `surface` is the present one. */
export function workOn(project: Project, surface: string, name: string): Patch {
  const found = project.others.find((other) => other.surface === name);
  if (!found) return {};
  return { ...found, others: [...project.others.filter((other) => other !== found), layoutOf(project, surface)] };
}

/** Gives lamps to one more surface, with a pattern as in the photo, and works on it. */
export function addSurface(project: Project, surface: string, name: string): Patch {
  const plain: Layout = { surface: name, pattern: PLAIN_PATTERN, ...PLAIN_LAMPS };
  return { ...plain, others: [...project.others, layoutOf(project, surface)] };
}

/** Takes the lamps of the present surface away, and works on another one. */
export function removeSurface(project: Project): Patch {
  const [next, ...others] = project.others;
  return next ? { ...next, others } : {};
}

const MAX_OTHERS = 15;

/** The list of surfaces with lamps: one is chosen, further ones are added. */
export class SurfaceList {
  readonly box = make("div", { class: "surfaces" });
  private names: string[] = []; // of the room's objects
  private project: Project | null = null;
  private surface = "";
  onChange: (what: string, patch: Patch) => void = () => {};

  /** The names of all objects of the room, any of which may receive lamps. */
  setNames(names: string[]): void {
    this.names = names;
    this.draw();
  }

  show(project: Project, surface: string): void {
    Object.assign(this, { project, surface });
    this.draw();
  }

  private draw(): void {
    const { project, surface } = this;
    if (!project) return;
    const focus = this.box.contains(document.activeElement) ? document.activeElement!.id : "";
    const others = project.others.map((other) => other.surface);
    const lit = [surface, ...others].sort();
    const chips = lit.map((name, i) => {
      const input = make("input", { type: "radio", name: "lit-surface", id: `lit-${i}`, checked: name === surface });
      input.onchange = () => this.onChange(`work on ${name}`, workOn(project, surface, name));
      return make("label", {}, input, name);
    });
    const free = this.names.filter((name) => !lit.includes(name));
    const more = make(
      "select",
      { id: "add-surface", "aria-label": "One more surface with lamps", disabled: others.length >= MAX_OTHERS },
      make("option", { value: "" }, "One more surface…"),
      ...free.map((name) => make("option", { value: name }, name)),
    );
    more.onchange = () => more.value && this.onChange(`add ${more.value}`, addSurface(project, surface, more.value));
    const less = make("button", { type: "button", id: "remove-surface" }, "No lamps here");
    less.onclick = () => this.onChange(`no lamps on ${surface}`, removeSurface(project));
    this.box.replaceChildren(
      make("div", { class: "tools", role: "radiogroup", "aria-label": "Surfaces with lamps" }, ...(others.length ? chips : [])),
      make("p", { class: "row" }, more, ...(others.length ? [less] : [])),
    );
    if (focus) document.getElementById(focus)?.focus();
  }
}
