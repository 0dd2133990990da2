import { describe, expect, test } from 'vitest';
import { hull, jointPaths, outline, planeMap, displayedSocket, type Point, type Triple } from './geometry';

function apply(matrix: number[], [x, y]: Point): Triple {
  const at = (row: number) => (matrix[row] as number) * x + (matrix[4 + row] as number) * y + (matrix[12 + row] as number);
  return [at(0), at(1), at(2)];
}

test('the plane map transforms each point to its displayed position', () => {
  const from: [Point, Point, Point] = [[93, 0], [-46, 80], [-47, -81]];
  const to: [Triple, Triple, Triple] = [[90, 1, 497], [-46, 79, 501], [-40, -85, 502]];
  const matrix = planeMap(from, to, [0, 0, 1]);
  from.forEach((point, i) => apply(matrix, point).forEach((value, k) => expect(value).toBeCloseTo(to[i]![k]!, 10)));
  expect(matrix.slice(8, 12)).toEqual([0, 0, 1, 0]);
});

test('a displayed socket differs from its ball by the scaled gap', () => {
  expect(displayedSocket([1, 2, 3], [0.5, 0, -0.25], 4)).toEqual([-1, 2, 4]);
});

test('the hull excludes inner points', () => {
  const corners: Point[] = [[0, 0], [4, 0], [4, 3], [0, 3]];
  expect(hull([...corners, [2, 1], [1, 2], [2, 0]])).toHaveLength(4);
});

test('an outline has a constant distance and is counter-clockwise', () => {
  const points: Point[] = [[100, 0], [-50, 86], [-50, -86]];
  const line = outline(points, 20);
  let area = 0;
  line.forEach((a, i) => {
    const b = line[(i + 1) % line.length]!;
    area += (a[0] * b[1] - a[1] * b[0]) / 2;
    const nearest = Math.min(...points.map((p) => Math.hypot(a[0] - p[0], a[1] - p[1])));
    expect(nearest).toBeCloseTo(20, 9);
  });
  expect(area).toBeGreaterThan(0);
  const sharp = outline(points, 0);
  expect(new Set(sharp.map((p) => p.join())).size).toBe(3);
});

describe('the joints of every model end at the ball', () => {
  for (const model of ['radial', 'polar', 'offset', 'planar'])
    for (const delta of [[3, 4], [-2, 0.5], [0, 0]] as Point[])
      test(`${model} ${delta}`, () => {
        const paths = jointPaths(model, [-46.6, 80.7], delta);
        expect(paths[0]![0]).toEqual([0, 0]);
        const end = paths.at(-1)!.at(-1)!;
        expect(end[0]).toBeCloseTo(delta[0], 12);
        expect(end[1]).toBeCloseTo(delta[1], 12);
        paths.slice(1).forEach((path, i) => path[0]!.forEach((value, k) => expect(value).toBeCloseTo(paths[i]!.at(-1)![k]!, 12)));
      });
});

test('a polar joint rotates about the centre', () => {
  const [slide, arc] = jointPaths('polar', [100, 0], [2, 20]);
  expect(slide!.at(-1)).toEqual([2, 0]);
  const middle = arc![8]!;
  expect(middle[1]).toBeCloseTo(10, 12);
  expect(middle[0]).toBeGreaterThan(2);
});
