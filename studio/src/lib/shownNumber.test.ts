import { expect, test } from 'vitest';
import { shownNumber } from './shownNumber';

test('round-off is not displayed, and zero has no sign', () => {
  expect(shownNumber(-1.3e-17, 9)).toBe('0');
  expect(shownNumber(0.0123456789, 9)).toBe('0.012346');
  expect(shownNumber(29.9999999999, 6)).toBe('30');
  expect(shownNumber(1.005, 3)).toBe('1');
});
