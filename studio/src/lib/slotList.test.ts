import { expect, test } from 'vitest';
import { parseSlots, slotText } from './slotList';

test('lists of slots are written with ranges, and read again', () => {
  expect(slotText([5, 1, 2, 3, 9])).toBe('1-3, 5, 9');
  expect(slotText([])).toBe('');
  for (const slots of [[], [1], [1, 2], [2, 4, 5, 6, 25]]) expect(parseSlots(slotText(slots), 25)).toEqual(slots);
});

test('what is not a list of slots of the station is refused', () => {
  expect(parseSlots('1 - 3,7;9', 25)).toEqual([1, 2, 3, 7, 9]);
  expect(parseSlots('3, 3, 2-4', 25)).toEqual([2, 3, 4]);
  for (const text of ['0', '26', '5-3', 'all', '1.5', '-2', '1-']) expect(parseSlots(text, 25), text).toBeNull();
});
