import { describe, expect, test } from 'vitest';
import { cutPlate, displayedBall, hull, jointPaths, outline, type Point } from './geometry';

test('the displacement of a displayed ball from its socket is scaled', () => {
  expect(displayedBall([93, -2], [93.007, -2.001], 1)).toEqual([93.007, -2.001]);
  const [x, y] = displayedBall([93, -2], [93.007, -2.001], 500);
  expect(x - 93).toBeCloseTo(3.5, 9);
  expect(y + 2).toBeCloseTo(-0.5, 9);
});

describe('a plate is cut open at its corners', () => {
  // A regular triangle, an oblique one, and a quadrilateral with a point inside.
  for (const points of [[[100, 0], [-50, 86], [-50, -86]], [[140, 10], [-60, 70], [-90, -60]], [[90, 0], [0, 80], [-85, 5], [5, -95], [3, 4]]] as Point[][])
    test(JSON.stringify(points), () => {
      const { line, holes, cuts } = cutPlate(points, 34, 18);
      const inside = ([x, y]: Point) =>
        line.filter(([x0, y0], i) => {
          const [x1, y1] = line[(i + 1) % line.length]!;
          return y0 > y !== y1 > y && x < x0 + ((y - y0) / (y1 - y0)) * (x1 - x0);
        }).length % 2 === 1;
      const around = ([x, y]: Point, radius: number, angle: number): Point => [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
      const corners = hull(points);
      expect(holes).toEqual(points.filter((point) => !corners.includes(point)));
      for (const corner of corners) {
        const { from, to } = cuts[points.indexOf(corner)]!;
        const middle = (from + to) / 2;
        // The hole and its cut are open, the rest of the rim is closed.
        for (const angle of [0, 1, 2, 3, 4, 5, 6]) expect(inside(around(corner, 17, angle))).toBe(false);
        expect(inside(around(corner, 26, middle))).toBe(false);
        for (const side of [from - 0.1, to + 0.1]) expect(inside(around(corner, 26, side))).toBe(true);
        // The cut faces away from the other points.
        for (const other of points) expect((other[0] - corner[0]) * Math.cos(middle) + (other[1] - corner[1]) * Math.sin(middle)).toBeLessThanOrEqual(1e-9);
        expect(inside(around(corner, 26, middle + Math.PI))).toBe(true);
      }
    });
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
