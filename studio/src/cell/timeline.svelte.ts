// The motion of the displayed plan. Its windows are loaded on demand and cached by their keys.

import * as api from '../api/client';
import { ApiError, type PlanDocument } from '../api/client';
import { frames, type Frame, type Names } from '../lib/kinematics';
import type { Part, Slot } from '../lib/parts';
import { MotionWindow, type WaferPlacement, type Step } from '../lib/motion';

/** State of the motion at one time. */
export interface MotionState {
  window: MotionWindow;
  /** Index of the step within its window. */
  index: number;
  step: ProgramStep;
  /** Time since the start of the step [s]. */
  since: number;
}

/** A step with times since the start of the program [s] and names of axes. */
export interface ProgramStep extends Omit<Step, 'moving' | 'loaded' | 'station'> {
  /** Name of the station that an effector reaches into. */
  station: string | null;
  moving: string[];
  loaded: string[];
}

/** Numbers per axis and window of an overview: minimum and maximum of position, velocity and acceleration, and the time in motion [m, rad, s]. */
export const OVERVIEW = 7;

/** Maximum number of windows displayed in detail; longer ranges are displayed by their overview. */
export const MAX_WINDOWS_SHOWN = 16;
/** Maximum size of the cache of windows [bytes]. */
const MAX_BYTES = 48e6;
const MAX_REQUESTS = 3;
/** Distance of the points of a path [s]. */
const TRACE_SPACING_S = 0.04;
/** Time ahead of the current time for which windows are prefetched [s]. */
const AHEAD_S = 30;

export class Timeline {
  /** Incremented with each window and each plan. */
  version = $state(0);
  /** Whether requested windows are still loading. */
  loading = $state(false);
  plan = $state.raw<PlanDocument | null>(null);
  readonly #failed: (error: unknown) => void;
  readonly #windows = new Map<string, MotionWindow>();
  #bytes = 0;
  readonly #overviews = new Map<string, Float64Array>();
  #requested = new Set<string>();
  #needed: string[] = [];
  #overviewRequested = false;

  constructor(failed: (error: unknown) => void) {
    this.#failed = failed;
  }

  get duration(): number {
    return this.plan?.report?.duration_s ?? 0;
  }

