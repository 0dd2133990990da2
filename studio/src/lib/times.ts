/** The last sample at or before a time, of times that grow; the first where all come later. */
export function sampleAt(times: ArrayLike<number>, time: number): number {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((times[middle] as number) <= time) low = middle + 1;
    else high = middle;
  }
  return Math.max(low - 1, 0);
}

/**
 * What values are at a time between samples: the cubic that has their rates at both, a line where they have none.
 * Outside of all samples it is that of the first or the last.
 */
export function valueAt(times: ArrayLike<number>, values: ArrayLike<number>, rates: ArrayLike<number> | null, time: number): number {
  const k = Math.min(sampleAt(times, time), times.length - 2);
  if (k < 0) return values[0] ?? NaN;
  const [t0, t1, v0, v1] = [times[k]!, times[k + 1]!, values[k]!, values[k + 1]!];
  const width = t1 - t0;
  const s = Math.min(Math.max((time - t0) / width, 0), 1);
  const straight = v0 + s * (v1 - v0);
  if (!rates) return straight;
  const [over, under] = [rates[k]! * width - (v1 - v0), v1 - v0 - rates[k + 1]! * width];
  return straight + s * (1 - s) * ((1 - s) * over + s * under);
}
