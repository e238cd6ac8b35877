// The project: all inputs that determine the result. It is kept in the browser at every change, and changes can be
// undone.

export type Kind = "plane" | "not-plane" | "light" | "not-light";

export interface Stroke {
  kind: Kind;
  radius: number;
  points: number[]; // x, y, x, y, ... in pixels of the photo
}

/** A lamp of the photo that was moved, resized or turned: a pixel on it, and its corners before and after. */
export interface Reshaped {
  at: [number, number];
  before: number[];
  after: number[];
}

export interface FileName {
  name: string;
  sha256: string;
}

export interface Camera {
  position: [number, number, number];
  target: [number, number, number];
  fov_y: number;
}

export interface Pattern {
  scale: "distance" | "lamp" | "spacing" | "across";
  length: number;
  rotation: number;
  offset: [number, number];
  keep_whole: boolean;
}

export interface LuxPlane {
  surface: string | null; // null: a level plane
  height: number; // of the level plane above the floor, in metres
}

/** A copy of a lamp of this kind, at u and v in metres on the surface. */
export type Added = [number, number, number];

/** The lamps of a further surface. */
export interface Layout {
  surface: string;
  pattern: Pattern;
  zones: [number, number, number, number][];
  mix: Record<string, number>;
  added: Added[];
}

export interface Project {
  luxfer_studio: number;
  photo: FileName;
  room: FileName | null;
  strokes: Stroke[];
  removed: [number, number][];
  reshaped: Reshaped[];
  grid: number[] | null; // x and y in the photo of the corners of a rectangle on the plane
  zones: [number, number, number, number][];
  surface: string | null;
  pattern: Pattern;
  mix: Record<string, number>; // the factor of each kind of lamp
  added: Added[];
  others: Layout[];
  lux_plane: LuxPlane;
  white: number;
  camera: Camera | null;
  exposure: number | null;
  noise: number;
  plan: { render: Record<string, number> } | null;
}

/** The lamps of a surface before anybody has changed them. */
export const PLAIN_LAMPS: Pick<Project, "zones" | "mix" | "added"> = { zones: [], mix: {}, added: [] };

/** The pattern of a surface before anybody has changed it. */
export const PLAIN_PATTERN: Pattern = { scale: "distance", length: 1.2, rotation: 0, offset: [0, 0], keep_whole: false };

/** Changes of one entry within this time, such as by a slider, are undone together. */
const TOGETHER_MS = 800;
const PREFIX = "luxfer-studio/";

export class Store {
  private past: Project[] = [];
  private future: Project[] = [];
  private lastChange = { what: "", time: 0 };
  onChange: (what: string) => void = () => {};

  constructor(
    public project: Project,
    public readonly session: string,
  ) {}

  /** Changes the project; `what` names the change, so that steps of one drag become one undo. */
  change(what: string, patch: Partial<Project>): void {
    const now = performance.now();
    if (what !== this.lastChange.what || now - this.lastChange.time > TOGETHER_MS) this.past.push(this.project);
    this.lastChange = { what, time: now };
    this.future = [];
    this.set({ ...this.project, plan: null, ...patch }, what);
  }

  /** Takes over values that the server has chosen: they are not undone, and no result has to be computed again. */
  note(patch: Partial<Project>): void {
    this.project = { ...this.project, ...patch };
    this.keep();
  }

  /** Begins with another project. */
  replace(project: Project): void {
    this.past.push(this.project);
    this.future = [];
    this.lastChange.what = "";
    this.set(project, "open");
  }

  undo(): void {
    this.travel(this.past, this.future);
  }

  redo(): void {
    this.travel(this.future, this.past);
  }

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  private travel(from: Project[], to: Project[]): void {
    const next = from.pop();
    if (!next) return;
    to.push(this.project);
    this.lastChange.what = "";
    this.set({ ...next, exposure: this.project.exposure, plan: null }, "travel");
  }

  private set(project: Project, what: string): void {
    this.project = project;
    this.keep();
    this.onChange(what);
  }

  /** Stores the project in the browser, where it survives the server. */
  keep(): void {
    try {
      localStorage.setItem(PREFIX + this.session, JSON.stringify({ time: Date.now(), project: this.project }));
    } catch {
      forgetOldest(PREFIX + this.session);
    }
  }
}

export interface Kept {
  session: string;
  time: number;
  project: Project;
}

/** The projects that this browser has kept, the latest first. */
export function kept(): Kept[] {
  const out: Kept[] = [];
  for (let i = 0; i < localStorage.length; i++) {
    const key = localStorage.key(i) ?? "";
    if (!key.startsWith(PREFIX)) continue;
    try {
      const { time, project } = JSON.parse(localStorage.getItem(key) ?? "");
      if (project?.photo && Array.isArray(project.strokes))
        out.push({ session: key.slice(PREFIX.length), time, project });
    } catch {
      localStorage.removeItem(key);
    }
  }
  return out.sort((a, b) => b.time - a.time);
}

/** Makes room in the browser's store. */
function forgetOldest(except: string): void {
  const oldest = kept().pop();
  if (oldest && PREFIX + oldest.session !== except) localStorage.removeItem(PREFIX + oldest.session);
}

/** Whether a project has any content worth keeping. */
export function hasWork(project: Project): boolean {
  return (
    project.strokes.length + project.removed.length + (project.reshaped ?? []).length + project.zones.length + (project.added ?? []).length + (project.others ?? []).length > 0 ||
    Boolean(project.grid)
  );
}

export function newSession(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(12)), (b) => b.toString(16).padStart(2, "0")).join("");
}
