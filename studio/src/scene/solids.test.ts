import { BoxGeometry, CylinderGeometry, TetrahedronGeometry, Vector3, type BufferGeometry } from 'three';
import { expect, test } from 'vitest';
import { boxSize, finished } from './solids';

test('boxes are recognised, with their sizes', () => {
  expect(boxSize(new BoxGeometry(0.3, 0.22, 0.003))?.map((value) => Number(value.toFixed(6)))).toEqual([0.3, 0.22, 0.003]);
  for (const other of [new BoxGeometry(1, 1, 1).translate(0.5, 0, 0), new CylinderGeometry(1, 1, 1, 32), new TetrahedronGeometry(1), new BoxGeometry(1, 1, 1, 2)]) expect(boxSize(other)).toBeNull();
});

/** Distance of a point outside of the box of a surface; at most 0 within. */
const outside = (geometry: BufferGeometry, [x, y, z]: [number, number, number]) => {
  const positions = geometry.getAttribute('position');
  let furthest = -Infinity;
  for (let i = 0; i < positions.count; i++)
    furthest = Math.max(furthest, Math.abs(positions.getX(i)) - x / 2, Math.abs(positions.getY(i)) - y / 2, Math.abs(positions.getZ(i)) - z / 2);
  return furthest;
};

test('a bevelled box reaches the faces of its box, and not beyond', () => {
  for (const size of [[0.3, 0.22, 0.003], [0.02, 0.5, 0.2], [1, 1, 1]] as [number, number, number][]) {
    const made = finished(new BoxGeometry(...size), 0.0015);
    expect(outside(made, size)).toBeLessThan(1e-7);
    made.computeBoundingBox();
    const found = made.boundingBox!.getSize(new Vector3()).toArray();
    found.forEach((value, k) => expect(value).toBeCloseTo(size[k]!, 6));
  }
});

test('other surfaces keep their vertices', () => {
  const made = finished(new CylinderGeometry(0.15, 0.15, 0.2, 24), 0.0015);
  made.computeBoundingBox();
  expect(made.boundingBox!.max.y).toBeCloseTo(0.1, 7);
  expect(made.getAttribute('normal')).toBeDefined();
});
