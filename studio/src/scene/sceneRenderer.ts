// What all pictures in three dimensions have in common: a canvas with labels over it, drawn when something has changed and only then; an eye that the pointer turns; handles that it drags.

import {
  Color,
  Raycaster,
  Scene,
  Vector2,
  WebGLRenderer,
  type GridHelper,
  type LineBasicMaterial,
  type OrthographicCamera,
  type PerspectiveCamera,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { ATTRIBUTES, takeContext } from './webgl';
import { SAYS, type Freedom, type Handles } from './handles';
import { paintLabels, type Label } from './labels';
import { SCENE, type Theme } from './palette';

export type Camera = PerspectiveCamera | OrthographicCamera;

export interface RendererEvents {
  /** Something is dragged by a handle: by how much since the drag began, mm or degrees; then that it ended, and whether it is to be taken. */
  drag: (freedom: Freedom, by: number) => void;
  dragStart: (freedom: Freedom) => void;
  dragEnd: (taken: boolean) => void;
  /** A picture has been drawn, in so many milliseconds of this thread. */
  drawn: (took_ms: number) => void;
}

/** What is written over a picture, and how much of its width lies under something else [px]. */
export interface Captions {
  labels: Label[];
  covered: { left: number; right: number };
  theme: Theme;
}

export abstract class SceneRenderer {
  protected readonly renderer = new WebGLRenderer({ ...ATTRIBUTES, ...takeContext() });
  protected readonly scene = new Scene();
  protected readonly controls: OrbitControls;
  protected readonly labelCanvas = document.createElement('canvas');
  protected camera: Camera;
  protected size = { width: 1, height: 1 };
  protected handles: Handles | null = null;
  protected drag: { freedom: Freedom; start: Vector2 } | null = null;
  /** How long a unit of the scene is [mm]. */
  protected abstract readonly unit_mm: number;

  readonly #host: HTMLElement;
  readonly #events: RendererEvents;
  readonly #observer: ResizeObserver;
  #asked = 0;

  constructor(host: HTMLElement, camera: Camera, says: string, events: RendererEvents) {
    this.#host = host;
    this.#events = events;
    this.camera = camera;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    // Asking each shader for its faults waits until it is built.
    this.renderer.debug.checkShaderErrors = import.meta.env.DEV;
    const { canvas } = this;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', says);
    this.labelCanvas.className = 'labels';
    host.append(canvas, this.labelCanvas);
    this.controls = new OrbitControls(camera, canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.invalidate());
    // Before the eye's own handlers: a drag of a handle does not turn it.
    canvas.addEventListener('pointerdown', (event) => this.#grab(event), { capture: true });
    canvas.addEventListener('pointermove', (event) => this.#pull(event));
    this.#observer = new ResizeObserver(() => this.measure());
    this.#observer.observe(host);
  }

  dispose(): void {
    this.#observer.disconnect();
    cancelAnimationFrame(this.#asked);
    this.controls.dispose();
    this.renderer.dispose();
    this.#host.replaceChildren();
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** The size is another one: the camera has to know. */
  protected abstract resized(): void;

  /** Makes all ready to be drawn; none while there is nothing to see. */
  protected abstract compose(): Captions | null;

  /** A picture is whole, labels and all. */
  protected finished(): void {}

  invalidate(): void {
    if (!this.#asked) this.#asked = requestAnimationFrame(() => this.render());
  }

  /** Takes the size that there is; to be called when all is made. */
  protected measure(): void {
    const { width, height } = this.#host.getBoundingClientRect();
    if (width < 2 || height < 2 || (width === this.size.width && height === this.size.height)) return;
    this.size = { width, height };
    this.renderer.setSize(width, height);
    const ratio = this.renderer.getPixelRatio();
    this.labelCanvas.width = Math.round(width * ratio);
    this.labelCanvas.height = Math.round(height * ratio);
    this.resized();
    // A canvas that was resized is empty until it is drawn.
    cancelAnimationFrame(this.#asked);
    this.render();
  }

  protected render(): void {
    this.#asked = 0;
    const start = performance.now();
    const captions = this.compose();
    if (!captions) return;
    this.renderer.render(this.scene, this.camera);
    const context = this.labelCanvas.getContext('2d');
    if (context) {
      const ratio = this.renderer.getPixelRatio();
      const { ink, background } = SCENE[captions.theme];
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, this.size.width, this.size.height);
      paintLabels(context, captions.labels, this.camera, this.size, captions.covered, { text: ink, halo: background });
    }
    this.finished();
    this.#events.drawn(performance.now() - start);
  }

  // The pointer

  protected ray(event: MouseEvent): Raycaster {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    return ray;
  }

  #grab(event: PointerEvent): void {
    const freedom = event.button === 0 ? this.handles?.hit(this.ray(event)) : null;
    if (!freedom) return;
    event.stopImmediatePropagation();
    this.drag = { freedom, start: new Vector2(event.clientX, event.clientY) };
    this.canvas.setPointerCapture(event.pointerId);
    this.#events.dragStart(freedom);
    const end = (ended: Event) => {
      this.drag = null;
      this.canvas.removeEventListener('pointerup', end);
      this.canvas.removeEventListener('pointercancel', end);
      this.#events.dragEnd(ended.type === 'pointerup');
    };
    this.canvas.addEventListener('pointerup', end);
    this.canvas.addEventListener('pointercancel', end);
  }

  #pull(event: PointerEvent): void {
    if (!this.handles) return;
    if (this.drag) {
      const moved = new Vector2(event.clientX, event.clientY).sub(this.drag.start);
      const { freedom } = this.drag;
      this.#events.drag(freedom, this.handles.change(freedom, moved, this.camera, this.size, this.unit_mm));
      return;
    }
    if (event.buttons !== 0) return;
    const hot = this.handles.hit(this.ray(event));
    this.canvas.style.cursor = hot ? 'grab' : '';
    this.canvas.title = hot ? `Drag: ${SAYS[hot]}` : '';
    if (this.handles.heat(hot)) this.invalidate();
  }
}

/** A grid in one colour, its middle lines among them. */
export function paintGrid(grid: GridHelper, colour: number): void {
  const material = grid.material as LineBasicMaterial;
  material.vertexColors = false;
  material.color = new Color(colour);
  material.needsUpdate = true;
}
