// 3D view of a work cell. The cell is a glTF scene of the server; the motion moves its frames. Units: m.

import { Box3, Group, Mesh, MeshStandardMaterial, Object3D, PerspectiveCamera, Plane, Ray, Vector3, type Material } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import type { StationDocument } from '../api/client';
import type { Frame } from '../lib/kinematics';
import { partKey, partTitle, type CellParts, type Part, type Slot } from '../lib/parts';
import { CellMaterials, type CellMaterial } from '../scene/cellMaterials';
import { Handles, type Freedom } from '../scene/handles';
import type { Label, Overlay } from '../scene/labels';
import { CellLines } from './cellLines';
import { frameOf } from './stationFrame';
import { boxCorners, sceneParts } from './sceneParts';
import { SECTION_AXES, type PointOfPart, type Section } from './viewTools.svelte';
import { SceneRenderer, type RendererEvents } from '../scene/sceneRenderer';
import { STANDARD_VIEWS, type SceneView } from '../scene/standardViews';

/** Color and emission of parts in violation, for a current and for an outdated check. */
const VIOLATION_COLORS = { checked: [0xd62f1f, 0x8a1208], outdated: [0x8a9099, 0x30343a] } as const;

export interface CellRendererEvents extends RendererEvents {
  /** A part was clicked, at a point that moves with it; `null` for the background. */
  picked: (part: Part | null, point: PointOfPart | null) => void;
  /** A cell was loaded, with the corners of the box around it [m]. */
  loaded: (extent: [number[], number[]]) => void;
}

/** Layer of hidden parts. */
const HIDDEN_LAYER = 31;
/** Radius of the drag handles of a station before scaling, and their largest size on the screen [px]. */
const HANDLES = { radius: 40, size: 130 } as const;

/** Walls within this share of the viewing distance from the line of sight are transparent. */
const WALL_MARGIN = 0.08;
/** Length of a station among many ones [m]: stations have no labels in views from far away. */
const LABELLED_M = 0.3;
/** Number of stations from which on each label has only that length. */
const MANY_STATIONS = 12;

export class CellRenderer extends SceneRenderer {
  readonly #events: CellRendererEvents;
  readonly #eye: PerspectiveCamera;
  // Transparent, so that a part inside another one is visible.
  readonly #violating = new MeshStandardMaterial({ color: VIOLATION_COLORS.checked[0], emissive: VIOLATION_COLORS.checked[1], roughness: 0.6, transparent: true, opacity: 0.7, depthWrite: false });
  readonly #selected = new MeshStandardMaterial({ color: 0xf0b000, emissive: 0x5a3d00, roughness: 0.6, transparent: true, opacity: 0.55, depthWrite: false });
  #cell: Object3D | null = null;
  readonly #look = new CellMaterials();
  #materials = new Map<Mesh, Material | Material[]>();
  /** Stationary bodies that may be between the viewer and the robot, with their extents. */
  #walls: { mesh: Mesh; box: Box3 }[] = [];
  /** The part that each mesh shows. */
  #shows: ReadonlyMap<Object3D, Part> = new Map();
  /** Moving frames, by the names with which the server sends their poses. */
  #frames: ReadonlyMap<string, Object3D> = new Map();
  /** The object at the origin of each part, by its key. */
  #objects: ReadonlyMap<string, Object3D> = new Map();
  /** Slots and bodies of each station, by its name. */
  #stationParts = new Map<string, Object3D[]>();
  /** Poses of the frames with the robot at home. */
  #home: Frame[] = [];
  /** Slot of each wafer that rests in one, by name. */
  #restingWafers: ReadonlyMap<string, Slot> = new Map();
  #stations: { name: string; position: Vector3 }[] = [];
  #displayedFrames: readonly Frame[] | null = null;
  /** Preview of a dragged station: the parts that move with it. */
  #preview: { station: string; group: Group } | null = null;
  readonly #lines = new CellLines();
  #hidden: ReadonlySet<string> = new Set();
  /** Names of stations without a shown part: they have no labels. */
  readonly #hiddenStations = new Set<string>();
  #followed: Part | null = null;
  #followedAt: Vector3 | null = null;
  #loads = 0;
  readonly #around = new Box3();
  readonly #seen = new Vector3();
  /** Whether the camera was restored before the first cell was loaded. */
  #cameraRestored = false;
  #highlighted: { violating: ReadonlySet<string>; selected: ReadonlySet<string> } = { violating: new Set(), selected: new Set() };

