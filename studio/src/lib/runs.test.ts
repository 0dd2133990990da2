import { expect, test } from 'vitest';
import { runs } from './runs';

test('executions of a line are counted', () => {
  expect(runs([5, 8, 9, 8, 9, 8])).toEqual([
    { nth: 1, of: 1 },
    { nth: 1, of: 3 },
    { nth: 1, of: 2 },
    { nth: 2, of: 3 },
    { nth: 2, of: 2 },
    { nth: 3, of: 3 },
  ]);
  expect(runs([])).toEqual([]);
});
