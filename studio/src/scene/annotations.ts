// Lines, arrows and dots with a width, rendered over all parts so that joint play is never hidden.

import {
  BufferGeometry,
  ConeGeometry,
  CylinderGeometry,
  Group,
  InstancedMesh,
  Matrix4,
  MeshBasicMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from 'three';

const Z = new Vector3(0, 0, 1);
const unitCylinder = new CylinderGeometry(1, 1, 1, 8, 1, true).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const unitCone = new ConeGeometry(1, 1, 14).rotateX(Math.PI / 2).translate(0, 0, 0.5);
const unitSphere = new SphereGeometry(1, 14, 10);

/** Parts of one shape, color and order: a single draw call. */
interface Batch {
  mesh: InstancedMesh;
  used: number;
}

const FIRST_CAPACITY = 16;

/** Annotations of a frame; the meshes are reused from frame to frame. */
export class Annotations {
  readonly group = new Group();
  readonly #batches = new Map<string, Batch>();
  readonly #materials = new Map<string, MeshBasicMaterial>();

  begin(): void {
    for (const batch of this.#batches.values()) batch.used = 0;
  }

  end(): void {
    for (const { mesh, used } of this.#batches.values()) {
      mesh.count = used;
      mesh.visible = used > 0;
      mesh.instanceMatrix.needsUpdate = true;
    }
  }

  line(from: Vector3, to: Vector3, radius: number, colour: string, order = 10): void {
    const length = from.distanceTo(to);
    if (length < 1e-6) return;
    const rotation = new Quaternion().setFromUnitVectors(Z, direction(from, to));
    this.#add(unitCylinder, colour, order, new Matrix4().compose(from, rotation, new Vector3(radius, radius, length)));
  }

  path(points: Vector3[], radius: number, colour: string, order = 10): void {
    for (let i = 1; i < points.length; i++) this.line(points[i - 1] as Vector3, points[i] as Vector3, radius, colour, order);
  }

  dot(at: Vector3, radius: number, colour: string, order = 11): void {
    this.#add(unitSphere, colour, order, new Matrix4().makeScale(radius, radius, radius).setPosition(at));
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
    const rotation = new Quaternion().setFromUnitVectors(Z, along);
    this.#add(unitCone, colour, order, new Matrix4().compose(neck, rotation, new Vector3(radius * 2.4, radius * 2.4, head)));
  }

  #add(geometry: BufferGeometry, colour: string, order: number, matrix: Matrix4): void {
    const key = `${geometry.id} ${colour} ${order}`;
    let batch = this.#batches.get(key);
    if (!batch || batch.used === batch.mesh.instanceMatrix.count) {
      const mesh = new InstancedMesh(geometry, this.#material(colour), batch ? 2 * batch.used : FIRST_CAPACITY);
      mesh.renderOrder = order;
      mesh.frustumCulled = false;
      if (batch) {
        mesh.instanceMatrix.array.set(batch.mesh.instanceMatrix.array);
        this.group.remove(batch.mesh);
        batch.mesh.dispose();
      }
      this.group.add(mesh);
      batch = { mesh, used: batch?.used ?? 0 };
      this.#batches.set(key, batch);
    }
    batch.mesh.setMatrixAt(batch.used, matrix);
    batch.used += 1;
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
