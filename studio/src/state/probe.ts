// State of the page for tests and for the measuring script.

import type { PoseDocument } from '../api/client';
import type { Freedom } from '../scene/handles';

/** Contents of the 3D view of a cell. */
export interface CellProbe {
  /** Names of all parts. */
  parts: () => string[];
  /** Origin of a frame in the base frame [m]. */
  origin: (name: string) => number[] | null;
  /** Position of a drag handle on the page [px]. */
  grip: (freedom: Freedom) => { x: number; y: number } | null;
  /** Names of the highlighted parts: the selected ones. */
  selected: () => string[];
  /** Names of the parts that are not hidden. */
  shown: () => string[];
  /** Position and target of the camera [m]. */
  camera: () => { eye: number[]; target: number[] } | null;
  /** Keys of the parts highlighted as in violation. */
  violating: () => string[];
  /** End points of the line of the minimum distance [m]; empty without a line. */
  nearest: () => number[];
  /** Stations with labels. */
  labels: () => readonly string[];
  /** Color of these parts, as hexadecimal digits. */
  violationColor: () => string;
}

/** Contents of the 3D view of a mechanism. */
export interface MechanismProbe {
  /** Positions of the joints in the base frame [m]. */
  joints: () => Record<string, number[]>;
  /** Origins of the links in the base frame [m]. */
  links: () => Record<string, number[]>;
  /** Position and target of the camera [sizes]. */
  camera: () => { eye: number[]; target: number[] } | null;
  /** Position of a joint on the page [px]. */
  onPage: (joint: string) => { x: number; y: number } | null;
  /** Position of a joint of the reference on the page, where it is drawn next to the mechanism [px]. */
  referenceOnPage: (joint: string) => { x: number; y: number } | null;
  /** The panes on the page, that of the shown mechanism first [px]. */
  panes: () => { left: number; top: number; right: number; bottom: number }[];
  /** Position of the handle of a point on the page [px]. */
  handle: () => { x: number; y: number } | null;
}

class TestProbe {
  /** Number of frames rendered in the robot view. */
  frames = 0;
  /** The last rendered pose. */
  pose: PoseDocument | null = null;
  /** Time of the last frame, from `performance.now` [ms]. */
  renderedAt = 0;
  /** Time of this thread for the last frame [ms]. */
  took_ms = 0;
  /** Whether all requests for poses have been answered. */
  settled = true;

  /** Extents of the meshes of the robot file along x, y and z [mm]. */
  meshExtents: Record<string, number[]> = {};

  /** Positions of the corners of the platform on the page, while the robot view is open [px]. */
  platform: (() => { x: number; y: number }[]) | null = null;
  /** Boxes of the texts of all labels on the page, while the robot view is open [px]. */
  labels: (() => { left: number; top: number; right: number; bottom: number }[]) | null = null;

  /** Number of frames rendered in the cell view. */
  cellFrames = 0;
  /** Contents of the cell view, while it is open. */
  cell: CellProbe | null = null;

  /** Number of frames rendered in the view of mechanisms. */
  mechanismFrames = 0;
  /** Contents of the view of mechanisms, while it is open. */
  mechanism: MechanismProbe | null = null;

  /** Number of check results shown, and the time of the last one, from `performance.now` [ms]. */
  checks = 0;
  checkShownAt = 0;

  checkShown(): void {
    this.checks += 1;
    this.checkShownAt = performance.now();
  }

  mechanismRendered(took_ms: number): void {
    this.took_ms = took_ms;
    this.mechanismFrames += 1;
  }

  cellRendered(took_ms: number): void {
    this.took_ms = took_ms;
    this.cellFrames += 1;
  }

  rendered(pose: PoseDocument | null, took_ms: number): void {
    this.took_ms = took_ms;
    this.frames += 1;
    this.pose = pose;
    this.renderedAt = performance.now();
  }
}

export const probe = new TestProbe();
declare global {
  interface Window {
    jointplay: { probe: TestProbe };
  }
}
window.jointplay = { probe };
