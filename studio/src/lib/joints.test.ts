import { expect, test } from 'vitest';
import type { RobotDocument } from '../api/client';
import { jointLabels, jointRows } from './joints';

const VIRTUALIZATIONS = [{ name: 'polar', joints: [{ symbol: 'l', limb: 0, motion: 'linear', nominal: 0.093218 }] }] as unknown as RobotDocument['virtualizations'];

test('virtual joints of the robot of a cell, whose document has no limbs', () => {
  const [row] = jointRows({ virtualizations: VIRTUALIZATIONS }, 'polar', [0.0932251], 'mm');
  expect([row!.value, row!.moved]).toEqual(['93.2251 mm', '+7.1 µm']);
});

test('labels of a small robot have more decimals', () => {
  const robot = { virtualizations: [{ ...VIRTUALIZATIONS[0]!, joints: [{ ...VIRTUALIZATIONS[0]!.joints[0]!, nominal: 0.0005 }] }], limbs: [{ socket_m: [0.0005, 0, 0] }] } as unknown as RobotDocument;
  expect(jointLabels(robot, 'polar', [0.0005 + 7e-8], 'mm')).toEqual(['l₁ +0.070 µm']);
});
