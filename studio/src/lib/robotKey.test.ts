import { expect, test } from 'vitest';
import { robotKey } from './robotKey';

const ROBOT = { name: 'r', version: '1', limbs: [{ socket_radius_m: 0.09 }], limits: { tilt_max_rad: 0.026 }, ball_clearance_m: null, cell: false, series_formats: ['csv'] };

test('a robot is identified by what its file determines', () => {
  for (const same of [{ ...ROBOT }, { ...ROBOT, version: '2', cell: true, series_formats: [] }, Object.fromEntries(Object.entries(ROBOT).reverse())]) expect(robotKey(same)).toBe(robotKey(ROBOT));
  for (const other of [{ ...ROBOT, name: 's' }, { ...ROBOT, limbs: [{ socket_radius_m: 0.12 }] }, { ...ROBOT, limits: { tilt_max_rad: 0.03 } }, { ...ROBOT, ball_clearance_m: 1e-5 }])
    expect(robotKey(other)).not.toBe(robotKey(ROBOT));
});
