// The inputs of the user, which undo, links and settings hold.
// Lengths are in mm and angles in degrees, as displayed.

export const VIRTUALIZATIONS = ['radial', 'polar', 'offset', 'planar'] as const;
export type Virtualization = (typeof VIRTUALIZATIONS)[number];

export const SOLVERS = ['newton', 'least-norm', 'closed-form'] as const;
export type Solver = (typeof SOLVERS)[number];

/** Characteristic length: `paper` is 1 mm, `radius` the mean socket radius, a number a length [mm]. */
export type Metric = 'paper' | 'radius' | number;

export type HeightKind = 'axis' | 'center';

export type Command =
  | { kind: 'tilt'; azimuth_deg: number; tilt_deg: number; height_mm: number; height_kind: HeightKind }
  | { kind: 'tilt_xy'; about_x_deg: number; about_y_deg: number; height_mm: number; height_kind: HeightKind }
  | { kind: 'rods'; rods_mm: [number, number, number] };

export interface KeyPose {
  about_x_deg: number;
  about_y_deg: number;
  height_mm: number;
  /** Duration of the motion from the previous pose [s]. */
  seconds: number;
}

export type Motion =
  | {
      kind: 'raster' | 'serpentine';
      azimuth_step_deg: number;
      tilt_from_deg: number;
      tilt_to_deg: number;
      tilt_step_deg: number;
      height_mm: number;
    }
  | { kind: 'key-poses'; poses: KeyPose[] };

/** Visible elements in addition to the robot. */
export interface Shown {
  joints: boolean;
  ghost: boolean;
  /** Outlines of the platform under the other virtualizations. */
  others: boolean;
  arrows: boolean;
  frames: boolean;
  labels: boolean;
}

export interface Document {
  command: Command;
  model: Virtualization;
  solver: Solver;
  metric: Metric;
  exaggeration: number;
  shown: Shown;
  motion: Motion | null;
  /** The robot file; `null` until it is loaded. Links do not contain it. */
  robotFile: RobotWork | null;
}

/** The text of a robot file, and what belongs to it. */
export interface RobotWork {
  name: string;
  text: string;
  /** Values of parameters in place of those of the text. */
  parameters: Record<string, number>;
  /** The text as it was opened in this browser; `null` for the file of the server. */
  opened: string | null;
}

export const EXAGGERATION = { min: 1, max: 2000 } as const;

/** The study of section VI of the paper; the paper does not state its azimuth step. */
export function paperStudy(height_mm: number): Motion {
  return { kind: 'raster', azimuth_step_deg: 10, tilt_from_deg: -2, tilt_to_deg: 2, tilt_step_deg: 0.2, height_mm };
}

/** The initial document: a tilt of two thirds of the limit, so that it can be increased. */
export function initialDocument(height_mm: number, tilt_max_deg = 1.5): Document {
  return {
    command: { kind: 'tilt', azimuth_deg: 0, tilt_deg: Number(((2 / 3) * tilt_max_deg).toFixed(2)), height_mm, height_kind: 'axis' },
    model: 'polar',
    solver: 'newton',
    metric: 'paper',
    exaggeration: 500,
    shown: { joints: true, ghost: false, others: false, arrows: true, frames: true, labels: true },
    motion: null,
    robotFile: null,
  };
}
