import { expect, test } from 'vitest';
import { EXAGGERATION } from './document';
import { SLIDER, fromSlider, scaleText, toSlider } from './playScale';

test('the slider covers all play scales, and every rounded scale has its position', () => {
  expect([fromSlider(0), fromSlider(SLIDER)]).toEqual([EXAGGERATION.min, EXAGGERATION.max]);
  for (const scale of [1, 1.1, 2.5, 9.9, 10, 37, 250, 1900]) expect(fromSlider(toSlider(scale))).toBe(scale);
  expect([1, 2.5, 37, 1900].map(scaleText)).toEqual(['1', '2.5', '37', '1900']);
});
