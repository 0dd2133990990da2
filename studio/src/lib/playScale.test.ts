import { expect, test } from 'vitest';
import { EXAGGERATION } from './document';
import { LARGEST_GAP, SLIDER, fromSlider, initialScale, roundedScale, scaleText, toSlider } from './playScale';

test('the slider covers all play scales, and every rounded scale has its position', () => {
  expect([fromSlider(0), fromSlider(SLIDER)]).toEqual([EXAGGERATION.min, EXAGGERATION.max]);
  for (const scale of [1, 1.1, 2.5, 9.9, 10, 37, 250, 1900]) expect(fromSlider(toSlider(scale))).toBe(scale);
  // The initial position in the playground.
  expect(roundedScale(10 ** 2.7)).toBe(500);
  expect([1, 2.5, 37, 1900].map(scaleText)).toEqual(['1', '2.5', '37', '1900']);
});

test('the initial play scale is the largest one at which balls stay in their bearings', () => {
  // The robot of the paper, a robot with 25 times its play, and one without any.
  expect([initialScale(0.0142), initialScale(0.35), initialScale(0)]).toEqual([500, 50, 500]);
  for (const displacement of [0.001, 0.04, 0.1, 0.7, 5]) expect(initialScale(displacement) * displacement).toBeLessThanOrEqual(LARGEST_GAP);
  expect(initialScale(1000)).toBe(1);
});
