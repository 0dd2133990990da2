// Forward kinematics of a robot with arms: from the channels of a motion to the poses of all frames. Units: m, rad.

/** Kinematic chain of a robot, as received from the server. */
export interface Chain {
  base_points_m: number[][];
  arms: {
    mount_m: number[];
    joints: { kind: 'revolute' | 'prismatic'; zero: number; drives: { axis: number; ratio: number }[]; next_m: number[]; rise_m: number }[];
    effectors: { name: string; center_m: number[]; heading_rad: number }[];
  }[];
}

export interface Frame {
  name: string;
  /** Origin in the parent frame [m]. */
  origin_m: number[];
  /** Unit quaternion x, y, z, w in the parent frame. */
  quaternion: number[];
}

/** A pose: origin x, y, z and unit quaternion x, y, z, w. */
type Pose = readonly [number, number, number, number, number, number, number];

const RODS = 3;
/** Channels of a pose: origin, and vector part of a unit quaternion. */
const POSE = 6;

/** The pose with a given origin and vector part of its quaternion; the scalar part is positive. */
export function poseOf(numbers: ArrayLike<number>, at = 0): Pose {
  const [x, y, z] = [numbers[at + 3]!, numbers[at + 4]!, numbers[at + 5]!];
  return [numbers[at]!, numbers[at + 1]!, numbers[at + 2]!, x, y, z, Math.sqrt(Math.max(0, 1 - x * x - y * y - z * z))];
}

const moved = (x: number, y: number, z: number): Pose => [x, y, z, 0, 0, 0, 1];
const turned = (angle: number): Pose => [0, 0, 0, 0, 0, Math.sin(angle / 2), Math.cos(angle / 2)];

/** The product of two poses: b in the parent frame of a. */
export function compose(a: Pose, b: Pose): Pose {
  const [ax, ay, az, x, y, z, w] = a;
  const [bx, by, bz, p, q, r, s] = b;
  // v + 2 w (u × v) + 2 u × (u × v)
  const [cx, cy, cz] = [y * bz - z * by, z * bx - x * bz, x * by - y * bx];
  return [
    ax + bx + 2 * (w * cx + y * cz - z * cy),
    ay + by + 2 * (w * cy + z * cx - x * cz),
    az + bz + 2 * (w * cz + x * cy - y * cx),
    w * p + x * s + y * r - z * q,
    w * q - x * r + y * s + z * p,
    w * r + x * q - y * p + z * s,
    w * s - x * p - y * q - z * r,
  ];
}

const frame = (name: string, pose: Pose): Frame => ({ name, origin_m: pose.slice(0, 3), quaternion: pose.slice(3) });

/** Names of the moving frames. */
export interface Names {
  axes: readonly string[];
  /** Links of each arm. */
  links: readonly (readonly string[])[];
  wafers: readonly string[];
}

/**
 * Poses of all frames in their parent frames: rods, platform and wafers in the base frame, links in the previous link.
 *
 * `values` are the channels of a segment: positions of all axes, pose of the platform, deflections of the last link of each arm, deflections of each effector in the rigid last link.
 */
export function frames(chain: Chain, names: Names, values: ArrayLike<number>, held: readonly { effector: number | null; pose: ArrayLike<number> }[]): Frame[] {
  const found: Frame[] = [];
  for (let k = 0; k < RODS; k += 1) {
    const [x, y] = chain.base_points_m[k]!;
    found.push(frame(names.axes[k]!, moved(x!, y!, values[k]!)));
  }
  const platform = poseOf(values, names.axes.length);
  found.push(frame('platform', platform));
  let link = names.axes.length + POSE;
  let effector = link + POSE * chain.arms.length;
  const wafers: Pose[] = [];
  chain.arms.forEach(({ mount_m, joints, effectors }, arm) => {
    let at = moved(mount_m[0]!, mount_m[1]!, mount_m[2]!);
    let base = platform;
    joints.forEach(({ kind, zero, drives, next_m, rise_m }, k) => {
      const value = drives.reduce((sum, { axis, ratio }) => sum + ratio * values[axis]!, zero);
      const local = compose(compose(at, moved(0, 0, rise_m)), kind === 'revolute' ? turned(value) : moved(value, 0, 0));
      base = compose(base, local);
      found.push(frame(names.links[arm]![k]!, k + 1 === joints.length ? compose(local, poseOf(values, link)) : local));
      at = moved(next_m[0]!, next_m[1]!, 0);
    });
    link += POSE;
    for (const { center_m, heading_rad } of effectors) {
      const center = compose(moved(center_m[0]!, center_m[1]!, center_m[2]!), turned(heading_rad));
      wafers.push(compose(compose(base, poseOf(values, effector)), center));
      effector += POSE;
    }
  });
  held.forEach(({ effector, pose }, k) => {
    const own = poseOf(pose);
    found.push(frame(names.wafers[k]!, effector === null ? own : compose(wafers[effector]!, own)));
  });
  return found;
}

/** The pose of the platform without play: level about its own normal, over the base axis. */
function withoutPlay([x, y, z, p, q, r, w]: Pose): Pose {
  const normal = [2 * (p * r + w * q), 2 * (q * r - w * p), 1 - 2 * (p * p + q * q)] as const;
  // The shortest rotation that tilts z to the normal.
  const half = Math.sqrt(Math.max(0, (1 + normal[2]) / 2));
  const height = z + (normal[0] * x + normal[1] * y) / normal[2];
  return [0, 0, height, -normal[1] / (2 * half), normal[0] / (2 * half), 0, half];
}

/** The inverse of a pose. */
export function inverse([x, y, z, p, q, r, w]: Pose): Pose {
  const turn: Pose = [0, 0, 0, -p, -q, -r, w];
  const [a, b, c] = compose(turn, moved(-x, -y, -z));
  return [a, b, c, -p, -q, -r, w];
}

/**
 * Frames with the play of the platform enlarged: its displacement from the base axis and its twist about its normal.
 *
 * Everything on the platform moves with it, and so do the wafers that an effector holds.
 */
export function exaggerated(frames: readonly Frame[], scale: number, held: (wafer: string) => boolean): Frame[] {
  const platform = frames.find(({ name }) => name === 'platform');
  if (!platform || scale === 1) return [...frames];
  const pose = [...platform.origin_m, ...platform.quaternion] as unknown as Pose;
  const ideal = withoutPlay(pose);
  const [x, y, z, , , r, w] = compose(inverse(ideal), pose);
  const shown = compose(ideal, compose(moved(x * scale, y * scale, z * scale), turned(2 * scale * Math.atan2(r, w))));
  const by = compose(shown, inverse(pose));
  return frames.map((one) => {
    if (one.name === 'platform') return frame(one.name, shown);
    if (!held(one.name)) return one;
    return frame(one.name, compose(by, [...one.origin_m, ...one.quaternion] as unknown as Pose));
  });
}
