import { expect, test } from 'vitest';
import { distanceTo, placeLabels, textParts, type Box, type LabelRequest } from './labelLayout';

/** Numbers from 0 to 1 that are the same in each run. */
function numbers(seed: number): () => number {
  return () => {
    seed = (seed * 1664525 + 1013904223) % 4294967296;
    return seed / 4294967296;
  };
}
const VIEW: Box = { left: 0, top: 0, right: 800, bottom: 600 };
const disjoint = (a: Box, b: Box) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;

test('labels overlap neither each other nor occupied areas, and stay in the view', () => {
  for (let seed = 1; seed <= 40; seed++) {
    const next = numbers(seed);
    const spread = seed % 2 === 0 ? 800 : 90;
    const requests: LabelRequest[] = Array.from({ length: 2 + (seed % 30) }, () => ({
      x: next() * spread, y: next() * spread * 0.75, width: 30 + next() * 160, height: 16, offset: [next() * 40 - 20, next() * 40 - 20],
    }));
    const occupied: Box[] = [{ left: 20, top: 20, right: 60, bottom: 90 }];
    const placed = placeLabels(requests, VIEW, occupied);
    placed.forEach(({ index, box, leader }, i) => {
      expect(box.right - box.left).toBeCloseTo(requests[index]!.width, 9);
      expect(box.left).toBeGreaterThanOrEqual(0);
      expect(box.top).toBeGreaterThanOrEqual(0);
      expect(box.right).toBeLessThanOrEqual(800);
      expect(box.bottom).toBeLessThanOrEqual(600);
      for (const other of [...placed.slice(i + 1).map((one) => one.box), ...occupied]) expect(disjoint(box, other)).toBe(true);
      expect(leader).toBe(distanceTo(box, requests[index]!.x, requests[index]!.y) > 26);
    });
  }
});

test('a label alone is at its preferred place, and coinciding ones get lines', () => {
  const one: LabelRequest = { x: 400, y: 300, width: 60, height: 16, offset: [40, 0] };
  expect(placeLabels([one], VIEW)).toEqual([{ index: 0, box: { left: 410, top: 292, right: 470, bottom: 308 }, leader: false }]);
  const all = placeLabels(Array.from({ length: 8 }, () => one), VIEW);
  expect(all).toHaveLength(8);
  expect(all.some(({ leader }) => leader)).toBe(true);
});

test('a label that does not fit into the view is omitted', () => {
  expect(placeLabels([{ x: 5, y: 5, width: 900, height: 16, offset: [0, 0] }], VIEW)).toEqual([]);
});

test('subscripts', () => {
  expect(textParts('O_b')).toEqual([{ text: 'O', subscript: false }, { text: 'b', subscript: true }]);
  expect(textParts('l₁ +7 µm')).toEqual([{ text: 'l', subscript: false }, { text: '1', subscript: true }, { text: ' +7 µm', subscript: false }]);
  expect(textParts('LP1')).toEqual([{ text: 'LP1', subscript: false }]);
  expect(textParts('a_')).toEqual([{ text: 'a', subscript: false }, { text: '_', subscript: false }]);
});
