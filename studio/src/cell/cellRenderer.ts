// The cell in three dimensions: what the server tells as glTF, with its frames where the motion has them. Metres.

import {
  Box3,
  DirectionalLight,
  GridHelper,
  Group,
  HemisphereLight,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  Object3D,
  PerspectiveCamera,
  Quaternion,
  Vector2,
  Vector3,
  type Material,
} from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import type { StationDocument } from '../api/client';
import type { Frame } from '../lib/kinematics';
import { Handles, type Freedom } from '../scene/handles';
import { SCENE, type Theme } from '../scene/palette';
import { paintGrid, SceneRenderer, type Captions, type RendererEvents } from '../scene/sceneRenderer';

const VIEWS = { home: [-0.75, -1, 0.9], top: [0, -1e-3, 1], front: [0, -1, 0.12], left: [-1, 0, 0.12] } as const;
export type CellView = keyof typeof VIEWS;
/** The views with their titles, in the order of their buttons and keys. */
export const CELL_VIEWS: [CellView, string][] = [['home', 'Fit'], ['top', 'Top'], ['front', 'Front'], ['left', 'Left']];
/** Colours of parts in collision, as checked and where the check is outdated. */
const BROKEN = { checked: [0xd62f1f, 0x8a1208], outdated: [0x8a9099, 0x30343a] } as const;

export interface CellRendererEvents extends RendererEvents {
  /** A part was clicked; none where there is none. */
  picked: (name: string | null) => void;
}

/** The handles of a station as they are made [mm], and how large they are seen at most, however far they are [px]. */
const GIZMO = { radius: 40, seen: 130 } as const;

export class CellRenderer extends SceneRenderer {
  protected readonly unit_mm = 1000;
  readonly #events: CellRendererEvents;
  readonly #eye: PerspectiveCamera;
  readonly #sun = new DirectionalLight(0xffffff, 2);
  readonly #fill = new DirectionalLight(0xdce8ff, 0.9);
  readonly #sky = new HemisphereLight(0xffffff, 0x94a0ac, 1.6);
  readonly #grid = new GridHelper(3, 30);
  // What is in a wall has to be seen in it.
  readonly #broken = new MeshStandardMaterial({ color: BROKEN.checked[0], emissive: BROKEN.checked[1], roughness: 0.6, transparent: true, opacity: 0.7, depthWrite: false });
  readonly #chosen = new MeshStandardMaterial({ color: 0xf0b000, emissive: 0x5a3d00, roughness: 0.6, transparent: true, opacity: 0.55, depthWrite: false });
  #whole: Object3D | null = null;
  #materials = new Map<Mesh, Material | Material[]>();
  /** What moves, by name. */
  #frames = new Map<string, Object3D>();
  /** What belongs to a station, by its name: slots and bodies. */
  #ofStation = new Map<string, Object3D[]>();
  /** Where the frames are while the robot stands at home. */
  #home: Frame[] = [];
  /** The slot that each wafer lies in, by the names of both. */
  #lying: ReadonlyMap<string, string> = new Map();
  #stations: { name: string; at: Vector3 }[] = [];
  #theme: Theme = 'light';
  #placed: readonly Frame[] | null = null;
  /** A station that is dragged, with its slots, its bodies and what lies in it. */
  #nudged: { station: string; slots: Set<string>; group: Group } | null = null;
  #loads = 0;
  /** Whether the camera was placed before there was anything to see. */
  #cameraPlaced = false;
  #marked: { broken: ReadonlySet<string>; chosen: ReadonlySet<string> } = { broken: new Set(), chosen: new Set() };

