import { expect, test } from 'vitest';
import { lengthsIn } from './lengthsInText';

test('lengths of messages are in the display unit', () => {
  for (const [mm, inch] of [
    ['blade and wall collide with a penetration depth of 25.4 mm', 'blade and wall collide with a penetration depth of 1 in'],
    ['blade comes within 1.234 mm of wall; the required clearance is 5 mm', 'blade comes within 0.04858 in of wall; the required clearance is 0.1969 in'],
    ['the virtual joints are displaced by 12.7 µm, the play budget is 10 µm', 'the virtual joints are displaced by 0.5 mil, the play budget is 0.3937 mil'],
    ['axis P1 moves at 254 mm/s, its limit is 127.5 mm/s', 'axis P1 moves at 10 in/s, its limit is 5.02 in/s'],
    ['axis P1 accelerates at 2540 mm/s², its limit is 1270 mm/s²', 'axis P1 accelerates at 100 in/s², its limit is 50 in/s²'],
    ['rod 2 is 254 mm long, its limits are 127 to 381 mm', 'rod 2 is 10 in long, its limits are 5 to 15 in'],
    ['it stops, at x 25.4, y -50.8, z 76.2 mm', 'it stops, at x 1, y -2, z 3 in'],
    ['pin-5mm touches LP1-10 within 2.54 mm', 'pin-5mm touches LP1-10 within 0.1 in'],
    ['line 3, 2.54 mm deep', 'line 3, 0.1 in deep'],
    ['the platform tilts by 1.6°, its limit is 1.5°', 'the platform tilts by 1.6°, its limit is 1.5°'],
    ['it requires friction of 2.1 m/s², LP1 slot 3 for 4 s', 'it requires friction of 2.1 m/s², LP1 slot 3 for 4 s'],
    ['residual of 2.54e-4 mm', 'residual of 0.00001 in'],
    ['0 mm', '0 in'],
  ] as const) {
    expect(lengthsIn(mm, 'inch')).toBe(inch);
    expect(lengthsIn(mm, 'mm')).toBe(mm);
  }
});

test('a value and its limit that differ in mm differ in inches', () => {
  const [, worst, limit] = /within (\S+) in .* is (\S+) in/.exec(lengthsIn('a comes within 4.9996 mm of b; the required clearance is 5.0000 mm', 'inch'))!;
  expect(Number(worst)).toBeLessThan(Number(limit));
});
