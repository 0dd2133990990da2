import { Box3, Vector3, type BufferGeometry } from 'three';
import { expect, test } from 'vitest';
import { MechanismShapes } from './mechanismShapes';

const KINDS = ['revolute', 'prismatic', 'cylindrical', 'helical', 'universal', 'spherical', 'planar', 'fixed', 'other'];
const triangles = (shapes: BufferGeometry[]) => shapes.reduce((sum, one) => sum + (one.index?.count ?? one.getAttribute('position').count) / 3, 0);
const size = (shapes: BufferGeometry[]) => {
  const box = new Box3();
  for (const one of shapes) {
    one.computeBoundingBox();
    box.union(one.boundingBox!);
  }
  return box.getSize(new Vector3()).toArray();
};

test.each(KINDS)('a %s joint with fewer faces has the same size', (kind) => {
  const [fine, coarse] = [1, 0.35].map((detail) => new MechanismShapes(detail).joint(kind, 2));
  size(coarse!).forEach((edge, i) => expect(edge / size(fine!)[i]!).toBeCloseTo(1, 0.7));
  expect(triangles(coarse!)).toBeLessThanOrEqual(triangles(fine!));
});

test('round shapes with a third of the detail have at most a third of the faces', () => {
  for (const draw of [(s: MechanismShapes) => s.joint('revolute', 1), (s: MechanismShapes) => s.joint('spherical', 1), (s: MechanismShapes) => [s.ball(1)], (s: MechanismShapes) => s.turnArrow(1)])
    expect(triangles(draw(new MechanismShapes(0.35)))).toBeLessThan(triangles(draw(new MechanismShapes(1))) / 3);
});

test('a rod reaches from one point to the other', () => {
  const [from, to] = [new Vector3(1, 2, 3), new Vector3(1, 2, 8)];
  const rod = new MechanismShapes(1).rod(from, to, 0.5);
  rod.computeBoundingBox();
  expect(rod.boundingBox!.min.toArray()).toEqual([0.5, 1.5, 3].map((value) => expect.closeTo(value, 6)));
  expect(rod.boundingBox!.max.toArray()).toEqual([1.5, 2.5, 8].map((value) => expect.closeTo(value, 6)));
});
