import { expect, test } from 'vitest';
import { sampleAt } from './times';

test('the sample of a time is the last one at or before it', () => {
  const times = [0, 0.04, 0.08, 0.1];
  const cases: [number, number][] = [[-1, 0], [0, 0], [0.03, 0], [0.04, 1], [0.09, 2], [0.1, 3], [7, 3]];
  for (const [time, sample] of cases) expect(sampleAt(times, time)).toBe(sample);
  expect(sampleAt([], 1)).toBe(0);
});
