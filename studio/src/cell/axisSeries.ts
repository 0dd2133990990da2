// Lines of a plot over a stretch of a motion: between its keys where it is short, its least and largest values where it is long.

import { MOST_SHOWN, OVERVIEW, type Timeline } from './timeline.svelte';

/** How far samples are from each other at most [s]. */
const SPACING_S = 0.04;

export interface AxisSeries {
  times: Float64Array;
  /** Of each axis: positions, velocities, accelerations; in m, rad and s. */
  values: [Float64Array, Float64Array, Float64Array][];
}

/** All axes over a stretch of time; `null` while nothing of it is there [s]. */
export function axisSeries(timeline: Timeline, range: readonly [number, number]): AxisSeries | null {
  void timeline.version;
  const axes = timeline.plan?.robot?.axes.length ?? 0;
  const [first, after] = timeline.within(range);
  const rows: number[][] = [];
  if (after - first > MOST_SHOWN)
    timeline.overview(first, after).forEach((numbers, k) => {
      if (!numbers) return;
      const [start, end] = timeline.bounds(first + k);
      // From the least to the largest value and on to the next.
      for (const [side, time] of [[0, start], [1, 0.5 * (start + end)]] as const) {
        const row = [time];
        for (let axis = 0; axis < axes; axis += 1) for (let rate = 0; rate < 3; rate += 1) row.push(numbers[axis * OVERVIEW + 2 * rate + side]!);
        rows.push(row);
      }
    });
  else
    for (let index = first; index < after; index += 1) {
      const window = timeline.window(index);
      if (!window) continue;
      const [start] = timeline.bounds(index);
      window.steps.forEach((step, k) => {
        const width = step.end_s - step.start_s;
        const sinces = new Set<number>([0, width]);
        for (const axis of step.moving) for (const key of window.keys(k, axis)) sinces.add(key);
        if (step.moving.length > 0) for (let since = SPACING_S; since < width; since += SPACING_S) sinces.add(since);
        for (const since of [...sinces].sort((a, b) => a - b)) {
          const row = [start + step.start_s + since];
          for (let axis = 0; axis < axes; axis += 1) row.push(...window.state(k, axis, since));
          rows.push(row);
        }
      });
    }
  if (rows.length === 0) return null;
  const column = (place: number) => Float64Array.from(rows, (row) => row[place]!);
  const values = Array.from({ length: axes }, (_, axis): [Float64Array, Float64Array, Float64Array] => [column(1 + 3 * axis), column(2 + 3 * axis), column(3 + 3 * axis)]);
  return { times: column(0), values };
}
