// The results as files.

import { download, Problem } from "./api";
import { byId, make, notice } from "./dom";

const KINDS: [string, string, string][] = [
  ["glb", "Room (GLB)", "the room with its lamps, in cd/m², for Blender and other programs"],
  ["usd", "Room (USD)", "the lit room as .usdz, for Omniverse, Houdini and others"],
  ["png", "Picture (PNG)", "at the exposure shown"],
  ["exr", "Picture (EXR)", "linear, in cd/m²"],
  ["csv", "Lamps (CSV)", "the schedule: place in metres, size, cd/m², lumens, kelvin"],
  ["json", "Lamps (JSON)", "the schedule with the outlines of the lamps"],
  ["photometry", "IES, LDT, TM-33, GLDF", "a zip with a file of each format for each kind of lamp"],
  ["room", "Unlit room (GLB)", "as the programs read it, also if it was opened as USD"],
  ["project", "Project (JSON)", "opens here again with the same result"],
  ["program", "Program (Python)", "gives the same results without the studio"],
  ["program-cpp", "Program (C++)", "such a program in C++17"],
  ["program-c", "Program (C)", "such a program in C11"],
];

export function showOut(session: string, openProject: () => void): void {
  byId("out").append(
    make(
      "ul",
      { class: "out" },
      ...KINDS.map(([kind, label, what]) =>
        make(
          "li",
          {},
          make("button", { type: "button", id: `out-${kind}`, onclick: () => void keep(kind, session) }, label),
          make("span", {}, what),
        ),
      ),
    ),
    make("p", {}, make("button", { type: "button", onclick: openProject }, "Open a project…")),
  );
}

async function keep(kind: string, session: string): Promise<void> {
  try {
    notice(`Saved ${await download(kind, session)}.`);
  } catch (problem) {
    notice(problem instanceof Problem ? problem.message : String(problem));
  }
}
