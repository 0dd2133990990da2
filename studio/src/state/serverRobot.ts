// The robot of the server, which another page or program may replace at any time.
//
// Answers about poses have no name of their robot: the page compares the document of the robot after each of them, when the window is shown, and while it is idle.

import * as api from '../api/client';
import type { RobotDocument } from '../api/client';
import { connection } from '../api/connection.svelte';
import { robotKey } from '../lib/robotKey';

/** Shortest interval between two comparisons [ms]: a drag requests many poses. */
const INTERVAL_MS = 250;

export class ServerRobot {
  readonly #changed: (robot: RobotDocument) => void;
  #key: string | null = null;
  /** Time of the last comparison [ms]. */
  #compared = -Infinity;
  #timer: ReturnType<typeof setTimeout> | undefined;

  /** `changed` is called with a robot that is another one than before. */
  constructor(changed: (robot: RobotDocument) => void) {
    this.#changed = changed;
    connection.onProbe((response) => void this.#take(response.json() as Promise<RobotDocument>));
    document.addEventListener('visibilitychange', () => document.visibilityState === 'visible' && this.compare());
    window.addEventListener('focus', () => this.compare());
  }

  /** Whether the robot is another one than at the last comparison. */
  isOther(robot: RobotDocument): boolean {
    const before = this.#key;
    this.#key = robotKey(robot);
    return before !== null && before !== this.#key;
  }

  /** Requests the robot, now or at the end of the interval. */
  compare(): void {
    if (this.#key === null || connection.state !== 'connected') return;
    clearTimeout(this.#timer);
    const wait_ms = this.#compared + INTERVAL_MS - performance.now();
    if (wait_ms > 0) this.#timer = setTimeout(() => this.compare(), wait_ms);
    else {
      this.#compared = performance.now();
      void this.#take(api.robot());
    }
  }

  async #take(answer: Promise<RobotDocument>): Promise<void> {
    try {
      const robot = await answer;
      // Before the first robot is shown, there is none to compare with.
      if (this.#key !== null && this.isOther(robot)) this.#changed(robot);
    } catch {
      // A later comparison requests it again.
    }
  }
}
