import { expect, test } from 'vitest';
import { keysOfPart, pairTitle, partKey, partOfKey, partTitle, samePart, stationOfPart, type CellParts, type Part } from './parts';

/** A cell whose parts share their names. */
const CELL: CellParts = {
  stations: [
    { name: 'A', slots: 2 },
    { name: 'A 1', slots: 1 },
  ],
  bodies: [
    { name: 'A', attached_to: 'base', station: null },
    { name: 'A 1', attached_to: 'base', station: 'A' },
    { name: 'blade', attached_to: 'A', station: null },
    { name: 'plate', attached_to: 'platform', station: null },
  ],
  robot: { name: 'A', axes: ['q1', 'q2', 'q3', 'T'].map((name) => ({ name })), arms: [{ name: 'A', links: ['A 1', 'A'], effectors: ['A'] }] },
};
const keys = (part: Part | null) => [...keysOfPart(part, CELL)];

test('parts of one name differ by their kind, and slots by their number', () => {
  const parts: Part[] = [{ kind: 'body', name: 'A 1' }, { kind: 'station', name: 'A 1' }, { kind: 'slot', name: 'A', slot: 1 }, { kind: 'slot', name: 'A 1', slot: 1 }];
  expect(new Set(parts.map(partKey)).size).toBe(4);
  expect(parts.map(partTitle)).toEqual(['A 1', 'A 1', 'A 1', 'A 1 1']);
  expect(samePart(parts[0]!, { kind: 'body', name: 'A 1' })).toBe(true);
  expect(samePart(parts[0]!, parts[1]!)).toBe(false);
  expect(samePart(parts[0]!, null)).toBe(false);
  expect(samePart(null, null)).toBe(true);
});

test('a pair of parts is named by its names, and by their kinds where the names are equal', () => {
  expect(pairTitle([{ kind: 'body', name: 'wall' }, { kind: 'wafer', name: 'wafer of LP1 1' }])).toBe('wall – wafer of LP1 1');
  expect(pairTitle([{ kind: 'body', name: 'wall' }, { kind: 'zone', name: 'wall' }])).toBe('body wall – zone wall');
});

test('a part is restored from its key', () => {
  for (const part of [{ kind: 'body', name: '3:a' }, { kind: 'slot', name: '3:a', slot: 12 }, { kind: 'zone', name: 'a:b = c' }] as const) expect(partOfKey(partKey(part))).toEqual(part);
  for (const bad of ['', 'wall', 'wheel:a', 'body:', 'slot:a', 'slot:0:a', 'slot:1:']) expect(partOfKey(bad), bad).toBeNull();
});

test('parts that belong to a part are found by kind, whatever their names', () => {
  expect(keys(null)).toEqual([]);
  expect(keys({ kind: 'station', name: 'A' })).toEqual(['station:A', 'slot:1:A', 'slot:2:A', 'body:A 1']);
  expect(keys({ kind: 'station', name: 'A 1' })).toEqual(['station:A 1', 'slot:1:A 1']);
  expect(keys({ kind: 'body', name: 'A' })).toEqual(['body:A']);
  expect(keys({ kind: 'arm', name: 'A' })).toEqual(['arm:A', 'link:A 1', 'link:A', 'body:blade']);
  expect(keys({ kind: 'effector', name: 'A' })).toEqual(['effector:A', 'link:A', 'body:blade']);
  expect(keys({ kind: 'link', name: 'A 1' })).toEqual(['link:A 1']);
  expect(keys({ kind: 'robot', name: 'A' })).toEqual(['robot:A', 'link:A 1', 'link:A', 'platform:platform', 'axis:q1', 'axis:q2', 'axis:q3', 'body:blade', 'body:plate']);
});

test('only stations and slots have a station', () => {
  const names = ([{ kind: 'station', name: 'A' }, { kind: 'slot', name: 'A 1', slot: 1 }, { kind: 'body', name: 'A' }, { kind: 'station', name: 'B' }] as Part[]).map((part) => stationOfPart(part, CELL.stations)?.name);
  expect(names).toEqual(['A', 'A 1', undefined, undefined]);
});
