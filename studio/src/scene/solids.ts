// Surfaces of solids as parts are made: bevelled boxes, smooth cylinders with sharp edges.

import { BufferGeometry } from 'three';
import { RoundedBoxGeometry } from 'three/examples/jsm/geometries/RoundedBoxGeometry.js';
import { mergeVertices, toCreasedNormals } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

/** Edges between faces at a greater angle are sharp [rad]. */
const CREASE = 0.6;

/** Edge lengths of an axis-parallel box around its centre; `null` for any other shape. */
export function boxSize(geometry: BufferGeometry): [number, number, number] | null {
  const positions = geometry.getAttribute('position');
  if (!positions) return null;
  geometry.computeBoundingBox();
  const { min, max } = geometry.boundingBox!;
  const corners = new Set<string>();
  for (let i = 0; i < positions.count; i++) {
    const at = [positions.getX(i), positions.getY(i), positions.getZ(i)];
    const sides = at.map((value, k) => (value === min.getComponent(k) ? 0 : value === max.getComponent(k) ? 1 : 2));
    if (sides.includes(2)) return null;
    corners.add(sides.join());
  }
  const size = max.clone().sub(min);
  const centred = min.clone().add(max).length() <= 1e-6 * size.length();
  return corners.size === 8 && centred ? [size.x, size.y, size.z] : null;
}

/**
 * The surface of a solid with its shading: within the given one and without larger clearances than its bevels.
 *
 * `bevel` is the largest radius of an edge.
 */
export function finished(geometry: BufferGeometry, bevel: number): BufferGeometry {
  const size = boxSize(geometry);
  if (size) return new RoundedBoxGeometry(...size, 2, Math.min(bevel, 0.2 * Math.min(...size)));
  return toCreasedNormals(mergeVertices(geometry), CREASE);
}
