// Time series of the axes over a time range: samples for short ranges, minima and maxima for long ones.

import { MAX_WINDOWS_SHOWN, OVERVIEW, type Timeline } from './timeline.svelte';

/** Maximum distance of samples [s]. */
const SPACING_S = 0.04;

export interface AxisSeries {
  times: Float64Array;
  /** Positions, velocities and accelerations of each axis [m, rad, s]. */
  values: [Float64Array, Float64Array, Float64Array][];
  /** Displacement of the virtual joints [m]; `null` for ranges that are displayed by their overview. */
  displacement: Float64Array | null;
}

/** Time series of all axes over a time range [s]; `null` while nothing is loaded. */
export function axisSeries(timeline: Timeline, range: readonly [number, number]): AxisSeries | null {
  void timeline.version;
  const axes = timeline.plan?.robot?.axes.length ?? 0;
  const [first, after] = timeline.windowsIn(range);
  const rows: number[][] = [];
  // What is not loaded is not drawn as a straight line.
  const gap = (time: number) => [time, ...Array<number>(3 * axes + 1).fill(NaN)];
  if (after - first > MAX_WINDOWS_SHOWN)
    timeline.overview(first, after).forEach((numbers, k) => {
      const [start, end] = timeline.bounds(first + k);
      if (!numbers) {
        rows.push(gap(start));
        return;
      }
      // The line passes from minimum to maximum of each window.
      for (const [side, time] of [[0, start], [1, 0.5 * (start + end)]] as const) {
        const row = [time];
        for (let axis = 0; axis < axes; axis += 1) for (let rate = 0; rate < 3; rate += 1) row.push(numbers[axis * OVERVIEW + 2 * rate + side]!);
        rows.push(row);
      }
    });
  else
    for (let index = first; index < after; index += 1) {
      const window = timeline.window(index);
      const [start] = timeline.bounds(index);
      if (!window) {
        rows.push(gap(start));
        continue;
      }
      window.steps.forEach((step, k) => {
        const width = step.end_s - step.start_s;
        const sinces = new Set<number>([0, width]);
        for (const axis of step.moving) for (const key of window.keys(k, axis)) sinces.add(key);
        for (const key of window.displacementKeys(k)) sinces.add(key);
        if (step.moving.length > 0) for (let since = SPACING_S; since < width; since += SPACING_S) sinces.add(since);
        for (const since of [...sinces].sort((a, b) => a - b)) {
          const row = [start + step.start_s + since];
          for (let axis = 0; axis < axes; axis += 1) row.push(...window.state(k, axis, since));
          row.push(window.displacement(k, since));
          rows.push(row);
        }
      });
    }
  if (rows.every((row) => Number.isNaN(row[1]))) return null;
  const column = (place: number) => Float64Array.from(rows, (row) => row[place]!);
  const values = Array.from({ length: axes }, (_, axis): [Float64Array, Float64Array, Float64Array] => [column(1 + 3 * axis), column(2 + 3 * axis), column(3 + 3 * axis)]);
  return { times: column(0), values, displacement: after - first > MAX_WINDOWS_SHOWN ? null : column(1 + 3 * axes) };
}
