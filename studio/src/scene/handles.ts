// Drag handles of a movable object, one for each of its degrees of freedom. Units before scaling: mm.

import {
  ConeGeometry,
  CylinderGeometry,
  Group,
  Mesh,
  MeshBasicMaterial,
  TorusGeometry,
  Vector2,
  Vector3,
  type Camera,
  type Object3D,
  type Raycaster,
} from 'three';
import { disposeGeometries } from './dispose';

export type Freedom = 'x' | 'y' | 'height' | 'heading' | 'about_x' | 'about_y';

/** Descriptions of the handles for tooltips. */
export const DESCRIPTIONS: Record<Freedom, string> = {
  x: 'along x',
  y: 'along y',
  height: 'along z',
  heading: 'rotate about z',
  about_x: 'tilt about x',
  about_y: 'tilt about y',
};

/** Degrees of freedom of the platform. */
const PLATFORM: readonly Freedom[] = ['height', 'about_x', 'about_y'];

/** Pointer movement for one degree of tilt [px]: tilts are small, so that dragging is scaled down. */
const PIXELS_PER_DEGREE = 90;

/** From a grip to both ends of its handle. */
const HALF_LENGTH = 30;

interface Handle {
  freedom: Freedom;
  group: Group;
  /** Position of the grip and its direction of motion for increasing values, in the frame of the group. */
  position: Vector3;
  direction: Vector3;
}

export class Handles {
  readonly group = new Group();
  readonly #handles: Handle[] = [];
  readonly #idle = new MeshBasicMaterial({ depthTest: false, transparent: true, opacity: 0.7, toneMapped: false });
  readonly #active = new MeshBasicMaterial({ depthTest: false, transparent: true, toneMapped: false });
  #highlighted: Freedom | null = null;

  readonly #reach: number;

