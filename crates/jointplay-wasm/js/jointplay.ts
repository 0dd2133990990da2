// Kinematics of the three-rod robot: the WebAssembly module of jointplay with types. Units: m, rad.
//
// The numbers are those of the Rust library; here they only get names.

/** A limb: its rod in the base, and its nominal socket in the platform. */
export interface Limb {
  /** Intersection of the rod axis with the base plane [m]. */
  base_point_m: readonly [number, number];
  /** Distance of the nominal socket from the centre of the platform [m]. */
  socket_radius_m: number;
  /** Direction of the nominal socket [rad]. */
  socket_angle_rad: number;
}

/** Dimensions and limits of a robot. */
export interface Geometry {
  limbs: readonly [Limb, Limb, Limb];
  rod_min_m: number;
  rod_max_m: number;
  tilt_max_rad: number;
  working_height_m: number;
  /** Clearance of the balls as a radius, if known [m]. */
  ball_clearance_m?: number;
  /** Whether poses beyond the limits are refused; yes by default. */
  check_limits?: boolean;
}

/** Tilt: azimuth toward which the platform tilts, and angle [rad]. */
export interface Tilt {
  azimuth_rad: number;
  angle_rad: number;
}

export const VIRTUALIZATIONS = ['radial', 'polar', 'offset', 'planar'] as const;
export type Virtualization = (typeof VIRTUALIZATIONS)[number];

export const SOLVERS = ['newton', 'least-norm', 'closed-form'] as const;
export type Solver = (typeof SOLVERS)[number];

/** Which model computes a pose. */
export interface Model {
  virtualization: Virtualization;
  /** Closed form by default; where none exists, least norm. */
  solver?: Solver;
  /** Length by which angles are weighed; 1 mm by default, 0 is the mean socket radius [m]. */
  characteristic_length_m?: number;
  /** 200 by default. */
  max_iterations?: number;
}

export type Triple = [number, number, number];

/** Origin [m] and rotation by rows, in the base frame. */
export interface Placed {
  origin_m: Triple;
  rotation: [Triple, Triple, Triple];
}

/** A pose of the platform, with the virtual joints that make it possible. */
export interface Pose {
  rods_m: Triple;
  sides_m: Triple;
  tilt: Tilt;
  axis_height_m: number;
  center_shift_m: [number, number];
  torsion_rad: number;
  base_from_platform: Placed;
  /** Centres of the balls in the base frame [m]. */
  balls_m: Triple[];
  /** Sockets in the platform frame [m]. */
  sockets_m: [number, number][];
  clearance: {
    /** Distance of each ball from the centre of its nominal socket [m]. */
    displacements_m: Triple;
    lower_bound_m: number;
    upper_bound_m: number;
    /** `null` where the clearance of the robot is unknown, or between the bounds. */
    is_sufficient: boolean | null;
  };
  /** Displacement of the virtual joints in the metric [m]. */
  displacement_m: number;
  characteristic_length_m: number;
  solver: Solver;
  iterations: number;
  residual_m: number;
  /** Coordinates of the virtual joints ([m], [rad]). */
  virtual_joints: number[];
  /** Their displacements from nominal ([m], [rad]). */
  virtual_displacements: number[];
}

/** Tilt and height of a set of rods, and the limits that they break. */
export interface Limits {
  tilt: Tilt;
  axis_height_m: number;
  rods_broken: [boolean, boolean, boolean];
  tilt_broken: boolean;
}

/** Why there is no result: `infeasible` for valid input without a solution, `invalid` for invalid input. */
export class JointplayError extends Error {
  override readonly name = 'JointplayError';
  readonly kind: 'infeasible' | 'invalid';

  constructor(kind: 'infeasible' | 'invalid', message: string) {
    super(message);
    this.kind = kind;
  }
}

interface Exports {
  memory: WebAssembly.Memory;
  numbers(): number;
  message(): number;
  message_length(): number;
  set(): number;
  inverse(): number;
  broken_limits(): number;
  clamp(): number;
  forward(model: number, solver: number, byCenter: number): number;
  approximate(): number;
}

/** Numbers that a call can have. */
const NUMBERS = 96;
/** Virtual joints that a model can have. */
const MOST_JOINTS = 12;

/** Compiles the module from the bytes of `jointplay.wasm`, or from a response of a server. */
export async function load(source: BufferSource | Response | Promise<Response>): Promise<WebAssembly.Module> {
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source as BufferSource);
  return WebAssembly.compile(await (await source).arrayBuffer());
}

/** A three-rod robot, with an instance of the module of its own. */
export class Robot {
  readonly #exports: Exports;
  readonly #numbers: Float64Array;

  /** Throws a `JointplayError` for dimensions that make up no robot. */
  constructor(module: WebAssembly.Module, geometry: Geometry) {
    this.#exports = new WebAssembly.Instance(module).exports as unknown as Exports;
    this.#numbers = new Float64Array(this.#exports.memory.buffer, this.#exports.numbers(), NUMBERS);
    const { limbs, rod_min_m, rod_max_m, tilt_max_rad, working_height_m } = geometry;
    const dimensions = limbs.flatMap(({ base_point_m, socket_radius_m, socket_angle_rad }) => [...base_point_m, socket_radius_m, socket_angle_rad]);
    const options = [geometry.check_limits === false ? 0 : 1, geometry.ball_clearance_m ?? NaN];
    this.#give([...dimensions, rod_min_m, rod_max_m, tilt_max_rad, working_height_m, ...options], 18);
    this.#done(this.#exports.set());
  }

