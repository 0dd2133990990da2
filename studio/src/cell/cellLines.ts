// Lines over the parts of a cell, with their labels: a path, the shortest distance of two parts, and a measurement.

import { BufferGeometry, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Vector3 } from 'three';
import type { Label } from '../scene/labels';

type Lines = LineSegments<BufferGeometry, LineBasicMaterial>;

/** Lengths of the arms of crosses at points [m]. */
const ARMS = { nearest: 0.006, measured: 0.012 } as const;

export class CellLines {
  readonly group = new Group();
  readonly #path = lineSegments(0xc2410c);
  readonly #measured = lineSegments(0x7c3aed);
  readonly #nearest = lineSegments(0xb3261e);
  /** Labels of the shortest distance and of the measurement. */
  nearestLabel: Label | null = null;
  measuredLabel: Label | null = null;

  constructor() {
    this.group.add(this.#path, this.#measured, this.#nearest);
  }

  dispose(): void {
    for (const lines of [this.#path, this.#measured, this.#nearest]) {
      lines.geometry.dispose();
      lines.material.dispose();
    }
  }

  /** Draws a path: pairs of points [m]. */
  showPath(points: readonly number[]): void {
    set(this.#path, points);
  }

  /** Draws the line between the nearest points of two parts [m], with a text; `null` for none. */
  showNearest(points: readonly number[][] | null, text: string): void {
    this.nearestLabel = points && { position: middle(points), text, strong: true, offset: [10, -12] };
    set(this.#nearest, points ? [...points.flat(), ...points.flatMap((point) => cross(point, ARMS.nearest))] : []);
  }

  /** End points of the line between nearest points [m]; empty without a line. */
  get nearestPoints(): number[] {
    return this.#nearest.visible ? [...this.#nearest.geometry.getAttribute('position').array].slice(0, 6) : [];
  }

  /** Draws the clicked points of a measurement [m], and the line between two of them with a text. */
  showMeasured(points: readonly number[][], text: string): void {
    const isWhole = points.length === 2;
    this.measuredLabel = isWhole ? { position: middle(points), text, strong: true, stays: true } : null;
    const crosses = points.flatMap((point) => cross(point, ARMS.measured));
    set(this.#measured, isWhole ? [...crosses, ...points.flat()] : crosses);
  }
}

const middle = ([from, to]: readonly number[][]): Vector3 => new Vector3().fromArray(from!).add(new Vector3().fromArray(to!)).multiplyScalar(0.5);

function set(lines: Lines, points: readonly number[]): void {
  lines.geometry.dispose();
  lines.geometry = new BufferGeometry().setAttribute('position', new Float32BufferAttribute(points, 3));
  lines.visible = points.length > 0;
}

/** A cross at a point, with arms along the axes [m]. */
function cross([x, y, z]: readonly number[], arm: number): number[] {
  return [x! - arm, y!, z!, x! + arm, y!, z!, x!, y! - arm, z!, x!, y! + arm, z!, x!, y!, z! - arm, x!, y!, z! + arm];
}

/** Line segments that are drawn over all parts. */
function lineSegments(color: number): Lines {
  const lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color, depthTest: false, transparent: true }));
  lines.renderOrder = 2;
  lines.visible = false;
  lines.frustumCulled = false;
  return lines;
}
