// 3D view of the three-rod robot: cameras and standard views.

import {
  Box3,
  Group,
  Object3D,
  OrthographicCamera,
  PerspectiveCamera,
  Vector3,
  type Material,
} from 'three';
import type { Point } from '../lib/geometry';
import type { Box } from '../lib/labelLayout';
import type { View } from '../lib/link';
import { Annotations } from './annotations';
import { Handles } from './handles';
import type { AxisArrow, Overlay } from './labels';
import { SCENE, type Theme } from './palette';
import { RobotMaterials, RobotModel, SIZES } from './robotModel';
import { updateRobotScene, type RobotPicture } from './robotScene';
import { sceneUnits } from './robotSize';
import { CUBE_SIDES } from './standardViews';
import { LOW_VIEW, SceneRenderer, type Camera, type RendererEvents } from './sceneRenderer';

Object3D.DEFAULT_UP.set(0, 0, 1);

export const STANDARD_VIEWS = { home: [0.6, -1, 0.62], ...CUBE_SIDES } as const;
export type StandardView = keyof typeof STANDARD_VIEWS;

const FIELD_OF_VIEW = 28;
/** Height of the play scale below the view, and the area of the button at its upper left [px]. */
const FOOTER = 76;
const BUTTON = { left: 0, right: 136, top: 0, bottom: 46 } as const;
/** Share of the free part of the view that a box fills. */
const MARGIN = 0.82;
/** Width at the right of other views with view cube and buttons [px]. */
const COLUMN = 104;
/** Height of the ground [units of the scene]. */
const FLOOR = -SIZES.flange - SIZES.housing;

export interface RobotRendererEvents extends RendererEvents {
  viewChanged: () => void;
}

export class RobotRenderer extends SceneRenderer {
  readonly #events: RobotRendererEvents;
  readonly #perspective: PerspectiveCamera;
  readonly #orthographic = new OrthographicCamera(-1, 1, 1, -1, -5000, 20000);
  readonly #materials = new RobotMaterials();
  readonly #annotations = new Annotations();
  #robot: RobotModel | null = null;
  #picture: RobotPicture | null = null;
  #animation = 0;
  /** Units of the scene in a metre. */
  #units = 1000;
  /** Whether the view is still the initial one, which adapts to the size of the window. */
  #initialView = true;
  /** Width at the left of the view that is covered by another element [px]. */
  #covered = 0;

