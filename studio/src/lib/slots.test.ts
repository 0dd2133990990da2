import { expect, test } from 'vitest';
import { slotNames, stationOf } from './slots';

const STATIONS = [
  { name: 'A', slots: 2 },
  { name: 'A B', slots: 3 },
];

test('slots are numbered from 1', () => {
  expect(slotNames(STATIONS[0]!)).toEqual(['A 1', 'A 2']);
});

test('a station is found by its name and by its slots, also if its name starts with that of another one', () => {
  const found = ['A', 'A 2', 'A B', 'A B 3'].map((name) => stationOf(STATIONS, name)?.name);
  expect(found).toEqual(['A', 'A', 'A B', 'A B']);
  expect([null, 'A 3', 'wall'].map((name) => stationOf(STATIONS, name))).toEqual([null, null, null]);
});
