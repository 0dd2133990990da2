// Poses as commands.

import type { PoseDocument } from '../api/client';
import type { Command, HeightKind } from './document';
import { degrees, millimetres } from './units';

/** Decimals of mm and degrees: rounded for display, and exact enough to keep a pose at a limit. */
export const DISPLAY_DECIMALS = 6;
export const EXACT_DECIMALS = 12;

/** A pose as a command. */
export function asCommand(kind: Command['kind'], height_kind: HeightKind, pose: PoseDocument, decimals: number): Command {
  const round = (value: number) => Number(value.toFixed(decimals));
  if (kind === 'rods') return { kind, rods_mm: pose.rods_m.map((q) => round(millimetres(q))) as [number, number, number] };
  const center = pose.models[0]?.answer?.pose.origin_m[2];
  const height_m = height_kind === 'center' && center !== undefined ? center : pose.axis_height_m;
  const height_mm = round(millimetres(height_m));
  const { azimuth_rad, angle_rad, about_x_rad, about_y_rad } = pose.tilt;
  return kind === 'tilt'
    ? { kind, azimuth_deg: round(degrees(azimuth_rad)), tilt_deg: round(degrees(angle_rad)), height_mm, height_kind }
    : { kind, about_x_deg: round(degrees(about_x_rad)), about_y_deg: round(degrees(about_y_rad)), height_mm, height_kind };
}

/** A pose as a command of the same kind as another command. */
export function asCommandLike(original: Command, pose: PoseDocument, decimals: number): Command {
  const command = asCommand(original.kind, original.kind === 'rods' ? 'axis' : original.height_kind, pose, decimals);
  if (original.kind !== 'tilt' || command.kind !== 'tilt') return command;
  // A level pose has no tilt direction; a negative tilt angle is a tilt in the opposite direction.
  if (command.tilt_deg === 0) return { ...command, azimuth_deg: original.azimuth_deg };
  if (original.tilt_deg >= 0) return command;
  return { ...command, tilt_deg: -command.tilt_deg, azimuth_deg: command.azimuth_deg + (command.azimuth_deg > 0 ? -180 : 180) };
}
