import { expect, test } from 'vitest';
import { find, put, tidy, type Docks } from './docks';

const KNOWN = ['a', 'b', 'c', 'd'];
const docks: Docks = { left: ['a'], right: ['b', 'c', 'd'] };

test('each panel stands somewhere, once', () => {
  for (const nothing of [null, 3, {}, { left: 'a' }]) expect(tidy(nothing, KNOWN)).toEqual({ left: [], right: KNOWN });
  expect(tidy({ left: ['c', 'x', 'c'], right: ['a', 'c', 7] }, KNOWN)).toEqual({ left: ['c'], right: ['a', 'b', 'd'] });
  expect(tidy(docks, KNOWN)).toEqual(docks);
});

test('panels move within a side and to the other', () => {
  expect(put(docks, 'b', 'right', 2)).toEqual({ left: ['a'], right: ['c', 'b', 'd'] });
  expect(put(docks, 'b', 'right', 0)).toEqual(docks);
  expect(put(docks, 'b', 'right', 1)).toEqual(docks);
  expect(put(docks, 'd', 'right', 0)).toEqual({ left: ['a'], right: ['d', 'b', 'c'] });
  expect(put(docks, 'b', 'right', 99)).toEqual({ left: ['a'], right: ['c', 'd', 'b'] });
  expect(put(docks, 'c', 'left', 0)).toEqual({ left: ['c', 'a'], right: ['b', 'd'] });
  expect(put(docks, 'a', 'right', 3)).toEqual({ left: [], right: ['b', 'c', 'd', 'a'] });
  expect(put(docks, 'a', 'left', -5)).toEqual(docks);
  expect(find(docks, 'c')).toEqual({ side: 'right', index: 1 });
});
