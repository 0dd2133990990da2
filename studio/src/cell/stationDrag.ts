// A station dragged by its handles: what it is on the way, and what the server is told at the end.

import type { StationChange, StationDocument } from '../api/client';
import type { Freedom } from '../scene/handles';
import { degrees, metres, radians } from '../lib/units';

export interface Drag {
  /** The station as it would be. */
  station: StationDocument;
  change: StationChange;
}

const AXES: readonly Freedom[] = ['x', 'y', 'height'];

/** One freedom changed by mm or degrees, to a hundredth of a mm or a thousandth of a degree; a lean no farther than the robot can follow [rad]. */
export function dragged(from: StationDocument, freedom: Freedom, by: number, leanMost: number): Drag {
  const k = AXES.indexOf(freedom);
  if (k >= 0) {
    const mm = Number((from.position_mm[k]! + by).toFixed(2));
    const position_mm = from.position_mm.map((value, i) => (i === k ? mm : value));
    return { station: { ...from, position_mm }, change: { position_m: position_mm.map(metres) } };
  }
  if (freedom === 'yaw') {
    const yaw_rad = radians(Number((degrees(from.yaw_rad) + by).toFixed(3)));
    return { station: { ...from, yaw_rad }, change: { yaw_rad } };
  }
  let [x, y] = [from.about_x_rad, from.about_y_rad];
  if (freedom === 'about_x') x = radians(Number((degrees(x) + by).toFixed(3)));
  else y = radians(Number((degrees(y) + by).toFixed(3)));
  const lean = Math.hypot(x, y);
  if (lean > leanMost) [x, y] = [(x * leanMost) / lean, (y * leanMost) / lean];
  const tilt_pitch_deg = degrees(Math.hypot(x, y));
  const tilt_yaw_deg = tilt_pitch_deg > 0 ? degrees(Math.atan2(-x, y)) : 0;
  return {
    station: { ...from, about_x_rad: x, about_y_rad: y, tilt_pitch_deg, tilt_yaw_deg, tilt_share: leanMost > 0 ? Math.hypot(x, y) / leanMost : 0 },
    change: { tilt_xy: { about_x_rad: x, about_y_rad: y }, ...driftOption(from) },
  };
}

/** A station placed by its first and last slot goes on to be: they lean with it. */
export function driftOption({ from }: StationDocument): Pick<StationChange, 'keep_drift'> {
  return from === 'drift' ? { keep_drift: true } : {};
}
