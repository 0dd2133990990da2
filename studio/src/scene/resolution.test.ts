import { expect, test } from 'vitest';
import { Resolution } from './resolution';

const run = (resolution: Resolution, interval: number, count: number) => {
  for (let i = 0; i < count; i++) resolution.observe(interval);
  return resolution.moving;
};

test('a slow scene loses resolution until it is fast enough, down to half', () => {
  const resolution = new Resolution(1, true);
  expect(resolution.moving).toBe(1);
  expect(run(resolution, 100, 2)).toBe(1);
  expect(run(resolution, 100, 1)).toBeLessThan(1);
  const reduced = resolution.moving;
  expect(run(resolution, 50, 100)).toBe(reduced);
  expect(run(resolution, 200, 1000)).toBe(0.5);
});

test('a fast scene recovers its resolution, and not more', () => {
  const resolution = new Resolution(3, false);
  run(resolution, 200, 1000);
  expect(run(resolution, 8, 10_000)).toBe(2);
  expect(resolution.still).toBe(2);
});

test('pauses are not slow frames', () => {
  expect(run(new Resolution(1, true), 5000, 100)).toBe(1);
});

test('a still picture is smoothed where movement is not', () => {
  expect(new Resolution(1, true).still).toBe(2);
  expect(new Resolution(2, true).still).toBe(2);
  expect(new Resolution(2, false).still).toBe(2);
});
