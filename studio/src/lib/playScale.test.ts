import { expect, test } from 'vitest';
import { EXAGGERATION } from './document';
import { LARGEST_GAP_MM, SLIDER, fromSlider, initialScale, scaleText, toSlider } from './playScale';

test('the slider covers all play scales, and every rounded scale has its position', () => {
  expect([fromSlider(0), fromSlider(SLIDER)]).toEqual([EXAGGERATION.min, EXAGGERATION.max]);
  for (const scale of [1, 1.1, 2.5, 9.9, 10, 37, 250, 1900]) expect(fromSlider(toSlider(scale))).toBe(scale);
  expect([1, 2.5, 37, 1900].map(scaleText)).toEqual(['1', '2.5', '37', '1900']);
});

test('the initial play scale is the largest one at which balls stay in their bearings', () => {
  // The robot of the paper, a robot with 25 times its play, and one without any.
  expect([initialScale(14.2e-6), initialScale(0.35e-3), initialScale(0)]).toEqual([500, 50, 500]);
  for (const displacement_m of [1e-6, 4e-5, 1e-4, 7e-4, 5e-3]) expect(initialScale(displacement_m) * 1000 * displacement_m).toBeLessThanOrEqual(LARGEST_GAP_MM);
  expect(initialScale(1)).toBe(1);
});
