import { expect, test } from 'vitest';
import { withoutBodies } from './unchecked';

const robot = { name: 'two arms', axes: [], arms: [{ name: 'upper', links: ['upper link 1', 'upper link 2'], effectors: ['A'] }, { name: 'lower', links: ['lower link 1'], effectors: ['B'] }] };
const body = (attached_to: string, station: string | null = null) => ({ name: `on ${attached_to}`, attached_to, station });

for (const [bodies, missing] of [
  [[], ['arm “upper”', 'arm “lower”', 'the surroundings of the robot']],
  [[body('base')], ['arm “upper”', 'arm “lower”']],
  [[body('base', 'LP1'), body('platform')], ['arm “upper”', 'arm “lower”']],
  [[body('base'), body('upper link 2')], ['arm “lower”']],
  [[body('upper link 1'), body('lower link 1'), body('platform')], ['the surroundings of the robot']],
  [[body('base'), body('upper link 1'), body('lower link 1')], []],
] as const)
  test(`bodies ${bodies.map(({ name }) => name).join(', ') || 'none'}`, () => expect(withoutBodies({ bodies, robot })).toEqual(missing));

test('an invalid cell has no robot', () => expect(withoutBodies({ bodies: [body('base')], robot: null })).toEqual([]));
