import { expect, test } from 'vitest';
import { lineDifference } from './lineDifference';

const written = (before: string, after: string) => lineDifference(before, after).map((part) => part.map(({ kind, text }) => ({ same: ' ', removed: '-', added: '+' })[kind] + text).join('\n'));

test('equal texts have no difference', () => {
  expect(lineDifference('', '')).toEqual([]);
  expect(lineDifference('a\nb\n', 'a\nb\n')).toEqual([]);
});

test('differences have lines around them, and are parts where they are apart', () => {
  const before = Array.from({ length: 20 }, (_, k) => `line ${k + 1}`);
  const after = before.flatMap((line, k) => (k === 4 ? ['changed'] : k === 15 ? [line, 'new'] : [line]));
  expect(written(before.join('\n'), after.join('\n'))).toEqual([' line 3\n line 4\n-line 5\n+changed\n line 6\n line 7', ' line 15\n line 16\n+new\n line 17\n line 18']);
  expect(lineDifference(before.join('\n'), after.join('\n'))[0]![2]).toEqual({ kind: 'removed', text: 'line 5', line: 5 });
});

test('either text follows from its lines', () => {
  let seed = 7;
  const next = (below: number) => (seed = (seed * 1103515245 + 12345) % 2147483648) % below;
  for (let run = 0; run < 200; run++) {
    const text = () => Array.from({ length: next(9) }, () => 'abc'[next(3)]).join('\n');
    const [before, after] = [text(), text()];
    // Contexts overlap in texts this short: one part has all lines but those at its ends.
    const lines = lineDifference(before, after).flat();
    const side = (kind: 'removed' | 'added') => lines.filter((one) => one.kind === 'same' || one.kind === kind).map((one) => one.text).join('\n');
    if (before !== after) {
      expect(before.includes(side('removed'))).toBe(true);
      expect(after.includes(side('added'))).toBe(true);
    } else expect(lines).toEqual([]);
  }
});

test('long texts without common lines are compared at once', () => {
  const text = (name: string) => Array.from({ length: 10_000 }, (_, k) => `${name} ${k}`).join('\n');
  const lines = lineDifference(text('a'), text('b')).flat();
  expect(lines.filter(({ kind }) => kind === 'removed')).toHaveLength(10_000);
  expect(lines.filter(({ kind }) => kind === 'added')).toHaveLength(10_000);
});
