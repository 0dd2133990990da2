import { expect, test } from 'vitest';
import { directionWithin, plainNumber, quantityAtEnd, withDecimalPoints } from './typed';

test('plain numbers have a point or a comma', () => {
  const cases: [string, number | null][] = [
    ['1.25', 1.25], [' 1,25 ', 1.25], ['−3', -3], ['+.5', 0.5], ['2.', 2], ['1e-3', 1e-3], ['0', 0],
    ['', null], ['1/3', null], ['0.5 mil', null], ['1,000.5', null], ['1.2.3', null], ['1e999', null], ['NaN', null], ['0x10', null], ['--1', null], ['-', null], ['.', null],
  ];
  for (const [text, value] of cases) expect(plainNumber(text), text).toBe(value);
});

test('expressions have decimal commas, and commas between arguments', () => {
  const cases: [string, string][] = [
    ['0,5 deg', '0.5 deg'], ['1,5/2', '1.5/2'], ['-1,5 + 2,25 mm', '-1.5 + 2.25 mm'], [',5 in', '0.5 in'], ['2*(1,5 + 1)', '2*(1.5 + 1)'], ['1,5e-3 rad', '1.5e-3 rad'],
    ['atan2(1,2)', 'atan2(1,2)'], ['min (1,2)', 'min (1,2)'], ['max((1,2),3)', 'max((1,2),3)'], ['atan2(1,2) + 0,5', 'atan2(1,2) + 0.5'],
    ['1.000,5', '1.000,5'], ['1,000.5 mm', '1,000.5 mm'], ['1,2,3', '1,2,3'], ['1, 2', '1, 2'], ['1,', '1,'],
  ];
  for (const [text, points] of cases) expect(withDecimalPoints(text), text).toBe(points);
});

test('the unit at the end of an expression has a quantity', () => {
  const cases: [string, ReturnType<typeof quantityAtEnd>][] = [
    ['20 mrad', 'angle'], ['250µrad', 'angle'], ['30°', 'angle'], ['2 deg ', 'angle'], ['1 rad', 'angle'],
    ['2 * 1.5 mm', 'length'], ['3um', 'length'], ['3 µm', 'length'], ['1/2 in', 'length'], ['0.5 mil', 'length'], ['1 m', 'length'],
    ['2 * pi', null], ['1/3', null], ['sin(30)', null], ['2 min', null], ['', null],
  ];
  for (const [text, quantity] of cases) expect(quantityAtEnd(text), text).toBe(quantity);
});

test('angles of directions are reduced by whole turns', () => {
  const cases: [number, number, number][] = [
    [370, 180, 10], [-370, 180, -10], [190, 180, -170], [180, 180, 180], [-180, 180, -180], [540, 180, 180], [725.1, 180, 5.1], [12.5, 180, 12.5],
    [370, 360, 10], [270, 360, 270], [-400, 360, -40],
  ];
  for (const [deg, most, within] of cases) expect(directionWithin(deg, -most, most), `${deg}`).toBe(within);
});
