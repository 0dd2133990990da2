// Marks for the measuring script and the tests: when which pose has been drawn.

import type { PoseDocument } from '../api/client';
import type { Freedom } from '../scene/handles';

class TestProbe {
  /** Pictures drawn since the page opened. */
  pictures = 0;
  /** The last pose that has been drawn. */
  pose: PoseDocument | null = null;
  /** When that was, as `performance.now` tells it. */
  drawnAt = 0;
  /** How long this thread worked at it. */
  took_ms = 0;
  /** Whether nothing is asked that is not answered. */
  settled = true;

  /** How large the robot file's own shapes are drawn, along x, y and z [mm]. */
  shapes: Record<string, number[]> = {};

  /** The cell's picture: how often it was drawn, and the names of its parts. */
  cellPictures = 0;
  cell: { parts: () => string[]; origin: (name: string) => number[] | null; grip: (freedom: Freedom) => { x: number; y: number } | null; marked: () => string[]; broken: () => string[]; brokenColour: () => string } | null = null;

  /** Verdicts on the cell that were shown, and when the last was, as `performance.now` tells it. */
  checks = 0;
  checkShownAt = 0;

  checkShown(): void {
    this.checks += 1;
    this.checkShownAt = performance.now();
  }

  cellDrawn(took_ms: number): void {
    this.took_ms = took_ms;
    this.cellPictures += 1;
  }

  drawn(pose: PoseDocument | null, took_ms: number): void {
    this.took_ms = took_ms;
    this.pictures += 1;
    this.pose = pose;
    this.drawnAt = performance.now();
  }
}

export const probe = new TestProbe();
declare global {
  interface Window {
    jointplay: { probe: TestProbe };
  }
}
window.jointplay = { probe };
