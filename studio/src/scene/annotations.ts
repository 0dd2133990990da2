// Lines, arrows and dots with a width, rendered over all parts so that joint play is never hidden. Units: mm.

import {
  BufferGeometry,
  ConeGeometry,
  CylinderGeometry,
  Group,
  Mesh,
  MeshBasicMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from 'three';

const Z = new Vector3(0, 0, 1);
const unitCylinder = new CylinderGeometry(1, 1, 1, 14).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const unitCone = new ConeGeometry(1, 1, 20).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const unitSphere = new SphereGeometry(1, 20, 14);

/** Annotations of a frame; the meshes are reused from frame to frame. */
export class Annotations {
  readonly group = new Group();
  readonly #parts: Mesh[] = [];
  readonly #materials = new Map<string, MeshBasicMaterial>();
  #used = 0;

  begin(): void {
    this.#used = 0;
  }

  end(): void {
    for (let i = this.#used; i < this.#parts.length; i++) (this.#parts[i] as Mesh).visible = false;
  }

  line(from: Vector3, to: Vector3, radius: number, colour: string, order = 10): void {
    const length = from.distanceTo(to);
    if (length < 1e-6) return;
    const part = this.#next(unitCylinder, colour, order);
    part.position.copy(from);
    part.quaternion.setFromUnitVectors(Z, direction(from, to));
    part.scale.set(radius, radius, length);
  }

  path(points: Vector3[], radius: number, colour: string, order = 10): void {
    for (let i = 1; i < points.length; i++) this.line(points[i - 1] as Vector3, points[i] as Vector3, radius, colour, order);
  }

  dot(at: Vector3, radius: number, colour: string, order = 11): void {
    const part = this.#next(unitSphere, colour, order);
    part.position.copy(at);
    part.quaternion.identity();
    part.scale.setScalar(radius);
  }

  arrow(from: Vector3, to: Vector3, radius: number, colour: string, order = 12): void {
    const length = from.distanceTo(to);
    // The radius of short arrows is reduced to keep their proportions.
    radius = Math.min(radius, Math.max(length * 0.11, 0.35));
    if (length < 2 * radius) {
      this.dot(from, 2.2, colour, order);
      return;
    }
    const head = Math.min(radius * 5, length * 0.5);
    const along = direction(from, to);
    const neck = to.clone().addScaledVector(along, -head);
    this.line(from, neck, radius, colour, order);
    const part = this.#next(unitCone, colour, order);
    part.position.copy(neck);
    part.quaternion.copy(new Quaternion().setFromUnitVectors(Z, along));
    part.scale.set(radius * 2.4, radius * 2.4, head);
  }

  #next(geometry: BufferGeometry, colour: string, order: number): Mesh {
    let part = this.#parts[this.#used];
    if (!part) {
      part = new Mesh(geometry, this.#material(colour));
      this.#parts.push(part);
      this.group.add(part);
    }
    this.#used += 1;
    part.geometry = geometry;
    part.material = this.#material(colour);
    part.renderOrder = order;
    part.visible = true;
    return part;
  }

  #material(colour: string): MeshBasicMaterial {
    let material = this.#materials.get(colour);
    if (!material) {
      material = new MeshBasicMaterial({ color: colour, depthTest: false, transparent: true, toneMapped: false });
      this.#materials.set(colour, material);
    }
    return material;
  }
}

function direction(from: Vector3, to: Vector3): Vector3 {
  return to.clone().sub(from).normalize();
}
