// The robot in three dimensions: cameras, lights, views.

import {
  ACESFilmicToneMapping,
  Box3,
  DirectionalLight,
  GridHelper,
  HemisphereLight,
  Mesh,
  Object3D,
  OrthographicCamera,
  PCFShadowMap,
  PerspectiveCamera,
  PlaneGeometry,
  ShadowMaterial,
  Vector3,
  type Material,
} from 'three';
import type { Point } from '../lib/geometry';
import type { View } from '../lib/link';
import { Handles } from './handles';
import { SCENE, type Theme } from './palette';
import { draw, type Picture } from './robotScene';
import { RobotMaterials, RobotModel, SIZES } from './robotModel';
import { paintGrid, SceneRenderer, type Camera, type Captions, type RendererEvents } from './sceneRenderer';
import { Annotations } from './annotations';

Object3D.DEFAULT_UP.set(0, 0, 1);

export const STANDARD_VIEWS = {
  home: [0.6, -1, 0.62],
  front: [0, -1, 0],
  back: [0, 1, 0],
  left: [-1, 0, 0],
  right: [1, 0, 0],
  top: [0, -1e-4, 1],
  bottom: [0, -1e-4, -1],
} as const;
export type StandardView = keyof typeof STANDARD_VIEWS;

const FIELD_OF_VIEW = 28;

export interface RobotRendererEvents extends RendererEvents {
  viewChanged: () => void;
}

export class RobotRenderer extends SceneRenderer {
  protected readonly unit_mm = 1;
  readonly #events: RobotRendererEvents;
  readonly #perspective: PerspectiveCamera;
  readonly #orthographic = new OrthographicCamera(-1, 1, 1, -1, -5000, 20000);
  readonly #materials = new RobotMaterials();
  readonly #annotations = new Annotations();
  readonly #sun = new DirectionalLight(0xffffff, 2.1);
  readonly #fill = new DirectionalLight(0xdce8ff, 0.8);
  readonly #rim = new DirectionalLight(0xffffff, 0.9);
  readonly #sky = new HemisphereLight(0xffffff, 0x94a0ac, 1.5);
  readonly #ground = new Mesh(new PlaneGeometry(4000, 4000), new ShadowMaterial({ opacity: 0.2 }));
  readonly #grid = new GridHelper(1600, 32);
  #body: RobotModel | null = null;
  #picture: Picture | null = null;
  #flight = 0;
  /** Nobody has chosen a view yet: a resized picture may choose again. */
  #untouched = true;
  /** Width at the left of the picture that something lies over [px]. */
  #covered = 0;
  /** Called with the canvas after each picture, to film it. */
  film: (() => void) | null = null;

