// Commands at the limits of the robot.

import type { Command } from './document';

/** Decimals of degrees that are kept where a tilt is reduced: below the limit, never above. */
const DECIMALS = 6;

/**
 * A tilt about x and y within the limit: where it is larger, the tilt of the same direction at the limit.
 * So a robot at its limit moves along it, as machine controllers do, and does not stop.
 */
export function withinTilt(command: Command, tilt_max_deg: number): Command {
  if (command.kind !== 'tilt_xy') return command;
  const { about_x_deg, about_y_deg } = command;
  const tilt = Math.hypot(about_x_deg, about_y_deg);
  if (tilt <= tilt_max_deg) return command;
  const reduced = (value: number) => Math.trunc(value * (tilt_max_deg / tilt) * 10 ** DECIMALS) / 10 ** DECIMALS;
  return { ...command, about_x_deg: reduced(about_x_deg), about_y_deg: reduced(about_y_deg) };
}