  constructor(host: HTMLElement, events: RobotRendererEvents) {
    const camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 10, 20000);
    super(
      host,
      {
        camera,
        description: '3D view of the robot; its values are in the panels',
        unit_mm: 1,
        occlusion: 60,
        grid: { step: 50, radius: 1100 },
      },
      events,
    );
    this.#perspective = camera;
    this.#events = events;
    this.controls.addEventListener('start', () => (this.#initialView = false));
    this.controls.addEventListener('change', () => this.#events.viewChanged());
    this.scene.add(this.#annotations.group);
    this.canvas.addEventListener('dblclick', (event) => this.#center(event));
    this.measure();
  }

  override dispose(): void {
    cancelAnimationFrame(this.#animation);
    this.#robot?.dispose();
    super.dispose();
  }

  /** Builds the model of a robot from the points of its rods in the base plane and its nominal sockets; shadows reach to the working height [m]. */
  build(limbs: readonly { base_point_m: readonly number[]; socket_m: readonly number[] }[], workingHeight: number): void {
    this.#units = sceneUnits(limbs);
    this.unit_mm = 1000 / this.#units;
    const points = (of: (limb: (typeof limbs)[number]) => readonly number[]) => limbs.map((limb) => of(limb).map((metres) => metres * this.#units) as Point);
    const [bases, sockets] = [points(({ base_point_m }) => base_point_m), points(({ socket_m }) => socket_m)];
    if (this.#robot) {
      this.scene.remove(this.#robot.group);
      this.#robot.dispose();
    }
    this.#robot = new RobotModel({ bases, sockets }, this.#materials);
    this.scene.add(this.#robot.group);
    const radius = Math.max(...sockets.map((socket) => Math.hypot(...socket)));
    this.setHandles(new Handles(radius));
    const reach = radius + SIZES.rim;
    this.placeGround(new Box3(new Vector3(-reach, -reach, FLOOR), new Vector3(reach, reach, this.#units * workingHeight + 60)), FLOOR);
  }

  /** Replaces a generated part by a mesh of the robot file. */
  setMesh(part: 'base' | 'platform', mesh: Object3D): void {
    const scaled = new Group().add(mesh);
    scaled.scale.setScalar(1 / this.unit_mm);
    this.#robot?.setMesh(part, scaled);
    this.partsMoved();
    if (this.#initialView && this.#picture) this.showInitialView();
  }

  /** Material of a part, for meshes without materials. */
  material(part: 'base' | 'platform'): Material {
    return this.#materials[part];
  }

  /** Extent of a displayed part along x, y and z of the base frame [mm]. */
  extent(part: 'base' | 'platform'): number[] {
    const box = this.#robot ? new Box3().setFromObject(this.#robot[part]) : new Box3();
    return box.getSize(new Vector3()).multiplyScalar(this.unit_mm).toArray();
  }

  /** Positions of the corners of the platform on the page [px]. */
  platformOnPage(): { x: number; y: number }[] {
    const { left, top } = this.canvas.getBoundingClientRect();
    return (this.#robot?.corners() ?? []).map((corner) => {
      const { x, y } = corner.project(this.camera);
      return { x: left + ((x + 1) / 2) * this.size.width, y: top + ((1 - y) / 2) * this.size.height };
    });
  }

  /** Boxes of the texts of all labels on the page [px]. */
  labelsOnPage(): Box[] {
    const { left: x, top: y } = this.canvas.getBoundingClientRect();
    return this.labelBoxes.map(({ left, top, right, bottom }) => ({ left: x + left, top: y + top, right: x + right, bottom: y + bottom }));
  }

  set covered(width: number) {
    if (width === this.#covered) return;
    this.#covered = width;
    this.#updateProjection();
    this.invalidate();
  }

  set handlesShown(shown: boolean) {
    if (this.handles) this.handles.group.visible = shown;
    this.invalidate();
  }

  override setTheme(theme: Theme): void {
    const colours = SCENE[theme];
    this.#materials.paint(colours);
    super.setTheme(theme);
  }

  /** Displays a pose. */
  show(picture: RobotPicture): void {
    if (picture.pose !== this.#picture?.pose || picture.exaggeration !== this.#picture.exaggeration || picture.model !== this.#picture.model)
      this.partsMoved();
    if (picture.shown !== this.#picture?.shown) this.surfacesChanged();
    this.#picture = picture;
    if (this.handles) this.handles.group.position.z = picture.pose.axis_height_m * this.#units;
    this.invalidate();
  }

  // Views

  get view(): View {
    return {
      eye_mm: this.camera.position.clone().multiplyScalar(this.unit_mm).toArray(),
      target_mm: this.controls.target.clone().multiplyScalar(this.unit_mm).toArray(),
      projection: this.camera === this.#perspective ? 'perspective' : 'orthographic',
      zoom: this.camera.zoom,
    };
  }

  /** The view, unless it is the initial one, which depends on the size of the window. */
  get chosenView(): View | null {
    return this.#initialView ? null : this.view;
  }

  set view(view: View) {
    this.#initialView = false;
    this.#useCamera(view.projection === 'perspective' ? this.#perspective : this.#orthographic);
    this.camera.position.set(...view.eye_mm).divideScalar(this.unit_mm);
    this.controls.target.set(...view.target_mm).divideScalar(this.unit_mm);
    this.camera.zoom = view.zoom;
    this.#updateProjection();
    this.controls.update();
    this.invalidate();
  }

  toggleProjection(): void {
    const { eye_mm, target_mm, projection } = this.view;
    this.view = { eye_mm, target_mm, zoom: 1, projection: projection === 'perspective' ? 'orthographic' : 'perspective' };
    this.#events.viewChanged();
  }

  /** Shows the robot, or its platform in a view of small height. */
  showInitialView(): void {
    if (this.size.height < 420) this.lookAtPlatform();
    else this.look('home');
    this.#initialView = true;
  }

  /** Shows the robot from a standard direction. */
  look(side: StandardView, box = this.#bounds()): void {
    const [x, y, z] = STANDARD_VIEWS[side];
    this.#showBox(new Vector3(x, y, z).normalize(), box);
  }

  /** Rotates the camera about its target to a standard direction. */
  override turnTo(side: StandardView): void {
    const [x, y, z] = STANDARD_VIEWS[side];
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.#moveCamera(new Vector3(x, y, z).normalize(), this.controls.target.clone(), distance, this.camera.zoom);
  }

  /** Shows the whole robot in the current direction. */
  fit(): void {
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    this.#showBox(direction, this.#bounds());
  }

  /** Shows a close-up of the platform. */
  lookAtPlatform(side: StandardView = 'home'): void {
    const height = (this.#picture?.pose.axis_height_m ?? 0.5) * this.#units;
    const sockets = this.#picture?.robot.limbs.map(({ socket_m }) => Math.hypot(socket_m[0]!, socket_m[1]!) * this.#units) ?? [93];
    const reach = Math.max(...sockets) + SIZES.rim + 12;
    this.look(side, new Box3(new Vector3(-reach, -reach, height - 30), new Vector3(reach, reach, height + 16)));
  }

  /** The part of the robot that standard views show: all above a plane slightly below the flange. */
  #bounds(): Box3 {
    if (this.#picture && this.#robot) updateRobotScene(this.#picture, this.#robot, this.#annotations);
    const box = this.#robot ? new Box3().setFromObject(this.#robot.group) : new Box3();
    if (box.isEmpty()) box.set(new Vector3(-150, -150, 0), new Vector3(150, 150, 500));
    box.min.z = Math.max(box.min.z, -70);
    return box;
  }

  /** Shows a box from a direction, in the part of the view that is not covered. */
  #showBox(direction: Vector3, box: Box3): void {
    const center = box.getCenter(new Vector3());
    const reference = Math.abs(direction.z) > 0.999 ? new Vector3(0, 1, 0) : new Vector3(0, 0, 1);
    const right = reference.clone().cross(direction).normalize();
    const up = direction.clone().cross(right);
    const full = Math.tan((FIELD_OF_VIEW * Math.PI) / 360) * MARGIN;
    const { left, right: covered, top, bottom } = this.#coveredNow;
    const halfWidth = (full * Math.max(this.size.width - left - covered, 200)) / this.size.height;
    const halfHeight = (full * Math.max(this.size.height - top - bottom, 120)) / this.size.height;
    let distance = 1;
    for (let index = 0; index < 8; index++) {
      const corner = new Vector3(...([1, 2, 4].map((bit, i) => ((index & bit) > 0 ? box.max : box.min).getComponent(i)) as [number, number, number]));
      corner.sub(center);
      const depth = corner.dot(direction);
      distance = Math.max(distance, Math.abs(corner.dot(right)) / halfWidth + depth, Math.abs(corner.dot(up)) / halfHeight + depth);
    }
    // The handles may be in the margin around the box.
    for (const end of this.handles?.ends() ?? []) {
      end.sub(center);
      const depth = end.dot(direction);
      distance = Math.max(distance, (MARGIN * Math.abs(end.dot(right))) / halfWidth + depth, (MARGIN * Math.abs(end.dot(up))) / halfHeight + depth);
    }
    this.#moveCamera(direction, center, distance, 1);
  }

  #moveCamera(direction: Vector3, center: Vector3, distance: number, zoom: number): void {
    this.#initialView = false;
    const from = { eye: this.camera.position.clone(), target: this.controls.target.clone(), zoom: this.camera.zoom };
    const eye = center.clone().addScaledVector(direction, distance);
    const interpolate = (share: number) => {
      this.controls.target.lerpVectors(from.target, center, share);
      this.camera.position.lerpVectors(from.eye, eye, share);
      // The straight line between the two positions may pass close to the target.
      const radius = from.eye.distanceTo(from.target) * (1 - share) + distance * share;
      this.camera.position.sub(this.controls.target).setLength(radius).add(this.controls.target);
      this.camera.zoom = from.zoom * (1 - share) + zoom * share;
      this.#updateProjection();
      this.controls.update();
      this.invalidate();
    };
    cancelAnimationFrame(this.#animation);
    if (reducedMotion() || from.eye.lengthSq() === 0) {
      interpolate(1);
      return;
    }
    const start = performance.now();
    const step = (now: number) => {
      const share = Math.min((now - start) / 320, 1);
      interpolate(1 - (1 - share) ** 3);
      if (share < 1) this.#animation = requestAnimationFrame(step);
    };
    this.#animation = requestAnimationFrame(step);
  }

  #useCamera(camera: Camera): void {
    if (camera === this.camera) return;
    this.camera = camera;
    this.controls.object = camera;
  }

  /** What other elements cover of the view [px]; nothing in pictures for export. */
  get #coveredNow(): { left: number; right: number; top: number; bottom: number } {
    if (this.exporting) return { left: 0, right: 0, top: 0, bottom: 0 };
    if (this.isBelowRows) return { left: this.#covered, right: 0, top: this.coveredRows.top * this.size.height, bottom: FOOTER };
    // The playground has neither buttons nor cube.
    const column = this.coveredBoxes().length > 0 ? COLUMN : 0;
    // Views that are low and narrow have the buttons at the left, and the cube at the right.
    const buttons = this.size.height <= LOW_VIEW.height ? column : 0;
    return { left: this.#covered + buttons, right: column, top: 0, bottom: FOOTER };
  }

  #updateProjection(): void {
    const aspect = this.size.width / this.size.height;
    this.#perspective.aspect = aspect;
    const distance = this.camera.position.distanceTo(this.controls.target);
    const half = distance * Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    if (this.camera === this.#orthographic)
      Object.assign(this.#orthographic, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
    const { width, height } = this.size;
    const { left, right, top, bottom } = this.#coveredNow;
    this.camera.setViewOffset(width, height, (right - left) / 2, (bottom - top) / 2, width, height);
    this.camera.updateProjectionMatrix();
  }

  // Frames

  protected resized(): void {
    this.#updateProjection();
    if (this.#initialView && this.#picture) this.showInitialView();
  }

  protected update(): Overlay | null {
    if (!this.#picture || !this.#robot) return null;
    const axes: AxisArrow[] = [];
    const labels = updateRobotScene(this.#picture, this.#robot, this.#annotations, this.vectors ? axes : null);
    return { labels, axes, avoided: this.#robot.silhouettes(), covered: { left: this.#covered + 10, right: this.isNarrow ? 8 : COLUMN }, occupied: [BUTTON, this.cornerBox(0), { left: 0, right: this.size.width, top: this.size.height - FOOTER, bottom: this.size.height }] };
  }

  // The pointer

  #center(event: MouseEvent): void {
    const hit = this.#robot && this.intersection(event, this.#robot.group);
    if (!hit) return;
    const distance = this.camera.position.distanceTo(this.controls.target);
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    this.#moveCamera(direction, hit.point, distance, this.camera.zoom);
  }
}

function reducedMotion(): boolean {
  return window.matchMedia('(prefers-reduced-motion: reduce)').matches;
}