  constructor(host: HTMLElement, events: CellRendererEvents) {
    const eye = new PerspectiveCamera(32, 1, 0.02, 60);
    eye.up.set(0, 0, 1);
    super(
      host,
      {
        camera: eye,
        description: '3D view of the cell; its stations, steps and violations are listed in the panels',
        unit_mm: 1000,
        occlusion: 0.16,
        grid: { step: 0.1, radius: 2.4 },
      },
      events,
    );
    this.#eye = eye;
    this.#events = events;
    this.scene.add(this.#lines.group);
    this.canvas.addEventListener('click', (event) => this.#pick(event));
    this.measure();
  }

  override dispose(): void {
    this.#lines.dispose();
    this.#clear();
    this.#look.dispose();
    super.dispose();
  }

  /** Names of the parts highlighted as selected. */
  get selected(): string[] {
    return this.#titles(({ material }) => material === this.#selected);
  }

  /** Keys of the parts highlighted as in contact or in violation. */
  get violating(): string[] {
    return [...new Set(this.#partsOf(({ material }) => material === this.#violating).map(partKey))];
  }

  /** Names of the parts whose meshes satisfy a condition. */
  #titles(holds: (mesh: Mesh) => boolean): string[] {
    return [...new Set(this.#partsOf(holds).map(partTitle))];
  }

  #partsOf(holds: (mesh: Mesh) => boolean): Part[] {
    return [...this.#materials.keys()].filter(holds).flatMap((mesh) => this.#shows.get(mesh) ?? []);
  }

  /** Keys of all parts. */
  get parts(): ReadonlySet<string> {
    return new Set([...this.#shows.values()].map(partKey));
  }

  /** Names of all parts. */
  get partTitles(): string[] {
    return this.#titles(() => true);
  }

  /** Displays another cell; the camera does not move. */
  async load(file: ArrayBuffer, stations: { name: string; position_mm: number[] }[], bodies: CellParts['bodies']): Promise<void> {
    const load = ++this.#loads;
    const { scene } = await new GLTFLoader().parseAsync(file, '');
    if (load !== this.#loads) return;
    const first = this.#cell === null;
    this.#clear();
    const { meshes, frames, objects } = sceneParts(scene, bodies);
    this.#shows = meshes;
    this.#frames = frames;
    this.#objects = objects;
    // glTF has y up.
    scene.rotation.x = Math.PI / 2;
    scene.updateMatrixWorld(true);
    scene.traverse((part) => {
      if (part instanceof Mesh) {
        const material = (part.material as Material).name as CellMaterial;
        (part.material as Material).dispose();
        this.#look.finish(part, material, this.#placeInStation(part, stations));
        this.#materials.set(part, part.material as Material);
        if (part.material === this.#look.body) this.#walls.push({ mesh: part, box: new Box3() });
      }
      const { station } = part.userData as { station?: string };
      if (station) this.#stationParts.set(station, [...(this.#stationParts.get(station) ?? []), part]);
    });
    this.#cell = scene;
    this.scene.add(scene);
    for (const { mesh, box } of this.#walls) box.setFromObject(mesh);
    const box = new Box3().setFromObject(scene);
    this.placeGround(box, box.min.z);
    this.#home = [...this.#frames].map(([name, { position, quaternion }]) => ({ name, origin_m: position.toArray(), quaternion: quaternion.toArray() }));
    this.#stations = stations.map(({ name, position_mm: [x, y, z] }) => ({ name, position: new Vector3(x! / 1000, y! / 1000, z! / 1000 + 0.02) }));
    this.place(this.#displayedFrames, this.#restingWafers);
    this.#highlight();
    this.hide(this.#hidden);
    if (!box.isEmpty()) this.#events.loaded([box.min.toArray(), box.max.toArray()]);
    if (first && !this.#cameraRestored) this.showView('home');
  }

  /** Whether a body of a station is around its wafers or below them; `null` for other parts. */
  #placeInStation(mesh: Mesh, stations: { name: string; position_mm: number[] }[]): 'around wafers' | 'below wafers' | null {
    const { station } = mesh.userData as { station?: string };
    const lowest = stations.find(({ name }) => name === station)?.position_mm[2];
    if (lowest === undefined) return null;
    return new Box3().setFromObject(mesh).max.z > lowest / 1000 ? 'around wafers' : 'below wafers';
  }

  /** Moves the frames to their poses and assigns resting wafers to slots; without frames, the robot is at home. */
  place(frames: readonly Frame[] | null, restingWafers: ReadonlyMap<string, Slot>): void {
    this.#displayedFrames = frames;
    this.#restingWafers = restingWafers;
    for (const { name, origin_m, quaternion } of frames ?? this.#home) {
      const part = this.#frames.get(name);
      part?.position.fromArray(origin_m);
      part?.quaternion.fromArray(quaternion);
    }
    this.#attachWafers();
    this.#moveCameraAlong();
    this.partsMoved();
  }

  /** Origin of a frame, or of a part with this name, in the base frame [m]. */
  origin(name: string): number[] | null {
    const part = this.#frames.get(name) ?? [...this.#shows].find(([, shown]) => partTitle(shown) === name)?.[0];
    return part ? this.#originOf(part).toArray() : null;
  }

  #originOf(part: Object3D): Vector3 {
    this.#cell?.updateMatrixWorld(true);
    return part.getWorldPosition(new Vector3());
  }

  /** Highlights parts by their keys: those in violation, and the selected ones. */
  highlight(violating: ReadonlySet<string>, selected: ReadonlySet<string>): void {
    this.#highlighted = { violating, selected };
    this.#highlight();
    this.surfacesChanged();
  }

  /** Whether the highlighted violations belong to an earlier state; they are then gray. */
  set outdated(outdated: boolean) {
    const [color, emissive] = outdated ? VIOLATION_COLORS.outdated : VIOLATION_COLORS.checked;
    this.#violating.color.setHex(color);
    this.#violating.emissive.setHex(emissive);
    this.invalidate();
  }

  /** Color of parts in violation, as hexadecimal digits. */
  get violationColor(): string {
    return this.#violating.color.getHexString();
  }

  /** Position and target of the camera [m]. */
  get cameraPose(): { eye: number[]; target: number[] } {
    return { eye: this.#eye.position.toArray(), target: this.controls.target.toArray() };
  }

  set cameraPose({ eye, target }: { eye: number[]; target: number[] }) {
    this.#eye.position.fromArray(eye);
    this.controls.target.fromArray(target);
    this.#cameraRestored = true;
    this.controls.update();
    this.invalidate();
  }

  /** Shows drag handles at a position [m] for the given degrees of freedom; hides them without a position. */
  showHandles(position: number[] | null, freedoms: readonly Freedom[]): void {
    if (this.dragging) {
      if (position) this.handles?.group.position.fromArray(position);
      this.invalidate();
      return;
    }
    if (position && freedoms.length > 0) {
      const handles = new Handles(HANDLES.radius, freedoms);
      handles.group.position.fromArray(position);
      this.setHandles(handles);
      this.#scaleHandles();
    } else this.setHandles(null);
    this.invalidate();
  }

  /** Scales the handles to a constant size on the screen. */
  #scaleHandles(): void {
    const group = this.handles?.group;
    if (!group || this.dragging) return;
    const perPixel = (2 * Math.tan((this.#eye.fov * Math.PI) / 360) * this.#eye.position.distanceTo(group.position)) / this.size.height;
    group.scale.setScalar((perPixel * Math.min(HANDLES.size, 0.26 * this.size.height)) / (HANDLES.radius + 62));
  }

  /** Position of a handle on the page [px]. */
  grip(freedom: Freedom): { x: number; y: number } | null {
    this.scene.updateMatrixWorld();
    const projected = this.handles?.grip(freedom)?.project(this.#eye);
    const box = this.canvas.getBoundingClientRect();
    return projected ? { x: box.left + ((projected.x + 1) / 2) * box.width, y: box.top + ((1 - projected.y) / 2) * box.height } : null;
  }

  /** Displays a station at another pose, with its slots, bodies and wafers, until the next plan arrives. */
  previewStation(from: StationDocument, to: StationDocument): void {
    if (this.#preview?.station !== from.name) {
      this.clearPreview();
      const group = new Group();
      this.#baseFrame?.add(group);
      this.#preview = { station: from.name, group };
      for (const part of this.#stationParts.get(from.name) ?? []) this.#attach(part, true);
      this.#attachWafers();
    }
    const { position, quaternion, scale } = this.#preview!.group;
    frameOf(to).multiply(frameOf(from).invert()).decompose(position, quaternion, scale);
    this.partsMoved();
  }

  /** Ends the preview of a station. */
  clearPreview(): void {
    if (!this.#preview) return;
    const { group } = this.#preview;
    for (const part of [...group.children]) this.#attach(part, false);
    group.removeFromParent();
    this.#preview = null;
    this.partsMoved();
  }

  /** The node of the base frame. */
  get #baseFrame(): Object3D | null {
    return this.#cell?.children[0] ?? null;
  }

  /** Attaches a part to the previewed station or to the base frame. */
  #attach(part: Object3D, toStation: boolean): void {
    const parent = toStation ? this.#preview?.group : this.#baseFrame;
    if (parent && part.parent !== parent) parent.add(part);
  }

  /** Attaches the wafers that rest in the previewed station to it. */
  #attachWafers(): void {
    if (!this.#preview) return;
    for (const [name, slot] of this.#restingWafers) {
      const part = this.#frames.get(name);
      if (part) this.#attach(part, slot.station === this.#preview.station);
    }
  }

  /** Shows the cell from a standard direction. */
  showView(view: SceneView): void {
    const box = this.#cell ? new Box3().setFromObject(this.#cell) : new Box3();
    if (box.isEmpty()) box.set(new Vector3(-0.8, -0.8, 0), new Vector3(0.8, 0.8, 1));
    this.lookAtBox(this.#eye, box, new Vector3(...STANDARD_VIEWS[view]));
  }

  #highlight(): void {
    const { violating, selected } = this.#highlighted;
    for (const [mesh, own] of this.#materials) {
      const part = this.#shows.get(mesh);
      const key = part && partKey(part);
      mesh.material = key === undefined ? own : violating.has(key) ? this.#violating : selected.has(key) ? this.#selected : own;
    }
  }

  #clear(): void {
    this.#look.clear();
    this.#walls = [];
    this.#materials = new Map();
    this.#shows = new Map();
    this.#frames = new Map();
    this.#objects = new Map();
    this.#stationParts = new Map();
    this.#preview = null;
    if (this.#cell) this.scene.remove(this.#cell);
    this.#cell = null;
  }

  protected resized(): void {
    this.#eye.aspect = this.size.width / this.size.height;
    this.#eye.updateProjectionMatrix();
  }

  /** Texts of the labels of stations in the view. */
  stationLabels: readonly string[] = [];

  protected update(): Overlay | null {
    if (!this.#cell) return null;
    this.#scaleHandles();
    this.#seeThroughWalls();
    const planes = this.renderer.clippingPlanes as Plane[];
    const isShown = ({ name, position }: { name: string; position: Vector3 }) => !this.#hiddenStations.has(name) && planes.every((plane) => plane.distanceToPoint(position) >= 0);
    const stations = this.#stations.map(({ name, position }) => ({ name, position: this.#labelPosition(name, position) })).filter(isShown);
    // The fewer labels, the more space each of them has.
    const extent = LABELLED_M * Math.max(1, Math.sqrt(MANY_STATIONS / Math.max(stations.length, 1)));
    const labels: Label[] = stations.map(({ name, position }) => ({ position, text: name, strong: true, stays: true, extent }));
    this.stationLabels = labels.map(({ text }) => text);
    const { measuredLabel, nearestLabel } = this.#lines;
    if (measuredLabel) labels.push(measuredLabel);
    if (nearestLabel) labels.unshift(nearestLabel);
    return { labels, avoided: nearestLabel ? this.#robotPoints() : [], covered: { left: 8, right: 8 }, occupied: [this.cornerBox(72)] };
  }

  /** Corners of the boxes around the parts of platform and arms [m]. */
  #robotPoints(): Vector3[][] {
    return [...this.#objects].filter(([key]) => key.startsWith('platform:')).flatMap(([, object]) => boxCorners(object));
  }

  /** Makes walls transparent that are between the viewer and the point that is looked at. */
  #seeThroughWalls(): void {
    const eye = this.#eye.position;
    const toTarget = this.controls.target.clone().sub(eye);
    const distance = toTarget.length();
    const ray = new Ray(eye, toTarget.normalize());
    for (const { mesh, box } of this.#walls) {
      const hit = ray.intersectBox(this.#around.copy(box).expandByScalar(WALL_MARGIN * distance), this.#seen);
      const obstructing = hit !== null && hit.distanceTo(eye) < 0.8 * distance;
      const own = obstructing ? this.#look.obstructing : this.#look.body;
      if (this.#materials.get(mesh) === own) continue;
      if (mesh.material === this.#materials.get(mesh)) mesh.material = own;
      this.#materials.set(mesh, own);
    }
  }

  /** Position of the label of a station, with the preview of a dragged station. */
  #labelPosition(station: string, position: Vector3): Vector3 {
    if (this.#preview?.station !== station) return position;
    const { group } = this.#preview;
    return position.clone().applyQuaternion(group.quaternion).add(group.position);
  }

  // Tools of the view

  /** Hides parts by their keys. */
  hide(hidden: ReadonlySet<string>): void {
    this.#hidden = hidden;
    const shown = new Set<string>();
    this.#hiddenStations.clear();
    // The layer also hides the part from the pointer.
    for (const mesh of this.#materials.keys()) {
      const part = this.#shows.get(mesh);
      const isHidden = part !== undefined && hidden.has(partKey(part));
      mesh.layers.set(isHidden ? HIDDEN_LAYER : 0);
      if (part?.kind === 'station' || part?.kind === 'slot') (isHidden ? this.#hiddenStations : shown).add(part.name);
    }
    // A station with one shown slot has its label.
    for (const name of shown) this.#hiddenStations.delete(name);
    this.partsMoved();
  }

  /** Names of the parts that are drawn. */
  get shownParts(): string[] {
    return this.#titles(({ layers }) => layers.isEnabled(0));
  }

  /** Cuts the view by a plane; `null` for none. */
  cut(section: Section | null): void {
    const normal = new Vector3();
    if (section) normal.setComponent(SECTION_AXES.indexOf(section.axis), -1);
    this.renderer.clippingPlanes = section ? [new Plane(normal, section.at)] : [];
    this.surfacesChanged();
  }

  /** Moves the camera along with a part; `null` for none. */
  follow(part: Part | null): void {
    this.#followed = part;
    this.#followedAt = part === null ? null : this.#place(part);
  }

  #moveCameraAlong(): void {
    if (this.#followed === null) return;
    const now = this.#place(this.#followed);
    if (now && this.#followedAt) {
      const by = now.clone().sub(this.#followedAt);
      this.#eye.position.add(by);
      this.controls.target.add(by);
      this.controls.update();
    }
    this.#followedAt = now;
  }

  /** Position of a part in the base frame [m]. */
  #place(part: Part): Vector3 | null {
    const object = this.#objects.get(partKey(part));
    return object ? this.#originOf(object) : null;
  }

  /** Draws a path: pairs of points [m]. */
  showPath(points: readonly number[]): void {
    this.#lines.showPath(points);
    this.invalidate();
  }

  /** Draws the line between the nearest points of two parts [m], with a text; `null` for none. */
  showNearest(points: readonly number[][] | null, text: string): void {
    this.#lines.showNearest(points, text);
    this.invalidate();
  }

  /** End points of the line between nearest points [m]; empty without a line. */
  get nearestPoints(): number[] {
    return this.#lines.nearestPoints;
  }

  /** Draws the clicked points of a measurement [m], and the line between two of them with a text. */
  showMeasured(points: readonly number[][], text: string): void {
    this.#lines.showMeasured(points, text);
    this.invalidate();
  }

  #pick(event: MouseEvent): void {
    if (!this.#cell || this.isDragOrHandle(event)) return;
    const hit = this.intersection(event, this.#cell);
    if (!hit) return this.#events.picked(null, null);
    // A clicked point moves with its part.
    const { object } = hit;
    const local = object.worldToLocal(hit.point.clone());
    const point = () => (this.#materials.has(object as Mesh) ? object.localToWorld(local.clone()).toArray() : null);
    this.#events.picked(this.#shows.get(object) ?? null, point);
  }
}
