/**
 * Selects samples of long series for display: in each of `buckets` equal intervals of `from..to` (integers, `to` excluded)
 * the first, the last, and the minimum and maximum of each series, so that no peak is lost.
 * Short series are kept completely.
 */
export function decimate(series: ArrayLike<number>[], from: number, to: number, buckets: number): number[] {
  const count = to - from;
  const most = 2 + 2 * series.length;
  if (count <= buckets * most) return Array.from({ length: Math.max(count, 0) }, (_, i) => from + i);
  const selected: number[] = [];
  for (let bucket = 0; bucket < buckets; bucket++) {
    const start = from + Math.floor((bucket * count) / buckets);
    const end = from + Math.floor(((bucket + 1) * count) / buckets);
    const here = new Set([start, end - 1]);
    for (const values of series) {
      let low = start;
      let high = start;
      for (let i = start + 1; i < end; i++) {
        const value = values[i] as number;
        if (value < (values[low] as number)) low = i;
        if (value > (values[high] as number)) high = i;
      }
      here.add(low).add(high);
    }
    selected.push(...[...here].sort((a, b) => a - b));
  }
  return selected;
}
