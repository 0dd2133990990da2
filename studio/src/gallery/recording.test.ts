import { expect, test } from 'vitest';
import { placed, type Recording } from './recording';

test('the third row of a rotation completes its first two', () => {
  const recording = { poses: [[[1, 2, 3, 0, -1, 0, 1, 0, 0]]] } as unknown as Recording;
  expect(placed(recording)).toEqual([[{ origin_m: [1, 2, 3], rotation: [[0, -1, 0], [1, 0, 0], [-0, 0, 1]] }]]);
});
