// The motion of the plan on show: windows of it are fetched as they are wanted, and kept by their keys.

import * as api from '../api/client';
import { ApiError, type PlanDocument } from '../api/client';
import { frames, type Frame, type Names } from '../lib/kinematics';
import { MotionWindow, type Held, type Step } from '../lib/motion';

/** A moment of the motion, with its step; times since the start of the program [s]. */
export interface Moment {
  window: MotionWindow;
  /** Index of the step in its window. */
  index: number;
  step: PlacedStep;
  /** Since the start of the step [s]. */
  since: number;
}

/** A step with its place in the program: times since its start [s], names of axes. */
export interface PlacedStep extends Omit<Step, 'moving' | 'loaded'> {
  moving: string[];
  loaded: string[];
}

/** Least and largest position, velocity and acceleration of each axis in a window, and how long it moves: in m, rad and s. */
export const OVERVIEW = 7;

/** Windows that are drawn one by one; longer stretches are drawn by their overview. */
export const MOST_SHOWN = 16;
/** Memory for windows [bytes]. */
const MOST_BYTES = 48e6;
const AT_A_TIME = 3;
/** How far ahead of the moment shown windows are fetched [s]. */
const AHEAD_S = 30;

export class Timeline {
  /** Grows as windows arrive, and with each plan. */
  version = $state(0);
  /** Whether something that is wanted is not there yet. */
  loading = $state(false);
  plan = $state.raw<PlanDocument | null>(null);
  readonly #failed: (error: unknown) => void;
  readonly #known = new Map<string, MotionWindow>();
  #bytes = 0;
  readonly #overviews = new Map<string, Float64Array>();
  #asked = new Set<string>();
  #wanted: string[] = [];
  #overviewAsked = false;

  constructor(failed: (error: unknown) => void) {
    this.#failed = failed;
  }

  get duration(): number {
    return this.plan?.report?.duration_s ?? 0;
  }

