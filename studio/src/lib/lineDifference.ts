// Differences of two texts by lines.

import { lineChange } from './lineChange';

export interface DifferenceLine {
  kind: 'same' | 'removed' | 'added';
  text: string;
  /** Number of the line in the old text, and of an added line in the new one, from 1. */
  line: number;
}

/** Lines of the difference that follow each other, with lines around them that are the same. */
export type DifferencePart = DifferenceLine[];

/** Lines before and after each difference. */
const CONTEXT = 2;
/** Largest product of the numbers of compared lines; longer ranges are one difference. */
const MOST = 4_000_000;

/** The differences between two texts: a longest common subsequence of the lines between the common start and end. */
export function lineDifference(before: string, after: string): DifferencePart[] {
  const { from, count, lines } = lineChange(before, after);
  if (count === 0 && lines.length === 0) return [];
  const old = before.split('\n');
  const all: DifferenceLine[] = old.slice(0, from).map((text, k) => ({ kind: 'same', text, line: k + 1 }));
  const removed = old.slice(from, from + count);
  const remove = (k: number) => all.push({ kind: 'removed', text: removed[k]!, line: from + k + 1 });
  const add = (k: number) => all.push({ kind: 'added', text: lines[k]!, line: from + k + 1 });
  const [rows, columns] = [removed.length, lines.length];
  let [i, k] = [0, 0];
  if (rows * columns <= MOST) {
    // Length of the longest common subsequence of the rest of both ranges.
    const width = columns + 1;
    const longest = new Uint32Array((rows + 1) * width);
    for (let row = rows - 1; row >= 0; row--)
      for (let column = columns - 1; column >= 0; column--)
        longest[row * width + column] = removed[row] === lines[column] ? longest[(row + 1) * width + column + 1]! + 1 : Math.max(longest[(row + 1) * width + column]!, longest[row * width + column + 1]!);
    while (i < rows && k < columns)
      if (removed[i] === lines[k]) {
        all.push({ kind: 'same', text: removed[i]!, line: from + i + 1 });
        i += 1;
        k += 1;
      } else if (longest[(i + 1) * width + k]! >= longest[i * width + k + 1]!) remove(i++);
      else add(k++);
  }
  while (i < rows) remove(i++);
  while (k < columns) add(k++);
  old.slice(from + count).forEach((text, k) => all.push({ kind: 'same', text, line: from + count + k + 1 }));
  return parts(all);
}

/** The differences with their context. */
function parts(all: readonly DifferenceLine[]): DifferencePart[] {
  const found: DifferencePart[] = [];
  let end = -1;
  all.forEach(({ kind }, k) => {
    if (kind === 'same') return;
    const start = Math.max(k - CONTEXT, end + 1);
    const stop = Math.min(k + CONTEXT, all.length - 1);
    const part = found[found.length - 1];
    if (part && start === end + 1 && end >= 0) part.push(...all.slice(start, stop + 1));
    else found.push(all.slice(start, stop + 1));
    end = stop;
  });
  return found;
}
