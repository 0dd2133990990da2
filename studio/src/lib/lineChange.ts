/** Lines in place of others: how many stay before them, how many go, and those in their place. */
export interface Lines {
  from: number;
  count: number;
  lines: string[];
}

/** The lines by which a text differs from another, as one stretch. */
export function lineChange(before: string, after: string): Lines {
  const [old, lines] = [before.split('\n'), after.split('\n')];
  const least = Math.min(old.length, lines.length);
  let from = 0;
  while (from < least && old[from] === lines[from]) from += 1;
  let same = 0;
  while (same < least - from && old[old.length - 1 - same] === lines[lines.length - 1 - same]) same += 1;
  return { from, count: old.length - same - from, lines: lines.slice(from, lines.length - same) };
}