  /** Another plan; what is known of it already stays. */
  show(plan: PlanDocument): void {
    this.plan = plan;
    this.#wanted = [];
    this.#overviewAsked = false;
    const keys = new Set(plan.windows.map(({ key }) => key));
    for (const key of [...this.#overviews.keys()]) if (!keys.has(key)) this.#overviews.delete(key);
    this.version += 1;
  }

  /** Index of the window at a time [s]. */
  #at(time: number): number {
    const windows = this.plan?.windows ?? [];
    let [low, high] = [0, windows.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (windows[middle]!.start_s <= time) low = middle + 1;
      else high = middle;
    }
    return Math.max(low - 1, 0);
  }

  /** Indices of the windows of a stretch of time: the first, and the one after the last [s]. */
  within([from, to]: readonly [number, number]): [number, number] {
    const count = this.plan?.windows.length ?? 0;
    return [this.#at(from), Math.min(this.#at(to) + 1, count)];
  }

  /** When a window starts, and when it ends [s]. */
  bounds(index: number): [number, number] {
    const windows = this.plan?.windows ?? [];
    return [windows[index]?.start_s ?? 0, windows[index + 1]?.start_s ?? this.duration];
  }

  window(index: number): MotionWindow | null {
    const key = this.plan?.windows[index]?.key;
    return (key !== undefined && this.#known.get(key)) || null;
  }

  /** What moves at a time; `null` where it is not known, yet or at all [s]. */
  moment(time: number): Moment | null {
    void this.version;
    const at = this.#at(time);
    const window = this.window(at);
    if (!window || window.steps.length === 0) return null;
    const since = time - this.plan!.windows[at]!.start_s;
    const index = window.stepAt(since);
    return { window, index, step: this.#placed(at, window, index), since: Math.max(since - window.steps[index]!.start_s, 0) };
  }

  #placed(at: number, window: MotionWindow, index: number): PlacedStep {
    const { start_s, instruction, line } = this.plan!.windows[at]!;
    const step = window.steps[index]!;
    const { robot, effectors } = this.plan!;
    return {
      ...step,
      instruction: instruction + step.instruction,
      line: line + step.line,
      start_s: start_s + step.start_s,
      end_s: start_s + step.end_s,
      moving: step.moving.map((axis) => robot!.axes[axis]!.name),
      loaded: step.loaded.map((effector) => effectors[effector]!),
    };
  }

  /** The steps of a window that is there, with their places in the program; those that take no time are left out. */
  steps(index: number): PlacedStep[] {
    const window = this.window(index);
    if (!window) return [];
    return window.steps.flatMap(({ start_s, end_s }, k) => (end_s > start_s ? [this.#placed(index, window, k)] : []));
  }

  /** What is broken at a time [s]. */
  broken(time: number): { names: string[]; message: string }[] {
    void this.version;
    const at = this.#at(time);
    const since = time - (this.plan?.windows[at]?.start_s ?? 0);
    return (this.window(at)?.violations ?? []).filter(({ start_s, end_s }) => start_s - 1e-3 <= since && since <= end_s + 1e-3);
  }

  /** Where everything is at a time, and which wafers lie in which slots; `null` where it is not known yet [s]. */
  pose(time: number): { frames: Frame[]; lying: Map<string, string> } | null {
    const { plan } = this;
    const moment = this.moment(time);
    if (!plan?.chain || !plan.robot || !moment) return null;
    const names: Names = { axes: plan.robot.axes.map(({ name }) => name), links: plan.robot.arms.map(({ links }) => links), wafers: plan.wafers.map(({ name }) => name) };
    const held = moment.window.held(plan.wafers.map(({ held }, wafer) => ({ wafer, ...held }) as Held), moment.index);
    const lying = new Map<string, string>();
    held.forEach(({ slot }, k) => {
      if (slot) lying.set(names.wafers[k]!, `${plan.stations[slot[0]]!.name} ${slot[1]}`);
    });
    return { frames: frames(plan.chain, names, moment.window.values(moment.index, moment.since), held), lying };
  }

  /** Fetches what is shown at a time, and what comes next; then the windows of a stretch, if they are few [s]. */
  want(time: number, stretch: readonly [number, number] | null): void {
    const { plan } = this;
    if (!plan || plan.windows.length === 0) return;
    const [now] = this.within([time, time]);
    const [, ahead] = this.within([time, Math.min(time + AHEAD_S, this.duration)]);
    const indices = [now];
    for (let k = now + 1; k < Math.min(ahead, now + MOST_SHOWN); k += 1) indices.push(k);
    if (stretch) {
      const [from, to] = this.within(stretch);
      if (to - from <= MOST_SHOWN) for (let k = from; k < to; k += 1) indices.push(k);
      else void this.#overview(from, to);
    }
    const keys = [...new Set(indices.map((k) => plan.windows[k]!.key))];
    for (const key of keys) this.#touch(key);
    this.#wanted = keys.filter((key) => !this.#known.has(key));
    this.#work();
  }

  /** Overviews of the windows of a stretch, one after the other; `null` where they are not there yet. */
  overview(from: number, to: number): (Float64Array | null)[] {
    void this.version;
    return (this.plan?.windows.slice(from, to) ?? []).map(({ key }) => this.#overviews.get(key) ?? null);
  }

  async #overview(from: number, to: number): Promise<void> {
    const { plan } = this;
    if (!plan || this.#overviewAsked) return;
    const windows: number[] = [];
    for (let k = from; k < to; k += 1) if (!this.#overviews.has(plan.windows[k]!.key)) windows.push(k);
    if (windows.length === 0) return;
    this.#overviewAsked = true;
    try {
      const numbers = await api.cellOverview(plan.key, windows);
      if (plan !== this.plan) return;
      const each = OVERVIEW * (plan.robot?.axes.length ?? 0);
      windows.forEach((window, k) => this.#overviews.set(plan.windows[window]!.key, numbers.slice(k * each, (k + 1) * each)));
      this.version += 1;
    } catch (error) {
      if (plan === this.plan) this.#failed(error);
    } finally {
      if (plan === this.plan) this.#overviewAsked = false;
    }
  }

  /** Notes that a window is in use: those that have not been for longest are forgotten first. */
  #touch(key: string): void {
    const window = this.#known.get(key);
    if (!window) return;
    this.#known.delete(key);
    this.#known.set(key, window);
  }

  #work(): void {
    this.loading = this.#wanted.length > 0;
    while (this.#asked.size < AT_A_TIME) {
      const key = this.#wanted.find((key) => !this.#asked.has(key));
      if (key === undefined) return;
      void this.#fetch(key);
    }
  }

  async #fetch(key: string): Promise<void> {
    this.#asked.add(key);
    try {
      const window = new MotionWindow(await api.cellWindow(key));
      this.#known.set(key, window);
      this.#bytes += window.bytes;
      for (const [other, { bytes }] of this.#known) {
        if (this.#bytes <= MOST_BYTES || other === key) break;
        this.#known.delete(other);
        this.#bytes -= bytes;
      }
      this.version += 1;
    } catch (error) {
      // The server forgets plans that are not the last ones; of those that are no longer shown nothing is missed.
      if (this.#wanted.includes(key)) {
        this.#wanted = [];
        this.#failed(error instanceof ApiError && error.status === 404 ? new Forgotten() : error);
      }
    } finally {
      this.#asked.delete(key);
      this.#wanted = this.#wanted.filter((one) => one !== key);
      this.#work();
    }
  }
}

/** The server does not remember the plan. */
export class Forgotten extends Error {}
