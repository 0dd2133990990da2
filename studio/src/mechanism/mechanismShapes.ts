// Shapes of the parts of a mechanism, with as many faces as their detail asks for.

import { BoxGeometry, ConeGeometry, CylinderGeometry, LatheGeometry, OctahedronGeometry, Quaternion, SphereGeometry, TorusGeometry, Vector2, Vector3, type BufferGeometry } from 'three';

/** Direction of the axis of cylinders and cones of three.js. */
export const UP = new Vector3(0, 1, 0);
/** Fewest sides of a round shape. */
const LEAST = 6;

export class MechanismShapes {
  /** Share of the sides of round shapes. */
  readonly #detail: number;

  constructor(detail: number) {
    this.#detail = detail;
  }

  /** A cylinder between two points. */
  rod(from: Vector3, to: Vector3, radius: number): BufferGeometry {
    const along = to.clone().sub(from);
    const geometry = new CylinderGeometry(radius, radius, along.length(), this.#sides(20));
    const turn = new Quaternion().setFromUnitVectors(UP, along.clone().normalize());
    return geometry.applyQuaternion(turn).translate(...from.clone().add(to).divideScalar(2).toArray());
  }

  ball(radius: number, sides = 16): BufferGeometry {
    return new SphereGeometry(radius, this.#sides(sides), this.#sides(0.7 * sides));
  }

  cone(radius: number, length: number): BufferGeometry {
    return new ConeGeometry(radius, length, this.#sides(16));
  }

  /** Shapes of a joint in its frame, whose z axis is that of the joint. */
  joint(kind: string, r: number): BufferGeometry[] {
    switch (kind) {
      case 'revolute':
        return [this.#along(r, 2.6 * r), this.#along(0.55 * r, 3.6 * r), this.#ring(r, 0.16 * r, 1.3 * r), this.#ring(r, 0.16 * r, -1.3 * r)];
      case 'prismatic':
        return [new BoxGeometry(1.9 * r, 1.9 * r, 3.4 * r), this.#along(0.45 * r, 9 * r)];
      case 'cylindrical':
        return [this.#along(1.1 * r, 3 * r), this.#along(0.55 * r, 9 * r), this.#ring(1.1 * r, 0.16 * r, 0)];
      case 'helical':
        return [this.#along(0.55 * r, 8 * r), this.#along(1.1 * r, 2 * r), ...[-2, -1, 0, 1, 2].map((k) => this.#ring(0.7 * r, 0.12 * r, 1.3 * k * r))];
      case 'universal':
        return [this.#along(0.5 * r, 3.6 * r), this.#along(0.5 * r, 3.6 * r).rotateY(Math.PI / 2), this.ball(0.9 * r, 20)];
      case 'spherical':
        return [this.ball(1.2 * r, 28), this.#race(r)];
      case 'planar':
        return [new BoxGeometry(4 * r, 4 * r, 0.5 * r)];
      case 'fixed':
        return [new BoxGeometry(1.3 * r, 1.3 * r, 1.3 * r)];
      default:
        return [new OctahedronGeometry(1.3 * r)];
    }
  }

  /** A double arrow along z. */
  slideArrow(r: number): BufferGeometry[] {
    const head = () => this.cone(0.6 * r, 1.4 * r).rotateX(Math.PI / 2);
    return [this.#along(0.22 * r, 5.6 * r), head().translate(0, 0, 3.4 * r), head().rotateX(Math.PI).translate(0, 0, -3.4 * r)];
  }

  /** A ring about z. */
  turnArrow(r: number): BufferGeometry[] {
    const arc = new TorusGeometry(2.2 * r, 0.2 * r, this.#sides(8), this.#sides(40), 1.5 * Math.PI);
    return [arc.rotateZ(0.5 * Math.PI), this.cone(0.55 * r, 1.2 * r).translate(2.2 * r, 0.4 * r, 0)];
  }

  /** A cylinder along z. */
  #along(radius: number, length: number): BufferGeometry {
    return new CylinderGeometry(radius, radius, length, this.#sides(28)).rotateX(Math.PI / 2);
  }

  #ring(radius: number, thickness: number, at: number): BufferGeometry {
    return new TorusGeometry(radius, thickness, this.#detail < 1 ? 3 : 8, this.#sides(28)).translate(0, 0, at);
  }

  /** The race of a spherical bearing about z. */
  #race(r: number): BufferGeometry {
    const profile = [[0.97, -0.8], [1.22, -0.35], [1.28, 0], [1.22, 0.35], [0.97, 0.8], [1.5, 0.8], [1.62, 0.68], [1.62, -0.68], [1.5, -0.8], [0.97, -0.8]];
    return new LatheGeometry(profile.map(([radius, z]) => new Vector2(radius! * r, z! * r)), this.#sides(36)).rotateX(Math.PI / 2);
  }

  #sides(most: number): number {
    return Math.max(LEAST, Math.round(this.#detail * most));
  }
}
