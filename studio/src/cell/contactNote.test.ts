import { expect, test } from 'vitest';
import { contactNoteLine } from './contactNote';

test('the contact comment of a station is found', () => {
  const text = '# Taught in contact: a and b.\n[[station]]\nname = "LP1"\n\n# Taught in contact: c and d.\n[[station]]\nslots = 2\nname = "LP2" # right\n\n[[body]]\nname = "wall"\n';
  expect([contactNoteLine(text, 'LP1'), contactNoteLine(text, 'LP2')]).toEqual([1, 5]);
  expect(contactNoteLine('station = [\n    # Taught in contact: a and b.\n    { name = "LP1" },\n]\n', 'LP1')).toBe(2);
});
