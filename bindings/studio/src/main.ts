// The start of the page: which project it begins with, and its colours.

import { ask, Problem, type Start } from "./api";
import { byId, notice } from "./dom";
import { Page } from "./page";
import { hasWork, kept, newSession, Store, type Project } from "./project";
import "./style_base.css";
import "./style_layout.css";
import "./style_views.css";
import "./style_panels.css";
import "./style_stylise.css";
import "./style_windows.css";

const SESSION_KEY = "luxfer-studio-session";

/** The project to begin with: the project of this tab, or one that this browser has kept, or the server's. */
function choose(start: Start): { store: Store; restored: number | null } {
  const mine = sessionStorage.getItem(SESSION_KEY);
  const all = kept();
  const ofTab = all.find((k) => k.session === mine && !start.open.includes(k.session));
  const same = (k: { project: Project }) => k.project.photo.sha256 === start.project.photo.sha256;
  const left = all.find((k) => !start.open.includes(k.session) && hasWork(k.project) && (!start.named || same(k)));
  const found = ofTab && (!start.named || same(ofTab)) ? ofTab : hasWork(start.project) ? undefined : left;
  const session = found?.session ?? newSession();
  sessionStorage.setItem(SESSION_KEY, session);
  const project = found ? { ...start.project, ...found.project } : start.project;
  return { store: new Store(project, session), restored: found && hasWork(found.project) ? found.time : null };
}

function theme(): void {
  const select = byId<HTMLSelectElement>("theme");
  const set = (value: string) => {
    document.documentElement.dataset.theme = value;
    localStorage.setItem("luxfer-studio-theme", value);
  };
  select.value = localStorage.getItem("luxfer-studio-theme") ?? "auto";
  set(select.value);
  select.onchange = () => set(select.value);
}

async function main(): Promise<void> {
  theme();
  byId("busy").textContent = "Preparing the photo…";
  byId("busy").hidden = false;
  try {
    const start = await ask<Start>("start");
    const { store, restored } = choose(start);
    new Page(store, start);
    if (restored !== null) {
      const when = new Date(restored).toLocaleString([], { dateStyle: "short", timeStyle: "short" });
      notice(`Your work of ${when} is back.`, {
        label: "Start anew",
        work: () => store.replace({ ...start.project }),
      });
    }
  } catch (problem) {
    byId("busy").hidden = true;
    notice(problem instanceof Problem ? problem.message : String(problem));
  }
}

void main();
