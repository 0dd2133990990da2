import { expect, test } from 'vitest';
import { sentence } from './text';

test('a message becomes a sentence with one period', () => {
  expect(sentence(new Error('Error creating WebGL context.'))).toBe('Error creating WebGL context.');
  expect(sentence(new Error('it has no triangles'))).toBe('it has no triangles.');
  expect(sentence('why?')).toBe('why?');
});
