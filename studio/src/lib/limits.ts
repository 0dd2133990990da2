// Commands at the limits of the robot.

import type { Command } from './document';

/** Decimals of the angles of a reduced tilt [deg]; they are truncated, so that the tilt stays below the limit. */
const DECIMALS = 6;

/**
 * Reduces a tilt about x and y beyond the limit to the limit, in the same direction.
 * The robot then moves along the limit, as with machine controllers, instead of stopping.
 */
export function withinTilt(command: Command, tilt_max_deg: number): Command {
  if (command.kind !== 'tilt_xy') return command;
  const { about_x_deg, about_y_deg } = command;
  const tilt = Math.hypot(about_x_deg, about_y_deg);
  if (tilt <= tilt_max_deg) return command;
  const reduced = (value: number) => Math.trunc(value * (tilt_max_deg / tilt) * 10 ** DECIMALS) / 10 ** DECIMALS;
  return { ...command, about_x_deg: reduced(about_x_deg), about_y_deg: reduced(about_y_deg) };
}