  /** Rods for a tilt at an axis height [m]. */
  inverse({ azimuth_rad, angle_rad }: Tilt, axis_height_m: number): Triple {
    this.#give([azimuth_rad, angle_rad, axis_height_m], 3);
    this.#done(this.#exports.inverse());
    return new Reader(this.#numbers).triple();
  }

  /** Pose for rods [m]. */
  forward(rods_m: readonly number[], model: Model): Pose {
    return this.#pose(rods_m, model, 0);
  }

  /** Pose with a tilt whose centre is at a height [m]. */
  inverseForCenter({ azimuth_rad, angle_rad }: Tilt, center_height_m: number, model: Model): Pose {
    return this.#pose([azimuth_rad, angle_rad, center_height_m], model, 1);
  }

  /** Tilt and height of a set of rods [m], and the limits that they break. */
  limits(rods_m: readonly number[]): Limits {
    this.#give(rods_m, 3);
    this.#done(this.#exports.broken_limits());
    const reader = new Reader(this.#numbers);
    const [azimuth_rad, angle_rad, axis_height_m] = reader.triple();
    const [first, second, third] = reader.triple();
    return { tilt: { azimuth_rad, angle_rad }, axis_height_m, rods_broken: [first === 1, second === 1, third === 1], tilt_broken: reader.next() === 1 };
  }

  /** The last rods within the limits on the straight motion between two sets of rods [m]. */
  clampToLimits(from_m: readonly number[], to_m: readonly number[]): Triple {
    this.#give([...from_m, ...to_m], 6);
    this.#done(this.#exports.clamp());
    return new Reader(this.#numbers).triple();
  }

  /** The approximate model, whose platform turns about its centre, and the gaps of its balls in the base frame [m]. */
  approximate({ azimuth_rad, angle_rad }: Tilt, axis_height_m: number): { rods_m: Triple; base_from_platform: Placed; gaps_m: Triple[] } {
    this.#give([azimuth_rad, angle_rad, axis_height_m], 3);
    this.#done(this.#exports.approximate());
    const reader = new Reader(this.#numbers);
    return { rods_m: reader.triple(), base_from_platform: reader.placed(), gaps_m: [reader.triple(), reader.triple(), reader.triple()] };
  }

  #pose(start: readonly number[], model: Model, byCenter: number): Pose {
    const { virtualization, solver = 'closed-form', characteristic_length_m = 1e-3, max_iterations = 200 } = model;
    const [which, how] = [VIRTUALIZATIONS.indexOf(virtualization), SOLVERS.indexOf(solver)];
    if (which < 0) throw new JointplayError('invalid', `virtualization must be one of ${VIRTUALIZATIONS.join(', ')}, got ${String(virtualization)}`);
    if (how < 0) throw new JointplayError('invalid', `solver must be one of ${SOLVERS.join(', ')}, got ${String(solver)}`);
    this.#give([...start, characteristic_length_m, max_iterations], 5);
    this.#done(this.#exports.forward(which, how, byCenter));
    return new Reader(this.#numbers).pose();
  }

  #give(numbers: readonly number[], count: number): void {
    if (numbers.length !== count || numbers.some((value) => typeof value !== 'number'))
      throw new JointplayError('invalid', `${count} numbers are needed, got ${numbers.length}: ${numbers.map(String).join(', ')}`);
    this.#numbers.set(numbers);
  }

  #done(kind: number): void {
    if (kind === 0) return;
    const { memory, message, message_length } = this.#exports;
    const text = new TextDecoder().decode(new Uint8Array(memory.buffer, message(), message_length()));
    throw new JointplayError(kind === 1 ? 'infeasible' : 'invalid', text);
  }
}

/** Names the numbers of a call, in their order. */
class Reader {
  readonly #numbers: Float64Array;
  #place = 0;

  constructor(numbers: Float64Array) {
    this.#numbers = numbers;
  }

  next(): number {
    return this.#numbers[this.#place++]!;
  }

  triple(): Triple {
    return [this.next(), this.next(), this.next()];
  }

  pair(): [number, number] {
    return [this.next(), this.next()];
  }

  placed(): Placed {
    return { origin_m: this.triple(), rotation: [this.triple(), this.triple(), this.triple()] };
  }

  joints(count: number): number[] {
    return Array.from({ length: MOST_JOINTS }, () => this.next()).slice(0, count);
  }

  pose(): Pose {
    const [rods_m, sides_m] = [this.triple(), this.triple()];
    const tilt = { azimuth_rad: this.next(), angle_rad: this.next() };
    const [axis_height_m, center_shift_m, torsion_rad] = [this.next(), this.pair(), this.next()];
    const base_from_platform = this.placed();
    const balls_m = [this.triple(), this.triple(), this.triple()];
    const sockets_m = [this.pair(), this.pair(), this.pair()];
    const [displacements_m, lower_bound_m, upper_bound_m, sufficient] = [this.triple(), this.next(), this.next(), this.next()];
    const clearance = { displacements_m, lower_bound_m, upper_bound_m, is_sufficient: Number.isNaN(sufficient) ? null : sufficient === 1 };
    const [displacement_m, characteristic_length_m] = this.pair();
    const [solver, iterations, residual_m, count] = [SOLVERS[this.next()]!, this.next(), this.next(), this.next()];
    const [virtual_joints, virtual_displacements] = [this.joints(count), this.joints(count)];
    return { rods_m, sides_m, tilt, axis_height_m, center_shift_m, torsion_rad, base_from_platform, balls_m, sockets_m, clearance, displacement_m, characteristic_length_m, solver, iterations, residual_m, virtual_joints, virtual_displacements };
  }
}
