// Kinematics of the three-rod robot: the WebAssembly module of jointplay with types. Units: m, rad.
//
// The numbers are those of the Rust library; here they only get names.
export const VIRTUALIZATIONS = ['radial', 'polar', 'offset', 'planar'];
export const SOLVERS = ['newton', 'least-norm', 'closed-form'];
/** Why there is no result: `infeasible` for valid input without a solution, `invalid` for invalid input. */
export class JointplayError extends Error {
    name = 'JointplayError';
    kind;
    constructor(kind, message) {
        super(message);
        this.kind = kind;
    }
}
/** Numbers that a call can have. */
const NUMBERS = 96;
/** Virtual joints that a model can have. */
const MOST_JOINTS = 12;
/** Compiles the module from the bytes of `jointplay.wasm`, or from a response of a server. */
export async function load(source) {
    if (source instanceof ArrayBuffer || ArrayBuffer.isView(source))
        return WebAssembly.compile(source);
    return WebAssembly.compile(await (await source).arrayBuffer());
}
/** A three-rod robot, with an instance of the module of its own. */
export class Robot {
    #exports;
    #numbers;
    /** Throws a `JointplayError` for dimensions that make up no robot. */
    constructor(module, geometry) {
        this.#exports = new WebAssembly.Instance(module).exports;
        this.#numbers = new Float64Array(this.#exports.memory.buffer, this.#exports.numbers(), NUMBERS);
        const { limbs, rod_min_m, rod_max_m, tilt_max_rad, working_height_m } = geometry;
        const dimensions = limbs.flatMap(({ base_point_m, socket_radius_m, socket_angle_rad }) => [...base_point_m, socket_radius_m, socket_angle_rad]);
        const options = [geometry.check_limits === false ? 0 : 1, geometry.ball_clearance_m ?? NaN];
        this.#give([...dimensions, rod_min_m, rod_max_m, tilt_max_rad, working_height_m, ...options], 18);
        this.#done(this.#exports.set());
    }
    /** Rods for a tilt at an axis height [m]. */
    inverse({ azimuth_rad, angle_rad }, axis_height_m) {
        this.#give([azimuth_rad, angle_rad, axis_height_m], 3);
        this.#done(this.#exports.inverse());
        return new Reader(this.#numbers).triple();
    }
    /** Pose for rods [m]. */
    forward(rods_m, model) {
        return this.#pose(rods_m, model, 0);
    }
    /** Pose with a tilt whose centre is at a height [m]. */
    inverseForCenter({ azimuth_rad, angle_rad }, center_height_m, model) {
        return this.#pose([azimuth_rad, angle_rad, center_height_m], model, 1);
    }
    /** Tilt and height of a set of rods [m], and the limits that they break. */
    limits(rods_m) {
        this.#give(rods_m, 3);
        this.#done(this.#exports.broken_limits());
        const reader = new Reader(this.#numbers);
        const [azimuth_rad, angle_rad, axis_height_m] = reader.triple();
        const [first, second, third] = reader.triple();
        return { tilt: { azimuth_rad, angle_rad }, axis_height_m, rods_broken: [first === 1, second === 1, third === 1], tilt_broken: reader.next() === 1 };
    }
    /** The last rods within the limits on the straight motion between two sets of rods [m]. */
    clampToLimits(from_m, to_m) {
        this.#give([...from_m, ...to_m], 6);
        this.#done(this.#exports.clamp());
        return new Reader(this.#numbers).triple();
    }
    /** The approximate model, whose platform turns about its centre, and the gaps of its balls in the base frame [m]. */
    approximate({ azimuth_rad, angle_rad }, axis_height_m) {
        this.#give([azimuth_rad, angle_rad, axis_height_m], 3);
        this.#done(this.#exports.approximate());
        const reader = new Reader(this.#numbers);
        return { rods_m: reader.triple(), base_from_platform: reader.placed(), gaps_m: [reader.triple(), reader.triple(), reader.triple()] };
    }
    #pose(start, model, byCenter) {
        const { virtualization, solver = 'closed-form', characteristic_length_m = 1e-3, max_iterations = 200 } = model;
        const [which, how] = [VIRTUALIZATIONS.indexOf(virtualization), SOLVERS.indexOf(solver)];
        if (which < 0)
            throw new JointplayError('invalid', `virtualization must be one of ${VIRTUALIZATIONS.join(', ')}, got ${String(virtualization)}`);
        if (how < 0)
            throw new JointplayError('invalid', `solver must be one of ${SOLVERS.join(', ')}, got ${String(solver)}`);
        this.#give([...start, characteristic_length_m, max_iterations], 5);
        this.#done(this.#exports.forward(which, how, byCenter));
        return new Reader(this.#numbers).pose();
    }
    #give(numbers, count) {
        if (numbers.length !== count || numbers.some((value) => typeof value !== 'number'))
            throw new JointplayError('invalid', `${count} numbers are needed, got ${numbers.length}: ${numbers.map(String).join(', ')}`);
        this.#numbers.set(numbers);
    }
    #done(kind) {
        if (kind === 0)
            return;
        const { memory, message, message_length } = this.#exports;
        const text = new TextDecoder().decode(new Uint8Array(memory.buffer, message(), message_length()));
        throw new JointplayError(kind === 1 ? 'infeasible' : 'invalid', text);
    }
}
/** Names the numbers of a call, in their order. */
class Reader {
    #numbers;
    #place = 0;
    constructor(numbers) {
        this.#numbers = numbers;
    }
    next() {
        return this.#numbers[this.#place++];
    }
    triple() {
        return [this.next(), this.next(), this.next()];
    }
    pair() {
        return [this.next(), this.next()];
    }
    placed() {
        return { origin_m: this.triple(), rotation: [this.triple(), this.triple(), this.triple()] };
    }
    joints(count) {
        return Array.from({ length: MOST_JOINTS }, () => this.next()).slice(0, count);
    }
    pose() {
        const [rods_m, sides_m] = [this.triple(), this.triple()];
        const tilt = { azimuth_rad: this.next(), angle_rad: this.next() };
        const [axis_height_m, center_shift_m, torsion_rad] = [this.next(), this.pair(), this.next()];
        const base_from_platform = this.placed();
        const balls_m = [this.triple(), this.triple(), this.triple()];
        const sockets_m = [this.pair(), this.pair(), this.pair()];
        const [displacements_m, lower_bound_m, upper_bound_m, sufficient] = [this.triple(), this.next(), this.next(), this.next()];
        const clearance = { displacements_m, lower_bound_m, upper_bound_m, is_sufficient: Number.isNaN(sufficient) ? null : sufficient === 1 };
        const [displacement_m, characteristic_length_m] = this.pair();
        const [solver, iterations, residual_m, count] = [SOLVERS[this.next()], this.next(), this.next(), this.next()];
        const [virtual_joints, virtual_displacements] = [this.joints(count), this.joints(count)];
        return { rods_m, sides_m, tilt, axis_height_m, center_shift_m, torsion_rad, base_from_platform, balls_m, sockets_m, clearance, displacement_m, characteristic_length_m, solver, iterations, residual_m, virtual_joints, virtual_displacements };
    }
}