  constructor(radius: number, freedoms: readonly Freedom[] = PLATFORM) {
    const reach = radius + 62;
    this.#reach = reach;
    const [x, y, z] = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)];
    for (const freedom of freedoms)
      switch (freedom) {
        // Positive about x lifts the side toward +y, positive about y lowers the side toward +x.
        case 'about_x':
          this.#add(freedom, y.clone().multiplyScalar(reach), z, arc(reach, 'x'));
          break;
        case 'about_y':
          this.#add(freedom, x.clone().multiplyScalar(reach), z.clone().negate(), arc(reach, 'y'));
          break;
        case 'heading':
          this.#add(freedom, new Vector3(-Math.SQRT1_2, -Math.SQRT1_2, 0).multiplyScalar(reach), new Vector3(Math.SQRT1_2, -Math.SQRT1_2, 0), arc(reach, 'z'));
          break;
        case 'height':
          this.#add(freedom, z.clone().multiplyScalar(74), z, straight());
          break;
        default: {
          const along = freedom === 'x' ? x : y;
          const group = straight();
          group.quaternion.setFromUnitVectors(z, along);
          this.#add(freedom, along.clone().multiplyScalar(74), along, group);
        }
      }
  }

  paint(idle: number, active: number): void {
    this.#idle.color.set(idle);
    this.#active.color.set(active);
  }

  /** Position of a grip in the scene. */
  grip(freedom: Freedom): Vector3 | null {
    const handle = this.#handles.find((one) => one.freedom === freedom);
    return handle ? this.group.localToWorld(handle.position.clone()) : null;
  }

  /** Positions of all grips in the scene; none while the handles are hidden. */
  grips(): Vector3[] {
    if (!this.group.visible) return [];
    return this.#handles.map(({ position }) => this.group.localToWorld(position.clone()));
  }

  /** Both ends of all handles in the scene; none while they are hidden. */
  ends(): Vector3[] {
    if (!this.group.visible) return [];
    return this.#handles.flatMap(({ position, direction }) => [-HALF_LENGTH, HALF_LENGTH].map((along) => this.group.localToWorld(position.clone().addScaledVector(direction, along))));
  }

  /** Disposes of geometries and materials. */
  dispose(): void {
    disposeGeometries(this.group);
    this.#idle.dispose();
    this.#active.dispose();
  }

  /** The handle on a ray; of several, the one whose grip is nearest to the ray. */
  pick(ray: Raycaster): Freedom | null {
    if (!this.group.visible) return null;
    const candidates = this.#handles.filter(({ group }) => ray.intersectObject(group, true).length > 0);
    const distance = ({ position }: Handle) => ray.ray.distanceSqToPoint(this.group.localToWorld(position.clone()));
    return candidates.reduce<Handle | null>((nearest, one) => (nearest && distance(nearest) <= distance(one) ? nearest : one), null)?.freedom ?? null;
  }

  /** Highlights one handle; returns whether this is a change. */
  highlight(freedom: Freedom | null): boolean {
    if (freedom === this.#highlighted) return false;
    this.#highlighted = freedom;
    for (const handle of this.#handles)
      handle.group.traverse((part) => {
        if (part instanceof Mesh && part.visible) part.material = handle.freedom === freedom ? this.#active : this.#idle;
      });
    return true;
  }

  /**
   * Displacement of a degree of freedom for a pointer movement [px]: in mm or degrees; tilts are scaled down, heading follows the pointer.
   * `unit_mm` is the length of a unit of the scene [mm].
   */
  displacement(freedom: Freedom, moved: Vector2, camera: Camera, size: { width: number; height: number }, unit_mm: number): number {
    const handle = this.#handles.find((one) => one.freedom === freedom) as Handle;
    const start = this.group.localToWorld(handle.position.clone());
    const end = this.group.localToWorld(handle.position.clone().add(handle.direction));
    const projected = toPixels(end, camera, size).sub(toPixels(start, camera, size));
    const pixels = projected.length();
    if (pixels < 1e-3) return 0;
    const along = moved.dot(projected.normalize());
    if (freedom === 'about_x' || freedom === 'about_y') return along / PIXELS_PER_DEGREE;
    const displacement = along / pixels;
    return freedom === 'heading' ? ((displacement / this.#reach) * 180) / Math.PI : displacement * this.group.scale.x * unit_mm;
  }

  #add(freedom: Freedom, position: Vector3, direction: Vector3, group: Group): void {
    group.traverse((part) => {
      if (part instanceof Mesh && part.visible) part.material = this.#idle;
      part.renderOrder = 9;
    });
    this.#handles.push({ freedom, group, position, direction });
    this.group.add(group);
  }
}

function toPixels(point: Vector3, camera: Camera, { width, height }: { width: number; height: number }): Vector2 {
  const projected = point.project(camera);
  return new Vector2(((projected.x + 1) / 2) * width, ((1 - projected.y) / 2) * height);
}

/** A circular arc about an axis through the centre with an arrow head at each end, and an invisible wider arc for picking. */
function arc(radius: number, about: 'x' | 'y' | 'z'): Group {
  const half = 0.2;
  const group = new Group();
  const rotated = new Group();
  group.add(rotated);
  // A torus lies in its xy plane and starts at +x; it is rotated so that its middle is at the grip.
  if (about === 'y') rotated.rotation.set(Math.PI / 2, 0, 0);
  else if (about === 'x') rotated.rotation.set(Math.PI / 2, Math.PI / 2, 0);
  // Opposite to the straight handles.
  else rotated.rotation.set(0, 0, (-3 * Math.PI) / 4);
  const line = new Mesh(new TorusGeometry(radius, 1.5, 10, 24, 2 * half));
  line.rotation.z = -half;
  const grip = new Mesh(new TorusGeometry(radius, 9, 6, 12, 2.4 * half), new MeshBasicMaterial({ visible: false }));
  grip.rotation.z = -1.2 * half;
  grip.visible = false;
  rotated.add(line, grip);
  for (const side of [-1, 1]) {
    const head = cone();
    head.position.set(radius * Math.cos(half), side * radius * Math.sin(half), 0);
    head.rotation.z = side * half + (side < 0 ? Math.PI : 0);
    rotated.add(head);
  }
  return group;
}

function straight(): Group {
  const group = new Group();
  const line = new Mesh(new CylinderGeometry(1.5, 1.5, 34, 12).rotateX(Math.PI / 2));
  line.position.z = 74;
  const grip = new Mesh(new CylinderGeometry(10, 10, 64, 8).rotateX(Math.PI / 2));
  grip.visible = false;
  grip.position.z = 74;
  group.add(line, grip);
  for (const side of [-1, 1]) {
    const head = cone();
    head.rotation.x = side > 0 ? Math.PI / 2 : -Math.PI / 2;
    head.position.z = 74 + side * 17;
    group.add(head);
  }
  return group;
}

/** A cone along +y. */
function cone(): Object3D {
  return new Mesh(new ConeGeometry(4.6, 11, 20).translate(0, 5.5, 0));
}
