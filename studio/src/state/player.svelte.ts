// The cursor in time: which sample of the motion is shown, and how it goes on.

import type { Studio } from './studio.svelte';

/** Samples a second at speed 1 of a motion that has no time of its own. */
export const SAMPLES_PER_SECOND = 30;
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 30, 100, 300] as const;

export class Player {
  /** The sample shown; none while the robot is moved by hand. */
  sample = $state<number | null>(null);
  playing = $state(false);
  loop = $state(true);
  speed = $state(1);
  readonly #studio: Studio;
  #position = 0;
  #last = 0;
  #frame = 0;
  /** Called at the end of a motion that is played once. */
  #ended: (() => void) | null = null;

  constructor(studio: Studio) {
    this.#studio = studio;
  }

  get #count(): number {
    return this.#studio.study.count;
  }

  seek(sample: number): void {
    if (this.#count === 0) return;
    const at = Math.min(Math.max(Math.round(sample), 0), this.#count - 1);
    this.#position = at;
    this.#show(at);
    if (!this.playing) this.#studio.rememberLink();
  }

  step(by: number): void {
    this.pause();
    this.seek((this.sample ?? (by > 0 ? -1 : this.#count)) + by);
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  play(): void {
    if (this.playing || this.#count === 0) return;
    if (this.sample === null || this.sample >= this.#count - 1) this.seek(0);
    this.playing = true;
    this.#last = performance.now();
    this.#frame = requestAnimationFrame((now) => this.#tick(now));
  }

  /** Plays from where it is to the end, whatever is said about loops. */
  playOnce(ended: () => void): void {
    this.pause();
    this.play();
    this.#ended = ended;
  }

  pause(): void {
    if (!this.playing) return;
    this.playing = false;
    this.#ended = null;
    cancelAnimationFrame(this.#frame);
    this.#studio.rememberLink();
  }

  /** Lets go of the motion: the robot is moved by hand, from where it is. */
  leave(): void {
    this.pause();
    this.sample = null;
  }

  #tick(now: number): void {
    const passed = Math.min(Math.max(now - this.#last, 0), 250) / 1000;
    this.#last = now;
    const rate = this.#studio.study.rate ?? SAMPLES_PER_SECOND;
    this.#position += passed * this.speed * rate;
    const end = this.#count - 1;
    if (this.#position > end) {
      if (this.loop && !this.#ended) this.#position %= end + 1;
      else {
        const ended = this.#ended;
        this.#show(end);
        this.pause();
        ended?.();
        return;
      }
    }
    this.#show(Math.floor(this.#position));
    this.#frame = requestAnimationFrame((next) => this.#tick(next));
  }

  #show(sample: number): void {
    if (sample === this.sample) return;
    const command = this.#studio.study.command(sample);
    if (!command) return;
    this.sample = sample;
    this.#studio.showSample(command);
  }
}
