// The time by which playback advances from one picture to the next.

/** Longest time between two pictures that playback advances by [ms]: a hidden page has no pictures. */
const LONGEST_MS = 250;

/** Time from one picture to the next [s]. A film has the time that passed, however slowly its pictures are rendered: it is as long as its motion. */
export function playbackTime(last_ms: number, now_ms: number, isFilm: boolean): number {
  const passed = Math.max(now_ms - last_ms, 0);
  return (isFilm ? passed : Math.min(passed, LONGEST_MS)) / 1000;
}
