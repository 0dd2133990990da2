/**
 * Selects samples of long series for display: in each of `buckets` intervals of equal width
 * the first, the last, and the minimum and maximum of each series, so that no peak is lost.
 * Short series are kept completely.
 *
 * The intervals divide the indices `from..to` (`to` excluded) or, where samples have increasing times, their times:
 * both samples at the ends of a long pause are kept, and the line between them is that of the series.
 */
export function decimate(series: ArrayLike<number>[], from: number, to: number, buckets: number, times: ArrayLike<number> | null = null): number[] {
  const count = to - from;
  const most = 2 + 2 * series.length;
  if (count <= buckets * most) return Array.from({ length: Math.max(count, 0) }, (_, i) => from + i);
  const selected: number[] = [];
  const [begin, finish] = times ? [times[from]!, times[to - 1]!] : [0, 0];
  let start = from;
  for (let bucket = 0; bucket < buckets && start < to; bucket++) {
    let end = from + Math.floor(((bucket + 1) * count) / buckets);
    if (times) {
      const until = begin + ((bucket + 1) * (finish - begin)) / buckets;
      for (end = start; end < to && (times[end]! < until || bucket + 1 === buckets); ) end++;
      if (end === start) continue;
    }
    const here = new Set([start, end - 1]);
    for (const values of series) {
      let low = start;
      let high = start;
      let least = values[start] as number;
      let largest = least;
      for (let i = start + 1; i < end; i++) {
        const value = values[i] as number;
        if (value < least) {
          low = i;
          least = value;
        } else if (value > largest) {
          high = i;
          largest = value;
        }
      }
      here.add(low).add(high);
    }
    selected.push(...[...here].sort((a, b) => a - b));
    start = end;
  }
  return selected;
}
