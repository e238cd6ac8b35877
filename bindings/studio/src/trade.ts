// Speed against accuracy: one slider, with the plan's prediction and then the actual figures of the picture.

import type { Message } from "./api";
import { byId, make, percent, seconds } from "./dom";

/** Noise of the picture, root mean square relative to its mean, from the fastest to the most accurate. */
const STEPS = [0.5, 0.3, 0.2, 0.1, 0.05, 0.03, 0.02, 0.01];

export class Trade {
  private readonly slider = make("input", {
    type: "range",
    id: "noise",
    min: 0,
    max: STEPS.length - 1,
    step: 1,
    list: "noise-steps",
  });
  private readonly goal = make("output", { for: "noise" });
  private readonly planned = make("p", { id: "planned" });
  private readonly left = make("p", { id: "left", class: "quiet" });
  private plan: { noise: number; seconds: number; error: number } | null = null;
  onNoise: (noise: number) => void = () => {};

  constructor() {
    byId("trade").append(
      make("label", { class: "trade" }, make("span", {}, "fast"), this.slider, make("span", {}, "accurate")),
      make("p", {}, "Noise of the picture: ", this.goal),
      this.planned,
      this.left,
    );
    this.slider.oninput = () => this.preview();
    this.slider.onchange = () => this.onNoise(this.noise);
  }

  private get noise(): number {
    return STEPS[Number(this.slider.value)];
  }

  show(noise: number): void {
    const nearest = STEPS.reduce(
      (best, step, i) => (Math.abs(Math.log(step / noise)) < Math.abs(Math.log(STEPS[best] / noise)) ? i : best),
      0,
    );
    this.slider.value = String(nearest);
    this.goal.textContent = percent(noise);
    this.slider.setAttribute("aria-valuetext", percent(noise));
  }

  /** An estimate until the plan for a new goal arrives: noise falls with the square root of the time. */
  private preview(): void {
    this.goal.textContent = percent(this.noise);
    this.slider.setAttribute("aria-valuetext", percent(this.noise));
    if (this.plan) {
      const cost = this.plan.seconds * (this.plan.error / this.noise) ** 2;
      this.planned.textContent = `about ${seconds(cost)} (planned when you let go)`;
    }
  }

  setPlan(message: Message): void {
    this.plan = { noise: message.noise, seconds: message.seconds, error: message.error };
    const time = (message.seconds_range as number[]).map(seconds).join(" to ");
    const noise = (message.error_range as number[]).map(percent).join(" to ");
    this.planned.textContent =
      `Planned: ${seconds(message.seconds)} (${time}), and ${percent(message.error)} (${noise}) of noise remain. ` +
      "More than 9 of 10 plans keep to these brackets, if other programs do not become busier.";
    this.planned.dataset.seconds = String(message.seconds);
  }

  setPicture(message: Message): void {
    if (message.noise === null) return;
    const state = message.done ? "Done" : "So far";
    this.left.textContent =
      `${state}: ${seconds(message.seconds)}, ${percent(message.noise)} of noise, ` +
      `${message.samples} paths per pixel.`;
  }
}
