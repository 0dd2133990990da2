// The cell in three dimensions: what the server tells as glTF, at any time of its one animation. Metres.

import {
  AnimationMixer,
  Box3,
  Color,
  DirectionalLight,
  Euler,
  GridHelper,
  HemisphereLight,
  Mesh,
  MeshStandardMaterial,
  Object3D,
  PerspectiveCamera,
  Quaternion,
  Raycaster,
  Scene,
  SRGBColorSpace,
  Vector2,
  Vector3,
  WebGLRenderer,
  type LineBasicMaterial,
  type Material,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import type { JogDocument } from '../api/client';
import { ATTRIBUTES, takeGraphics } from '../lib/graphics';
import { Handles, SAYS, type Freedom } from '../scene/handles';
import { paintLabels, type Label } from '../scene/labels';
import { SCENE, type Theme } from '../scene/palette';

const VIEWS = { home: [-0.75, -1, 0.9], top: [0, -1e-3, 1], front: [0, -1, 0.12], left: [-1, 0, 0.12] } as const;
export type CellView = keyof typeof VIEWS;

type Frame = JogDocument['frames'][number];

export interface CellViewerEvents {
  /** A part was clicked; none where there is none. */
  picked: (name: string | null) => void;
  drawn: (took_ms: number) => void;
  /** The chosen station is dragged by a handle: by how much since the drag began, mm or degrees; then that it ended. */
  dragStart: (freedom: Freedom) => void;
  drag: (freedom: Freedom, by: number) => void;
  dragEnd: (taken: boolean) => void;
}

/** The handles of a station as they are made [mm], and how large they are seen at most, however far they are [px]. */
const GIZMO = { radius: 40, seen: 130 } as const;

export class CellViewer {
  readonly #host: HTMLElement;
  readonly #events: CellViewerEvents;
  readonly #renderer = new WebGLRenderer({ ...ATTRIBUTES, ...takeGraphics() });
  readonly #labelCanvas = document.createElement('canvas');
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(32, 1, 0.02, 60);
  readonly #controls: OrbitControls;
  readonly #sun = new DirectionalLight(0xffffff, 2);
  readonly #fill = new DirectionalLight(0xdce8ff, 0.9);
  readonly #sky = new HemisphereLight(0xffffff, 0x94a0ac, 1.6);
  readonly #grid = new GridHelper(3, 30);
  readonly #observer: ResizeObserver;
  readonly #broken = new MeshStandardMaterial({ color: 0xd62f1f, emissive: 0x8a1208, roughness: 0.6 });
  readonly #chosen = new MeshStandardMaterial({ color: 0xf0b000, emissive: 0x5a3d00, roughness: 0.6, transparent: true, opacity: 0.55, depthWrite: false });
  #whole: Object3D | null = null;
  #mixer: AnimationMixer | null = null;
  #duration = 0;
  #time = 0;
  #materials = new Map<Mesh, Material | Material[]>();
  /** What moves, by name. */
  #frames = new Map<string, Object3D>();
  /** Where the frames were before the robot was moved by hand. */
  #before: Map<Object3D, { place: Vector3; turn: Quaternion }> | null = null;
  #stations: { name: string; at: Vector3 }[] = [];
  #labels: Label[] = [];
  #theme: Theme = 'light';
  #size = { width: 1, height: 1 };
  #posed: Frame[] | null = null;
  readonly #nudged = new Map<Object3D, { place: Vector3; turn: Quaternion }>();
  #asked = 0;
  #loads = 0;
  #handles: Handles | null = null;
  #drag: { freedom: Freedom; start: Vector2 } | null = null;
  #marked: { broken: ReadonlySet<string>; chosen: ReadonlySet<string> } = { broken: new Set(), chosen: new Set() };

  constructor(host: HTMLElement, events: CellViewerEvents) {
    this.#host = host;
    this.#events = events;
    this.#renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.#renderer.outputColorSpace = SRGBColorSpace;
    this.#renderer.debug.checkShaderErrors = import.meta.env.DEV;
    const canvas = this.#renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', 'The cell in three dimensions; its stations, steps and violations are told in the panels beside it');
    this.#labelCanvas.className = 'labels';
    host.append(canvas, this.#labelCanvas);
    this.#camera.up.set(0, 0, 1);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enableDamping = false;
    this.#controls.zoomToCursor = true;
    this.#controls.addEventListener('change', () => this.invalidate());
    this.#sun.position.set(1.2, -1.6, 3);
    this.#fill.position.set(-2, 1, 1.4);
    this.#grid.rotation.x = Math.PI / 2;
    this.#scene.add(this.#sun, this.#fill, this.#sky, this.#grid);
    // Before the camera's own handlers: a drag of a handle turns no camera.
    canvas.addEventListener('pointerdown', (event) => this.#grab(event), { capture: true });
    canvas.addEventListener('pointermove', (event) => this.#pull(event));
    let down = new Vector2();
    canvas.addEventListener('pointerdown', (event) => (down = new Vector2(event.clientX, event.clientY)));
    canvas.addEventListener('click', (event) => {
      if (down.distanceTo(new Vector2(event.clientX, event.clientY)) < 4) this.#pick(event);
    });
    this.#observer = new ResizeObserver(() => this.#resize());
    this.#observer.observe(host);
    this.#resize();
  }

  dispose(): void {
    this.#observer.disconnect();
    cancelAnimationFrame(this.#asked);
    this.#controls.dispose();
    this.#drop();
    this.#renderer.dispose();
    this.#host.replaceChildren();
  }

  get canvas(): HTMLCanvasElement {
    return this.#renderer.domElement;
  }

  /** Names of the parts that are marked as chosen. */
  get marked(): string[] {
    return [...new Set([...this.#materials.keys()].filter(({ material }) => material === this.#chosen).map((mesh) => nameOf(mesh)))];
  }

  /** Names of all parts that are there. */
  get parts(): string[] {
    return [...new Set([...this.#materials.keys()].map((mesh) => nameOf(mesh)))];
  }

  /** Shows another cell or another motion of it; the eye stays where it is. */
  async load(file: ArrayBuffer, stations: { name: string; position_mm: number[] }[]): Promise<void> {
    const load = ++this.#loads;
    const { scene, animations } = await new GLTFLoader().parseAsync(file, '');
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
    });
    this.#whole = scene;
    this.#scene.add(scene);
    const [motion] = animations;
    this.#mixer = motion ? new AnimationMixer(scene) : null;
    this.#duration = motion?.duration ?? 0;
    if (motion) this.#mixer?.clipAction(motion).play();
    this.#stations = stations.map(({ name, position_mm: [x, y, z] }) => ({ name, at: new Vector3(x! / 1000, y! / 1000, z! / 1000 + 0.02) }));
    this.at(this.#time);
    this.#mark();
    if (this.#posed) this.#place(this.#posed);
    if (first) this.look('home');
  }

  /** Shows a moment of the motion [s]. */
  at(time: number): void {
    this.#time = time;
    if (this.#before) return;
    // At its very end an animation begins anew.
    this.#mixer?.setTime(Math.min(Math.max(time, 0), Math.max(this.#duration - 1e-6, 0)));
    this.invalidate();
  }

  /** Shows the robot moved by hand, with what it carries; `null` gives it back to the motion. */
  pose(frames: Frame[] | null): void {
    this.#posed = frames;
    if (frames) this.#place(frames);
    else if (this.#before) {
      for (const [part, { place, turn }] of this.#before) {
        part.position.copy(place);
        part.quaternion.copy(turn);
      }
      this.#before = null;
      this.at(this.#time);
    }
    this.invalidate();
  }

  /** Where a frame is in the base frame [m]. */
  origin(name: string): number[] | null {
    const part = this.#frames.get(name);
    if (!part) return null;
    this.#whole?.updateMatrixWorld(true);
    return part.getWorldPosition(new Vector3()).toArray();
  }

  #place(frames: Frame[]): void {
    if (!this.#before) {
      this.#before = new Map();
      for (const part of this.#frames.values()) this.#before.set(part, { place: part.position.clone(), turn: part.quaternion.clone() });
    }
    for (const { name, origin_m, quaternion } of frames) {
      const part = this.#frames.get(name);
      part?.position.fromArray(origin_m);
      part?.quaternion.fromArray(quaternion);
    }
    this.invalidate();
  }

  /** Marks parts by name: those that break something now, and the one that is chosen. */
  mark(broken: ReadonlySet<string>, chosen: ReadonlySet<string>): void {
    this.#marked = { broken, chosen };
    this.#mark();
    this.invalidate();
  }

  /** Handles at a place [m], for the freedoms that there are; none takes them away. */
  hold(at: number[] | null, freedoms: readonly Freedom[]): void {
    if (this.#drag) {
      if (at) this.#handles?.group.position.fromArray(at);
      this.invalidate();
      return;
    }
    if (this.#handles) {
      this.#scene.remove(this.#handles.group);
      this.#handles.dispose();
      this.#handles = null;
    }
    if (at && freedoms.length > 0) {
      this.#handles = new Handles(GIZMO.radius, freedoms);
      this.#handles.group.position.fromArray(at);
      this.#fit();
      this.#handles.paint(SCENE[this.#theme].handle, SCENE[this.#theme].handleActive);
      this.#scene.add(this.#handles.group);
    }
    this.invalidate();
  }

  /** Handles are as large from afar as from near. */
  #fit(): void {
    const group = this.#handles?.group;
    if (!group || this.#drag) return;
    const perPixel = (2 * Math.tan((this.#camera.fov * Math.PI) / 360) * this.#camera.position.distanceTo(group.position)) / this.#size.height;
    group.scale.setScalar((perPixel * Math.min(GIZMO.seen, 0.26 * this.#size.height)) / (GIZMO.radius + 62));
  }

  /** Where a handle is seen, in the page [px]. */
  grip(freedom: Freedom): { x: number; y: number } | null {
    this.#scene.updateMatrixWorld();
    const at = this.#handles?.grip(freedom)?.project(this.#camera);
    const box = this.canvas.getBoundingClientRect();
    return at ? { x: box.left + ((at.x + 1) / 2) * box.width, y: box.top + ((1 - at.y) / 2) * box.height } : null;
  }

  /** Shows the slots of a station moved and turned about its place, until the server says where they are. */
  nudge(station: string, slots: number, from: number[], by: number[], turn: { x: number; y: number; z: number }): void {
    const center = new Vector3().fromArray(from);
    const moved = new Vector3().fromArray(by);
    const turned = new Quaternion().setFromEuler(new Euler(turn.x, turn.y, turn.z));
    for (let slot = 1; slot <= slots; slot++) {
      const part = this.#frames.get(`${station} ${slot}`);
      if (!part) continue;
      const was = this.#nudged.get(part) ?? { place: part.position.clone(), turn: part.quaternion.clone() };
      this.#nudged.set(part, was);
      part.position.copy(was.place).sub(center).applyQuaternion(turned).add(center).add(moved);
      part.quaternion.copy(turned).multiply(was.turn);
    }
    this.invalidate();
  }

  /** Takes back what was nudged. */
  unnudge(): void {
    for (const [part, { place, turn }] of this.#nudged) {
      part.position.copy(place);
      part.quaternion.copy(turn);
    }
    this.#nudged.clear();
    this.invalidate();
  }

  paint(theme: Theme): void {
    this.#theme = theme;
    const colours = SCENE[theme];
    this.#handles?.paint(colours.handle, colours.handleActive);
    const grid = this.#grid.material as LineBasicMaterial;
    grid.vertexColors = false;
    grid.color = new Color(colours.grid);
    grid.needsUpdate = true;
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
    const aspect = Math.min(this.#camera.aspect, 1);
    const distance = (0.82 * reach) / Math.sin((this.#camera.fov * Math.PI) / 360) / aspect;
    this.#controls.target.copy(center);
    this.#camera.position.copy(center).addScaledVector(way, distance);
    this.#controls.update();
    this.invalidate();
  }

  invalidate(): void {
    if (!this.#asked) this.#asked = requestAnimationFrame(() => this.#render());
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
    this.#mixer?.stopAllAction();
    this.#mixer = null;
    for (const [mesh, own] of this.#materials) {
      mesh.geometry.dispose();
      for (const one of [own].flat()) one.dispose();
    }
    this.#materials = new Map();
    this.#frames = new Map();
    this.#before = null;
    this.#nudged.clear();
    if (this.#whole) this.#scene.remove(this.#whole);
    this.#whole = null;
  }

  #resize(): void {
    const { width, height } = this.#host.getBoundingClientRect();
    if (width < 2 || height < 2) return;
    this.#size = { width, height };
    this.#renderer.setSize(width, height);
    const ratio = this.#renderer.getPixelRatio();
    this.#labelCanvas.width = Math.round(width * ratio);
    this.#labelCanvas.height = Math.round(height * ratio);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    cancelAnimationFrame(this.#asked);
    this.#render();
  }

  #render(): void {
    this.#asked = 0;
    const start = performance.now();
    this.#fit();
    this.#renderer.render(this.#scene, this.#camera);
    const context = this.#labelCanvas.getContext('2d');
    if (context) {
      const ratio = this.#renderer.getPixelRatio();
      const { ink, background } = SCENE[this.#theme];
      this.#labels = this.#stations.map(({ name, at }) => ({ at, text: name, strong: true }));
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, this.#size.width, this.#size.height);
      paintLabels(context, this.#labels, this.#camera, this.#size, { left: 8, right: 8 }, { text: ink, halo: background });
    }
    this.#events.drawn(performance.now() - start);
  }

  #ray(event: MouseEvent): Raycaster {
    const box = this.canvas.getBoundingClientRect();
    const ray = new Raycaster();
    ray.setFromCamera(
      new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2),
      this.#camera,
    );
    return ray;
  }

  #grab(event: PointerEvent): void {
    const freedom = event.button === 0 ? this.#handles?.hit(this.#ray(event)) : null;
    if (!freedom) return;
    event.stopImmediatePropagation();
    this.#drag = { freedom, start: new Vector2(event.clientX, event.clientY) };
    this.canvas.setPointerCapture(event.pointerId);
    this.#events.dragStart(freedom);
    const end = (ended: Event) => {
      this.#drag = null;
      this.canvas.removeEventListener('pointerup', end);
      this.canvas.removeEventListener('pointercancel', end);
      this.#events.dragEnd(ended.type === 'pointerup');
    };
    this.canvas.addEventListener('pointerup', end);
    this.canvas.addEventListener('pointercancel', end);
  }

  #pull(event: PointerEvent): void {
    if (!this.#handles) return;
    if (this.#drag) {
      const moved = new Vector2(event.clientX, event.clientY).sub(this.#drag.start);
      const { freedom } = this.#drag;
      const by = this.#handles.change(freedom, moved, this.#camera, this.#size);
      const isLength = freedom === 'x' || freedom === 'y' || freedom === 'height';
      this.#events.drag(freedom, isLength ? by * this.#handles.group.scale.x * 1000 : by);
      return;
    }
    if (event.buttons !== 0) return;
    const hot = this.#handles.hit(this.#ray(event));
    this.canvas.style.cursor = hot ? 'grab' : '';
    this.canvas.title = hot ? `Drag: ${SAYS[hot]}` : '';
    if (this.#handles.heat(hot)) this.invalidate();
  }

  #pick(event: MouseEvent): void {
    if (!this.#whole || this.#handles?.hit(this.#ray(event))) return;
    const ray = this.#ray(event);
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
