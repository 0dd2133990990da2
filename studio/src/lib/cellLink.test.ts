import { describe, expect, test } from 'vitest';
import { fromCellHash, isCellLink, toCellHash, type CellLink } from './cellLink';

const links: CellLink[] = [
  { cell: 'mine.toml', time: 0, tab: 'program', instruction: null, selected: null, range: null, play: 1, camera: null },
  { cell: 'Zelle & Süd=1#2.toml', time: 12.345678, tab: 'steps', instruction: 7, selected: { kind: 'slot', name: 'LP1', slot: 3 }, range: [1.5, 20.25], play: 500, camera: { eye: [1.5, -2.25, 3], target: [0, 0.125, 0.5] } },
  { cell: 'example', time: 849.999999, tab: 'parts', instruction: null, selected: { kind: 'body', name: '50 % & more: a' }, range: null, play: 1, camera: { eye: [0, 0, 1], target: [0, 0, 0] } },
];

describe('a link restores the view it was created from', () => {
  for (const link of links) test(link.cell, () => expect(fromCellHash(toCellHash(link))).toEqual(link));
});

test('a link of another view is none of the cell', () => {
  expect(isCellLink('#pose=tilt,0,1,500,axis')).toBe(false);
  expect(fromCellHash('')).toBe(null);
});

test('invalid parts have their defaults', () => {
  const nothing = { cell: 'a', time: 0, tab: 'program', instruction: null, selected: null, range: null, play: 1, camera: null };
  for (const bad of ['time=-3', 'time=1e999', 'time=', 'tab=none', 'instruction=0', 'instruction=1.5', 'range=5,1', 'range=1', 'range=-1,2', 'play=0', 'play=x', 'view=1,2,3', 'view=1,2,3,1,2,3', 'view=1,2,x,0,0,0', 'selected=', 'selected=wall', 'selected=wheel:a', 'what=ever', '=', '&&'])
    expect(fromCellHash(`#cell=a&${bad}`), bad).toEqual(nothing);
  expect(fromCellHash('#cell=%E0%A4%A')!.cell).toBe('%E0%A4%A');
});