  /** Displays another plan; cached windows are kept. */
  show(plan: PlanDocument): void {
    this.plan = plan;
    this.#needed = [];
    this.#overviewRequested = false;
    const keys = new Set(plan.windows.map(({ key }) => key));
    for (const key of [...this.#overviews.keys()]) if (!keys.has(key)) this.#overviews.delete(key);
    this.version += 1;
  }

  /** Index of the window at a time [s]. */
  #windowIndex(time: number): number {
    const windows = this.plan?.windows ?? [];
    let [low, high] = [0, windows.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (windows[middle]!.start_s <= time) low = middle + 1;
      else high = middle;
    }
    return Math.max(low - 1, 0);
  }

  /** Indices of the windows of a time range [s]: the first, and one past the last. */
  windowsIn([from, to]: readonly [number, number]): [number, number] {
    const count = this.plan?.windows.length ?? 0;
    return [this.#windowIndex(from), Math.min(this.#windowIndex(to) + 1, count)];
  }

  /** Start and end of a window [s]. */
  bounds(index: number): [number, number] {
    const windows = this.plan?.windows ?? [];
    return [windows[index]?.start_s ?? 0, windows[index + 1]?.start_s ?? this.duration];
  }

  window(index: number): MotionWindow | null {
    const key = this.plan?.windows[index]?.key;
    return (key !== undefined && this.#windows.get(key)) || null;
  }

  /** State of the motion at a time [s]; `null` if it is not loaded or there is no motion. */
  stateAt(time: number): MotionState | null {
    void this.version;
    const at = this.#windowIndex(time);
    const window = this.window(at);
    if (!window || window.steps.length === 0) return null;
    const since = time - this.plan!.windows[at]!.start_s;
    const index = window.stepAt(since);
    return { window, index, step: this.#stepInProgram(at, window, index), since: Math.max(since - window.steps[index]!.start_s, 0) };
  }

  #stepInProgram(at: number, window: MotionWindow, index: number): ProgramStep {
    const { start_s, instruction, line } = this.plan!.windows[at]!;
    const step = window.steps[index]!;
    const { robot, effectors, stations } = this.plan!;
    return {
      ...step,
      instruction: instruction + step.instruction,
      line: line + step.line,
      start_s: start_s + step.start_s,
      end_s: start_s + step.end_s,
      station: step.station === null ? null : stations[step.station]!.name,
      moving: step.moving.map((axis) => robot!.axes[axis]!.name),
      loaded: step.loaded.map((effector) => effectors[effector]!),
    };
  }

  /** The steps of a loaded window, without steps of zero duration. */
  steps(index: number): ProgramStep[] {
    const window = this.window(index);
    if (!window) return [];
    return window.steps.flatMap(({ start_s, end_s }, k) => (end_s > start_s ? [this.#stepInProgram(index, window, k)] : []));
  }

  /** The violations at a time [s]. */
  violations(time: number): { entities: Part[]; message: string }[] {
    void this.version;
    const at = this.#windowIndex(time);
    const since = time - (this.plan?.windows[at]?.start_s ?? 0);
    return (this.window(at)?.violations ?? []).filter(({ start_s, end_s }) => start_s - 1e-3 <= since && since <= end_s + 1e-3);
  }

  /** Poses of all frames at a time [s], and the slots of resting wafers; `null` while they are loading. */
  pose(time: number): { frames: Frame[]; restingWafers: Map<string, Slot> } | null {
    const { plan } = this;
    const moment = this.stateAt(time);
    if (!plan?.chain || !plan.robot || !moment) return null;
    const names: Names = { axes: plan.robot.axes.map(({ name }) => name), links: plan.robot.arms.map(({ links }) => links), wafers: plan.wafers.map(({ name }) => name) };
    const held = moment.window.held(plan.wafers.map(({ held }, wafer) => ({ wafer, ...held }) as WaferPlacement), moment.index);
    const restingWafers = new Map<string, Slot>();
    held.forEach(({ slot }, k) => {
      if (slot) restingWafers.set(names.wafers[k]!, { station: plan.stations[slot[0]]!.name, slot: slot[1] });
    });
    return { frames: frames(plan.chain, names, moment.window.values(moment.index, moment.since), held), restingWafers };
  }

  /** Path of the centre of a wafer over a time range [s], as far as it is loaded: pairs of points in the base frame [m]. */
  waferPath(name: string, range: readonly [number, number]): number[] {
    void this.version;
    const { plan } = this;
    const wafer = plan?.wafers.findIndex((one) => one.name === name) ?? -1;
    if (!plan?.chain || !plan.robot || wafer < 0) return [];
    const { chain } = plan;
    const names: Names = { axes: plan.robot.axes.map(({ name }) => name), links: plan.robot.arms.map(({ links }) => links), wafers: [name] };
    const start = plan.wafers.map(({ held }, wafer) => ({ wafer, ...held }) as WaferPlacement);
    const points: number[] = [];
    const [first, after] = this.windowsIn(range);
    for (let index = first; index < after; index += 1) {
      const window = this.window(index);
      const [from] = this.bounds(index);
      window?.steps.forEach(({ start_s, end_s, moving }, step) => {
        const held = window.held(start, step)[wafer]!;
        if (held.effector === null || moving.length === 0 || from + end_s < range[0] || from + start_s > range[1]) return;
        const width = end_s - start_s;
        const count = Math.max(1, Math.ceil(width / TRACE_SPACING_S));
        let last: number[] | null = null;
        for (let k = 0; k <= count; k += 1) {
          const next: number[] = frames(chain, names, window.values(step, (width * k) / count), [held]).at(-1)!.origin_m;
          if (last) points.push(...last, ...next);
          last = next;
        }
      });
    }
    return points;
  }

  /** Loads the window at a time [s] and the following ones, then those of a time range, or their overview. */
  prefetch(time: number, stretch: readonly [number, number] | null): void {
    const { plan } = this;
    if (!plan || plan.windows.length === 0) return;
    const [now] = this.windowsIn([time, time]);
    const [, ahead] = this.windowsIn([time, Math.min(time + AHEAD_S, this.duration)]);
    const indices = [now];
    for (let k = now + 1; k < Math.min(ahead, now + MAX_WINDOWS_SHOWN); k += 1) indices.push(k);
    if (stretch) {
      const [from, to] = this.windowsIn(stretch);
      if (to - from <= MAX_WINDOWS_SHOWN) for (let k = from; k < to; k += 1) indices.push(k);
      else void this.#overview(from, to);
    }
    const keys = [...new Set(indices.map((k) => plan.windows[k]!.key))];
    for (const key of keys) this.#markUsed(key);
    this.#needed = keys.filter((key) => !this.#windows.has(key));
    this.#fetchNext();
  }

  /** Overviews of a range of windows; `null` for those that are not loaded. */
  overview(from: number, to: number): (Float64Array | null)[] {
    void this.version;
    return (this.plan?.windows.slice(from, to) ?? []).map(({ key }) => this.#overviews.get(key) ?? null);
  }

  async #overview(from: number, to: number): Promise<void> {
    const { plan } = this;
    if (!plan || this.#overviewRequested) return;
    const windows: number[] = [];
    for (let k = from; k < to; k += 1) if (!this.#overviews.has(plan.windows[k]!.key)) windows.push(k);
    if (windows.length === 0) return;
    this.#overviewRequested = true;
    try {
      const numbers = await api.cellOverview(plan.key, windows);
      if (plan !== this.plan) return;
      const each = OVERVIEW * (plan.robot?.axes.length ?? 0);
      windows.forEach((window, k) => this.#overviews.set(plan.windows[window]!.key, numbers.slice(k * each, (k + 1) * each)));
      this.version += 1;
    } catch (error) {
      if (plan === this.plan) this.#failed(error);
    } finally {
      if (plan === this.plan) this.#overviewRequested = false;
    }
  }

  /** Marks a window as recently used; the least recently used windows are evicted first. */
  #markUsed(key: string): void {
    const window = this.#windows.get(key);
    if (!window) return;
    this.#windows.delete(key);
    this.#windows.set(key, window);
  }

  #fetchNext(): void {
    this.loading = this.#needed.length > 0;
    while (this.#requested.size < MAX_REQUESTS) {
      const key = this.#needed.find((key) => !this.#requested.has(key));
      if (key === undefined) return;
      void this.#fetch(key);
    }
  }

  async #fetch(key: string): Promise<void> {
    this.#requested.add(key);
    try {
      const window = new MotionWindow(await api.cellWindow(key));
      this.#windows.set(key, window);
      this.#bytes += window.bytes;
      for (const [other, { bytes }] of this.#windows) {
        if (this.#bytes <= MAX_BYTES || other === key) break;
        this.#windows.delete(other);
        this.#bytes -= bytes;
      }
      this.version += 1;
    } catch (error) {
      // The server keeps the last plans only; an error for a plan that is no longer displayed is ignored.
      if (this.#needed.includes(key)) {
        this.#needed = [];
        this.#failed(error instanceof ApiError && error.status === 404 ? new UnknownPlan() : error);
      }
    } finally {
      this.#requested.delete(key);
      this.#needed = this.#needed.filter((one) => one !== key);
      this.#fetchNext();
    }
  }
}

/** The server no longer has the plan. */
export class UnknownPlan extends Error {}
