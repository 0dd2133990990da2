// Marks for the measuring script and the tests: when which pose has been drawn.

import type { PoseDocument } from '../api/client';

class Measure {
  /** Pictures drawn since the page opened. */
  pictures = 0;
  /** The last pose that has been drawn. */
  pose: PoseDocument | null = null;
  /** When that was, as `performance.now` tells it. */
  drawnAt = 0;
  /** Whether nothing is asked that is not answered. */
  settled = true;

  drawn(pose: PoseDocument | null): void {
    this.pictures += 1;
    this.pose = pose;
    this.drawnAt = performance.now();
  }
}

export const measure = new Measure();
declare global {
  interface Window {
    jointplay: { measure: Measure };
  }
}
window.jointplay = { measure };
