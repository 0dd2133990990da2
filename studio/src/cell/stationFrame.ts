// The frame of a station.

import { Matrix4, Quaternion, Vector3 } from 'three';
import type { StationDocument } from '../api/client';

/** The frame of a station in the base frame [m]: rotated by its heading, then tilted. */
export function frameOf({ position_mm, heading_rad, about_x_rad, about_y_rad }: StationDocument): Matrix4 {
  const tilt = new Vector3(about_x_rad, about_y_rad, 0);
  const tilted = new Quaternion().setFromAxisAngle(tilt.clone().normalize(), tilt.length());
  const rotated = new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), heading_rad);
  return new Matrix4().compose(new Vector3().fromArray(position_mm).divideScalar(1000), tilted.multiply(rotated), new Vector3(1, 1, 1));
}
