// The handle of a point of a link: a ball that is dragged, and a line to the wanted position.

import { BufferGeometry, Group, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, SphereGeometry, TorusGeometry, Vector3, type Camera, type Raycaster } from 'three';
import { disposeGeometries, disposeMaterials } from '../scene/dispose';

/** Radius of the ball on the screen, and that of the area that takes it [px]. */
const RADIUS = { ball: 6, grip: 14 } as const;

export class PointHandle {
  readonly group = new Group();
  readonly #idle = new MeshBasicMaterial({ depthTest: false, transparent: true, opacity: 0.85, toneMapped: false });
  readonly #active = new MeshBasicMaterial({ depthTest: false, transparent: true, toneMapped: false });
  readonly #line = new LineBasicMaterial({ depthTest: false, transparent: true, toneMapped: false });
  readonly #ball: Mesh;
  readonly #ring: Mesh;
  readonly #wanted: Mesh;
  readonly #to = new Line(new BufferGeometry(), this.#line);
  readonly #grip = new Vector3();
  #size = 1;

  constructor() {
    this.#ball = new Mesh(new SphereGeometry(1, 20, 14), this.#idle);
    this.#ring = new Mesh(new TorusGeometry(1.9, 0.16, 8, 36), this.#idle);
    this.#wanted = new Mesh(new SphereGeometry(0.6, 14, 10), this.#active);
    this.group.add(this.#ball, this.#ring, this.#wanted, this.#to);
    this.group.traverse((part) => (part.renderOrder = 9));
    this.group.visible = false;
  }

  paint(idle: number, active: number): void {
    this.#idle.color.set(idle);
    this.#active.color.set(active);
    this.#line.color.set(active);
  }

  dispose(): void {
    disposeGeometries(this.group);
    this.#to.geometry.dispose();
    disposeMaterials([this.#idle, this.#active, this.#line]);
  }

  /** Moves the handle to a point of the scene, and the line to the wanted position. */
  place(point: Vector3, wanted: Vector3 | null, camera: Camera, height_px: number, active: boolean): void {
    this.#grip.copy(point);
    // The length of a pixel at the point.
    const inView = point.clone().applyMatrix4(camera.matrixWorldInverse);
    this.#size = (2 * Math.abs(inView.z)) / (camera.projectionMatrix.elements[5]! * height_px);
    const radius = RADIUS.ball * this.#size;
    this.#ball.position.copy(point);
    this.#ball.scale.setScalar(radius);
    this.#ring.position.copy(point);
    this.#ring.scale.setScalar(radius);
    this.#ring.quaternion.copy(camera.quaternion);
    this.#ball.material = this.#ring.material = active ? this.#active : this.#idle;
    this.#wanted.visible = this.#to.visible = wanted !== null;
    if (wanted) {
      this.#wanted.position.copy(wanted);
      this.#wanted.scale.setScalar(radius);
      this.#to.geometry.setFromPoints([point, wanted]);
    }
  }

  /** Whether a ray passes the handle. */
  isHit({ ray }: Raycaster): boolean {
    return this.group.visible && ray.distanceToPoint(this.#grip) < RADIUS.grip * this.#size;
  }
}
