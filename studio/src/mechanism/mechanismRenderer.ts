// 3D view of a mechanism. The scene is scaled so that every mechanism has the same size; units of the scene: sizes.

import { Box3, PerspectiveCamera, Plane, Vector2, Vector3 } from 'three';
import type { MechanismDocument, PlacedDocument, RedundantConstraint } from '../api/client';
import { SCENE, type Theme } from '../scene/palette';
import { CLICK_DISTANCE, SceneRenderer, type Overlay, type RendererEvents } from '../scene/sceneRenderer';
import { STANDARD_VIEWS, type SceneView } from '../scene/standardViews';
import type { Label } from '../scene/labels';
import { MechanismMaterials, MechanismModel, type PartOf } from './mechanismModel';
import { PointHandle } from './pointHandle';

export interface MechanismRendererEvents extends RendererEvents {
  /** A part was clicked; `null` for the background. */
  picked: (part: PartOf | null) => void;
  /** A point of a link was taken [m, in the frame of the link]; without this event, links cannot be dragged. */
  pointTaken?: (part: PartOf, link: string, point_m: number[]) => void;
  /** The point is dragged to a position [m, in the base frame, with exaggerated play]. */
  pointMoved?: (to_m: number[]) => void;
}

/** A drag of a point: where it was taken, and the plane in which the pointer moves it. */
interface PointDrag {
  plane: Plane;
  /** From the pointer to the point, in the scene. */
  offset: Vector3;
  start: Vector2;
  wanted: Vector3 | null;
}

/** Up to this number of joints, all of them have labels. */
const MANY = 16;
/** Length of a joint and its surroundings [sizes]: joints have no labels in views from far away. */
const LABELLED = 0.18;
/** The view is larger than the mechanism by this factor, for labels and buttons. */
const MARGIN = 1.22;
/** Period of an animated motion [ms]. */
const PERIOD_MS = 2600;

export class MechanismRenderer extends SceneRenderer {
  readonly #events: MechanismRendererEvents;
  readonly #eye: PerspectiveCamera;
  readonly #materials = new MechanismMaterials();
  #model: MechanismModel | null = null;
  #document: MechanismDocument | null = null;
  #poses: readonly PlacedDocument[] = [];
  #selected: (part: PartOf) => boolean = () => false;
  #animation = 0;
  readonly #ghostMaterials = new MechanismMaterials();
  #ghost: MechanismModel | null = null;
  readonly #handle = new PointHandle();
  /** The point with a handle [m, in the frame of the link]. */
  #point: { link: string; point_m: readonly number[] } | null = null;
  #drag: PointDrag | null = null;