  constructor(host: HTMLElement, events: RobotRendererEvents) {
    const camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 10, 20000);
    super(host, camera, '3D view of the robot; its values are in the panels', events);
    this.#perspective = camera;
    this.#events = events;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    // Shadows change with the robot, not with the eye.
    this.renderer.shadowMap.autoUpdate = false;
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 1.05;
    this.controls.addEventListener('start', () => (this.#untouched = false));
    this.controls.addEventListener('change', () => this.#events.viewChanged());
    // Lamps rather than a picture of a room: without a graphics card, making that one alone takes seconds.
    this.#fill.position.set(-620, -260, 420);
    this.#rim.position.set(120, 760, 520);
    this.#sun.position.set(380, -520, 1100);
    this.#sun.castShadow = true;
    this.#sun.shadow.mapSize.set(1024, 1024);
    this.#sun.shadow.bias = -0.0006;
    this.#sun.shadow.normalBias = 0.6;
    this.#ground.receiveShadow = true;
    const floor = -SIZES.flange - SIZES.housing;
    this.#ground.position.z = floor;
    this.#grid.rotation.x = Math.PI / 2;
    this.#grid.position.z = floor + 0.2;
    this.scene.add(this.#sun, this.#sun.target, this.#fill, this.#rim, this.#sky, this.#ground, this.#grid, this.#annotations.group);
    this.canvas.addEventListener('dblclick', (event) => this.#centre(event));
    this.measure();
  }

  override dispose(): void {
    cancelAnimationFrame(this.#flight);
    this.#body?.dispose();
    super.dispose();
  }

  /** Builds the robot; the view is set if it is the first. */
  build(bases: Point[], sockets: Point[]): void {
    if (this.#body) {
      this.scene.remove(this.#body.group);
      this.#body.dispose();
    }
    this.#body = new RobotModel({ bases, sockets }, this.#materials);
    this.scene.add(this.#body.group);
    const radius = Math.max(...sockets.map((socket) => Math.hypot(...socket)));
    if (this.handles) this.scene.remove(this.handles.group);
    this.handles = new Handles(radius);
    this.scene.add(this.handles.group);
    const reach = radius * 3;
    Object.assign(this.#sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 50, far: 2600 });
    this.#sun.shadow.camera.updateProjectionMatrix();
  }

  /** Shows a shape from the robot file in place of the one made here. */
  wear(part: 'base' | 'platform', shape: Object3D): void {
    this.#body?.wear(part, shape);
    this.renderer.shadowMap.needsUpdate = true;
    this.invalidate();
    if (this.#untouched && this.#picture) this.begin();
  }

  /** What a part with its own material is painted with. */
  material(part: 'base' | 'platform'): Material {
    return this.#materials[part];
  }

  /** How large a part is as it is drawn, along x, y and z of the base frame [mm]. */
  extent(part: 'base' | 'platform'): number[] {
    const box = this.#body ? new Box3().setFromObject(this.#body[part]) : new Box3();
    return box.getSize(new Vector3()).toArray();
  }

  set covered(width: number) {
    if (width === this.#covered) return;
    this.#covered = width;
    this.#frustum();
    this.invalidate();
  }

  set handlesShown(shown: boolean) {
    if (this.handles) this.handles.group.visible = shown;
    this.invalidate();
  }

  paint(theme: Theme): void {
    const colours = SCENE[theme];
    this.#materials.paint(colours);
    this.handles?.paint(colours.handle, colours.handleActive);
    this.#sun.intensity = 2.1 * colours.light;
    this.#fill.intensity = 0.8 * colours.light;
    this.#rim.intensity = 0.9 * colours.light;
    this.#sky.intensity = 1.5 * colours.light;
    (this.#ground.material as ShadowMaterial).opacity = colours.shadow;
    paintGrid(this.#grid, colours.grid);
    this.invalidate();
  }

  show(picture: Picture): void {
    if (picture.pose !== this.#picture?.pose || picture.exaggeration !== this.#picture.exaggeration || picture.model !== this.#picture.model)
      this.renderer.shadowMap.needsUpdate = true;
    this.#picture = picture;
    if (this.handles) this.handles.group.position.z = picture.pose.axis_height_m * 1000;
    this.invalidate();
  }

  // Views

  get view(): View {
    return {
      eye_mm: this.camera.position.toArray(),
      target_mm: this.controls.target.toArray(),
      projection: this.camera === this.#perspective ? 'perspective' : 'orthographic',
      zoom: this.camera.zoom,
    };
  }

  set view(view: View) {
    this.#untouched = false;
    this.#use(view.projection === 'perspective' ? this.#perspective : this.#orthographic);
    this.camera.position.set(...view.eye_mm);
    this.controls.target.set(...view.target_mm);
    this.camera.zoom = view.zoom;
    this.#frustum();
    this.controls.update();
    this.invalidate();
  }

  toggleProjection(): void {
    const { eye_mm, target_mm, projection } = this.view;
    this.view = { eye_mm, target_mm, zoom: 1, projection: projection === 'perspective' ? 'orthographic' : 'perspective' };
    this.#events.viewChanged();
  }

  /** Where a visitor begins: the robot, or in a low picture its platform. */
  begin(): void {
    if (this.size.height < 420) this.lookAtPlatform();
    else this.look('home');
    this.#untouched = true;
  }

  /** Looks at the whole robot from one of the standard sides. */
  look(side: StandardView, box = this.#bounds()): void {
    this.#untouched = false;
    const [x, y, z] = STANDARD_VIEWS[side];
    this.#fly(new Vector3(x, y, z).normalize(), box);
  }

  /** Looks at the same place from another of the standard sides. */
  turnTo(side: StandardView): void {
    const [x, y, z] = STANDARD_VIEWS[side];
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.#approach(new Vector3(x, y, z).normalize(), this.controls.target.clone(), distance, this.camera.zoom);
  }

  /** The turn from the base frame to the eye's, column by column: what a view cube shows. */
  get turn(): number[] {
    return this.camera.matrixWorldInverse.toArray();
  }

  /** Keeps the direction and shows the whole robot. */
  fit(): void {
    const way = this.camera.position.clone().sub(this.controls.target).normalize();
    this.#fly(way, this.#bounds());
  }

  /** Shows the platform from near. */
  lookAtPlatform(side: StandardView = 'home'): void {
    const height = (this.#picture?.pose.axis_height_m ?? 0.5) * 1000;
    const sockets = this.#picture?.robot.limbs.map((limb) => limb.socket_radius_m * 1000) ?? [93];
    const reach = Math.max(...sockets) + SIZES.rim + 12;
    this.look(side, new Box3(new Vector3(-reach, -reach, height - 40), new Vector3(reach, reach, height + 40)));
  }

  /** What of the robot should be in view: down to a little below the flange. */
  #bounds(): Box3 {
    if (this.#picture && this.#body) draw(this.#picture, this.#body, this.#annotations);
    const box = this.#body ? new Box3().setFromObject(this.#body.group) : new Box3();
    if (box.isEmpty()) box.set(new Vector3(-150, -150, 0), new Vector3(150, 150, 500));
    box.min.z = Math.max(box.min.z, -70);
    return box;
  }

  /** Shows a box from a side, leaving room for what lies over the picture. */
  #fly(way: Vector3, box: Box3): void {
    const center = box.getCenter(new Vector3());
    const up = Math.abs(way.z) > 0.999 ? new Vector3(0, 1, 0) : new Vector3(0, 0, 1);
    const right = up.clone().cross(way).normalize();
    const over = way.clone().cross(right);
    const tall = Math.tan((FIELD_OF_VIEW * Math.PI) / 360) * 0.8;
    const wide = (tall * Math.max(this.size.width - this.#covered, 200)) / this.size.height;
    let distance = 1;
    for (let corner = 0; corner < 8; corner++) {
      const at = new Vector3(...([1, 2, 4].map((bit, i) => ((corner & bit) > 0 ? box.max : box.min).getComponent(i)) as [number, number, number]));
      at.sub(center);
      const near = at.dot(way);
      distance = Math.max(distance, Math.abs(at.dot(right)) / wide + near, Math.abs(at.dot(over)) / tall + near);
    }
    this.#approach(way, center, distance, 1);
  }

  #approach(way: Vector3, center: Vector3, distance: number, zoom: number): void {
    const from = { eye: this.camera.position.clone(), target: this.controls.target.clone(), zoom: this.camera.zoom };
    const eye = center.clone().addScaledVector(way, distance);
    const arrive = (part: number) => {
      this.controls.target.lerpVectors(from.target, center, part);
      this.camera.position.lerpVectors(from.eye, eye, part);
      // On the straight way the eye would pass near what it looks at.
      const reach = from.eye.distanceTo(from.target) * (1 - part) + distance * part;
      this.camera.position.sub(this.controls.target).setLength(reach).add(this.controls.target);
      this.camera.zoom = from.zoom * (1 - part) + zoom * part;
      this.#frustum();
      this.controls.update();
      this.invalidate();
    };
    cancelAnimationFrame(this.#flight);
    if (reducedMotion() || from.eye.lengthSq() === 0) {
      arrive(1);
      return;
    }
    const start = performance.now();
    const step = (now: number) => {
      const part = Math.min((now - start) / 320, 1);
      arrive(1 - (1 - part) ** 3);
      if (part < 1) this.#flight = requestAnimationFrame(step);
    };
    this.#flight = requestAnimationFrame(step);
  }

  #use(camera: Camera): void {
    if (camera === this.camera) return;
    this.camera = camera;
    this.controls.object = camera;
  }

  #frustum(): void {
    const aspect = this.size.width / this.size.height;
    this.#perspective.aspect = aspect;
    const distance = this.camera.position.distanceTo(this.controls.target);
    const half = distance * Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    if (this.camera === this.#orthographic)
      Object.assign(this.#orthographic, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
    const { width, height } = this.size;
    this.camera.setViewOffset(width, height, -this.#covered / 2, 0, width, height);
    this.camera.updateProjectionMatrix();
  }

  // Pictures

  protected resized(): void {
    this.#frustum();
    if (this.#untouched && this.#picture) this.begin();
  }

  protected compose(): Captions | null {
    if (!this.#picture || !this.#body) return null;
    const labels = draw(this.#picture, this.#body, this.#annotations);
    return { labels, covered: { left: this.#covered + 10, right: 104 }, theme: this.#picture.theme };
  }

  protected override finished(): void {
    this.film?.();
  }

  /** Paints what is seen onto a canvas, with a line that says how play is drawn. */
  copyTo(canvas: HTMLCanvasElement, note: string): void {
    const source = this.renderer.domElement;
    if (canvas.width !== source.width || canvas.height !== source.height) {
      canvas.width = source.width;
      canvas.height = source.height;
    }
    const context = canvas.getContext('2d');
    if (!context || !this.#picture) return;
    const colours = SCENE[this.#picture.theme];
    const ratio = this.renderer.getPixelRatio();
    context.fillStyle = colours.background;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(source, 0, 0);
    context.drawImage(this.labelCanvas, 0, 0);
    context.font = `600 ${14 * ratio}px system-ui, sans-serif`;
    context.fillStyle = colours.ink;
    context.fillText(note, 14 * ratio, canvas.height - 14 * ratio);
  }

  /** What is seen. */
  snapshot(note: string): Promise<Blob | null> {
    const film = this.film;
    this.film = null;
    this.render();
    const canvas = document.createElement('canvas');
    this.copyTo(canvas, note);
    this.film = film;
    this.invalidate();
    return new Promise((done) => canvas.toBlob(done, 'image/png'));
  }

  // The pointer

  #centre(event: MouseEvent): void {
    const hit = this.#body && this.ray(event).intersectObject(this.#body.group, true)[0];
    if (!hit) return;
    const distance = this.camera.position.distanceTo(this.controls.target);
    const way = this.camera.position.clone().sub(this.controls.target).normalize();
    this.#approach(way, hit.point, distance, this.camera.zoom);
  }
}

function reducedMotion(): boolean {
  return window.matchMedia('(prefers-reduced-motion: reduce)').matches;
}
