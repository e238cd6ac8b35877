// The library's notes on its results: proposals, warnings, and the place where one more stroke helps most.

import { adviceFor } from "./advice";
import type { Message } from "./api";
import { byId, make } from "./dom";
import type { Mark } from "./marks";

interface Warning {
  code: string;
  stage: string;
  message: string;
  advice: string;
  at: [number, number] | null;
}

const STAGES: Record<string, string> = {
  scene: "Room",
  view: "Camera",
  features: "Room in the photo",
  plane: "Plane",
  lights: "Lights",
  unwarp: "Straight view",
  emission: "Pattern",
  relight: "Strength",
};
const MASKS: Record<string, string> = { plane: "plane", lights: "lights" };

export class Notes {
  private room: Warning[] = [];
  private warnings: Warning[] = [];
  private doubt: { phase: string; at: [number, number] } | null = null;
  private isKnown = false; // whether the library has looked at the photo
  private failure = "";
  onMarks: (marks: Mark[]) => void = () => {};

  /** Warnings about the room, which stay until another room is opened. */
  setRoom(message: Message): void {
    this.room = (message.warnings as Warning[]).map((w) => ({ ...w, stage: "scene", at: null }));
    this.draw();
  }

  setWarnings(message: Message): void {
    this.isKnown = true;
    this.warnings = (message.list as Warning[]).filter((w) => w.stage !== "scene");
    this.draw();
  }

  /** Forgets the notes on a photo. */
  clear(): void {
    this.warnings = [];
    this.isKnown = false;
    this.doubt = null;
    this.failure = "";
    this.draw();
  }

  setDoubt(message: Message): void {
    this.doubt = message.place;
    this.draw();
  }

  fail(text: string): void {
    this.failure = text;
    this.draw();
  }

  /** The masks that nobody has confirmed by strokes. */
  get proposed(): Set<string> {
    return new Set(this.warnings.filter((w) => w.code === "PROPOSED").map((w) => w.stage));
  }

  private draw(): void {
    const proposed = this.proposed;
    const isSaid = (code: string) => code === "PROPOSED" || (code === "UNSEEN" && this.doubt !== null);
    const rest = [...this.room, ...this.warnings].filter((w) => !isSaid(w.code));
    const marks: Mark[] = [];
    const items: HTMLElement[] = [];
    if (this.failure) items.push(item("error", "!", make("b", {}, "Failed: "), this.failure));
    if (proposed.size) {
      const which = [...proposed].map((p) => MASKS[p]).join(" and ");
      items.push(
        item(
          "proposal",
          "▨",
          make("b", {}, "Proposal: "),
          `nobody has painted the ${which} yet, so the striped mask is a guess. Paint to correct it.`,
        ),
      );
    }
    if (this.doubt) {
      const what = this.doubt.phase === "plane" ? "on the plane or off it" : "a light or not";
      items.push(item("help", "?", make("b", {}, "One stroke here helps most: "), `say whether this is ${what}.`));
      marks.push({ at: this.doubt.at, text: "?", isMain: true });
    }
    rest.forEach((warning, index) => {
      const sign = String(index + 1);
      if (warning.at) marks.push({ at: warning.at, text: sign, isMain: false });
      const said = adviceFor(warning.code, warning.advice);
      const advice = said ? make("span", { class: "advice" }, sentence(said)) : "";
      items.push(
        item(
          "warning",
          warning.at ? sign : "!",
          make("b", {}, `${STAGES[warning.stage] ?? warning.stage}: `),
          sentence(warning.message),
          " ",
          advice,
        ),
      );
    });
    if (!items.length && this.isKnown) items.push(item("fine", "✓", "Nothing to doubt."));
    byId("notes").replaceChildren(...items);
    byId("notes-count").textContent = items.length > 1 || rest.length ? String(items.length) : "";
    this.onMarks(marks);
  }
}

function item(kind: string, sign: string, ...inside: (Node | string)[]): HTMLElement {
  return make(
    "li",
    { class: kind },
    make("span", { class: "sign", "aria-hidden": "true" }, sign),
    make("span", {}, ...inside),
  );
}

function sentence(text: string): string {
  return `${text.charAt(0).toUpperCase()}${text.slice(1).replace(/\.$/, "")}.`;
}
