import { expect, test } from 'vitest';
import { findPanel, insertPanel, validDocks, type Docks } from './docks';

const KNOWN = ['a', 'b', 'c', 'd'];
const docks: Docks = { left: ['a'], right: ['b', 'c', 'd'] };

test('each known panel appears exactly once', () => {
  for (const nothing of [null, 3, {}, { left: 'a' }]) expect(validDocks(nothing, KNOWN)).toEqual({ left: [], right: KNOWN });
  expect(validDocks({ left: ['c', 'x', 'c'], right: ['a', 'c', 7] }, KNOWN)).toEqual({ left: ['c'], right: ['a', 'b', 'd'] });
  expect(validDocks(docks, KNOWN)).toEqual(docks);
});

test('panels move within a side and to the other side', () => {
  expect(insertPanel(docks, 'b', 'right', 2)).toEqual({ left: ['a'], right: ['c', 'b', 'd'] });
  expect(insertPanel(docks, 'b', 'right', 0)).toEqual(docks);
  expect(insertPanel(docks, 'b', 'right', 1)).toEqual(docks);
  expect(insertPanel(docks, 'd', 'right', 0)).toEqual({ left: ['a'], right: ['d', 'b', 'c'] });
  expect(insertPanel(docks, 'b', 'right', 99)).toEqual({ left: ['a'], right: ['c', 'd', 'b'] });
  expect(insertPanel(docks, 'c', 'left', 0)).toEqual({ left: ['c', 'a'], right: ['b', 'd'] });
  expect(insertPanel(docks, 'a', 'right', 3)).toEqual({ left: [], right: ['b', 'c', 'd', 'a'] });
  expect(insertPanel(docks, 'a', 'left', -5)).toEqual(docks);
  expect(findPanel(docks, 'c')).toEqual({ side: 'right', index: 1 });
});