  constructor(host: HTMLElement, events: MechanismRendererEvents) {
    const eye = new PerspectiveCamera(30, 1, 0.02, 80);
    eye.up.set(0, 0, 1);
    super(
      host,
      {
        camera: eye,
        description: '3D view of the mechanism; its links, joints and values are in the panels',
        unit_mm: 1000,
        grid: { step: 0.1, radius: 3 },
      },
      events,
    );
    this.#eye = eye;
    this.#events = events;
    this.scene.add(this.#handle.group);
    this.canvas.addEventListener('click', (event) => this.#pick(event));
    // For the capture phase: a drag of a point must not reach the camera controls.
    this.canvas.addEventListener('pointerdown', (event) => this.#take(event), { capture: true });
    this.canvas.addEventListener('pointermove', (event) => this.#follow(event));
    this.measure();
  }

  override dispose(): void {
    cancelAnimationFrame(this.#animation);
    this.#model?.dispose();
    this.#materials.dispose();
    this.#handle.dispose();
    this.#ghost?.dispose();
    this.#ghostMaterials.dispose();
    super.dispose();
  }

  /** Draws another mechanism; without one, the view is empty. */
  load(document: MechanismDocument | null, poses: readonly PlacedDocument[]): void {
    this.stop();
    if (this.#model) {
      this.scene.remove(this.#model.group);
      this.#model.dispose();
    }
    this.#document = document;
    this.#model = document && new MechanismModel(document, this.#materials);
    if (!document || !this.#model) {
      this.invalidate();
      return;
    }
    this.#model.group.scale.setScalar(1 / document.size_m);
    this.scene.add(this.#model.group);
    this.place(poses);
    this.#model.highlight(this.#selected);
    const box = this.#box();
    this.placeGround(box, box.min.z - 0.04);
  }

  /** Moves the links to their poses. */
  place(poses: readonly PlacedDocument[]): void {
    this.#poses = poses;
    this.#model?.place(poses);
    this.partsMoved();
  }

  /** Animates poses of a motion, from one side to the other and back; without movement, shows its end. */
  play(steps: readonly (readonly PlacedDocument[])[], moving: boolean): void {
    this.stop();
    const model = this.#model;
    if (!model || steps.length < 2) return;
    const at = (share: number) => {
      const along = ((share + 1) / 2) * (steps.length - 1);
      const first = Math.min(Math.floor(along), steps.length - 2);
      model.placeBetween(steps[first]!, steps[first + 1]!, along - first);
      this.partsMoved();
    };
    if (!moving) {
      at(1);
      return;
    }
    const start = performance.now();
    const next = () => {
      at(Math.sin(((performance.now() - start) / PERIOD_MS) * 2 * Math.PI));
      this.#animation = requestAnimationFrame(next);
    };
    next();
  }

  /** Ends an animation. */
  stop(): void {
    if (this.#animation) cancelAnimationFrame(this.#animation);
    this.#animation = 0;
    this.#model?.place(this.#poses);
    this.partsMoved();
  }

  /** Highlights the parts for which a condition holds. */
  highlight(selected: (part: PartOf) => boolean): void {
    this.#selected = selected;
    this.#model?.highlight(selected);
    this.invalidate();
  }

  /** Draws the forces and moments of a redundant constraint. */
  showLoads(constraint: RedundantConstraint | null): void {
    this.#model?.showLoads(constraint);
    this.invalidate();
  }

  override setTheme(theme: Theme): void {
    this.#materials.paint(SCENE[theme]);
    this.#ghostMaterials.makeGhost(SCENE[theme].reference);
    this.#handle.paint(SCENE[theme].handle, SCENE[theme].handleActive);
    super.setTheme(theme);
  }

  #box(): Box3 {
    const box = this.#model ? new Box3().setFromObject(this.#model.group) : new Box3();
    return box.isEmpty() ? new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1)) : box;
  }

  /** Shows the mechanism from a standard direction; `home` is the direction that separates the joints best. */
  showView(view: SceneView): void {
    const best = view === 'home' ? this.#document?.view_direction : null;
    this.#fit(new Vector3(...(best ?? STANDARD_VIEWS[view])).normalize());
  }

  /** Moves the camera along a direction to where the corners of all bars fit into the view, with a margin. */
  #fit(toward: Vector3): void {
    const box = this.#box();
    const center = box.getCenter(new Vector3());
    const right = new Vector3().crossVectors(this.#eye.up, toward).normalize();
    const up = new Vector3().crossVectors(toward, right);
    const slope = Math.tan((this.#eye.fov * Math.PI) / 360);
    const needed = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => {
      const corner = new Vector3(i & 1 ? box.min.x : box.max.x, i & 2 ? box.min.y : box.max.y, i & 4 ? box.min.z : box.max.z).sub(center);
      return corner.dot(toward) + (MARGIN * Math.max(Math.abs(corner.dot(right)) / this.#eye.aspect, Math.abs(corner.dot(up)))) / slope;
    });
    this.controls.target.copy(center);
    this.#eye.position.copy(center).addScaledVector(toward, Math.max(...needed));
    this.controls.update();
    this.invalidate();
  }

  /** Position and target of the camera [sizes]. */
  get cameraPose(): { eye: number[]; target: number[] } {
    return { eye: this.#eye.position.toArray(), target: this.controls.target.toArray() };
  }

  set cameraPose({ eye, target }: { eye: number[]; target: number[] }) {
    this.#eye.position.fromArray(eye);
    this.controls.target.fromArray(target);
    this.controls.update();
    this.invalidate();
  }

  /** Positions of the joints in the base frame [m]. */
  jointPositions(): Record<string, number[]> {
    const size = this.#document?.size_m ?? 1;
    return Object.fromEntries((this.#model?.jointPositions() ?? []).map(({ name, position }) => [name, position.multiplyScalar(size).toArray()]));
  }

  /** Origins of the links in the base frame [m]. */
  linkOrigins(): Record<string, number[]> {
    const size = this.#document?.size_m ?? 1;
    return Object.fromEntries((this.#model?.linkOrigins() ?? []).map(({ name, position }) => [name, position.multiplyScalar(size).toArray()]));
  }

  /** Position of a joint on the page [px]. */
  onPage(name: string): { x: number; y: number } | null {
    const found = this.#model?.jointPositions().find((one) => one.name === name);
    if (!found) return null;
    return this.#pagePosition(found.position);
  }

  protected resized(): void {
    this.#eye.aspect = this.size.width / this.size.height;
    this.#eye.updateProjectionMatrix();
  }

  /** Draws a state to compare with, translucent and in the base frame of the mechanism. */
  showGhost(state: { document: MechanismDocument; poses: readonly PlacedDocument[] } | null): void {
    if (this.#ghost) {
      this.scene.remove(this.#ghost.group);
      this.#ghost.dispose();
    }
    this.#ghost = state && new MechanismModel(state.document, this.#ghostMaterials);
    if (state && this.#ghost) {
      this.#ghost.place(state.poses);
      this.#ghost.group.scale.setScalar(1 / (this.#document?.size_m ?? state.document.size_m));
      this.#ghost.group.traverse((part) => (part.castShadow = false));
      this.scene.add(this.#ghost.group);
    }
    this.invalidate();
  }

  // The moved point

  /** Shows the handle of a point. */
  showPoint(point: { link: string; point_m: readonly number[] } | null): void {
    this.#point = point;
    this.invalidate();
  }

  /** Position of the handle on the page [px]. */
  handleOnPage(): { x: number; y: number } | null {
    const found = this.#pointPosition();
    return found && this.#pagePosition(found);
  }

  /** Position of the point in the scene. */
  #pointPosition(): Vector3 | null {
    return this.#point && this.#model ? this.#model.ofLink(this.#point.link, new Vector3(...this.#point.point_m)) : null;
  }

  /** The part and the point of a moving link under the pointer, by the handle first. */
  #under(event: MouseEvent): { part: PartOf | null; link: string; position: Vector3 } | null {
    if (!this.#model || !this.#events.pointTaken) return null;
    const position = this.#pointPosition();
    if (position && this.#point && this.#handle.isHit(this.ray(event))) return { part: null, link: this.#point.link, position };
    const hit = this.intersection(event, this.#model.group);
    const part = hit?.object.userData.part as PartOf | undefined;
    const link = part && this.#model.movingLink(part);
    return hit && part && link ? { part, link, position: hit.point } : null;
  }

  #take(event: PointerEvent): void {
    if (event.button !== 0 || event.ctrlKey || event.shiftKey || event.metaKey || this.#drag) return;
    const taken = this.#under(event);
    if (!taken || !this.#model) return;
    event.stopImmediatePropagation();
    this.canvas.focus();
    this.canvas.setPointerCapture(event.pointerId);
    const { part, link, position } = taken;
    const plane = new Plane().setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new Vector3()), position);
    const pointer = this.ray(event).ray.intersectPlane(plane, new Vector3()) ?? position;
    this.#drag = { plane, offset: position.clone().sub(pointer), start: new Vector2(event.clientX, event.clientY), wanted: null };
    if (part) this.#events.pointTaken?.(part, link, this.#model.inLink(link, position).toArray());
    const end = (): void => {
      this.#drag = null;
      this.canvas.removeEventListener('pointerup', end);
      this.canvas.removeEventListener('pointercancel', end);
      this.invalidate();
    };
    this.canvas.addEventListener('pointerup', end);
    this.canvas.addEventListener('pointercancel', end);
  }

  #follow(event: PointerEvent): void {
    const drag = this.#drag;
    if (!drag) {
      if (event.buttons === 0) this.canvas.style.cursor = this.#under(event) ? 'grab' : '';
      return;
    }
    if (!drag.wanted && drag.start.distanceTo(new Vector2(event.clientX, event.clientY)) < CLICK_DISTANCE) return;
    const at = this.ray(event).ray.intersectPlane(drag.plane, new Vector3());
    if (!at) return;
    this.canvas.style.cursor = 'grabbing';
    drag.wanted = at.add(drag.offset);
    this.#events.pointMoved?.(drag.wanted.clone().multiplyScalar(this.#document?.size_m ?? 1).toArray());
    this.invalidate();
  }

  #pagePosition(position: Vector3): { x: number; y: number } {
    const { x, y } = position.project(this.#eye);
    const box = this.canvas.getBoundingClientRect();
    return { x: box.left + ((x + 1) / 2) * box.width, y: box.top + ((1 - y) / 2) * box.height };
  }

  protected update(): Overlay | null {
    const handle = this.exporting || this.#animation ? null : this.#pointPosition();
    this.#handle.group.visible = handle !== null;
    if (handle) this.#handle.place(handle, this.#drag?.wanted ?? null, this.#eye, this.size.height, this.#drag !== null);
    const joints = this.#model?.jointPositions() ?? [];
    const all = joints.length <= MANY;
    const isSelected = (name: string) => this.#selected({ kind: 'joint', name });
    const shown = joints.filter(({ name, actuated }) => all || actuated || isSelected(name));
    // Labels that are painted first have the best places.
    const rank = ({ name, actuated }: (typeof joints)[number]) => (isSelected(name) ? 0 : actuated ? 1 : 2);
    const labels = shown.sort((a, b) => rank(a) - rank(b)).map(({ name, actuated, position }): Label => ({ position, text: name, offset: [12, -10], strong: actuated || isSelected(name), extent: isSelected(name) ? undefined : LABELLED }));
    return { labels, covered: { left: 8, right: 8 }, occupied: [this.cornerBox(34)] };
  }

  #pick(event: MouseEvent): void {
    if (!this.#model || this.isDragOrHandle(event) || this.#handle.isHit(this.ray(event))) return;
    const hit = this.intersection(event, this.#model.group);
    this.#events.picked((hit?.object.userData.part as PartOf | undefined) ?? null);
  }
}
