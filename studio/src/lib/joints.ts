import type { RobotDocument } from '../api/client';
import { finerDecimals } from '../scene/robotSize';
import { degrees, fixed, length, angle, small, smallAngle, type LengthUnit } from './units';

const SYMBOLS: Record<string, string> = { phi: 'φ', dphi: 'dφ' };
const SUBSCRIPTS = '₁₂₃';

export function symbol(name: string, limb: number): string {
  return `${SYMBOLS[name] ?? name}${SUBSCRIPTS[limb] ?? `_${limb + 1}`}`;
}

export interface JointRow {
  symbol: string;
  limb: number;
  /** Joint coordinate. */
  value: string;
  /** Displacement from the nominal position. */
  moved: string;
}

/** Table of the virtual joints of a model; `finer` are decimals of lengths in addition to the usual ones. */
export function jointRows(robot: Pick<RobotDocument, 'virtualizations'>, model: string, values: number[], unit: LengthUnit, finer = 0): JointRow[] {
  const joints = robot.virtualizations.find(({ name }) => name === model)?.joints ?? [];
  return joints.map((joint, i) => {
    const value = values[i] as number;
    const moved = value - joint.nominal;
    const slides = joint.motion === 'linear';
    return {
      symbol: symbol(joint.symbol, joint.limb),
      limb: joint.limb,
      value: slides ? length(value, unit, 4 + finer) : angle(value, 4),
      moved: slides ? small(moved, unit, 1 + finer, true) : turned(moved),
    };
  });
}

/** Labels of the limbs, with the displacement of each of their virtual joints in a line. */
export function jointLabels(robot: RobotDocument, model: string, values: number[], unit: LengthUnit): string[] {
  const rows = jointRows(robot, model, values, unit, finerDecimals(robot.limbs));
  return robot.limbs.map((_, limb) =>
    rows
      .filter((row) => row.limb === limb)
      .map((row) => `${row.symbol} ${row.moved}`)
      .join('\n'),
  );
}

/** Small angles in µrad, others in degrees: the direction angle of the offset model is arbitrary. */
function turned(rad: number): string {
  return Math.abs(rad) < 0.01 ? smallAngle(rad, true) : `${fixed(degrees(rad), 1)}°`;
}
