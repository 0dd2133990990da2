// Dragging of a station: its pose during the drag, and the change requested at the end.

import type { StationChange, StationDocument } from '../api/client';
import type { Freedom } from '../scene/handles';
import { degrees, metres, radians } from '../lib/units';

export interface Drag {
  /** The station at its new pose. */
  station: StationDocument;
  change: StationChange;
}

const AXES: readonly Freedom[] = ['x', 'y', 'height'];

/** Changes one degree of freedom of a station by mm or degrees, rounded to 0.01 mm or 0.001°; the tilt is limited to that of the robot [rad]. */
export function dragged(from: StationDocument, freedom: Freedom, by: number, tiltMax: number): Drag {
  const k = AXES.indexOf(freedom);
  if (k >= 0) {
    const mm = Number((from.position_mm[k]! + by).toFixed(2));
    const position_mm = from.position_mm.map((value, i) => (i === k ? mm : value));
    return { station: { ...from, position_mm }, change: { position_m: position_mm.map(metres) } };
  }
  if (freedom === 'heading') {
    const heading_rad = radians(Number((degrees(from.heading_rad) + by).toFixed(3)));
    return { station: { ...from, heading_rad }, change: { heading_rad } };
  }
  let [x, y] = [from.about_x_rad, from.about_y_rad];
  if (freedom === 'about_x') x = radians(Number((degrees(x) + by).toFixed(3)));
  else y = radians(Number((degrees(y) + by).toFixed(3)));
  const tilt = Math.hypot(x, y);
  if (tilt > tiltMax) [x, y] = [(x * tiltMax) / tilt, (y * tiltMax) / tilt];
  const tilt_angle_deg = degrees(Math.hypot(x, y));
  const tilt_azimuth_deg = tilt_angle_deg > 0 ? degrees(Math.atan2(-x, y)) : 0;
  return {
    station: tilted(from, tilt_azimuth_deg, tilt_angle_deg, tiltMax),
    change: { tilt_xy: { about_x_rad: x, about_y_rad: y }, ...carrierAxisOption(from) },
  };
}

/** A station with another tilt; the greatest of the robot is in rad. */
export function tilted(from: StationDocument, tilt_azimuth_deg: number, tilt_angle_deg: number, tiltMax: number): StationDocument {
  const [azimuth, angle] = [radians(tilt_azimuth_deg), radians(tilt_angle_deg)];
  const [about_x_rad, about_y_rad] = [-angle * Math.sin(azimuth), angle * Math.cos(azimuth)];
  return { ...from, about_x_rad, about_y_rad, tilt_angle_deg, tilt_azimuth_deg, tilt_share: tiltMax > 0 ? angle / tiltMax : 0 };
}

/** The option that preserves the definition of a station by its first and last slot. */
export function carrierAxisOption({ from }: StationDocument): Pick<StationChange, 'keep_carrier_axis'> {
  return from === 'carrier axis' ? { keep_carrier_axis: true } : {};
}
