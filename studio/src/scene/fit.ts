// Distance of a camera from a box that it sees whole.

import { Vector3, type Box3, type PerspectiveCamera } from 'three';

/** Room around the box, as a factor of the distance. */
const MARGIN = 1.03;

/**
 * Least distance of a camera from the middle of a box at which no corner is outside of its picture.
 *
 * `direction` points from the box to the camera; `rows` is the share of the rows of the picture that are free.
 */
export function fittingDistance(camera: PerspectiveCamera, box: Box3, direction: Vector3, rows: number): number {
  const toward = direction.clone().normalize();
  const right = camera.up.clone().cross(toward);
  // From above, x is to the right.
  if (right.lengthSq() < 1e-6) right.set(1, 0, 0);
  right.normalize();
  const up = toward.clone().cross(right);
  const half = Math.tan((camera.fov * Math.PI) / 360);
  const center = box.getCenter(new Vector3());
  let distance = 0;
  for (const x of [box.min.x, box.max.x])
    for (const y of [box.min.y, box.max.y])
      for (const z of [box.min.z, box.max.z]) {
        const corner = new Vector3(x, y, z).sub(center);
        const across = Math.abs(corner.dot(right)) / (half * camera.aspect);
        const upward = Math.abs(corner.dot(up)) / (half * rows);
        distance = Math.max(distance, corner.dot(toward) + MARGIN * Math.max(across, upward));
      }
  return distance;
}
