import { expect, test } from 'vitest';
import { FACTORS, MIN_SPAN } from './channels';
import { PLOTS, decimalsOf, verticalRange } from './figures';

test('values have a margin of eight hundredths above and below', () => {
  const [low, high] = verticalRange(0, 100, 1e-6);
  expect(low).toBeCloseTo(-8, 12);
  expect(high).toBeCloseTo(108, 12);
});

test('rounding errors are a flat line, motion is not', () => {
  for (const { unit, id } of PLOTS) {
    // Noise as it was seen: some 1e-11 rad and 1e-15 m about a value.
    const noise = { mm: 1e-15, µm: 1e-15, in: 1e-15, mil: 1e-15, mrad: 1e-11, '°': 1e-11, s: 0, '1': 0 }[unit] * FACTORS[unit];
    const [low, high] = verticalRange(3 - noise, 3 + noise, MIN_SPAN[unit]);
    expect((2 * noise) / (high - low), id).toBeLessThan(0.01);
    // A tenth of a micrometre and of a microradian fill their plots.
    const motion = 1e-7 * FACTORS[unit];
    const [from, to] = verticalRange(-motion, motion, MIN_SPAN[unit]);
    expect((2 * motion) / (to - from), id).toBeGreaterThan(0.8);
  }
});

test('no values and one value have a range', () => {
  expect(verticalRange(null, null, 2)).toEqual([-1, 1]);
  expect(verticalRange(5, 5, 2)).toEqual([4, 6]);
});

test('the decimals of ticks write their distance in full', () => {
  for (const [step, decimals] of [[0.025, 3], [0.25, 2], [2.5, 1], [0.1, 1], [0.05, 2], [1, 0], [25, 0], [0.001, 3], [1e-7, 7], [2.5e-7, 8]] as const) expect(decimalsOf(step), String(step)).toBe(decimals);
});
