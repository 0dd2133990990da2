/** A change of a text: the number of lines before it, the number of replaced lines, and the new lines. */
export interface LineChange {
  from: number;
  count: number;
  lines: string[];
}

/** The change from one text to another, as one range of lines. */
export function lineChange(before: string, after: string): LineChange {
  const [old, lines] = [before.split('\n'), after.split('\n')];
  const least = Math.min(old.length, lines.length);
  let from = 0;
  while (from < least && old[from] === lines[from]) from += 1;
  let same = 0;
  while (same < least - from && old[old.length - 1 - same] === lines[lines.length - 1 - same]) same += 1;
  return { from, count: old.length - same - from, lines: lines.slice(from, lines.length - same) };
}
