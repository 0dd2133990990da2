// Size of the picture of a robot: parts whose dimensions are not in the robot file have those of a robot of the size of the paper's.

/** Radii of sockets to which parts of fixed dimensions fit [units of the scene]. */
const RADIUS = { min: 45, max: 240 } as const;
const MM = 1000;

type Limbs = readonly { socket_m: readonly number[] }[];

/**
 * Units of the scene in a metre of a robot.
 *
 * A unit is a millimetre, unless the robot is so small or large that its rods, balls and bearings would be out of proportion.
 */
export function sceneUnits(limbs: Limbs): number {
  const radius = MM * Math.max(...limbs.map(({ socket_m: [x, y] }) => Math.hypot(x!, y!)));
  return radius > 0 ? (MM * Math.min(Math.max(radius, RADIUS.min), RADIUS.max)) / radius : MM;
}

/** Decimals of the lengths of a small robot in addition to those of a robot of the size of the paper's. */
export const finerDecimals = (limbs: Limbs): number => Math.max(0, Math.ceil(Math.log10(sceneUnits(limbs) / MM)));
