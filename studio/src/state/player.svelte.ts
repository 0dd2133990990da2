// Playback of a motion: the current sample, speed and loop.

import { playbackTime } from '../lib/playbackTime';
import type { ApiCommand } from '../api/client';
import type { Study } from './study.svelte';

/** Samples per second at speed 1 of a motion without time stamps. */
export const SAMPLES_PER_SECOND = 30;
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 30, 100, 300] as const;

/** What a player does with the view. */
export interface PlayerEvents {
  /** Shows the command of another sample. */
  show: (command: ApiCommand) => void;
  /** The current sample has changed while the motion is paused, or playback has paused. */
  stopped: () => void;
}

export class Player {
  /** Index of the current sample; `null` while the robot is jogged. */
  sample = $state<number | null>(null);
  playing = $state(false);
  loop = $state(true);
  speed = $state(1);
  readonly #study: Study;
  readonly #events: PlayerEvents;
  #position = 0;
  #last = 0;
  #frame = 0;
  /** Called at the end of a motion that is played once, or when it is paused. */
  #ended: (() => void) | null = null;

  constructor(study: Study, events: PlayerEvents) {
    this.#study = study;
    this.#events = events;
  }

  get #count(): number {
    return this.#study.count;
  }

  seek(sample: number): void {
    if (this.#count === 0) return;
    const at = Math.min(Math.max(Math.round(sample), 0), this.#count - 1);
    this.#position = at;
    this.#show(at);
    if (!this.playing) this.#events.stopped();
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

  /** Plays from the current sample to the end, regardless of `loop`; calls `ended` there, or when the motion is paused. */
  playOnce(ended: () => void): void {
    this.pause();
    this.play();
    this.#ended = ended;
  }

  pause(): void {
    if (!this.playing) return;
    this.playing = false;
    cancelAnimationFrame(this.#frame);
    this.#events.stopped();
    const ended = this.#ended;
    this.#ended = null;
    ended?.();
  }

  /** Detaches the robot from the motion, so that it can be jogged from its current pose. */
  detach(): void {
    this.pause();
    this.sample = null;
  }

  #tick(now: number): void {
    const passed = playbackTime(this.#last, now, this.#ended !== null);
    this.#last = now;
    const rate = this.#study.rate ?? SAMPLES_PER_SECOND;
    this.#position += passed * this.speed * rate;
    const end = this.#count - 1;
    if (this.#position > end) {
      if (this.loop && !this.#ended) this.#position %= end + 1;
      else {
        this.#show(end);
        this.pause();
        return;
      }
    }
    this.#show(Math.floor(this.#position));
    this.#frame = requestAnimationFrame((next) => this.#tick(next));
  }

  #show(sample: number): void {
    if (sample === this.sample) return;
    const command = this.#study.command(sample);
    if (!command) return;
    this.sample = sample;
    this.#events.show(command);
  }
}
