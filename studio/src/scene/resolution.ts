// Number of rendered pixels: fewer while a slow scene moves, more for a still picture.

/** Longest interval between frames of a moving scene [ms]: 15 frames per second, with a margin. */
const TARGET_MS = 58;
/** Below this interval the resolution may increase again [ms]. */
const FAST_MS = 26;
/** Intervals above this one are pauses between movements [ms]. */
const PAUSE_MS = 700;
const LOWEST = 0.5;
const FACTOR = 0.84;
/** Number of slow frames before a reduction: the first frames of a scene include the compilation of its shaders. */
const PATIENCE = 3;

export class Resolution {
  /** Pixels per CSS pixel of a moving scene. */
  moving: number;
  /** Pixels per CSS pixel of a still picture. */
  readonly still: number;
  readonly #highest: number;
  #slow = 0;
  #fast = 0;

  /**
   * Without a graphics card, edges are smoothed in still pictures only, which are rendered at twice the resolution.
   */
  constructor(devicePixelRatio: number, software: boolean) {
    this.#highest = Math.min(devicePixelRatio, software ? 1 : 2);
    this.moving = this.#highest;
    this.still = software ? 2 * this.#highest : this.#highest;
  }

  /** Takes over the interval between two frames of a moving scene; returns whether the resolution changes. */
  observe(interval_ms: number): boolean {
    if (interval_ms > PAUSE_MS) return false;
    this.#slow = interval_ms > TARGET_MS ? this.#slow + 1 : 0;
    this.#fast = interval_ms < FAST_MS ? this.#fast + 1 : 0;
    const before = this.moving;
    if (this.#slow >= PATIENCE) this.moving = Math.max(this.moving * FACTOR, LOWEST * this.#highest);
    else if (this.#fast >= 20 * PATIENCE) this.moving = Math.min(this.moving / FACTOR, this.#highest);
    if (this.moving === before) return false;
    this.#slow = this.#fast = 0;
    return true;
  }
}
