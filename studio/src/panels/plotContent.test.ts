import { expect, test } from 'vitest';
import { plotContents } from './plotContent';

test('plots of the robot view follow the length unit', () => {
  const own = [{ name: 'q1_m', symbol: 'q₁', quantity: 'rods' as const, values: Float64Array.of(0.254, 0.508) }, { name: 'tilt_rad', symbol: 'α', quantity: 'other' as const, values: Float64Array.of(0, 1) }];
  const defined = [{ id: 'own', x: 'q1_m', y: ['tilt_rad'], unit: '°' as const }, { id: 'small', x: null, y: ['q1_m'], unit: 'µm' as const }];
  const [rods, against, small] = plotContents({ selected: 'polar', own, compared: [] }, defined, 'light', 'inch');
  expect(rods!.unit).toBe('in');
  expect(Array.from(rods!.lines[0]!.values, (value) => value * rods!.lines[0]!.factor)).toEqual([expect.closeTo(10, 9), expect.closeTo(20, 9)]);
  expect([against!.unit, against!.x!.unit]).toEqual(['°', 'in']);
  expect(0.254 * against!.x!.factor).toBeCloseTo(10, 9);
  expect(small!.unit).toBe('mil');
  expect(plotContents({ selected: 'polar', own, compared: [] }, defined, 'light', 'mm').map(({ unit }) => unit)).toEqual(['mm', '°', 'µm']);
});
