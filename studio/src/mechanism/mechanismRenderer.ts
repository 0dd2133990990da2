// 3D view of a mechanism, and of a reference next to it. The scene is scaled so that every mechanism has the same size; of two, the larger one.

import { Box3, PerspectiveCamera, Plane, Vector2, Vector3 } from 'three';
import type { MechanismDocument, PlacedDocument, RedundantConstraint } from '../api/client';
import { SCENE, type Theme } from '../scene/palette';
import { arrangementOf, pictureArrangement, redirectWheel, split, type Pane } from '../scene/panes';
import { CLICK_DISTANCE, SceneRenderer, type RendererEvents } from '../scene/sceneRenderer';
import { STANDARD_VIEWS, type SceneView } from '../scene/standardViews';
import type { Label, Overlay } from '../scene/labels';
import type { Box } from '../lib/labelLayout';
import { MechanismMaterials, MechanismModel, type PartOf } from './mechanismModel';
import { PointHandle } from './pointHandle';
import { ReferencePicture, type DrawnReference } from './referencePicture';

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
/** Area of the titles of panes, which labels leave free: from the top of a view and of a lower pane [px]. */
const TITLES = { width: 300, first: 68, lower: 30 } as const;
/** Distance of the ground below the mechanism [units of the scene]. */
const ABOVE_GROUND = 0.04;
const GRID = { step: 0.1, radius: 3 } as const;
const DESCRIPTIONS = {
  alone: '3D view of the mechanism; its links, joints and values are in the panels',
  separate: '3D views of the reference and of the shown mechanism, side by side; their values are in the panel Comparison',
} as const;
/** Length of a joint and its surroundings among many joints [sizes]: joints have no labels in views from far away. */
const LABELLED = 0.18;
/** Labels of mechanisms with more bars may cover them. */
const MOST_AVOIDED = 500;
/** The view is larger than the mechanism by this factor, for labels and buttons. */
const MARGIN = 1.22;
/** Largest share of the height of a pane that buttons and legend keep free of the mechanism, at the top and at the bottom. */
const MOST_COVERED = 0.27;
/** Space between the mechanism and these, for the size of its joints [px]. */
const ABOVE_LEGEND = 10;
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
  readonly #reference = new ReferencePicture(GRID);
  /** Length of a unit of the scene [m]. */
  #unit_m = 1;
  readonly #handle = new PointHandle();
  /** Whether the mechanism fills the view: then it does so in another size of the view. */
  #isFitted = false;
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
        description: DESCRIPTIONS.alone,
        unit_mm: 1000,
        occlusion: 0.1,
        grid: GRID,
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
    this.controls.addEventListener('start', () => (this.#isFitted = false));
    redirectWheel(this.canvas, (event) => (this.#reference.separate ? this.paneBoxes[this.paneUnder(event)]! : null));
    // Two fingers zoom to the target where the centre between them is not that of the whole canvas.
    this.canvas.addEventListener('pointerdown', ({ pointerType }) => (this.controls.zoomToCursor = pointerType !== 'touch' || !this.#reference.separate), { capture: true });
    this.measure();
  }

  override dispose(): void {
    cancelAnimationFrame(this.#animation);
    this.#model?.dispose();
    this.#materials.dispose();
    this.#handle.dispose();
    this.#reference.dispose();
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
    this.scene.add(this.#model.group);
    this.place(poses);
    this.#model.highlight(this.#selected);
    this.#arrange(this.#reference.separate !== null);
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
    // Parts are compared by name, as values are.
    this.#reference.highlight(selected);
    this.invalidate();
  }

  /** Draws the forces and moments of a redundant constraint. */
  showLoads(constraint: RedundantConstraint | null): void {
    this.#model?.showLoads(constraint);
    this.surfacesChanged();
  }

  override setTheme(theme: Theme): void {
    this.#materials.paint(SCENE[theme]);
    this.#reference.paint(theme);
    this.#handle.paint(SCENE[theme].handle, SCENE[theme].handleActive);
    super.setTheme(theme);
  }

  #box(): Box3 {
    const box = this.#model?.box ?? new Box3();
    return box.isEmpty() ? new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1)) : box;
  }

  /** Shows the mechanism from a standard direction; `home` is the direction that separates the joints best. */
  showView(view: SceneView): void {
    const best = view === 'home' ? this.#document?.view_direction : null;
    this.#fit(new Vector3(...(best ?? STANDARD_VIEWS[view])).normalize());
  }

  /** Moves the camera along a direction to where the corners of all bars fit into the view, with a margin. */
  #fit(toward: Vector3): void {
    const box = this.#wholeBox();
    const center = box.getCenter(new Vector3());
    const right = new Vector3().crossVectors(this.#eye.up, toward).normalize();
    const up = new Vector3().crossVectors(toward, right);
    const slope = Math.tan((this.#eye.fov * Math.PI) / 360);
    const [across, upward] = [MARGIN / this.#eye.aspect, Math.max(MARGIN, 1 / (1 - 2 * this.#coveredShare))];
    const needed = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => {
      const corner = new Vector3(i & 1 ? box.min.x : box.max.x, i & 2 ? box.min.y : box.max.y, i & 4 ? box.min.z : box.max.z).sub(center);
      return corner.dot(toward) + Math.max(across * Math.abs(corner.dot(right)), upward * Math.abs(corner.dot(up))) / slope;
    });
    this.controls.target.copy(center);
    this.#eye.position.copy(center).addScaledVector(toward, Math.max(...needed));
    this.#isFitted = true;
    this.controls.update();
    this.invalidate();
  }

  /** Share of the height of a pane that buttons at its top or the legend at its bottom cover, the larger of both. */
  get #coveredShare(): number {
    const { height } = this.size;
    const edges = this.coveredBoxes().map(({ top, bottom }) => Math.min(bottom, height - top) + ABOVE_LEGEND);
    return Math.min(Math.max(0, ...edges) / this.paneSize.height, MOST_COVERED);
  }

  /** Position and target of the camera [sizes of the mechanism]. */
  get cameraPose(): { eye: number[]; target: number[] } {
    const scale = this.#unit_m / (this.#document?.size_m ?? this.#unit_m);
    return { eye: this.#eye.position.clone().multiplyScalar(scale).toArray(), target: this.controls.target.clone().multiplyScalar(scale).toArray() };
  }

  set cameraPose({ eye, target }: { eye: number[]; target: number[] }) {
    const scale = (this.#document?.size_m ?? this.#unit_m) / this.#unit_m;
    this.#eye.position.fromArray(eye).multiplyScalar(scale);
    this.controls.target.fromArray(target).multiplyScalar(scale);
    this.#isFitted = false;
    this.controls.update();
    this.invalidate();
  }

  /** Positions of the joints in the base frame [m]. */
  jointPositions(): Record<string, number[]> {
    return Object.fromEntries((this.#model?.jointPositions() ?? []).map(({ name, position }) => [name, position.multiplyScalar(this.#unit_m).toArray()]));
  }

  /** Origins of the links in the base frame [m]. */
  linkOrigins(): Record<string, number[]> {
    return Object.fromEntries((this.#model?.linkOrigins() ?? []).map(({ name, position }) => [name, position.multiplyScalar(this.#unit_m).toArray()]));
  }

  /** Position of a joint on the page [px]. */
  onPage(name: string): { x: number; y: number } | null {
    const found = this.#model?.jointPositions().find((one) => one.name === name);
    if (!found) return null;
    return this.#pagePosition(found.position);
  }

  protected resized(): void {
    const { width, height } = this.paneSize;
    this.#eye.aspect = width / height;
    this.#eye.updateProjectionMatrix();
    // The controls take the whole canvas as the picture.
    this.controls.panSpeed = this.size.height / height;
  }

  // The reference

  /** Draws a state to compare with: translucent in the base frame of the mechanism, or next to it. */
  compare(drawn: DrawnReference | null): void {
    const before = this.#reference.separate;
    this.#reference.draw(drawn, this.scene, this.#materials);
    const { separate } = this.#reference;
    this.canvas.setAttribute('aria-label', DESCRIPTIONS[separate ? 'separate' : 'alone']);
    this.#arrange(true);
    this.#reference.highlight(this.#selected);
    this.resized();
    if (separate && separate.document !== before?.document && !this.#isInView) this.#fitAgain();
  }

  /** Keeps a mechanism that fills the view, or two mechanisms in their panes, in view when it changes its shape. */
  protected override measure(): void {
    const before = this.size;
    const keeps = this.#reference.separate !== null && this.#isInView;
    super.measure();
    if (this.size !== before && (this.#isFitted || (keeps && !this.#isInView))) this.#fitAgain();
  }

  #fitAgain(): void {
    this.#fit(this.#eye.position.clone().sub(this.controls.target).normalize());
  }

  /** Scales and places the mechanism and the reference; with `keepsPicture`, the camera follows the unit of the scene. */
  #arrange(keepsPicture: boolean): void {
    const { drawn, separate } = this.#reference;
    const own = this.#document?.size_m ?? drawn?.document.size_m ?? this.#unit_m;
    const before = this.#unit_m;
    this.#unit_m = separate ? Math.max(own, separate.document.size_m) : own;
    if (keepsPicture && before !== this.#unit_m) {
      this.#eye.position.multiplyScalar(before / this.#unit_m);
      this.controls.target.multiplyScalar(before / this.#unit_m);
      this.controls.update();
    }
    this.#model?.group.scale.setScalar(1 / this.#unit_m);
    const isSame = drawn?.document.name === this.#document?.name;
    this.#reference.arrange(this.#unit_m, this.#box(), isSame);
    // Two states of one mechanism are above the same ground.
    const box = separate && isSame ? this.#wholeBox() : this.#box();
    this.placeGround(box, box.min.z - ABOVE_GROUND);
    if (!separate) return;
    const other = isSame ? box : this.#reference.box;
    this.#reference.stage.place(other, other.min.z - ABOVE_GROUND);
  }

  /** The box around all panes. */
  #wholeBox(): Box3 {
    return this.#reference.separate ? this.#box().union(this.#reference.box) : this.#box();
  }

  /** Whether the corners of that box are in view. */
  get #isInView(): boolean {
    const { min, max } = this.#wholeBox();
    this.#eye.updateMatrixWorld();
    return [0, 1, 2, 3, 4, 5, 6, 7].every((i) => {
      const { x, y } = new Vector3(i & 1 ? min.x : max.x, i & 2 ? min.y : max.y, i & 4 ? min.z : max.z).project(this.#eye);
      return Math.max(Math.abs(x), Math.abs(y)) <= 1;
    });
  }

  /** Places of the panes: that of the shown mechanism comes second on the page. */
  protected override get paneBoxes(): Box[] {
    if (!this.#reference.separate) return super.paneBoxes;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const [first, second] = split(this.size, this.exporting ? pictureArrangement(this.size, { width, height }) : arrangementOf(this.size.width));
    return [second, first];
  }

  protected override panes(overlay: Overlay): Pane[] {
    const { separate, stage } = this.#reference;
    if (!separate) return super.panes(overlay);
    const [box, other] = this.paneBoxes as [Box, Box];
    const { covered, occupied = [] } = overlay;
    // Titles are below the buttons of the view, and at the top of a lower pane.
    const titles = [other, box].map(({ left, top, right }) => ({ left, top, right: Math.min(left + TITLES.width, right), bottom: top + (top > 0 ? TITLES.lower : TITLES.first) }));
    const labels = this.#labels(separate.model, separate.document.size_m);
    return [
      { stage: this.stage, box, overlay: { ...overlay, occupied: [...occupied, ...titles] }, title: `Shown: ${this.#document?.name ?? ''}` },
      { stage, box: other, overlay: { labels, covered, occupied: [...occupied, ...titles] }, title: `Reference: ${separate.document.name}` },
    ];
  }

  /** Position of a joint of the reference on the page [px]; `null` without a pane of its own. */
  referenceOnPage(name: string): { x: number; y: number } | null {
    const found = this.#reference.separate?.model.jointPositions().find((one) => one.name === name);
    return found ? this.#pagePosition(found.position, 1) : null;
  }

  /** The panes on the page, that of the shown mechanism first [px]. */
  panesOnPage(): Box[] {
    const { left, top } = this.canvas.getBoundingClientRect();
    return this.paneBoxes.map((box) => ({ left: left + box.left, top: top + box.top, right: left + box.right, bottom: top + box.bottom }));
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
    // The reference is not moved.
    if (!this.#model || !this.#events.pointTaken || this.paneUnder(event) !== 0) return null;
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
    // The pointer may leave the pane.
    const at = this.ray(event, 0).ray.intersectPlane(drag.plane, new Vector3());
    if (!at) return;
    this.canvas.style.cursor = 'grabbing';
    drag.wanted = at.add(drag.offset);
    this.#events.pointMoved?.(drag.wanted.clone().multiplyScalar(this.#unit_m).toArray());
    this.invalidate();
  }

  #pagePosition(position: Vector3, pane = 0): { x: number; y: number } {
    const { x, y } = position.project(this.#eye);
    const { left, top, right, bottom } = this.panesOnPage()[pane]!;
    return { x: left + ((x + 1) / 2) * (right - left), y: top + ((1 - y) / 2) * (bottom - top) };
  }

  protected update(): Overlay | null {
    this.#model?.drawCoarsely(this.isDraft);
    this.#reference.drawCoarsely(this.isDraft);
    const handle = this.exporting || this.#animation ? null : this.#pointPosition();
    this.#handle.group.visible = handle !== null;
    if (handle) this.#handle.place(handle, this.#drag?.wanted ?? null, this.#eye, this.paneSize.height, this.#drag !== null);
    const labels = this.#model && this.#document ? this.#labels(this.#model, this.#document.size_m) : [];
    const bars = this.#model?.barEnds() ?? [];
    return { labels, avoided: bars.length <= MOST_AVOIDED ? bars : [], covered: { left: 8, right: 8 }, occupied: [this.cornerBox(34)] };
  }

  /** Labels of the joints of a mechanism. */
  #labels(model: MechanismModel, size_m: number): Label[] {
    const joints = model.jointPositions();
    const all = joints.length <= MANY;
    const isSelected = (name: string) => this.#selected({ kind: 'joint', name });
    const shown = joints.filter(({ name, actuated }) => all || actuated || isSelected(name));
    // Labels that are painted first have the best places.
    const rank = ({ name, actuated }: (typeof joints)[number]) => (isSelected(name) ? 0 : actuated ? 1 : 2);
    // The fewer labels, the more space each of them has; those that are painted later take none of it.
    const extents = [1, 2].map((last) => (LABELLED * Math.sqrt(MANY / Math.max(shown.filter((one) => rank(one) <= last).length, 1)) * size_m) / this.#unit_m);
    return shown.sort((a, b) => rank(a) - rank(b)).map(({ name, actuated, position }) => ({ position, text: name, offset: [12, -10], strong: actuated || isSelected(name), extent: isSelected(name) ? undefined : extents[actuated ? 0 : 1] }));
  }

  #pick(event: MouseEvent): void {
    if (!this.#model || this.isDragOrHandle(event)) return;
    const { separate } = this.#reference;
    const inReference = separate !== null && this.paneUnder(event) !== 0;
    if (!inReference && this.#handle.isHit(this.ray(event))) return;
    const hit = this.intersection(event, inReference ? separate.model.group : this.#model.group);
    const part = (hit?.object.userData.part as PartOf | undefined) ?? null;
    // In the pane of the reference, the part of the shown mechanism with the same name is selected, if there is one.
    if (part && inReference && !this.#model.hasPart(part)) return;
    this.#events.picked(part);
  }
}
