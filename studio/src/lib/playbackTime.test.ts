import { expect, test } from 'vitest';
import { playbackTime } from './playbackTime';

test('a film is as long as its motion where pictures are rendered slowly, and playback does not jump after a pause', () => {
  // Pictures of a processor without a graphics card, and of a hidden page [ms].
  const pictures = [0, 16, 900, 2400, 2416, 9100];
  const total = (isFilm: boolean) => pictures.slice(1).reduce((sum, now, k) => sum + playbackTime(pictures[k]!, now, isFilm), 0);
  expect(total(true)).toBeCloseTo(9.1, 9);
  expect(total(false)).toBeCloseTo(0.016 + 0.25 + 0.25 + 0.016 + 0.25, 9);
  // The first picture may be older than the start.
  expect(playbackTime(5, 3, true)).toBe(0);
});
