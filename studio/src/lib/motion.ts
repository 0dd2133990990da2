// Windows of a motion as received from the server: each channel is a piecewise cubic between keys.

import type { Part } from './parts';

/** Location of a wafer and its pose there: origin [m] and vector part of the unit quaternion. */
export interface WaferPlacement {
  wafer: number;
  /** Index of the effector; `null` for a wafer in a slot. */
  effector: number | null;
  /** Index of the station and number of the slot. */
  slot: [number, number] | null;
  pose: number[];
}

/** A violation, with times since the start of the window [s]. */
export interface WindowViolation {
  /** The axis, effector, bodies, wafers or zone concerned. */
  entities: Part[];
  message: string;
  /** Phase of the instruction at the worst time, such as `turn` or `extend`. */
  phase: string;
  line: number;
  start_s: number;
  end_s: number;
}

interface Description {
  steps: { segment: number; instruction: number; line: number; phase: string; station: number | null; loaded: number[] }[];
  segments: { duration_s: number; channels: number[]; moving: number[] }[];
  channels: [number, number][];
  wafers: WaferPlacement[];
  changes: (WaferPlacement & { step: number })[];
  violations: WindowViolation[];
}

/** A motion from rest to rest, with times since the start of its window [s]. */
export interface Step {
  segment: number;
  /** Relative to that of the window. */
  instruction: number;
  /** Relative to that of the window. */
  line: number;
  phase: string;
  /** Index of the station that an effector reaches into. */
  station: number | null;
  loaded: number[];
  /** Indices of the moving axes. */
  moving: number[];
  start_s: number;
  end_s: number;
}

/** Unpacks a binary response: a JSON text followed by numbers. */
export function unpack<T>(bytes: ArrayBuffer): { description: T; numbers: Float64Array } {
  const length = new DataView(bytes).getUint32(0, true);
  const description = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length))) as T;
  return { description, numbers: new Float64Array(bytes, 4 + length) };
}

/** A sequence of motions, with the locations of the wafers. */
export class MotionWindow {
  readonly steps: readonly Step[];
  readonly duration_s: number;
  readonly violations: readonly WindowViolation[];
  readonly bytes: number;
  readonly #segments: Description['segments'];
  readonly #channels: Description['channels'];
  readonly #wafers: readonly WaferPlacement[];
  readonly #handOffs: Description['changes'];
  readonly #numbers: Float64Array;

  constructor(bytes: ArrayBuffer) {
    const { description, numbers } = unpack<Description>(bytes);
    this.bytes = bytes.byteLength;
    this.#numbers = numbers;
    this.#segments = description.segments;
    this.#channels = description.channels;
    this.#wafers = description.wafers;
    this.#handOffs = description.changes;
    this.violations = description.violations;
    let now = 0;
    this.steps = description.steps.map((step) => {
      const { duration_s, moving } = this.#segments[step.segment]!;
      const start_s = now;
      now += duration_s;
      return { ...step, moving, start_s, end_s: now };
    });
    this.duration_s = now;
  }

  /** Index of the step at a time since the start [s]; the last of several steps that start at this time. */
  stepAt(since: number): number {
    let [low, high] = [0, this.steps.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.steps[middle]!.start_s <= since) low = middle + 1;
      else high = middle;
    }
    return Math.max(low - 1, 0);
  }

  /** Values of all channels of a step at a time since its start [s]. */
  values(step: number, since: number): Float64Array {
    const { channels } = this.#segments[this.steps[step]!.segment]!;
    return Float64Array.from(channels, (channel) => this.#state(channel, since)[0]);
  }

  /** Displacement of the virtual joints in a step at a time since its start [m]: the last channel. */
  displacement(step: number, since: number): number {
    return this.#state(this.#segments[this.steps[step]!.segment]!.channels.at(-1)!, since)[0];
  }

  /** Times of the keys of this displacement, since the start of the step [s]. */
  displacementKeys(step: number): Float64Array {
    return this.keys(step, this.#segments[this.steps[step]!.segment]!.channels.length - 1);
  }

  /** Value of a channel of a step at a time since its start [s], with its first and second derivative. */
  state(step: number, channel: number, since: number): [number, number, number] {
    return this.#state(this.#segments[this.steps[step]!.segment]!.channels[channel]!, since);
  }

  /** Times of the keys of a channel of a step, since the start of the step [s]. */
  keys(step: number, channel: number): Float64Array {
    const [from, count] = this.#channels[this.#segments[this.steps[step]!.segment]!.channels[channel]!]!;
    return this.#numbers.subarray(from, from + count);
  }

  #state(channel: number, since: number): [number, number, number] {
    const [from, count] = this.#channels[channel]!;
    const numbers = this.#numbers;
    if (count === 1) return [numbers[from + 1]!, 0, 0];
    let [low, high] = [1, count - 1];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (numbers[from + middle]! <= since) low = middle + 1;
      else high = middle;
    }
    const k = from + low - 1;
    const start = numbers[k]!;
    const width = numbers[k + 1]! - start;
    const [v0, v1] = [numbers[k + count]!, numbers[k + count + 1]!];
    const [r0, r1] = [numbers[k + 2 * count]! * width, numbers[k + 2 * count + 1]! * width];
    const s = Math.min(Math.max((since - start) / width, 0), 1);
    const one = v1 - v0 - r0;
    const two = r1 - (v1 - v0) - one;
    return [v0 + s * (r0 + s * (one + (s - 1) * two)), (r0 + s * (2 * one + (3 * s - 2) * two)) / width, (2 * one + (6 * s - 2) * two) / (width * width)];
  }

  /** Locations of all wafers in a step, given those at the start of the program. */
  held(start: readonly WaferPlacement[], step: number): WaferPlacement[] {
    const held = [...start];
    for (const one of this.#wafers) held[one.wafer] = one;
    for (const one of this.#handOffs) if (one.step < step) held[one.wafer] = one;
    return held;
  }
}
