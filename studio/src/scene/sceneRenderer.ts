// Common base of all 3D views: canvas, labels, lights, grid, camera controls, drag handles, picking.
// A frame is rendered only after a change.

import {
  Color,
  Vector3,
  DirectionalLight,
  GridHelper,
  HemisphereLight,
  Raycaster,
  Scene,
  Vector2,
  WebGLRenderer,
  type Box3,
  type Intersection,
  type LineBasicMaterial,
  type Object3D,
  type OrthographicCamera,
  type PerspectiveCamera,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { DESCRIPTIONS, type Freedom, type Handles } from './handles';
import { paintLabels, type Label } from './labels';
import { SCENE, type Theme } from './palette';
import { CONTEXT_ATTRIBUTES, takeContext } from './webgl';

export type Camera = PerspectiveCamera | OrthographicCamera;

export interface RendererEvents {
  /** A drag of a handle has begun. */
  dragStart: (freedom: Freedom) => void;
  /** The displacement since the start of the drag has changed [mm or degrees]. */
  drag: (freedom: Freedom, displacement: number) => void;
  /** The drag has ended, and is accepted or cancelled. */
  dragEnd: (accepted: boolean) => void;
  /** A frame has been rendered, with the time that it took [ms]. */
  rendered: (took_ms: number) => void;
}

/** Labels of a frame, and the widths at its left and right that are covered by other elements [px]. */
export interface Overlay {
  labels: Label[];
  covered: { left: number; right: number };
}

/** What differs between the scenes of the views. */
export interface SceneOptions {
  camera: Camera;
  /** Description of the view for screen readers. */
  description: string;
  /** Length of a unit of the scene [mm]. */
  unit_mm: number;
  /** Intensity and position of the key light and the fill light, and the intensity of the sky. */
  lights: { key: Light; fill: Light; sky: number };
  /** Edge length and number of divisions of the ground grid. */
  grid: { size: number; divisions: number };
}

interface Light {
  intensity: number;
  position: [number, number, number];
}

/** Pointer movement up to which a click is a click and not a drag [px]. */
const CLICK_DISTANCE = 4;

export abstract class SceneRenderer {
  protected readonly renderer = new WebGLRenderer({ ...CONTEXT_ATTRIBUTES, ...takeContext() });
  protected readonly scene = new Scene();
  protected readonly controls: OrbitControls;
  protected readonly labelCanvas = document.createElement('canvas');
  protected readonly keyLight: DirectionalLight;
  protected readonly grid: GridHelper;
  protected camera: Camera;
  protected size = { width: 1, height: 1 };
  protected theme: Theme = 'light';
  readonly #host: HTMLElement;
  readonly #events: RendererEvents;
  readonly #options: SceneOptions;
  readonly #fillLight: DirectionalLight;
  readonly #sky: HemisphereLight;
  readonly #observer: ResizeObserver;
  #handles: Handles | null = null;
  #drag: { freedom: Freedom; start: Vector2 } | null = null;
  #pointerDown = new Vector2();
  #frame = 0;

  constructor(host: HTMLElement, options: SceneOptions, events: RendererEvents) {
    this.#host = host;
    this.#options = options;
    this.#events = events;
    this.camera = options.camera;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    // Checking each shader for errors blocks until it is compiled.
    this.renderer.debug.checkShaderErrors = import.meta.env.DEV;
    const { canvas } = this;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', options.description);
    this.labelCanvas.className = 'labels';
    host.append(canvas, this.labelCanvas);
    const { key, fill, sky } = options.lights;
    this.keyLight = new DirectionalLight(0xffffff, key.intensity);
    this.keyLight.position.set(...key.position);
    this.#fillLight = new DirectionalLight(0xdce8ff, fill.intensity);
    this.#fillLight.position.set(...fill.position);
    this.#sky = new HemisphereLight(0xffffff, 0x94a0ac, sky);
    this.grid = new GridHelper(options.grid.size, options.grid.divisions);
    // GridHelper lies in the plane y = 0; here z is up.
    this.grid.rotation.x = Math.PI / 2;
    this.scene.add(this.keyLight, this.keyLight.target, this.#fillLight, this.#sky, this.grid);
    this.controls = new OrbitControls(options.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.invalidate());
    // Registered for the capture phase: a drag of a handle must not reach the camera controls.
    canvas.addEventListener('pointerdown', (event) => this.#grab(event), { capture: true });
    canvas.addEventListener('pointermove', (event) => this.#pointerMove(event));
    this.#observer = new ResizeObserver(() => this.measure());
    this.#observer.observe(host);
  }

  dispose(): void {
    this.#observer.disconnect();
    cancelAnimationFrame(this.#frame);
    this.setHandles(null);
    this.controls.dispose();
    this.renderer.dispose();
    this.#host.replaceChildren();
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** Adapts the camera to a new size of the view. */
  protected abstract resized(): void;
  /** Updates the scene before a frame; `null` while there is nothing to render. */
  protected abstract update(): Overlay | null;
  /** Called after each frame, with labels. */
  protected frameRendered(): void {}

  /** Requests a frame. */
  invalidate(): void {
    if (!this.#frame) this.#frame = requestAnimationFrame(() => this.render());
  }

  /** Takes over the size of the host element; to be called at the end of the constructor of a subclass. */
  protected measure(): void {
    const { width, height } = this.#host.getBoundingClientRect();
    if (width < 2 || height < 2 || (width === this.size.width && height === this.size.height)) return;
    this.size = { width, height };
    this.renderer.setSize(width, height);
    const ratio = this.renderer.getPixelRatio();
    this.labelCanvas.width = Math.round(width * ratio);
    this.labelCanvas.height = Math.round(height * ratio);
    this.resized();
    // Resizing clears the canvas.
    cancelAnimationFrame(this.#frame);
    this.render();
  }

  /** Moves a camera so that it sees a box from a direction. */
  protected lookAtBox(camera: PerspectiveCamera, box: Box3, direction: Vector3): void {
    const center = box.getCenter(new Vector3());
    const reach = box.getSize(new Vector3()).length() / 2;
    const aspect = Math.min(camera.aspect, 1);
    const distance = (0.82 * reach) / Math.sin((camera.fov * Math.PI) / 360) / aspect;
    this.controls.target.copy(center);
    camera.position.copy(center).addScaledVector(direction.clone().normalize(), distance);
    this.controls.update();
    this.invalidate();
  }

  protected render(): void {
    this.#frame = 0;
    const start = performance.now();
    const overlay = this.update();
    if (!overlay) return;
    this.renderer.render(this.scene, this.camera);
    const context = this.labelCanvas.getContext('2d');
    if (context) {
      const ratio = this.renderer.getPixelRatio();
      const { ink, background } = SCENE[this.theme];
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, this.size.width, this.size.height);
      paintLabels(context, overlay.labels, this.camera, this.size, overlay.covered, { text: ink, halo: background });
    }
    this.frameRendered();
    this.#events.rendered(performance.now() - start);
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    const colours = SCENE[theme];
    const { key, fill, sky } = this.#options.lights;
    this.keyLight.intensity = key.intensity * colours.light;
    this.#fillLight.intensity = fill.intensity * colours.light;
    this.#sky.intensity = sky * colours.light;
    this.#handles?.paint(colours.handle, colours.handleActive);
    const material = this.grid.material as LineBasicMaterial;
    material.vertexColors = false;
    material.color = new Color(colours.grid);
    material.needsUpdate = true;
    this.invalidate();
  }

  // Drag handles

  protected get handles(): Handles | null {
    return this.#handles;
  }

  /** Whether a handle is being dragged. */
  protected get dragging(): boolean {
    return this.#drag !== null;
  }

  /** Replaces the drag handles. */
  protected setHandles(handles: Handles | null): void {
    if (this.#handles) {
      this.scene.remove(this.#handles.group);
      this.#handles.dispose();
    }
    this.#handles = handles;
    if (!handles) return;
    handles.paint(SCENE[this.theme].handle, SCENE[this.theme].handleActive);
    this.scene.add(handles.group);
  }

  #grab(event: PointerEvent): void {
    this.#pointerDown.set(event.clientX, event.clientY);
    const freedom = event.button === 0 ? this.#handles?.pick(this.#ray(event)) : null;
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

  #pointerMove(event: PointerEvent): void {
    if (!this.#handles) return;
    if (this.#drag) {
      const { freedom, start } = this.#drag;
      const moved = new Vector2(event.clientX, event.clientY).sub(start);
      this.#events.drag(freedom, this.#handles.displacement(freedom, moved, this.camera, this.size, this.#options.unit_mm));
      return;
    }
    if (event.buttons !== 0) return;
    const hovered = this.#handles.pick(this.#ray(event));
    this.canvas.style.cursor = hovered ? 'grab' : '';
    this.canvas.title = hovered ? `Drag: ${DESCRIPTIONS[hovered]}` : '';
    if (this.#handles.highlight(hovered)) this.invalidate();
  }

  // Picking

  /** The first intersection of the ray through the pointer with an object; `null` if there is none. */
  protected intersection(event: MouseEvent, object: Object3D): Intersection | null {
    return this.#ray(event).intersectObject(object, true)[0] ?? null;
  }

  /** Whether a click is the end of a drag of the view, or hits a handle. */
  protected isDragOrHandle(event: MouseEvent): boolean {
    const moved = this.#pointerDown.distanceTo(new Vector2(event.clientX, event.clientY));
    return moved >= CLICK_DISTANCE || Boolean(this.#handles?.pick(this.#ray(event)));
  }

  #ray(event: MouseEvent): Raycaster {
    const box = this.canvas.getBoundingClientRect();
    const pointer = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(pointer, this.camera);
    return ray;
  }
}
