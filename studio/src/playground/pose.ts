// Poses of the WebAssembly module in the form in which the server sends them, for the renderer of the robot.

import { VIRTUALIZATIONS, type Geometry, type Placed, type Pose, type Robot, type Tilt, type Virtualization } from '../../../crates/jointplay-wasm/js/jointplay';
import type { AnswerDocument, PlacedDocument } from '../api/client';
import type { RobotPicture } from '../scene/robotScene';

export interface Computed {
  picture: Pick<RobotPicture, 'robot' | 'pose'>;
  poses: Record<Virtualization, Pose>;
}

/** The poses of all virtualizations at a tilt and an axis height [m], solved as the paper does. */
export function computed(robot: Robot, geometry: Geometry, tilt: Tilt, axis_height_m: number): Computed {
  const rods_m = robot.inverse(tilt, axis_height_m);
  const { base_from_platform, gaps_m } = robot.approximate(tilt, axis_height_m);
  const poses = Object.fromEntries(VIRTUALIZATIONS.map((virtualization) => [virtualization, robot.forward(rods_m, { virtualization, solver: 'newton' })])) as Record<Virtualization, Pose>;
  const nominal = robot.forward(Array(3).fill(geometry.working_height_m), { virtualization: 'radial', solver: 'newton' });
  const limbs = geometry.limbs.map((limb, k) => ({ ...limb, base_point_m: [...limb.base_point_m], socket_m: nominal.sockets_m[k]! }));
  const models = VIRTUALIZATIONS.map((virtualization) => ({ model: { virtualization }, problem: null, answer: answer(poses[virtualization]) }));
  // What the renderer reads: the rest of the documents of the server is for panels.
  const picture = { robot: { limbs, virtualizations: [] }, pose: { axis_height_m, approximate: { pose: placed(base_from_platform), gaps_m }, models } };
  return { picture: picture as unknown as Computed['picture'], poses };
}

const placed = ({ origin_m, rotation }: Placed): PlacedDocument => ({ origin_m, rotation });

function answer(pose: Pose): Partial<AnswerDocument> {
  const { center_shift_m, torsion_rad, sockets_m, virtual_joints } = pose;
  return { pose: placed(pose.base_from_platform), center_shift_m, torsion_rad, sockets_m, virtual_joints };
}
