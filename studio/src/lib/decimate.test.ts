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
  const kept = decimate([wave, spikes], 0, count, 500);
  expect(kept).toContain(33_333);
  expect(kept).toContain(77_777);
  expect(kept.length).toBeLessThanOrEqual(500 * 6);
  expect(kept[0]).toBe(0);
  expect(kept.at(-1)).toBe(count - 1);
  for (let i = 1; i < kept.length; i++) expect(kept[i]).toBeGreaterThan(kept[i - 1] as number);
  const largest = Math.max(...kept.map((i) => wave[i] as number));
  expect(largest).toBe(wave.reduce((a, b) => Math.max(a, b)));
});

test('decimation of a range does not depend on the rest', () => {
  const ramp = Float64Array.from({ length: 10_000 }, (_, i) => i);
  const kept = decimate([ramp], 2000, 9000, 10);
  expect(kept[0]).toBe(2000);
  expect(kept.at(-1)).toBe(8999);
  expect(kept.length).toBe(20);
});
