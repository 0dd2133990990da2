import { expect, test } from 'vitest';
import { compose, exaggerated, inverse, poseOf, type Frame } from './kinematics';

/** A tilt about a horizontal axis, as origin and quaternion. */
function tilted(x: number, y: number, z: number, azimuth: number, angle: number, twist: number): Frame {
  const tilt = [0, 0, 0, -Math.sin(azimuth) * Math.sin(angle / 2), Math.cos(azimuth) * Math.sin(angle / 2), 0, Math.cos(angle / 2)] as const;
  const turn = [0, 0, 0, 0, 0, Math.sin(twist / 2), Math.cos(twist / 2)] as const;
  const [, , , ...quaternion] = compose(tilt, turn);
  return { name: 'platform', origin_m: [x, y, z], quaternion };
}

test('a scale of 1 leaves all frames as they are', () => {
  const platform = tilted(1e-5, -2e-5, 0.5, 0.7, 0.02, 1e-6);
  expect(exaggerated([platform], 1, () => true)).toEqual([platform]);
});

test('displacement and twist grow by the scale, the plane of the platform remains', () => {
  const [azimuth, angle, twist, scale] = [2.1, 0.025, 3e-6, 500];
  // A displacement within the plane of the platform, as the balls determine it.
  const normal = [Math.cos(azimuth) * Math.sin(angle), Math.sin(azimuth) * Math.sin(angle), Math.cos(angle)];
  const [x, y] = [1.2e-5, -0.7e-5];
  const lift = (x: number, y: number) => 0.5 - (normal[0]! * x + normal[1]! * y) / normal[2]!;
  const [found] = exaggerated([tilted(x, y, lift(x, y), azimuth, angle, twist)], scale, () => false);
  const expected = tilted(scale * x, scale * y, lift(scale * x, scale * y), azimuth, angle, scale * twist);
  found!.origin_m.forEach((value, k) => expect(value).toBeCloseTo(expected.origin_m[k]!, 12));
  found!.quaternion.forEach((value, k) => expect(value).toBeCloseTo(expected.quaternion[k]!, 12));
});

test('a held wafer keeps its pose on the platform, a resting one its own', () => {
  const platform = tilted(1e-5, 2e-5, 0.5, 0.3, 0.01, 0);
  const wafers = ['held', 'resting'].map((name): Frame => ({ name, origin_m: [0.6, 0.1, 0.55], quaternion: [0, 0, 0, 1] }));
  const shown = exaggerated([platform, ...wafers], 800, (name) => name === 'held');
  const pose = ({ origin_m, quaternion }: Frame) => [...origin_m, ...quaternion] as unknown as ReturnType<typeof poseOf>;
  const before = compose(inverse(pose(platform)), pose(wafers[0]!));
  const after = compose(inverse(pose(shown[0]!)), pose(shown[1]!));
  after.forEach((value, k) => expect(value).toBeCloseTo(before[k]!, 12));
  expect(shown[1]!.origin_m[0]).toBeGreaterThan(0.605);
  expect(shown[2]).toEqual(wafers[1]);
});
