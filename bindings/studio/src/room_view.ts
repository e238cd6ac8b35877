// The room: its picture by the library, and while the camera moves a quick view of its surfaces by three.js.

import {
  AmbientLight,
  Box3,
  Color,
  DirectionalLight,
  Group,
  Material,
  Mesh,
  PerspectiveCamera,
  Scene,
  Texture,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { PICTURE, type Message } from "./api";
import { byId } from "./dom";
import { rgbPicture } from "./masks";
import type { Camera } from "./project";
import { dot, type Rectangle, type Vector } from "./surface";

const ASPECT = PICTURE[0] / PICTURE[1];
const KEY_ANGLE = 0.06;
const KEY_DOLLY = 1.1;
/** The camera has come to rest when nothing has moved it for this time. */
const REST_MS = 250;
/** Marks end at this distance from the camera, and the pointer reaches this far, in metres. */
const NEAR = 0.05;
const MAX_DISTANCE = 1000;

export interface Spot {
  position: Vector;
  label: string;
}

export class RoomView {
  readonly frame = byId("room");
  private readonly after = byId<HTMLCanvasElement>("room-after");
  private readonly before = byId<HTMLCanvasElement>("room-before");
  private readonly marks = byId<HTMLCanvasElement>("room-marks");
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(60, ASPECT, 0.02, 1000);
  private renderer: WebGLRenderer | null = null;
  private controls: OrbitControls | null = null;
  private model: Group | null = null;
  private home: Camera | null = null;
  private rest = 0;
  private isMoving = false;
  private hasBefore = false;
  private spots: Spot[] = [];
  onCamera: (camera: Camera | null) => void = () => {};
  /** Handles a key before the view does; returns true if it has handled the key. */
  onKey: (event: KeyboardEvent) => boolean = () => false;
  /** Draws over the picture, in pixels of the screen. */
  drawOver: (context: CanvasRenderingContext2D) => void = () => {};

  constructor() {
    this.startWebGl();
    new ResizeObserver(() => this.fit()).observe(byId("room-stage"));
    this.frame.addEventListener("keydown", (e) => this.key(e));
    byId("camera-home").onclick = () => this.goHome();
    byId<HTMLInputElement>("split").oninput = () => this.split();
    this.fit();
  }

  /** Without WebGL the picture stays as it is until the next one; keys still turn the view. */
  private startWebGl(): void {
    try {
      this.renderer = new WebGLRenderer({ antialias: true, powerPreference: "low-power" });
    } catch {
      return;
    }
    const canvas = this.renderer.domElement;
    canvas.className = "webgl";
    canvas.setAttribute("aria-hidden", "true");
    this.frame.prepend(canvas);
    this.scene.background = new Color(0x15181c);
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(1, 3, 2);
    this.scene.add(new AmbientLight(0xffffff, 1.4), sun);
    this.controls = new OrbitControls(this.camera, this.frame);
    this.controls.addEventListener("start", () => this.moved());
    this.controls.addEventListener("change", () => this.moved());
  }

  /** Loads the surfaces of the room. */
  async load(address: string): Promise<void> {
    if (!this.renderer) return;
    const { scene } = await new GLTFLoader().loadAsync(address);
    if (this.model) dispose(this.model);
    if (this.model) this.scene.remove(this.model);
    this.model = scene as unknown as Group;
    this.scene.add(this.model);
    const far = new Box3().setFromObject(this.model).getSize(new Vector3()).length();
    this.camera.far = 10 * far;
    this.camera.near = far / 2000;
    this.camera.updateProjectionMatrix();
    this.paint();
  }

  /** Places the camera without notifying the page. */
  setCamera(camera: Camera, isHome: boolean): void {
    if (isHome) this.home = camera;
    this.camera.position.set(...camera.position);
    this.camera.fov = (180 / Math.PI) * camera.fov_y;
    this.camera.updateProjectionMatrix();
    const target = new Vector3(...camera.target);
    if (this.controls) {
      // Turn about a point inside the room instead of a point one metre ahead.
      const ahead = target.clone().sub(this.camera.position);
      const distance = Math.max(ahead.length(), 2.5);
      this.controls.target.copy(this.camera.position).add(ahead.setLength(distance));
      this.quietly(() => this.controls!.update());
    } else this.camera.lookAt(target);
    this.paint();
    this.drawMarks();
  }

  private isQuiet = false;
  private quietly(work: () => void): void {
    this.isQuiet = true;
    work();
    this.isQuiet = false;
  }

  private goHome(): void {
    if (!this.home) return;
    this.setCamera(this.home, true);
    this.onCamera(null);
  }

  /** A picture has arrived; of a moving camera the quick view stays until the camera rests. */
  picture(message: Message, rgb: Uint8Array): void {
    const isBefore = message.which === "before";
    rgbPicture(message.width, message.height, rgb, isBefore ? this.before : this.after);
    if (isBefore) this.hasBefore = true;
    else this.isMoving = false;
    this.frame.dataset.picture = message.done ? "done" : "first";
    this.split();
  }

  /** Without a comparison the picture fills the frame. */
  compare(isOn: boolean): void {
    this.hasBefore = false;
    byId("split-label").hidden = !isOn;
    this.split();
  }

  private split(): void {
    const isShown = this.hasBefore && !byId("split-label").hidden && !this.isMoving;
    const share = Number(byId<HTMLInputElement>("split").value);
    this.before.hidden = byId("label-before").hidden = byId("label-after").hidden = !isShown;
    this.before.style.clipPath = `inset(0 ${100 - share}% 0 0)`;
    this.after.classList.toggle("away", this.isMoving && !!this.renderer);
    this.frame.style.setProperty("--split", `${share}%`);
    this.frame.classList.toggle("splitting", isShown);
    this.drawMarks();
  }

  /** Rings around lamps, such as the one that a list shows. */
  highlight(spots: Spot[]): void {
    this.spots = spots;
    this.drawMarks();
  }

  /** Whether drags turn the view. */
  setTurning(isOn: boolean): void {
    if (this.controls) this.controls.enabled = isOn;
    this.frame.classList.toggle("pointing", !isOn);
  }

  drawMarks(): void {
    const canvas = this.marks;
    canvas.width = this.frame.clientWidth;
    canvas.height = this.frame.clientHeight;
    const context = canvas.getContext("2d")!;
    this.camera.updateMatrixWorld();
    this.drawOver(context);
    for (const spot of this.spots) {
      const at = this.onScreen(spot.position);
      if (!at) continue;
      for (const [colour, wide] of [
        ["#000", 5],
        ["#fff", 2.5],
      ] as const) {
        context.strokeStyle = colour;
        context.lineWidth = wide;
        context.beginPath();
        context.arc(...at, 14, 0, 2 * Math.PI);
        context.stroke();
      }
    }
  }

  /** Where a point of the room is on the picture; null behind the camera. */
  onScreen(point: Vector): [number, number] | null {
    const seen = new Vector3(...point).applyMatrix4(this.camera.matrixWorldInverse);
    return seen.z > -NEAR ? null : this.toPixels(seen);
  }

  private toPixels(seen: Vector3): [number, number] {
    const at = seen.clone().applyMatrix4(this.camera.projectionMatrix);
    return [((at.x + 1) / 2) * this.frame.clientWidth, ((1 - at.y) / 2) * this.frame.clientHeight];
  }

  /** The outline of a polygon on the picture, cut where it is behind the camera. */
  outline(corners: Vector[]): Path2D {
    const seen = corners.map((c) => new Vector3(...c).applyMatrix4(this.camera.matrixWorldInverse));
    const cut: Vector3[] = [];
    seen.forEach((to, i) => {
      const from = seen[(i + seen.length - 1) % seen.length];
      if (from.z > -NEAR !== to.z > -NEAR) cut.push(from.clone().lerp(to, (-NEAR - from.z) / (to.z - from.z)));
      if (to.z <= -NEAR) cut.push(to);
    });
    const path = new Path2D();
    cut.forEach((point, i) => (i ? path.lineTo(...this.toPixels(point)) : path.moveTo(...this.toPixels(point))));
    if (cut.length) path.closePath();
    return path;
  }

  /** u and v where a pointer meets the plane of a surface; null if it does not. */
  onPlane(surface: Rectangle, event: { clientX: number; clientY: number }): [number, number] | null {
    const box = this.frame.getBoundingClientRect();
    const x = (2 * (event.clientX - box.left)) / box.width - 1;
    const y = 1 - (2 * (event.clientY - box.top)) / box.height;
    const eye = this.camera.position;
    const ahead = new Vector3(x, y, 0.5).unproject(this.camera).sub(eye).normalize();
    const towards = dot(ahead.toArray(), surface.normal);
    const far = dot(surface.origin.map((o, i) => o - eye.toArray()[i]), surface.normal) / towards;
    if (!(far > 0 && far < MAX_DISTANCE)) return null;
    const at = ahead.multiplyScalar(far).add(eye).toArray().map((p, i) => p - surface.origin[i]);
    return [dot(at, surface.u_axis), dot(at, surface.v_axis)];
  }

  private moved(): void {
    if (this.isQuiet) return;
    this.isMoving = true;
    this.split();
    this.paint();
    clearTimeout(this.rest);
    this.rest = window.setTimeout(() => this.onCamera(this.current()), REST_MS);
  }

  private current(): Camera {
    const ahead = this.camera.getWorldDirection(new Vector3()).add(this.camera.position);
    const three = (v: Vector3) => v.toArray().map((x) => Math.round(1e4 * x) / 1e4) as [number, number, number];
    return {
      position: three(this.camera.position),
      target: three(ahead),
      fov_y: (this.camera.fov * Math.PI) / 180,
    };
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.onKey(event)) return event.preventDefault();
    const ahead = this.camera.getWorldDirection(new Vector3());
    const distance = this.controls ? this.controls.target.distanceTo(this.camera.position) : 2.5;
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [KEY_ANGLE, 0],
      ArrowRight: [-KEY_ANGLE, 0],
      ArrowUp: [0, KEY_ANGLE],
      ArrowDown: [0, -KEY_ANGLE],
    };
    if (turns[event.key]) {
      const [about, up] = turns[event.key];
      const side = ahead.clone().cross(this.camera.up).normalize();
      const steep = Math.asin(Math.min(1, Math.max(-1, ahead.y)));
      ahead.applyAxisAngle(this.camera.up, about);
      if (Math.abs(steep + up) < 1.4) ahead.applyAxisAngle(side, up);
    } else if (event.key === "+" || event.key === "=")
      this.camera.position.addScaledVector(ahead, distance * (KEY_DOLLY - 1));
    else if (event.key === "-") this.camera.position.addScaledVector(ahead, -distance * (KEY_DOLLY - 1));
    else if (event.key === "Home") return this.goHome();
    else return;
    event.preventDefault();
    const target = ahead.multiplyScalar(distance).add(this.camera.position);
    this.camera.lookAt(target);
    this.controls?.target.copy(target);
    this.quietly(() => this.controls?.update());
    this.moved();
  }

  private fit(): void {
    const stage = byId("room-stage");
    const width = Math.max(1, Math.min(stage.clientWidth, stage.clientHeight * ASPECT));
    this.frame.style.width = `${width}px`;
    this.frame.style.height = `${width / ASPECT}px`;
    this.renderer?.setPixelRatio(window.devicePixelRatio || 1);
    this.renderer?.setSize(width, width / ASPECT);
    this.paint();
    this.drawMarks();
  }

  private paint(): void {
    this.renderer?.render(this.scene, this.camera);
  }
}

function dispose(group: Group): void {
  group.traverse((thing) => {
    if (!(thing instanceof Mesh)) return;
    thing.geometry.dispose();
    for (const material of [thing.material].flat() as Material[]) {
      for (const value of Object.values(material)) if (value instanceof Texture) value.dispose();
      material.dispose();
    }
  });
}