  constructor(host: HTMLElement, events: CellRendererEvents) {
    const eye = new PerspectiveCamera(32, 1, 0.02, 60);
    eye.up.set(0, 0, 1);
    super(host, eye, '3D view of the cell; its stations, steps and violations are listed in the panels', events);
    this.#eye = eye;
    this.#events = events;
    this.#sun.position.set(1.2, -1.6, 3);
    this.#fill.position.set(-2, 1, 1.4);
    this.#grid.rotation.x = Math.PI / 2;
    this.scene.add(this.#sun, this.#fill, this.#sky, this.#grid);
    let down = new Vector2();
    this.canvas.addEventListener('pointerdown', (event) => (down = new Vector2(event.clientX, event.clientY)));
    this.canvas.addEventListener('click', (event) => {
      if (down.distanceTo(new Vector2(event.clientX, event.clientY)) < 4) this.#pick(event);
    });
    this.measure();
  }

  override dispose(): void {
    this.#drop();
    super.dispose();
  }

  /** Names of the parts that are marked as chosen. */
  get marked(): string[] {
    return this.#wearing(this.#chosen);
  }

  /** Names of the parts that are marked as in contact or in violation. */
  get broken(): string[] {
    return this.#wearing(this.#broken);
  }

  #wearing(mark: Material): string[] {
    return [...new Set([...this.#materials.keys()].filter(({ material }) => material === mark).map((mesh) => nameOf(mesh)))];
  }

  /** Names of all parts that are there. */
  get parts(): string[] {
    return [...new Set([...this.#materials.keys()].map((mesh) => nameOf(mesh)))];
  }

  /** Shows another cell; the eye stays where it is. */
  async load(file: ArrayBuffer, stations: { name: string; position_mm: number[] }[]): Promise<void> {
    const load = ++this.#loads;
    const { scene } = await new GLTFLoader().parseAsync(file, '');
    if (load !== this.#loads) return;
    const first = this.#whole === null;
    this.#drop();
    // The file has y up.
    scene.rotation.x = Math.PI / 2;
    scene.traverse((part) => {
      if (part instanceof Mesh) this.#materials.set(part, part.material as Material);
      const { name } = part.userData as { name?: string };
      // A body may be called as the frame that it is on, which comes first.
      if (name && !this.#frames.has(name)) this.#frames.set(name, part);
      const { station } = part.userData as { station?: string };
      if (station) this.#ofStation.set(station, [...(this.#ofStation.get(station) ?? []), part]);
    });
    this.#whole = scene;
    this.scene.add(scene);
    this.#home = [...this.#frames].map(([name, { position, quaternion }]) => ({ name, origin_m: position.toArray(), quaternion: quaternion.toArray() }));
    this.#stations = stations.map(({ name, position_mm: [x, y, z] }) => ({ name, at: new Vector3(x! / 1000, y! / 1000, z! / 1000 + 0.02) }));
    this.place(this.#placed, this.#lying);
    this.#mark();
    if (first && !this.#cameraPlaced) this.look('home');
  }

  /** Puts the frames where they are at a moment, and notes which wafer lies in which slot; without frames, the robot stands at home. */
  place(frames: readonly Frame[] | null, lying: ReadonlyMap<string, string>): void {
    this.#placed = frames;
    this.#lying = lying;
    for (const { name, origin_m, quaternion } of frames ?? this.#home) {
      const part = this.#frames.get(name);
      part?.position.fromArray(origin_m);
      part?.quaternion.fromArray(quaternion);
    }
    this.#gather();
    this.invalidate();
  }

  /** Where a frame is in the base frame [m]. */
  origin(name: string): number[] | null {
    const part = this.#frames.get(name);
    if (!part) return null;
    this.#whole?.updateMatrixWorld(true);
    return part.getWorldPosition(new Vector3()).toArray();
  }

  /** Marks parts by name: those that break something now, and the one that is chosen. */
  mark(broken: ReadonlySet<string>, chosen: ReadonlySet<string>): void {
    this.#marked = { broken, chosen };
    this.#mark();
    this.invalidate();
  }

  /** Whether the marks of violations are those of an earlier state: they lose their colour. */
  set outdated(outdated: boolean) {
    const [color, emissive] = outdated ? BROKEN.outdated : BROKEN.checked;
    this.#broken.color.setHex(color);
    this.#broken.emissive.setHex(emissive);
    this.invalidate();
  }

  /** The colour of the marks of violations, as hexadecimal digits. */
  get brokenColour(): string {
    return this.#broken.color.getHexString();
  }

  /** Where the camera is and what it looks at [m]. */
  get eyeAndTarget(): { eye: number[]; target: number[] } {
    return { eye: this.#eye.position.toArray(), target: this.controls.target.toArray() };
  }

  set eyeAndTarget({ eye, target }: { eye: number[]; target: number[] }) {
    this.#eye.position.fromArray(eye);
    this.controls.target.fromArray(target);
    this.#cameraPlaced = true;
    this.controls.update();
    this.invalidate();
  }

  /** Handles at a place [m], for the freedoms that there are; none takes them away. */
  hold(at: number[] | null, freedoms: readonly Freedom[]): void {
    if (this.drag) {
      if (at) this.handles?.group.position.fromArray(at);
      this.invalidate();
      return;
    }
    if (this.handles) {
      this.scene.remove(this.handles.group);
      this.handles.dispose();
      this.handles = null;
    }
    if (at && freedoms.length > 0) {
      this.handles = new Handles(GIZMO.radius, freedoms);
      this.handles.group.position.fromArray(at);
      this.#fit();
      this.handles.paint(SCENE[this.#theme].handle, SCENE[this.#theme].handleActive);
      this.scene.add(this.handles.group);
    }
    this.invalidate();
  }

  /** Handles are as large from afar as from near. */
  #fit(): void {
    const group = this.handles?.group;
    if (!group || this.drag) return;
    const perPixel = (2 * Math.tan((this.#eye.fov * Math.PI) / 360) * this.#eye.position.distanceTo(group.position)) / this.size.height;
    group.scale.setScalar((perPixel * Math.min(GIZMO.seen, 0.26 * this.size.height)) / (GIZMO.radius + 62));
  }

  /** Where a handle is seen, in the page [px]. */
  grip(freedom: Freedom): { x: number; y: number } | null {
    this.scene.updateMatrixWorld();
    const at = this.handles?.grip(freedom)?.project(this.#eye);
    const box = this.canvas.getBoundingClientRect();
    return at ? { x: box.left + ((at.x + 1) / 2) * box.width, y: box.top + ((1 - at.y) / 2) * box.height } : null;
  }

  /** Shows a station elsewhere than it is, its slots and bodies with what lies in them, until the server says where they are. */
  nudge(from: StationDocument, to: StationDocument): void {
    if (this.#nudged?.station !== from.name) {
      this.unnudge();
      const group = new Group();
      this.#base?.add(group);
      const slots = Array.from({ length: from.slots }, (_, k) => `${from.name} ${k + 1}`);
      this.#nudged = { station: from.name, slots: new Set(slots), group };
      for (const part of this.#ofStation.get(from.name) ?? []) this.#regroup(part, true);
      this.#gather();
    }
    const { position, quaternion, scale } = this.#nudged!.group;
    frameOf(to).multiply(frameOf(from).invert()).decompose(position, quaternion, scale);
    this.invalidate();
  }

  /** Takes back what was nudged. */
  unnudge(): void {
    if (!this.#nudged) return;
    const { group } = this.#nudged;
    for (const part of [...group.children]) this.#regroup(part, false);
    group.removeFromParent();
    this.#nudged = null;
    this.invalidate();
  }

  /** What everything of the base frame hangs on. */
  get #base(): Object3D | null {
    return this.#whole?.children[0] ?? null;
  }

  /** Lets a part go with the station that is dragged, or stay with the base again. */
  #regroup(part: Object3D, along: boolean): void {
    const parent = along ? this.#nudged?.group : this.#base;
    if (parent && part.parent !== parent) parent.add(part);
  }

  /** Wafers that lie in the station that is dragged, now, go with it. */
  #gather(): void {
    if (!this.#nudged) return;
    const { slots } = this.#nudged;
    for (const [name, slot] of this.#lying) {
      const part = this.#frames.get(name);
      if (part) this.#regroup(part, slots.has(slot));
    }
  }

  paint(theme: Theme): void {
    this.#theme = theme;
    const colours = SCENE[theme];
    this.handles?.paint(colours.handle, colours.handleActive);
    paintGrid(this.#grid, colours.grid);
    this.#sun.intensity = 2 * colours.light;
    this.#sky.intensity = 1.6 * colours.light;
    this.invalidate();
  }

  look(view: CellView): void {
    const box = this.#whole ? new Box3().setFromObject(this.#whole) : new Box3();
    if (box.isEmpty()) box.set(new Vector3(-0.8, -0.8, 0), new Vector3(0.8, 0.8, 1));
    const center = box.getCenter(new Vector3());
    const reach = box.getSize(new Vector3()).length() / 2;
    const [x, y, z] = VIEWS[view];
    const way = new Vector3(x, y, z).normalize();
    const aspect = Math.min(this.#eye.aspect, 1);
    const distance = (0.82 * reach) / Math.sin((this.#eye.fov * Math.PI) / 360) / aspect;
    this.controls.target.copy(center);
    this.#eye.position.copy(center).addScaledVector(way, distance);
    this.controls.update();
    this.invalidate();
  }

  #mark(): void {
    const { broken, chosen } = this.#marked;
    for (const [mesh, own] of this.#materials) {
      const name = nameOf(mesh);
      const frame = (mesh.parent?.userData as { name?: string } | undefined)?.name ?? '';
      mesh.material = broken.has(name) ? this.#broken : chosen.has(name) || chosen.has(frame) ? this.#chosen : own;
    }
  }

  #drop(): void {
    for (const [mesh, own] of this.#materials) {
      mesh.geometry.dispose();
      for (const one of [own].flat()) one.dispose();
    }
    this.#materials = new Map();
    this.#frames = new Map();
    this.#ofStation = new Map();
    this.#nudged = null;
    if (this.#whole) this.scene.remove(this.#whole);
    this.#whole = null;
  }

  protected resized(): void {
    this.#eye.aspect = this.size.width / this.size.height;
    this.#eye.updateProjectionMatrix();
  }

  protected compose(): Captions | null {
    if (!this.#whole) return null;
    this.#fit();
    const labels = this.#stations.map(({ name, at }) => ({ at: this.#shownAt(name, at), text: name, strong: true }));
    return { labels, covered: { left: 8, right: 8 }, theme: this.#theme };
  }

  /** Where the name of a station stands: with the station while it is dragged. */
  #shownAt(station: string, at: Vector3): Vector3 {
    if (this.#nudged?.station !== station) return at;
    const { group } = this.#nudged;
    return at.clone().applyQuaternion(group.quaternion).add(group.position);
  }

  #pick(event: MouseEvent): void {
    if (!this.#whole || this.handles?.hit(this.ray(event))) return;
    const ray = this.ray(event);
    const hit = ray.intersectObject(this.#whole, true)[0];
    this.#events.picked(hit ? nameOf(hit.object) : null);
  }
}

/** What the server calls a part; the loader changes names that it does not like. */
function nameOf(part: Object3D): string {
  for (let at: Object3D | null = part; at; at = at.parent) {
    const name = (at.userData as { name?: string }).name;
    // All wafers have one shape; which one it is, the frame that it moves with says.
    if (name && name !== 'wafer') return name;
  }
  return '';
}

/** Where a station's frame is [m]: turned by its yaw, then leaning. */
function frameOf({ position_mm, yaw_rad, about_x_rad, about_y_rad }: StationDocument): Matrix4 {
  const lean = new Vector3(about_x_rad, about_y_rad, 0);
  const leaning = new Quaternion().setFromAxisAngle(lean.clone().normalize(), lean.length());
  const turned = new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), yaw_rad);
  return new Matrix4().compose(new Vector3().fromArray(position_mm).divideScalar(1000), leaning.multiply(turned), new Vector3(1, 1, 1));
}
