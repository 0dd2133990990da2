// Handles by which things are dragged, one for each freedom that they have. Millimetres, before they are scaled.

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

export type Freedom = 'x' | 'y' | 'height' | 'yaw' | 'about_x' | 'about_y';

/** What a handle does, for people. */
export const SAYS: Record<Freedom, string> = {
  x: 'along x',
  y: 'along y',
  height: 'along z',
  yaw: 'rotate about z',
  about_x: 'tilt about x',
  about_y: 'tilt about y',
};

/** The platform has these, and no other. */
const PLATFORM: readonly Freedom[] = ['height', 'about_x', 'about_y'];

/** How far the pointer goes for one degree [px]: tilts are small, so the drag is geared down. */
const PIXELS_PER_DEGREE = 90;

interface Handle {
  freedom: Freedom;
  group: Group;
  /** Where it is grabbed and which way a growing value moves it, in the group of all handles. */
  at: Vector3;
  way: Vector3;
}

export class Handles {
  readonly group = new Group();
  readonly #handles: Handle[] = [];
  readonly #idle = new MeshBasicMaterial({ depthTest: false, transparent: true, opacity: 0.7, toneMapped: false });
  readonly #active = new MeshBasicMaterial({ depthTest: false, transparent: true, toneMapped: false });
  #hot: Freedom | null = null;

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
        case 'yaw':
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

  /** Where a handle is grabbed, in the scene. */
  grip(freedom: Freedom): Vector3 | null {
    const handle = this.#handles.find((one) => one.freedom === freedom);
    return handle ? this.group.localToWorld(handle.at.clone()) : null;
  }

  /** Gives back what was made for it. */
  dispose(): void {
    this.group.traverse((part) => {
      if (part instanceof Mesh) part.geometry.dispose();
    });
    this.#idle.dispose();
    this.#active.dispose();
  }

  /** The handle under the pointer; of several, the one that is grabbed nearest to it. */
  hit(ray: Raycaster): Freedom | null {
    if (!this.group.visible) return null;
    const under = this.#handles.filter(({ group }) => ray.intersectObject(group, true).length > 0);
    const off = ({ at }: Handle) => ray.ray.distanceSqToPoint(this.group.localToWorld(at.clone()));
    return under.reduce<Handle | null>((near, one) => (near && off(near) <= off(one) ? near : one), null)?.freedom ?? null;
  }

  heat(freedom: Freedom | null): boolean {
    if (freedom === this.#hot) return false;
    this.#hot = freedom;
    for (const handle of this.#handles)
      handle.group.traverse((part) => {
        if (part instanceof Mesh && part.visible) part.material = handle.freedom === freedom ? this.#active : this.#idle;
      });
    return true;
  }

  /**
   * By how much a pointer's way [px] changes a freedom: mm for places, degrees for turns; tilts are geared down, a yaw follows the pointer.
   * `unit_mm` is how long a unit of the scene is [mm].
   */
  change(freedom: Freedom, moved: Vector2, camera: Camera, size: { width: number; height: number }, unit_mm: number): number {
    const handle = this.#handles.find((one) => one.freedom === freedom) as Handle;
    const start = this.group.localToWorld(handle.at.clone());
    const end = this.group.localToWorld(handle.at.clone().add(handle.way));
    const way = toPixels(end, camera, size).sub(toPixels(start, camera, size));
    const pixels = way.length();
    if (pixels < 1e-3) return 0;
    const along = moved.dot(way.normalize());
    if (freedom === 'about_x' || freedom === 'about_y') return along / PIXELS_PER_DEGREE;
    const far = along / pixels;
    return freedom === 'yaw' ? ((far / this.#reach) * 180) / Math.PI : far * this.group.scale.x * unit_mm;
  }

  #add(freedom: Freedom, at: Vector3, way: Vector3, group: Group): void {
    group.traverse((part) => {
      if (part instanceof Mesh && part.visible) part.material = this.#idle;
      part.renderOrder = 9;
    });
    this.#handles.push({ freedom, group, at, way });
    this.group.add(group);
  }
}

function toPixels(point: Vector3, camera: Camera, { width, height }: { width: number; height: number }): Vector2 {
  const seen = point.project(camera);
  return new Vector2(((seen.x + 1) / 2) * width, ((1 - seen.y) / 2) * height);
}

/** A piece of a circle about an axis through the centre, with an arrow head at each end, and a wider piece to grab it by. */
function arc(radius: number, about: 'x' | 'y' | 'z'): Group {
  const half = 0.2;
  const group = new Group();
  const turn = new Group();
  group.add(turn);
  // A torus lies in its xy plane, starting at +x: turned so that its middle is where the handle is.
  if (about === 'y') turn.rotation.set(Math.PI / 2, 0, 0);
  else if (about === 'x') turn.rotation.set(Math.PI / 2, Math.PI / 2, 0);
  // Toward where no straight handle is.
  else turn.rotation.set(0, 0, (-3 * Math.PI) / 4);
  const line = new Mesh(new TorusGeometry(radius, 1.5, 10, 24, 2 * half));
  line.rotation.z = -half;
  const grip = new Mesh(new TorusGeometry(radius, 9, 6, 12, 2.4 * half), new MeshBasicMaterial({ visible: false }));
  grip.rotation.z = -1.2 * half;
  grip.visible = false;
  turn.add(line, grip);
  for (const side of [-1, 1]) {
    const head = cone();
    head.position.set(radius * Math.cos(half), side * radius * Math.sin(half), 0);
    head.rotation.z = side * half + (side < 0 ? Math.PI : 0);
    turn.add(head);
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

/** A cone that points along +y. */
function cone(): Object3D {
  return new Mesh(new ConeGeometry(4.6, 11, 20).translate(0, 5.5, 0));
}
