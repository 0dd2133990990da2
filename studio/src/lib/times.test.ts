import { expect, test } from 'vitest';
import { sampleAt, valueAt } from './times';

test('the sample of a time is the last that is not later', () => {
  const times = [0, 0.04, 0.08, 0.1];
  const cases: [number, number][] = [[-1, 0], [0, 0], [0.03, 0], [0.04, 1], [0.09, 2], [0.1, 3], [7, 3]];
  for (const [time, sample] of cases) expect(sampleAt(times, time)).toBe(sample);
  expect(sampleAt([], 1)).toBe(0);
});

test('between samples a value follows its rate, and a line where it has none', () => {
  const times = [0, 0.1, 0.3];
  const cubic = (t: number) => 2 - 3 * t + 5 * t * t - 7 * t ** 3;
  const values = times.map(cubic);
  const rates = times.map((t) => -3 + 10 * t - 21 * t * t);
  for (const time of [0, 0.04, 0.1, 0.17, 0.3]) expect(valueAt(times, values, rates, time)).toBeCloseTo(cubic(time), 12);
  expect(valueAt(times, values, null, 0.2)).toBeCloseTo((values[1]! + values[2]!) / 2, 12);
  for (const rated of [rates, null]) {
    expect(valueAt(times, values, rated, -1)).toBe(values[0]);
    expect(valueAt(times, values, rated, 9)).toBeCloseTo(values[2]!, 12);
  }
  expect(valueAt([0], [4], null, 1)).toBe(4);
});
