// The surface that receives the lights, and how the pattern lies on it.

import type { Message } from "./api";
import { byId, make, short } from "./dom";
import { PLAIN_LAMPS, type Pattern, type Project } from "./project";
import type { Candidate } from "./room_tools";
import { SurfaceList } from "./surfaces";

const SCALES: [Pattern["scale"], string][] = [
  ["distance", "as in the photo"],
  ["lamp", "by the length of a lamp"],
  ["spacing", "by the spacing of lamps"],
  ["across", "as many across as in the photo"],
];
/** How far the sliders shift, in metres. */
const MAX_SHIFT = 1.5;
const DEGREES = Math.PI / 180;

export class PatternForm {
  private readonly box = byId("pattern");
  private readonly surface = make("select", { id: "surface" });
  private readonly reason = make("p", { class: "quiet" });
  private readonly scale = make(
    "select",
    { id: "scale" },
    ...SCALES.map(([value, label]) => make("option", { value }, label)),
  );
  private readonly length = number("length", 0.1, 6, 0.05);
  private readonly turn = slider("turn", -180, 180, 1);
  private readonly across = slider("across", -MAX_SHIFT, MAX_SHIFT, 0.001);
  private readonly along = slider("along", -MAX_SHIFT, MAX_SHIFT, 0.001);
  private readonly whole = make("input", { type: "checkbox", id: "whole" });
  private readonly white = number("white", 1, 100000, 1);
  private readonly proposal = make("p", { class: "quiet row" });
  readonly surfaces = new SurfaceList();
  private candidates: Candidate[] = [];
  private names: string[] = []; // of all objects
  private project: Project | null = null;
  private isTurn = false;
  onChange: (what: string, patch: Partial<Project>) => void = () => {};

  constructor() {
    const row = (label: string, input: HTMLElement, unit = "") =>
      make("label", { class: "field" }, make("span", {}, label), input, make("span", { class: "unit" }, unit));
    this.box.append(
      this.surfaces.box,
      row("Surface", this.surface),
      this.reason,
      row("Size", this.scale),
      row("Length", this.length, "m"),
      row("Turn", this.turn, "°"),
      row("Shift across", this.across, "m"),
      row("Shift along", this.along, "m"),
      make("label", { class: "inline" }, this.whole, " No lamp cut by the edge"),
      row("White of the photo", this.white, "cd/m²"),
      this.proposal,
    );
    this.surface.onchange = () => this.onChange("surface", { surface: this.surface.value, ...PLAIN_LAMPS });
    this.surfaces.onChange = (what, patch) => this.onChange(what, patch);
    for (const [input, name] of [
      [this.scale, "scale"],
      [this.length, "length"],
      [this.turn, "turn"],
      [this.across, "shift"],
      [this.along, "shift"],
      [this.whole, "whole"],
    ] as const) {
      input.addEventListener("input", () => {
        this.isTurn = name === "turn"; // the slider has whole degrees, a drag any angle
        this.onChange(name, { pattern: this.read() });
      });
    }
    this.white.onchange = () => this.onChange("white", { white: Math.max(1e-3, Number(this.white.value) || 100) });
  }

  private read(): Pattern {
    return {
      scale: this.scale.value as Pattern["scale"],
      length: Math.max(0.01, Number(this.length.value) || 1.2),
      rotation: this.isTurn ? Number(this.turn.value) * DEGREES : this.project!.pattern.rotation,
      offset: [Number(this.across.value), Number(this.along.value)],
      keep_whole: this.whole.checked,
    };
  }

  setCandidates(message: Message): void {
    this.candidates = message.candidates;
    this.names = message.surfaces;
    this.surfaces.setNames(this.names);
    if (this.project) this.show(this.project);
  }

  show(project: Project): void {
    this.project = project;
    const { pattern } = project;
    const name = project.surface ?? this.candidates[0]?.name ?? "";
    this.offer(project.others.map((other) => other.surface));
    this.surface.value = name;
    this.surfaces.show(project, name);
    this.reason.textContent = this.candidates.find((c) => c.name === name)?.reason ?? "";
    this.scale.value = pattern.scale;
    this.length.value = String(pattern.length);
    this.length.closest("label")!.hidden = pattern.scale === "distance" || pattern.scale === "across";
    this.turn.value = String(Math.round(pattern.rotation / DEGREES));
    [this.across, this.along].forEach((input, i) => {
      const limit = Math.max(MAX_SHIFT, Math.abs(pattern.offset[i])); // a drag may go farther
      input.min = String(-limit);
      input.max = String(limit);
      input.value = String(pattern.offset[i]);
    });
    this.whole.checked = pattern.keep_whole;
    this.white.value = String(project.white);
    for (const input of [this.turn, this.across, this.along]) {
      const unit = input.nextElementSibling as HTMLElement;
      unit.textContent = input === this.turn ? `${input.value}°` : `${Number(input.value).toFixed(2)} m`;
    }
  }

  /** The surfaces that the lamps can move to: the likely ceilings first. */
  private offer(taken: string[]): void {
    const isFree = (name: string) => !taken.includes(name);
    const likely = this.candidates.filter((c) => isFree(c.name));
    const rest = this.names.filter((name) => isFree(name) && !likely.some((c) => c.name === name));
    const options = (names: [string, string][]) => names.map(([value, text]) => make("option", { value }, text));
    const title = (c: Candidate) => (c.kind === "material" ? `${c.name} (material)` : c.name);
    this.surface.replaceChildren(
      ...options(likely.map((c) => [c.name, title(c)])),
      ...(rest.length
        ? [make("optgroup", { label: "Other objects" }, ...options(rest.map((name) => [name, name])))]
        : []),
    );
  }

  /** The library's estimates for the photo: the distance of its camera, and a likely luminance of its white. */
  setEstimates(message: Message): void {
    const [value, low, high] = message.proposed_white as number[];
    const distance = Number.isFinite(message.distance)
      ? `The photo's camera is taken to be ${short(message.distance)} m ` +
        `(${(message.distance_range as number[]).map(short).join(" to ")} m) from the plane of the lamps. `
      : "";
    const isSame = Math.abs((this.project?.white ?? 0) - value) < 0.6;
    this.proposal.replaceChildren(
      `${distance}Likely white: ${Math.round(value)} (${Math.round(low)} to ${Math.round(high)}) cd/m².`,
      ...(isSame
        ? []
        : [
            make(
              "button",
              { type: "button", onclick: () => this.onChange("white", { white: Math.round(value) }) },
              `Use ${Math.round(value)}`,
            ),
          ]),
    );
  }
}

function slider(id: string, min: number, max: number, step: number): HTMLInputElement {
  return make("input", { type: "range", id, min, max, step, value: 0 });
}

function number(id: string, min: number, max: number, step: number): HTMLInputElement {
  return make("input", { type: "number", id, min, max, step: step === 1 ? "any" : step });
}
