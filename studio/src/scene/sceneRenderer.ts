// Common base of all 3D views: canvas, labels, lights, ground, camera controls, drag handles, picking, pictures for export.
// A frame is rendered only after a change; when nothing moves any more, a still picture with smooth edges follows.

import {
  NeutralToneMapping,
  PCFShadowMap,
  Raycaster,
  Vector2,
  Vector3,
  WebGLRenderer,
  type Box3,
  type Intersection,
  type Object3D,
  type OrthographicCamera,
  type PerspectiveCamera,
  type Plane,
  type Scene,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { fittingDistance } from './fit';
import { installEnvironment } from './environment';
import type { Box } from '../lib/labelLayout';
import type { TextContext } from '../lib/svgContext';
import { HandleDrag, type DragEvents } from './handleDrag';
import type { Freedom, Handles } from './handles';
import { Occlusion } from './occlusion';
import { paintAxes, paintLabels, type Overlay } from './labels';
import { SCENE, type Theme } from './palette';
import { heightOf, paintDivider, paintTitles, renderPanes, wholeOf, widthOf, type Pane } from './panes';
import type { Picture } from './picture';
import { Resolution } from './resolution';
import { Stage, type Grid } from './stage';
import { CUBE_SIDES, type CubeSide } from './standardViews';
import { takeContext } from './webgl';

export type Camera = PerspectiveCamera | OrthographicCamera;

export interface RendererEvents extends DragEvents {
  /** A frame has been rendered, with the time that it took [ms]. */
  rendered: (took_ms: number) => void;
}

/** Width and height of the view cube with its margins [px]. */
const CORNER = 104;

/** What differs between the scenes of the views. */
export interface SceneOptions {
  camera: Camera;
  /** Description of the view for screen readers. */
  description: string;
  /** Length of a unit of the scene [mm]. */
  unit_mm: number;
  /** Length up to which parts occlude each other [units of the scene]. */
  occlusion: number;
  grid: Grid;
}

/** In views of a smaller width, elements over the view take whole rows [px]; the largest share of the height that the picture leaves to them at an edge. */
const NARROW_VIEW = 480;
/** Views of at most this height, and wider than this width, have their buttons in rows too, as in the style sheet [px]. */
export const LOW_VIEW = { height: 350, width: 600 } as const;
const MOST_COVERED = 0.27;
/** Area of a drag handle that labels leave free [px]. */
const GRIP = { width: 26, height: 64 } as const;
/** Largest number of pixels of a still picture, which takes the processor about a second. */
const STILL_PIXELS = 9e6;
/** Time without changes before the still picture [ms]: longer where moving pictures are slow, so that none is rendered between two of them. */
const STILL_AFTER = { least: 400, most: 900, intervals: 4 } as const;

/** Pointer movement up to which a click is a click and not a drag [px]. */
export const CLICK_DISTANCE = 4;

export abstract class SceneRenderer {
  protected readonly renderer: WebGLRenderer;
  protected readonly controls: OrbitControls;
  protected readonly labelCanvas = document.createElement('canvas');
  protected camera: Camera;
  protected size = { width: 1, height: 1 };
  protected theme: Theme = 'light';
  readonly #host: HTMLElement;
  readonly #events: RendererEvents;
  /** Length of a unit of the scene [mm]. */
  protected unit_mm: number;
  protected readonly stage: Stage;
  readonly #resolution: Resolution;
  readonly #occlusion: Occlusion;
  /** Whether moving pictures have occlusion: with a graphics card, as long as it reaches the full resolution. */
  #occludesMoving: boolean;
  /** Whether the processor renders the pictures. */
  readonly #software: boolean;
  readonly #observer: ResizeObserver;
  readonly #handleDrag: HandleDrag;
  #pointerDown = new Vector2();
  #frame = 0;
  #still: ReturnType<typeof setTimeout> | undefined;
  #lastFrame = 0;
  #stillAfter: number = STILL_AFTER.least;

  constructor(host: HTMLElement, options: SceneOptions, events: RendererEvents) {
    this.#host = host;
    this.unit_mm = options.unit_mm;
    this.#events = events;
    this.camera = options.camera;
    installEnvironment();
    const context = takeContext();
    this.renderer = new WebGLRenderer({ alpha: true, ...(context && { canvas: context.canvas, context: context.context }) });
    this.#software = context?.software ?? false;
    this.#resolution = new Resolution(window.devicePixelRatio, this.#software);
    this.renderer.setPixelRatio(this.#resolution.moving);
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    // Shadows depend on the parts, not on the camera.
    this.renderer.shadowMap.autoUpdate = false;
    // Checking each shader for errors blocks until it is compiled.
    this.renderer.debug.checkShaderErrors = import.meta.env.DEV;
    const { canvas } = this;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', options.description);
    this.labelCanvas.className = 'labels';
    host.append(canvas, this.labelCanvas);
    this.stage = new Stage(options.grid);
    this.#occlusion = new Occlusion(options.occlusion);
    this.#occludesMoving = !this.#software;
    this.controls = new OrbitControls(options.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.invalidate());
    canvas.addEventListener('pointerdown', ({ clientX, clientY }) => this.#pointerDown.set(clientX, clientY), { capture: true });
    const displacement = (handles: Handles, freedom: Freedom, moved: Vector2) => handles.displacement(freedom, moved, this.camera, this.size, this.unit_mm);
    this.#handleDrag = new HandleDrag({ canvas, scene: this.scene, ray: (event) => this.ray(event), displacement, invalidate: () => this.invalidate() }, events);
    this.#observer = new ResizeObserver(() => this.measure());
    this.#observer.observe(host);
  }

  dispose(): void {
    this.onDispose?.();
    this.#observer.disconnect();
    cancelAnimationFrame(this.#frame);
    clearTimeout(this.#still);
    this.stage.dispose();
    this.#occlusion.dispose();
    this.setHandles(null);
    this.controls.dispose();
    this.renderer.dispose();
    this.#host.replaceChildren();
  }

  protected get scene(): Scene {
    return this.stage.scene;
  }

  /** Size of the view [px]. */
  get viewSize(): { width: number; height: number } {
    return this.size;
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** Adapts the camera to a new size of the view. */
  protected abstract resized(): void;
  /** Updates the scene before a frame; `null` while there is nothing to render. */
  protected abstract update(): Overlay | null;
  /** Places of the panes in the view [px]; that of `stage` is the first one. */
  protected get paneBoxes(): Box[] {
    return [wholeOf(this.size)];
  }
  /** Pictures of the panes of a frame; `overlay` is that of `stage`. */
  protected panes(overlay: Overlay): Pane[] {
    return [{ stage: this.stage, box: wholeOf(this.size), overlay }];
  }
  /** Size of each pane [px]. */
  protected get paneSize(): { width: number; height: number } {
    const [box] = this.paneBoxes as [Box];
    return { width: widthOf(box), height: heightOf(box) };
  }
  /** Called after each frame. */
  onFrame: (() => void) | null = null;
  /** Called before the view is removed. */
  onDispose: (() => void) | null = null;

  /** Requests a frame. */
  invalidate(): void {
    clearTimeout(this.#still);
    if (!this.#frame) this.#frame = requestAnimationFrame(() => this.render());
  }

  /** Requests a frame after parts have moved. */
  protected partsMoved(): void {
    this.stage.partsMoved();
    this.invalidate();
  }

  /** Requests a frame after parts were cut, or are hidden or transparent now. */
  protected surfacesChanged(): void {
    this.stage.surfacesChanged();
    this.invalidate();
  }

  /** Places ground and key light for a scene within a box. */
  protected placeGround(box: Box3, floor: number): void {
    this.stage.place(box, floor);
    this.invalidate();
  }

  /** Takes over the size of the host element; to be called at the end of the constructor of a subclass. */
  protected measure(): void {
    const { width, height } = this.#host.getBoundingClientRect();
    if (width < 2 || height < 2 || (width === this.size.width && height === this.size.height)) return;
    this.size = { width, height };
    this.renderer.setSize(width, height);
    const ratio = Math.min(window.devicePixelRatio, 2);
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
    const { top, bottom } = this.isBelowRows ? this.coveredRows : { top: 0, bottom: 0 };
    // From the home direction, a box fills about two thirds of its sphere.
    const free = Math.sqrt(1 - top - bottom);
    const usual = (0.82 * reach) / Math.sin((camera.fov * Math.PI) / 360) / aspect / free;
    const distance = Math.max(usual, fittingDistance(camera, box, direction, 1 - top - bottom));
    // The box is in the middle of the rows that are free.
    const up = camera.up.clone().addScaledVector(direction, -camera.up.dot(direction) / direction.lengthSq());
    const height = 2 * distance * Math.tan((camera.fov * Math.PI) / 360);
    if (up.lengthSq() > 1e-6) center.addScaledVector(up.normalize(), ((top - bottom) / 2) * height);
    this.controls.target.copy(center);
    camera.position.copy(center).addScaledVector(direction.clone().normalize(), distance);
    this.controls.update();
    this.invalidate();
  }

  /** Rotation from the base frame to the camera frame, by columns, as the view cube shows it. */
  get rotation(): number[] {
    return this.camera.matrixWorldInverse.toArray();
  }

  /** Rotates the camera about its target to a side. */
  turnTo(side: CubeSide): void {
    const { target } = this.controls;
    const distance = this.camera.position.distanceTo(target);
    this.camera.position.copy(target).addScaledVector(new Vector3(...CUBE_SIDES[side]).normalize(), distance);
    this.controls.update();
    this.invalidate();
  }

  protected render(): void {
    this.#frame = 0;
    clearTimeout(this.#still);
    const start = performance.now();
    const interval = start - this.#lastFrame;
    if (this.#resolution.observe(interval)) this.#occludesMoving = false;
    // Longer intervals are pauses between movements.
    this.#stillAfter = interval > STILL_AFTER.most ? STILL_AFTER.least : Math.min(Math.max(STILL_AFTER.intervals * interval, STILL_AFTER.least), STILL_AFTER.most);
    this.#lastFrame = start;
    this.#useRatio(this.#resolution.moving);
    if (!this.#draw(this.#occludesMoving)) return;
    this.#scheduleStill();
    this.onFrame?.();
    this.#events.rendered(performance.now() - start);
  }

  /** Whether a picture of a moving scene is being rendered that is slow: without occlusion, and with fewer faces of many parts. */
  protected isDraft = false;
  /** Whether a picture for export is being rendered. */
  protected exporting = false;
  /** Whether axes and labels of that picture are vectors. */
  protected vectors = false;

  /**
   * Renders the view to another canvas, in another size and without drag handles.
   *
   * `smooth` renders it at twice the resolution where the graphics card does not smooth edges.
   * With `vectors`, axes, labels and note are drawn there, in pixels of the screen, and not on the canvas.
   * Returns whether there is a scene.
   */
  renderPicture(canvas: HTMLCanvasElement, picture: Picture, smooth = true, vectors: TextContext | null = null): boolean {
    const { width, height, scale, transparent, labels, note } = picture;
    const context = canvas.getContext('2d');
    const largest = this.renderer.capabilities.maxTextureSize;
    if (!context) throw new Error('this browser cannot render the picture');
    if (!(Math.max(width, height) <= largest && Math.min(width, height) >= 16))
      throw new Error(`pictures have 16 to ${largest} pixels along each edge, got ${width} × ${height}`);
    const factor = smooth && this.#software && 2 * Math.max(width, height) <= largest ? 2 : 1;
    const before = { size: this.size, handles: this.handles?.group.visible ?? false };
    const { background, ink } = SCENE[this.theme];
    try {
      this.exporting = true;
      this.vectors = vectors !== null;
      if (this.handles) this.handles.group.visible = false;
      this.size = { width: width / scale, height: height / scale };
      this.renderer.setPixelRatio(1);
      this.renderer.setSize(width * factor, height * factor, false);
      this.resized();
      const scene = this.#renderScene(true);
      const panes = scene ?? [];
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.clearRect(0, 0, width, height);
      if (!transparent) {
        context.fillStyle = background;
        context.fillRect(0, 0, width, height);
      }
      context.imageSmoothingQuality = 'high';
      context.drawImage(this.renderer.domElement, 0, 0, width, height);
      context.setTransform(scale, 0, 0, scale, 0, 0);
      const texts = vectors ?? context;
      const inks = { text: ink, halo: background };
      paintDivider(texts, panes, ink);
      for (const { overlay, box } of panes) {
        if (overlay.axes) paintAxes(texts, overlay.axes, this.camera, this.size);
        if (labels) paintLabels(texts, { ...overlay, covered: { left: 8, right: 8 } }, this.camera, box, [], inks);
      }
      paintTitles(texts, panes, inks);
      texts.textBaseline = 'alphabetic';
      texts.font = '600 14px system-ui, sans-serif';
      texts.fillStyle = ink;
      texts.fillText(note, 14, height / scale - 14);
      return scene !== null;
    } finally {
      this.exporting = this.vectors = false;
      if (this.handles) this.handles.group.visible = before.handles;
      this.size = before.size;
      this.renderer.setPixelRatio(this.#resolution.moving);
      this.renderer.setSize(this.size.width, this.size.height);
      this.resized();
      if (this.#draw(this.#occludesMoving)) this.#scheduleStill();
    }
  }

  #useRatio(ratio: number): void {
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
  }

  #scheduleStill(): void {
    clearTimeout(this.#still);
    if (this.#resolution.still > this.#resolution.moving || !this.#occludesMoving) this.#still = setTimeout(() => this.#drawStill(), this.#stillAfter);
  }

  #drawStill(): void {
    const { width, height } = this.size;
    const largest = Math.sqrt(STILL_PIXELS / (width * height));
    this.#useRatio(Math.max(Math.min(this.#resolution.still, largest), this.#resolution.moving));
    this.#draw(true);
  }

  /** Renders the panes, with a new occlusion where `occludes`; returns them, and `null` without a scene. */
  #renderScene(occludes: boolean): Pane[] | null {
    this.isDraft = !occludes;
    const overlay = this.update();
    if (!overlay) return null;
    const panes = this.panes(overlay);
    renderPanes(this.renderer, panes, this.camera, this.size, { occlusion: this.#occlusion, computes: occludes, isCoarse: this.#software && !this.exporting });
    return panes;
  }

  /** Renders the panes and their labels; returns whether there is a scene. */
  #draw(occludes: boolean): boolean {
    const panes = this.#renderScene(occludes);
    if (!panes) return false;
    const context = this.labelCanvas.getContext('2d');
    if (context) {
      const ratio = this.labelCanvas.width / this.size.width;
      const { ink, background } = SCENE[this.theme];
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, this.size.width, this.size.height);
      paintDivider(context, panes, ink);
      const occupied = [...this.#gripBoxes(), ...this.coveredBoxes()];
      this.#labelBoxes = panes.flatMap(({ overlay, box }) => paintLabels(context, overlay, this.camera, box, [...occupied, ...(overlay.occupied ?? [])], { text: ink, halo: background }));
    }
    return true;
  }

  /** The corner of the view with the view cube and the buttons above it, of a given height [px]. */
  protected cornerBox(buttons: number): Box {
    return { left: this.size.width - CORNER, right: this.size.width, top: 0, bottom: buttons + CORNER };
  }

  /** Areas of the view under elements of the page that are marked by `data-covers` [px]; pictures for export have none. */
  protected coveredBoxes(): Box[] {
    if (this.exporting) return [];
    const { left, top } = this.#host.getBoundingClientRect();
    return [...(this.#host.parentElement?.querySelectorAll('[data-covers]') ?? [])].map((element) => {
      const box = element.getBoundingClientRect();
      return { left: box.left - left, top: box.top - top, right: box.right - left, bottom: box.bottom - top };
    });
  }

  /** Whether elements over the view take whole rows. */
  protected get isNarrow(): boolean {
    return this.size.width <= NARROW_VIEW;
  }

  /** Whether elements over the view take rows above and below the scene, and no column next to it. */
  protected get isBelowRows(): boolean {
    const { width, height } = this.size;
    return this.isNarrow || (height <= LOW_VIEW.height && width > LOW_VIEW.width);
  }

  /** Shares of the height of the view that elements of the page cover at its top and at its bottom, where they take whole rows. */
  protected get coveredRows(): { top: number; bottom: number } {
    const { height } = this.size;
    const rows = { top: 0, bottom: 0 };
    for (const { top, bottom } of this.coveredBoxes())
      if (top < height - bottom) rows.top = Math.min(Math.max(rows.top, bottom / height), MOST_COVERED);
      else rows.bottom = Math.min(Math.max(rows.bottom, (height - top) / height), MOST_COVERED);
    return rows;
  }

  #labelBoxes: Box[] = [];

  /** Boxes of the texts of all labels of the view [px]. */
  get labelBoxes(): readonly Box[] {
    return this.#labelBoxes;
  }

  /** Areas of the view around the drag handles [px]. */
  #gripBoxes(): Box[] {
    return (this.handles?.grips() ?? []).map((grip) => {
      const { x, y } = grip.project(this.camera);
      const [across, down] = [((x + 1) / 2) * this.size.width, ((1 - y) / 2) * this.size.height];
      return { left: across - GRIP.width / 2, right: across + GRIP.width / 2, top: down - GRIP.height / 2, bottom: down + GRIP.height / 2 };
    });
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    const { handle, handleActive } = SCENE[theme];
    this.handles?.paint(handle, handleActive);
    this.stage.paint(theme);
    this.invalidate();
  }

  // Drag handles

  protected get handles(): Handles | null {
    return this.#handleDrag.handles;
  }

  /** Whether a handle is being dragged. */
  protected get dragging(): boolean {
    return this.#handleDrag.isActive;
  }

  /** Replaces the drag handles. */
  protected setHandles(handles: Handles | null): void {
    handles?.paint(SCENE[this.theme].handle, SCENE[this.theme].handleActive);
    this.#handleDrag.replace(handles);
  }

  // Picking

  /** The first intersection of the ray through the pointer with a visible surface of an object; `null` if there is none. */
  protected intersection(event: MouseEvent, object: Object3D): Intersection | null {
    const planes = this.renderer.clippingPlanes as Plane[];
    return this.ray(event).intersectObject(object, true).find(({ point }) => planes.every((plane) => plane.distanceToPoint(point) >= 0)) ?? null;
  }

  /** Whether a click is the end of a drag of the view, or hits a handle. */
  protected isDragOrHandle(event: MouseEvent): boolean {
    const moved = this.#pointerDown.distanceTo(new Vector2(event.clientX, event.clientY));
    return moved >= CLICK_DISTANCE || Boolean(this.handles?.pick(this.ray(event)));
  }

  /** Index of the pane under the pointer. */
  protected paneUnder(event: MouseEvent): number {
    const { left, top } = this.canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - left, event.clientY - top];
    return Math.max(this.paneBoxes.findIndex((box) => x >= box.left && x < box.right && y >= box.top && y < box.bottom), 0);
  }

  /** The ray through the pointer in a pane. */
  protected ray(event: MouseEvent, pane = this.paneUnder(event)): Raycaster {
    const view = this.canvas.getBoundingClientRect();
    const box = this.paneBoxes[pane] as Box;
    const [x, y] = [(event.clientX - view.left - box.left) / widthOf(box), (event.clientY - view.top - box.top) / heightOf(box)];
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2(2 * x - 1, 1 - 2 * y), this.camera);
    return ray;
  }
}
