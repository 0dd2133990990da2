import { expect, test } from 'vitest';
import type { Command } from './document';
import { withinTilt } from './limits';

const tilt = (about_x_deg: number, about_y_deg: number): Command => ({ kind: 'tilt_xy', about_x_deg, about_y_deg, height_mm: 500, height_kind: 'axis' });

test('a tilt within the limit is unchanged', () => {
  for (const command of [tilt(0, 0), tilt(0.9, -1.2), tilt(-1.5, 0)]) expect(withinTilt(command, 1.5)).toBe(command);
  const rods: Command = { kind: 'rods', rods_mm: [1, 2, 3] };
  expect(withinTilt(rods, 0)).toBe(rods);
});

test('a larger tilt is reduced to the limit in its direction', () => {
  for (const [x, y] of [[0.1, 1.5], [3, 4], [-2, 0.3], [1e-9, 1.6], [1.06067, 1.06067]] as const) {
    const found = withinTilt(tilt(x, y), 1.5);
    if (found.kind !== 'tilt_xy') throw new Error('another kind');
    const size = Math.hypot(found.about_x_deg, found.about_y_deg);
    expect(size).toBeLessThanOrEqual(1.5);
    expect(size).toBeGreaterThan(1.5 - 3e-6);
    expect(found.about_x_deg * y - found.about_y_deg * x).toBeCloseTo(0, 5);
  }
});
