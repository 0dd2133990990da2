import { expect, test } from 'vitest';
import { distanceTo, intersect, placeLabels, textParts, type Box, type LabelRequest } from './labelLayout';

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
  for (const name of ['a_', 'motor_a', 'elbow_left', 'a_b_c', 'leg_1 slide']) expect(textParts(name)).toEqual([{ text: name, subscript: false }]);
});

test('labels do not cover avoided areas while there is room, and are on them otherwise', () => {
  const middle: LabelRequest = { x: 400, y: 300, width: 120, height: 32, offset: [0, -12] };
  const area = [[300, 250], [500, 250], [400, 380]] as const;
  const [outside] = placeLabels([middle], VIEW, [], [area]);
  expect(outside!.leader).toBe(true);
  // By sampling, which shares nothing with the test of separating edges.
  const inside = (x: number, y: number) => y >= 250 && y <= 380 && Math.abs(x - 400) <= (100 * (380 - y)) / 130;
  for (let i = 0; i <= 20; i++)
    for (let k = 0; k <= 20; k++) {
      const { left, top, right, bottom } = outside!.box;
      expect(inside(left + (i / 20) * (right - left), top + (k / 20) * (bottom - top))).toBe(false);
    }
  const [covering] = placeLabels([middle], VIEW, [], [[[-1, -1], [900, -1], [900, 700], [-1, 700]]]);
  expect(covering!.box).toEqual({ left: 340, top: 272, right: 460, bottom: 304 });
});

test('leader lines of labels that face away from a middle cross no other label', () => {
  const requests: LabelRequest[] = [[0, 0], [30, 0], [-30, 0], [0, 20], [0, -20]].map(([x, y]) => ({ x: 400 + x!, y: 300 + y!, width: 90, height: 16, offset: [Math.sign(x!) * 55, Math.sign(y!) * 12] }));
  const area = [[330, 260], [470, 260], [470, 340], [330, 340]] as const;
  const placed = placeLabels(requests, VIEW, [], [area]);
  expect(placed).toHaveLength(requests.length);
  expect(placed.filter(({ leader }) => leader).length).toBeGreaterThanOrEqual(3);
  placed.filter(({ leader }) => leader).forEach(({ index, box }) => {
    const { x, y } = requests[index]!;
    const end = [Math.min(Math.max(x, box.left), box.right), Math.min(Math.max(y, box.top), box.bottom)] as const;
    for (const other of placed)
      if (other.index !== index)
        for (let i = 0; i <= 50; i++) {
          const [px, py] = [x + ((end[0] - x) * i) / 50, y + ((end[1] - y) * i) / 50];
          expect(px > other.box.left && px < other.box.right && py > other.box.top && py < other.box.bottom).toBe(false);
        }
  });
});

test('convex polygons, lines and points intersect', () => {
  const square = [[0, 0], [2, 0], [2, 2], [0, 2]] as const;
  expect(intersect(square, [[1, 1]])).toBe(true);
  expect(intersect(square, [[3, 1]])).toBe(false);
  expect(intersect(square, [[-1, 1], [3, 1]])).toBe(true);
  expect(intersect(square, [[-1, 2], [1, 4]])).toBe(false);
  expect(intersect([[0, 0], [2, 2]], [[0, 2], [2, 0]])).toBe(true);
  expect(intersect([[0, 0], [2, 2]], [[3, 0], [5, 0]])).toBe(false);
});

test('a label that stays is next to its point, also in an avoided area', () => {
  const area = [[300, 200], [500, 200], [500, 400], [300, 400]] as const;
  const request: LabelRequest = { x: 400, y: 300, width: 40, height: 16, offset: [0, -12] };
  const [stays, moves] = placeLabels([{ ...request, stays: true }, request], VIEW, [], [area]);
  expect(stays!.box).toEqual({ left: 380, top: 280, right: 420, bottom: 296 });
  expect(moves!.leader).toBe(true);
  expect(moves!.box.right < 300 || moves!.box.left > 500 || moves!.box.bottom < 200 || moves!.box.top > 400).toBe(true);
});

test('labels cover none of many bars while there is room', () => {
  // A row of 300 bars of a mechanism, each at the preferred place of a label.
  const bars = Array.from({ length: 300 }, (_, k) => [[20 + 2.5 * k, 280], [20 + 2.5 * k, 310]] as const);
  const requests: LabelRequest[] = [60, 250, 440, 630].map((x) => ({ x, y: 300, width: 60, height: 16, offset: [42, -10] }));
  const placed = placeLabels(requests, VIEW, [], bars);
  expect(placed).toHaveLength(4);
  for (const { box } of placed) for (const bar of bars) expect(intersect(bar, [[box.left, box.top], [box.right, box.top], [box.right, box.bottom], [box.left, box.bottom]])).toBe(false);
});
