import { expect, test } from 'vitest';
import { channelKey, displayedUnit, FACTORS, isOwnPlot, kindOf, parseChannel } from './channels';

test('channels have keys', () => {
  for (const channel of [{ model: null, column: 'l1_m' }, { model: 'polar' as const, column: 'torsion_rad' }]) expect(parseChannel(channelKey(channel))).toEqual(channel);
  expect(['q1_m', 'phi2_rad', 'time_s', 'iterations'].map(kindOf)).toEqual(['length', 'angle', 'time', 'number']);
});

test('plots of lengths follow the length unit', () => {
  expect((['mm', 'µm', '°', 's'] as const).map((unit) => displayedUnit(unit, 'inch'))).toEqual(['in', 'mil', '°', 's']);
  expect((['mm', 'µm', 'mrad'] as const).map((unit) => displayedUnit(unit, 'mm'))).toEqual(['mm', 'µm', 'mrad']);
  expect(0.0508 * FACTORS.in).toBeCloseTo(2, 12);
  expect(50.8e-6 * FACTORS.mil).toBeCloseTo(2, 12);
});

test.each([
  [{ id: 'a', x: null, y: ['q1_m', 'polar:l1_m'], unit: 'µm' }, true],
  [{ id: 'a', x: 'tilt_rad', y: ['torsion_rad'], unit: 'mrad' }, true],
  [{ id: 'a', x: null, y: ['q1_m', 'torsion_rad'], unit: 'mm' }, false],
  [{ id: 'a', x: null, y: ['q1_m'], unit: '°' }, false],
  [{ id: 'a', x: null, y: [], unit: 'mm' }, false],
  [{ id: 'a', x: '<b>', y: ['q1_m'], unit: 'mm' }, false],
  [{ id: 1, x: null, y: ['q1_m'], unit: 'mm' }, false],
  [{ id: 'a', x: null, y: 'q1_m', unit: 'mm' }, false],
  [null, false],
  ['plot', false],
])('a stored plot is checked: %o', (value, valid) => expect(isOwnPlot(value)).toBe(valid));
