import { expect, test } from 'vitest';
import { angle, clock, fileUnit, fixed, fromUnit, inUnit, length, metres, millimetres, power, radians, signed, small, smallAngle } from './units';

test('numbers are formatted', () => {
  const cases: [string, string][] = [
    [fixed(-1.25, 1), '−1.3'],
    [fixed(-0.0001, 3), '0.000'],
    [fixed(-0, 0), '0'],
    [fixed(Number.NaN, 2), '–'],
    [signed(2, 1), '+2.0'],
    [signed(-2, 1), '−2.0'],
    [signed(0.01, 1), '0.0'],
    [length(0.4976, 'mm'), '497.600 mm'],
    [length(0.0254, 'inch'), '1.00000 in'],
    [small(2.84e-5, 'mm', 1, true), '+28.4 µm'],
    [small(2.54e-5, 'inch'), '1.00 mil'],
    [angle(Math.PI / 2), '90.000°'],
    [smallAngle(-2.5e-6), '−2.5 µrad'],
    [smallAngle(-0.0037021, true), '−3.702 mrad'],
    [smallAngle(0.0013761, true), '+1.376 mrad'],
    [power(-12), '10⁻¹²'],
    [power(0), '10⁰'],
    [clock(75.26), '1:15.3'],
    [clock(3), '0:03.0'],
  ];
  for (const [found, expected] of cases) expect(found).toBe(expected);
});

test('units of mechanism files have symbols', () => {
  expect(['um', 'deg', 'mm', 'in', 'rad'].map(fileUnit)).toEqual(['µm', '°', 'mm', 'in', 'rad']);
});

test('conversion from mm to m shifts the decimal point exactly', () => {
  const pairs = [[501, 0.501], [93.218, 0.093218], [1e-7, 1e-10], [-1e21, -1e18], [0, 0]] as const;
  for (const [mm, m] of pairs) {
    expect(metres(mm)).toBe(m);
    expect(millimetres(m)).toBe(mm);
  }
  expect(radians(180)).toBe(Math.PI);
});

test('number fields use the selected unit', () => {
  expect(fromUnit(1, 'inch')).toBe(25.4);
  expect(fromUnit(19.685, 'inch')).toBe(499.999);
  expect(inUnit(25.4, 'inch')).toBe(1);
  for (const mm of [500, 93.218, 1e-3]) {
    expect(fromUnit(inUnit(mm, 'inch'), 'inch')).toBe(mm);
    expect(fromUnit(inUnit(mm, 'mm'), 'mm')).toBe(mm);
  }
});
