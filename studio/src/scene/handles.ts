// Handles by which the platform is dragged: up and down, about x, about y. Nothing else can it do.

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

export type Freedom = 'height' | 'about_x' | 'about_y';

/** What a handle does, for people. */
export const SAYS: Record<Freedom, string> = { height: 'up and down', about_x: 'tilt about x', about_y: 'tilt about y' };

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

  constructor(radius: number) {
    const reach = radius + 62;
    // Positive about x lifts the side toward +y, positive about y lowers the side toward +x.
    this.#add('about_x', new Vector3(0, reach, 0), new Vector3(0, 0, 1), arc(reach, 'x'));
    this.#add('about_y', new Vector3(reach, 0, 0), new Vector3(0, 0, -1), arc(reach, 'y'));
    this.#add('height', new Vector3(0, 0, 74), new Vector3(0, 0, 1), straight());
  }

  paint(idle: number, active: number): void {
    this.#idle.color.set(idle);
    this.#active.color.set(active);
  }

  /** The handle under the pointer. */
  hit(ray: Raycaster): Freedom | null {
    if (!this.group.visible) return null;
    for (const { freedom, group } of this.#handles) if (ray.intersectObject(group, true).length > 0) return freedom;
    return null;
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

  /** By how much a pointer's way [px] changes a freedom: mm for the height, degrees for the tilts. */
  change(freedom: Freedom, moved: Vector2, camera: Camera, size: { width: number; height: number }): number {
    const handle = this.#handles.find((one) => one.freedom === freedom) as Handle;
    const start = this.group.localToWorld(handle.at.clone());
    const end = this.group.localToWorld(handle.at.clone().add(handle.way));
    const a = toPixels(start, camera, size);
    const b = toPixels(end, camera, size);
    const way = b.sub(a);
    const pixelsPerMillimetre = way.length();
    if (pixelsPerMillimetre < 1e-3) return 0;
    const along = moved.dot(way.normalize());
    return freedom === 'height' ? along / pixelsPerMillimetre : along / PIXELS_PER_DEGREE;
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
function arc(radius: number, about: 'x' | 'y'): Group {
  const half = 0.2;
  const group = new Group();
  const turn = new Group();
  group.add(turn);
  // A torus lies in its xy plane, starting at +x: turned so that its middle is where the handle is.
  if (about === 'y') turn.rotation.set(Math.PI / 2, 0, 0);
  else turn.rotation.set(Math.PI / 2, Math.PI / 2, 0);
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
