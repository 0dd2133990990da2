import { describe, expect, test } from 'vitest';
import { initialDocument, paperStudy, type Command, type Document } from './document';
import { fingerprint, fromHash, toHash, type Linked } from './link';

const usual = initialDocument(500);

const commands: Command[] = [
  { kind: 'tilt', azimuth_deg: -17.25, tilt_deg: 1.5, height_mm: 500, height_kind: 'center' },
  { kind: 'tilt_xy', about_x_deg: 0.1, about_y_deg: -1e-7, height_mm: 321.123456789, height_kind: 'axis' },
  { kind: 'rods', rods_mm: [500, 501.0625, 502] },
];

const motions = [
  null,
  paperStudy(500),
  { ...paperStudy(400), kind: 'serpentine' } as Document['motion'],
  {
    kind: 'key-poses',
    poses: [
      { about_x_deg: 0, about_y_deg: 0, height_mm: 500, seconds: 0 },
      { about_x_deg: -0.5, about_y_deg: 1.25, height_mm: 510, seconds: 2.5 },
    ],
  } as Document['motion'],
];

describe('a link restores the document it was created from', () => {
  for (const command of commands)
    for (const motion of motions)
      test(`${command.kind}, ${motion?.kind ?? 'no motion'}`, () => {
        const linked: Linked = {
          robot: { name: 'Gerät, #1 & “2”', print: '0badcafe' },
          document: {
            ...usual,
            command,
            motion,
            model: 'offset',
            solver: 'least-norm',
            metric: 12.5,
            exaggeration: 1234,
            shown: { joints: false, ghost: true, others: true, arrows: false, frames: true, labels: false },
          },
          view: { eye_mm: [1, -2.5, 3], target_mm: [0, 0, 400], projection: 'orthographic', zoom: 1.5 },
          sample: motion ? 42 : null,
        };
        expect(fromHash(toHash(linked), usual)).toEqual(linked);
      });
});

describe('what a link garbles is as usual', () => {
  const cases = [
    '',
    '#',
    '#pose=tilt,1,2&model=nothing,at,all&play=x&view=p,1,2',
    '#pose=rods,1,2,&model=,,-3&motion=raster,1&sample=-1',
    '#pose=%E0%A4%A&motion=key-poses;1,2',
    '#pose=spin,1,2,3,axis',
    '#robot=unknown',
  ];
  for (const hash of cases)
    test(hash, () => {
      expect(fromHash(hash, usual)).toEqual({ robot: null, document: usual, view: null, sample: null });
    });

  test('a play scale out of range is clamped', () => {
    expect(fromHash('#play=1e9', usual).document.exaggeration).toBe(2000);
    expect(fromHash('#play=-4', usual).document.exaggeration).toBe(1);
  });

  test('a link without a motion clears a stored motion', () => {
    expect(fromHash('#play=1', { ...usual, motion: paperStudy(500) }).document.motion).toBeNull();
  });
});

test('equal values have equal fingerprints of eight digits', () => {
  expect(fingerprint('')).toBe(fingerprint(''));
  expect(fingerprint({ rod: 0.5 })).toMatch(/^[0-9a-f]{8}$/);
  expect(fingerprint({ rod: 0.5 })).not.toBe(fingerprint({ rod: 0.51 }));
});
