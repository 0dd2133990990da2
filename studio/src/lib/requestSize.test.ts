import { expect, test } from 'vitest';
import { fileSizeProblem, jsonBytes, MAX_BODY_BYTES, sizeProblem } from './requestSize';

test('the size of a text is that of its JSON', () => {
  expect(jsonBytes('abc')).toBe(5);
  expect(jsonBytes('a\nb')).toBe(6);
  expect(jsonBytes('"µ"')).toBe(8);
  expect(jsonBytes({ text: 'a' })).toBe('{"text":"a"}'.length);
});

test('a text is refused if its JSON is too long, however short its file', () => {
  const short = 'x'.repeat(0.85 * MAX_BODY_BYTES);
  expect(sizeProblem('a.toml', { text: short })).toBeNull();
  // Each line break is two bytes of JSON.
  const lines = '\n'.repeat(0.5 * MAX_BODY_BYTES);
  expect(fileSizeProblem({ name: 'a.toml', size: lines.length })).toBeNull();
  expect(sizeProblem('a.toml', { text: lines })).toBe('a.toml is too large: it needs 10.00 MB in a request, and 9.00 MB are allowed.');
  // A model and the file of its loops are sent together.
  expect(sizeProblem('a.urdf', { text: short, loops: short })).toContain('needs 17.00 MB');
});

test('a file that is longer than any request is not read', () => {
  expect(fileSizeProblem({ name: 'big.urdf', size: 1.5 * MAX_BODY_BYTES })).toBe('big.urdf is too large: it has 15.00 MB, and 9.00 MB are allowed in a request.');
});
