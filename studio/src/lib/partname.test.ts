import { expect, test } from 'vitest';
import { partName } from './partname';

test('wafers of a check result are found in the picture, also where an effector and a station have one name', () => {
  const stations = [{ name: 'LP1', slots: 25 }, { name: 'PM1', slots: 1 }, { name: 'A', slots: 1 }];
  const names = ['wafer from A', 'wafer of A', 'wafer of PM1', 'wafer of LP1 3', 'wafer of LP1', 'blade-A', 'wall'];
  expect(names.map((name) => partName(name, stations))).toEqual(['wafer of A', 'wafer of A 1', 'wafer of PM1 1', 'wafer of LP1 3', 'wafer of LP1', 'blade-A', 'wall']);
});
