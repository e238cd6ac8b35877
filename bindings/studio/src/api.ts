// The connection to the server: edits go out, results come in as a JSON header and bytes.

import type { FileName, Project } from "./project";

export interface Message {
  type: string;
  [name: string]: any;
}

export interface Start {
  project: Project;
  open: string[];
  named: boolean;
  version: string;
}

/** Number of pixels of every picture, so that a project gives equal pictures in all windows. */
export const PICTURE: [number, number] = [720, 480];
const RECONNECT_MS = 1000;

export class Problem extends Error {}

/** Returns an answer of the server, as JSON unless `read` reads it otherwise; an error that it states is thrown as a
 * Problem. */
export async function ask<T>(
  path: string,
  init?: RequestInit,
  read: (answer: Response) => Promise<unknown> = (answer) => answer.json(),
): Promise<T> {
  let answer: Response;
  try {
    answer = await fetch(path, init);
  } catch {
    throw new Problem("The studio does not answer: has it been ended?");
  }
  if (!answer.ok) throw new Problem(await reason(answer));
  return (await read(answer)) as T;
}

async function reason(answer: Response): Promise<string> {
  const text = await answer.text();
  try {
    return JSON.parse(text).message;
  } catch {
    return text.trim() || `the server answered ${answer.status}`;
  }
}

/** Sends a file of the user to the server. */
export function upload(file: File): Promise<FileName & { is_room: boolean }> {
  return ask(`files?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file });
}

/** Fetches a result and lets the browser keep it. */
export async function download(kind: string, session: string): Promise<string> {
  const answer = await fetch(`out/${kind}?session=${session}`);
  if (!answer.ok) throw new Problem(await reason(answer));
  const stated = /filename\*?=(?:utf-8'')?"?([^";]+)/i.exec(answer.headers.get("content-disposition") ?? "");
  const name = stated ? decodeURIComponent(stated[1]) : `result.${kind}`;
  const address = URL.createObjectURL(await answer.blob());
  const link = Object.assign(document.createElement("a"), { href: address, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
  return name;
}

export interface Edit {
  project: Project;
  compare: string;
  draft: boolean;
}

/** Sends the latest state of the page to the server; skips earlier states that the server could not take. */
export class Connection {
  private socket: WebSocket | null = null;
  private waiting: Edit | null = null;
  private version = 0;
  private isDraftUnanswered = false;
  isUp = false;
  onMessage: (message: Message, payload: Uint8Array) => void = () => {};
  onState: (isUp: boolean) => void = () => {};
  /** The state to send when a connection has been made. */
  current: () => Edit = () => {
    throw new Error("not set");
  };

  constructor(private readonly session: string) {}

  open(): void {
    const address = new URL(`ws?session=${this.session}`, location.href.replace(/^http/, "ws"));
    const socket = (this.socket = new WebSocket(address));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.isUp = true;
      this.isDraftUnanswered = false;
      this.onState(true);
      this.send(this.current());
    };
    socket.onmessage = (event) => this.take(event.data as ArrayBuffer);
    socket.onclose = () => {
      if (this.isUp) this.onState(false);
      this.isUp = false;
      setTimeout(() => this.open(), RECONNECT_MS);
    };
  }

  /** Sends a state. While a stroke is painted, only one of its states is on its way at a time. */
  send(edit: Edit): number {
    if (!this.isUp || !this.socket) return this.version;
    if (edit.draft && this.isDraftUnanswered) {
      this.waiting = edit;
      return this.version;
    }
    this.waiting = null;
    this.isDraftUnanswered = edit.draft;
    this.version += 1;
    this.socket.send(JSON.stringify({ type: "edit", version: this.version, size: PICTURE, ...edit }));
    return this.version;
  }

  /** Sends another brightness of the picture; running work continues. */
  expose(exposure: number): void {
    if (this.isUp) this.socket?.send(JSON.stringify({ type: "expose", exposure }));
  }

  /** Sends a message other than a state of the project. */
  say(message: Message): void {
    if (this.isUp) this.socket?.send(JSON.stringify(message));
  }

  private take(data: ArrayBuffer): void {
    const length = new DataView(data).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length))) as Message;
    this.onMessage(header, new Uint8Array(data, 4 + length));
    if (header.type === "masks" && header.live) {
      this.isDraftUnanswered = false;
      if (this.waiting) this.send(this.waiting);
    }
  }
}
