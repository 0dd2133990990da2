// The cell in three dimensions: what the server tells as glTF, at any time of its one animation. Metres.

import {
  AnimationMixer,
  Box3,
  Color,
  DirectionalLight,
  GridHelper,
  HemisphereLight,
  Mesh,
  MeshStandardMaterial,
  Object3D,
  PerspectiveCamera,
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
import { paintLabels, type Label } from '../scene/labels';
import { SCENE, type Theme } from '../scene/palette';

const VIEWS = { home: [-0.75, -1, 0.9], top: [0, -1e-3, 1], front: [0, -1, 0.12], left: [-1, 0, 0.12] } as const;
export type CellView = keyof typeof VIEWS;

export interface CellViewerEvents {
  /** A part was clicked; none where there is none. */
  picked: (name: string | null) => void;
  drawn: (took_ms: number) => void;
}

export class CellViewer {
  readonly #host: HTMLElement;
  readonly #events: CellViewerEvents;
  readonly #renderer = new WebGLRenderer({ antialias: true, alpha: true });
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
  readonly #chosen = new MeshStandardMaterial({ color: 0xf0b000, emissive: 0x5a3d00, roughness: 0.6 });
  #whole: Object3D | null = null;
  #mixer: AnimationMixer | null = null;
  #duration = 0;
  #time = 0;
  #materials = new Map<Mesh, Material | Material[]>();
  #stations: { name: string; at: Vector3 }[] = [];
  #labels: Label[] = [];
  #theme: Theme = 'light';
  #size = { width: 1, height: 1 };
  #asked = 0;
  #loads = 0;
  #marked: { broken: ReadonlySet<string>; chosen: string | null } = { broken: new Set(), chosen: null };

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
    if (first) this.look('home');
  }

  /** Shows a moment of the motion [s]. */
  at(time: number): void {
    this.#time = time;
    // At its very end an animation begins anew.
    this.#mixer?.setTime(Math.min(Math.max(time, 0), Math.max(this.#duration - 1e-6, 0)));
    this.invalidate();
  }

  /** Marks parts by name: those that break something now, and the one that is chosen. */
  mark(broken: ReadonlySet<string>, chosen: string | null): void {
    this.#marked = { broken, chosen };
    this.#mark();
    this.invalidate();
  }

  paint(theme: Theme): void {
    this.#theme = theme;
    const colours = SCENE[theme];
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
      mesh.material = broken.has(name) ? this.#broken : name === chosen ? this.#chosen : own;
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

  #pick(event: MouseEvent): void {
    if (!this.#whole) return;
    const box = this.canvas.getBoundingClientRect();
    const ray = new Raycaster();
    ray.setFromCamera(
      new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2),
      this.#camera,
    );
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
