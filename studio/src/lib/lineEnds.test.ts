import { expect, test } from 'vitest';
import { withLineEnds, withoutReturns } from './lineEnds';

test('an edited text keeps the line ends of its file', () => {
  for (const [before, text, expected] of [
    ['a\r\nb\r\nc\r\n', 'a\nB\nc\n', 'a\r\nB\r\nc\r\n'],
    ['a\r\nb\r\n', 'a\nnew\nb\n', 'a\r\nnew\r\nb\r\n'],
    ['a\r\nb\r\nc', 'a\nc', 'a\r\nc'],
    ['a\r\nb\nc\r\n', 'a\nx\nb\nC\n', 'a\r\nx\r\nb\r\nC\r\n'],
    ['a\r\nb\nc\r\n', 'a\nB\nc\n', 'a\r\nB\nc\r\n'],
    ['a\nb\n', 'a\nB\n', 'a\nB\n'],
    ['a\r\n', '', ''],
    ['', 'a\n', 'a\n'],
    ['\r\n\r\n', '\n\n\n', '\r\n\r\n\r\n'],
  ] as const)
    expect(withLineEnds(text, before)).toBe(expected);
});

test('a text that is not changed keeps every line end', () => {
  for (const text of ['a\r\nb\nc\rd\r\n', '\r\n', 'a', '']) expect(withLineEnds(withoutReturns(text), text)).toBe(text);
});
