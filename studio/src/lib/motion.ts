// Windows of a motion, as the server sends them: channels are cubics between keys.

/** What holds a wafer, and its frame there: origin [m] and vector part of its unit quaternion. */
export interface Held {
  wafer: number;
  /** The effector, by index; none where it lies in a slot. */
  effector: number | null;
  /** Station, by index, and number of the slot. */
  slot: [number, number] | null;
  pose: number[];
}

/** Something that is broken; times since the start of the window [s]. */
export interface Broken {
  names: string[];
  message: string;
  line: number;
  start_s: number;
  end_s: number;
}

interface Description {
  steps: { segment: number; instruction: number; line: number; phase: string; loaded: number[] }[];
  segments: { duration_s: number; channels: number[]; moving: number[] }[];
  channels: [number, number][];
  wafers: Held[];
  changes: (Held & { step: number })[];
  violations: Broken[];
}

/** A motion from rest to rest; times since the start of its window [s]. */
export interface Step {
  segment: number;
  /** Counted from that of the window. */
  instruction: number;
  /** Counted from that of the window. */
  line: number;
  phase: string;
  loaded: number[];
  /** Indices of the axes that move in it. */
  moving: number[];
  start_s: number;
  end_s: number;
}

/** A JSON text and numbers in one. */
export function unpack<T>(bytes: ArrayBuffer): { description: T; numbers: Float64Array } {
  const length = new DataView(bytes).getUint32(0, true);
  const description = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length))) as T;
  return { description, numbers: new Float64Array(bytes, 4 + length) };
}

/** Some motions one after the other, and where the wafers are meanwhile. */
export class MotionWindow {
  readonly steps: readonly Step[];
  readonly duration_s: number;
  readonly violations: readonly Broken[];
  readonly bytes: number;
  readonly #segments: Description['segments'];
  readonly #channels: Description['channels'];
  readonly #wafers: readonly Held[];
  readonly #changes: Description['changes'];
  readonly #numbers: Float64Array;

  constructor(bytes: ArrayBuffer) {
    const { description, numbers } = unpack<Description>(bytes);
    this.bytes = bytes.byteLength;
    this.#numbers = numbers;
    this.#segments = description.segments;
    this.#channels = description.channels;
    this.#wafers = description.wafers;
    this.#changes = description.changes;
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

  /** Index of the step at a time since the start; of several that begin then, the last [s]. */
  stepAt(since: number): number {
    let [low, high] = [0, this.steps.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.steps[middle]!.start_s <= since) low = middle + 1;
      else high = middle;
    }
    return Math.max(low - 1, 0);
  }

  /** All channels of a step, a time after its start [s]. */
  values(step: number, since: number): Float64Array {
    const { channels } = this.#segments[this.steps[step]!.segment]!;
    return Float64Array.from(channels, (channel) => this.#state(channel, since)[0]);
  }

  /** One channel of a step with its first and second derivative, a time after its start [s]. */
  state(step: number, channel: number, since: number): [number, number, number] {
    return this.#state(this.#segments[this.steps[step]!.segment]!.channels[channel]!, since);
  }

  /** Times at which a channel of a step has keys, since the start of the step [s]. */
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

  /** Where the wafers are in a step that have changed hands, of those that were at a place at the start of the program. */
  held(start: readonly Held[], step: number): Held[] {
    const held = [...start];
    for (const one of this.#wafers) held[one.wafer] = one;
    for (const one of this.#changes) if (one.step < step) held[one.wafer] = one;
    return held;
  }
}
