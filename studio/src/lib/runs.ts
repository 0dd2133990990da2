/** For each row, the number of its execution of a line and the total number of executions. */
export function runs(lines: readonly number[]): { nth: number; of: number }[] {
  const counted = new Map<number, number>();
  const nth = lines.map((line) => {
    const next = (counted.get(line) ?? 0) + 1;
    counted.set(line, next);
    return next;
  });
  return lines.map((line, i) => ({ nth: nth[i]!, of: counted.get(line)! }));
}
