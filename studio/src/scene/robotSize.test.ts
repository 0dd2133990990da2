import { expect, test } from 'vitest';
import { small } from '../lib/units';
import { finerDecimals } from './robotSize';

const robot = (radius_m: number) => [0, 1, 2].map((k) => ({ socket_m: [radius_m * Math.cos(2 * k), radius_m * Math.sin(2 * k), 0] }));

test('lengths of small robots have more decimals: their play has digits', () => {
  const finer = (radius_m: number) => finerDecimals(robot(radius_m));
  // The robot of the paper, large ones, and robots of 10 mm, 1 mm and 0.1 mm.
  expect([0.093218, 1, 10, 0.005, 0.0005, 0.00005].map(finer)).toEqual([0, 0, 0, 1, 2, 3]);
  // A ten thousandth of the radius, as in the robot of the paper.
  expect(small(1e-4 * 0.093218, 'mm', 1)).toBe('9.3 µm');
  expect(small(1e-4 * 0.0005, 'mm', 1 + finer(0.0005))).toBe('0.050 µm');
});
