import { expect, test } from 'vitest';
import { axisSeries } from './axisSeries';
import { MAX_WINDOWS_SHOWN, OVERVIEW, type Timeline } from './timeline.svelte';

test('an overview has a gap where a window is not loaded', () => {
  const count = MAX_WINDOWS_SHOWN + 3;
  const missing = 2;
  const timeline = {
    version: 0,
    plan: { robot: { axes: [{}] } },
    windowsIn: () => [0, count],
    bounds: (index: number) => [index, index + 1],
    overview: () => Array.from({ length: count }, (_, k) => (k === missing ? null : new Float64Array(OVERVIEW).fill(k))),
  } as unknown as Timeline;
  const series = axisSeries(timeline, [0, count])!;
  const positions = [...series.values[0]![0]];
  expect([...series.times].slice(0, 7)).toEqual([0, 0.5, 1, 1.5, missing, 3, 3.5]);
  expect(positions.map(Number.isNaN).flatMap((isGap, k) => (isGap ? [series.times[k]] : []))).toEqual([missing]);
});
