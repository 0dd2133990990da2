import { expect, test } from 'vitest';
import { plainNumber } from './typed';

test('plain numbers have a point or a comma', () => {
  const cases: [string, number | null][] = [
    ['1.25', 1.25], [' 1,25 ', 1.25], ['−3', -3], ['+.5', 0.5], ['2.', 2], ['1e-3', 1e-3], ['0', 0],
    ['', null], ['1/3', null], ['0.5 mil', null], ['1,000.5', null], ['1.2.3', null], ['1e999', null], ['NaN', null], ['0x10', null], ['--1', null], ['-', null], ['.', null],
  ];
  for (const [text, value] of cases) expect(plainNumber(text), text).toBe(value);
});
