// Opening photos, rooms and projects: from the machine, by dropping, or from folders that were named at the start.

import { ask, Problem, upload } from "./api";
import { byId, make, notice, showDialog } from "./dom";
import type { FileName, Project } from "./project";

interface Listed {
  path: string;
  name: string;
  is_room: boolean;
}

export interface Targets {
  photo: (file: FileName) => void;
  room: (file: FileName | null) => void;
  project: (project: Project) => void;
  demo: () => void;
}

export class Opener {
  constructor(private readonly targets: Targets) {
    document.addEventListener("dragover", (e) => e.preventDefault());
    document.addEventListener("drop", (e) => {
      e.preventDefault();
      for (const file of e.dataTransfer?.files ?? []) void this.take(file);
    });
  }

  /** A file of the user's, by its kind. */
  async take(file: File): Promise<void> {
    try {
      if (/\.json$/i.test(file.name)) {
        const { project } = await ask<{ project: Project }>("projects", { method: "POST", body: file });
        this.targets.project(project);
      } else this.use(await upload(file));
      byId<HTMLDialogElement>("dialog").close();
    } catch (problem) {
      notice(problem instanceof Problem ? problem.message : String(problem));
      byId<HTMLDialogElement>("dialog").close();
    }
  }

  private use({ name, sha256, is_room }: FileName & { is_room: boolean }): void {
    if (is_room) this.targets.room({ name, sha256 });
    else this.targets.photo({ name, sha256 });
  }

  async show(): Promise<void> {
    const input = make("input", {
      type: "file",
      multiple: true,
      id: "files",
      accept: ".jpg,.jpeg,.png,.webp,.tif,.tiff,.bmp,.gif,.hdr,.exr,.glb,.gltf,.usd,.usda,.usdc,.usdz,.json",
    });
    input.onchange = () => {
      for (const file of input.files ?? []) void this.take(file);
    };
    const listed = await ask<{ files: Listed[] }>("files").catch(() => ({ files: [] as Listed[] }));
    const close = () => byId<HTMLDialogElement>("dialog").close();
    showDialog(
      "Open",
      make("p", {}, "A photo, a room (glTF or USD) or a project of the studio. You can also drop files on the page."),
      make("label", { class: "file" }, "Choose files ", input),
      make(
        "p",
        { class: "row" },
        make("button", { type: "button", onclick: () => (close(), this.targets.demo()) }, "The generated photo"),
        make("button", { type: "button", onclick: () => (close(), this.targets.room(null)) }, "The generated room"),
      ),
      ...(listed.files.length
        ? [
            make("h3", {}, "Files named at the start"),
            make(
              "ul",
              { class: "listed" },
              ...listed.files.map((f) =>
                make(
                  "li",
                  {},
                  make("button", { type: "button", onclick: () => void this.openListed(f, close) }, f.name),
                  make("span", { class: "quiet" }, f.is_room ? "room" : "photo"),
                ),
              ),
            ),
          ]
        : []),
    );
  }

  private async openListed(file: Listed, close: () => void): Promise<void> {
    try {
      this.use(await ask<FileName & { is_room: boolean }>(`files?open=${encodeURIComponent(file.path)}`));
    } catch (problem) {
      notice(problem instanceof Problem ? problem.message : String(problem));
    }
    close();
  }
}
