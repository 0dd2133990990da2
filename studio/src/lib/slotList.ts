// Numbers of slots as text, with ranges: `1-5, 8`.

/** Numbers as text, with ranges of consecutive ones. */
export function slotText(slots: readonly number[]): string {
  const runs: [number, number][] = [];
  for (const slot of [...slots].sort((a, b) => a - b)) {
    const last = runs.at(-1);
    if (last && slot <= last[1] + 1) last[1] = slot;
    else runs.push([slot, slot]);
  }
  return runs.map(([from, to]) => (from === to ? String(from) : `${from}-${to}`)).join(', ');
}

/** The numbers of a text, each once and in order; `null` if it is not a list of numbers from 1 to `count`. */
export function parseSlots(text: string, count: number): number[] | null {
  const found = new Set<number>();
  for (const part of text.replace(/\s*[-–]\s*/g, '-').split(/[,;\s]+/).filter(Boolean)) {
    const range = /^(\d+)(?:-(\d+))?$/.exec(part);
    if (!range) return null;
    const [from, to] = [Number(range[1]), Number(range[2] ?? range[1])];
    if (from < 1 || to > count || from > to) return null;
    for (let slot = from; slot <= to; slot += 1) found.add(slot);
  }
  return [...found].sort((a, b) => a - b);
}
