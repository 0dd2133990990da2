import { expect, test } from 'vitest';
import { lineChange } from './lineChange';

const cases: [string, string, string, unknown][] = [
  ['nothing', 'a\nb\n', 'a\nb\n', { from: 3, count: 0, lines: [] }],
  ['a line in the middle', 'a\nb\nc', 'a\nx\nc', { from: 1, count: 1, lines: ['x'] }],
  ['a line more among equal ones', 'a\na\na', 'a\na\na\na', { from: 3, count: 0, lines: ['a'] }],
  ['a line less', 'a\nb\nc', 'a\nc', { from: 1, count: 1, lines: [] }],
  ['all', '', 'a\nb', { from: 0, count: 1, lines: ['a', 'b'] }],
];
for (const [name, before, after, lines] of cases)
  test(`changed lines: ${name}`, () => {
    const found = lineChange(before, after);
    expect(found).toEqual(lines);
    const all = before.split('\n');
    all.splice(found.from, found.count, ...found.lines);
    expect(all.join('\n')).toBe(after);
  });
