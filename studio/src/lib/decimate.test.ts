import { expect, test } from 'vitest';
import { decimate } from './decimate';

test('short series are kept completely', () => {
  expect(decimate([[1, 2, 3, 4]], 1, 4, 2)).toEqual([1, 2, 3]);
  expect(decimate([[]], 0, 0, 10)).toEqual([]);
});

test('decimation keeps every peak of every series in order', () => {
  const count = 100_000;
  const wave = Float64Array.from({ length: count }, (_, i) => Math.sin(i / 500));
  const spikes = new Float64Array(count);
  spikes[33_333] = 9;
  spikes[77_777] = -9;
  const selected = decimate([wave, spikes], 0, count, 500);
  expect(selected).toContain(33_333);
  expect(selected).toContain(77_777);
  expect(selected.length).toBeLessThanOrEqual(500 * 6);
  expect(selected[0]).toBe(0);
  expect(selected.at(-1)).toBe(count - 1);
  for (let i = 1; i < selected.length; i++) expect(selected[i]).toBeGreaterThan(selected[i - 1] as number);
  const largest = Math.max(...selected.map((i) => wave[i] as number));
  expect(largest).toBe(wave.reduce((a, b) => Math.max(a, b)));
});

test('decimation of a range does not depend on the rest', () => {
  const ramp = Float64Array.from({ length: 10_000 }, (_, i) => i);
  const selected = decimate([ramp], 2000, 9000, 10);
  expect(selected[0]).toBe(2000);
  expect(selected.at(-1)).toBe(8999);
  expect(selected.length).toBe(20);
});

test('a pause between motions is drawn with both of its ends', () => {
  // Dense oscillations, a pause of one second without samples, and dense oscillations.
  const times: number[] = [];
  const values: number[] = [];
  for (let i = 0; i <= 3000; i++) {
    times.push(i < 1500 ? i / 1000 : i / 1000 + 1);
    values.push(i === 1499 || i === 1500 ? 0 : Math.sin(i));
  }
  const selected = decimate([values], 0, times.length, 50, times);
  expect(selected).toContain(1499);
  expect(selected).toContain(1500);
  expect(selected[0]).toBe(0);
  expect(selected.at(-1)).toBe(3000);
  expect(selected.length).toBeLessThanOrEqual(200);
  for (let i = 1; i < selected.length; i++) expect(selected[i]).toBeGreaterThan(selected[i - 1] as number);
  // Intervals of equal numbers of samples lose them.
  expect(decimate([values], 0, times.length, 47)).not.toContain(1499);
});
