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
export declare const VIRTUALIZATIONS: readonly ["radial", "polar", "offset", "planar"];
export type Virtualization = (typeof VIRTUALIZATIONS)[number];
export declare const SOLVERS: readonly ["newton", "least-norm", "closed-form"];
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
export declare class JointplayError extends Error {
    readonly name = "JointplayError";
    readonly kind: 'infeasible' | 'invalid';
    constructor(kind: 'infeasible' | 'invalid', message: string);
}
/** Compiles the module from the bytes of `jointplay.wasm`, or from a response of a server. */
export declare function load(source: BufferSource | Response | Promise<Response>): Promise<WebAssembly.Module>;
/** A three-rod robot, with an instance of the module of its own. */
export declare class Robot {
    #private;
    /** Throws a `JointplayError` for dimensions that make up no robot. */
    constructor(module: WebAssembly.Module, geometry: Geometry);
    /** Rods for a tilt at an axis height [m]. */
    inverse({ azimuth_rad, angle_rad }: Tilt, axis_height_m: number): Triple;
    /** Pose for rods [m]. */
    forward(rods_m: readonly number[], model: Model): Pose;
    /** Pose with a tilt whose centre is at a height [m]. */
    inverseForCenter({ azimuth_rad, angle_rad }: Tilt, center_height_m: number, model: Model): Pose;
    /** Tilt and height of a set of rods [m], and the limits that they break. */
    limits(rods_m: readonly number[]): Limits;
    /** The last rods within the limits on the straight motion between two sets of rods [m]. */
    clampToLimits(from_m: readonly number[], to_m: readonly number[]): Triple;
    /** The approximate model, whose platform turns about its centre, and the gaps of its balls in the base frame [m]. */
    approximate({ azimuth_rad, angle_rad }: Tilt, axis_height_m: number): {
        rods_m: Triple;
        base_from_platform: Placed;
        gaps_m: Triple[];
    };
}
