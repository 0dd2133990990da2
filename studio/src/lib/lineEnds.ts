// Line ends of texts in editors, which know `\n` alone.

const LINE_END = /\r\n?|\n/;

/** A text as editors have it: with `\n` at the end of each line. */
export const withoutReturns = (text: string): string => text.replace(/\r\n?/g, '\n');

/** The text of an editor with the line ends of the text before the change; new lines have that of the first line. */
export function withLineEnds(text: string, before: string): string {
  if (!before.includes('\r')) return text;
  const ends = before.match(new RegExp(LINE_END, 'g')) ?? [];
  const [old, lines] = [before.split(LINE_END), text.split('\n')];
  const least = Math.min(old.length, lines.length);
  let from = 0;
  while (from < least && old[from] === lines[from]) from += 1;
  let same = 0;
  while (same < least - from && old[old.length - 1 - same] === lines[lines.length - 1 - same]) same += 1;
  const moved = old.length - lines.length;
  // A line that was changed alone keeps its end.
  const end = (index: number) => (index < from || moved === 0 ? ends[index] : index >= lines.length - same ? ends[index + moved] : undefined) ?? ends[0];
  return lines.map((line, index) => (index === lines.length - 1 ? line : line + end(index))).join('');
}
