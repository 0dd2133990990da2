// The current time of the motion of a cell: playing, seeking, and the time range of chart and plots.

import { playbackTime } from '../lib/playbackTime';

/** Minimum duration of the time range of chart and plots [s]. */
export const MIN_RANGE_S = 0.05;
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10] as const;

/** The part of the session that playback depends on. */
export interface PlaybackContext {
  /** Duration of the motion [s]. */
  readonly duration: number;
  readonly timeline: {
    prefetch(time: number, range: [number, number] | null): void;
    /** State of the motion; `null` while it is loading. */
    stateAt(time: number): unknown;
  };
  /** The program determines the displayed pose from now on. */
  showProgram(): void;
  /** The motion rests at the current time. */
  rest(): void;
}

export class Playback {
  /** Current time [s]. */
  time = $state(0);
  playing = $state(false);
  loop = $state(true);
  speed = $state(1);
  /** Time range of chart and plots [s]; `null` for the whole motion. */
  range = $state.raw<[number, number] | null>(null);

  readonly #context: PlaybackContext;
  #frame = 0;
  #last = 0;
  /** Called at the end of the range that is played once, or when it is paused. */
  #once: (() => void) | null = null;

  constructor(context: PlaybackContext) {
    this.#context = context;
  }

  /** Shows the part of a time range that is within the motion [s]; the whole motion if there is none. */
  show(range: [number, number] | null): void {
    const { duration } = this.#context;
    const [from, to] = [Math.max(range?.[0] ?? 0, 0), Math.min(range?.[1] ?? duration, duration)];
    this.range = to - from > MIN_RANGE_S && to - from < duration ? [from, to] : null;
  }

  seek(time: number): void {
    this.time = Math.min(Math.max(time, 0), this.#context.duration);
    this.#context.showProgram();
    if (!this.playing) this.#context.rest();
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  play(): void {
    const { duration } = this.#context;
    if (this.playing || duration === 0) return;
    if (this.time >= duration) this.time = 0;
    this.#context.showProgram();
    this.playing = true;
    this.#last = performance.now();
    this.#frame = requestAnimationFrame((now) => this.#tick(now));
  }

  /** Plays the shown time range once; calls `done` at its end, or when the motion is paused. */
  playOnce(done: () => void): void {
    this.seek(this.range?.[0] ?? 0);
    this.#once = done;
    this.play();
  }

  pause(): void {
    if (!this.playing) return;
    this.playing = false;
    cancelAnimationFrame(this.#frame);
    this.#context.rest();
    const once = this.#once;
    this.#once = null;
    once?.();
  }

  /** Rests at a time. */
  #rest(time: number): void {
    this.seek(time);
    this.pause();
  }

  #tick(now: number): void {
    const { duration, timeline } = this.#context;
    const passed = playbackTime(this.#last, now, this.#once !== null);
    this.#last = now;
    let to = this.time + passed * this.speed;
    const end = this.range?.[1] ?? duration;
    if (this.#once && to >= end) return this.#rest(end);
    if (to >= duration) {
      if (!this.loop) return this.#rest(duration);
      to %= duration || 1;
    }
    // Playback waits for windows that are still loading.
    timeline.prefetch(to, null);
    if (timeline.stateAt(to)) this.time = to;
    this.#frame = requestAnimationFrame((next) => this.#tick(next));
  }
}
