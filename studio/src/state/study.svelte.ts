// Time series of a motion, received from the server in batches.

import * as api from '../api/client';
import type { ModelChoice, ApiCommand, RobotSource } from '../api/client';
import { readArrow } from '../lib/arrow';
import { column, type Column } from '../lib/columns';
import type { Motion } from '../lib/document';
import { otherEvents } from '../lib/otherEvents';

export type StudyState = 'none' | 'loading' | 'ready' | 'failed';

/** Minimum interval between plot updates while samples arrive [ms]: a million samples arrive in hundreds of batches. */
const REDRAW_MS = 400;
/** Longest time for which samples are read before the page handles other events [ms]. */
const MAX_BLOCKING_MS = 8;

export class Study {
  state = $state<StudyState>('none');
  /** Number of samples that have arrived, and in total. */
  count = $state(0);
  total = $state(0);
  error = $state<string | null>(null);
  /** Incremented with each update, to trigger plots. */
  version = $state(0);
  columns: Column[] = [];
  /** Sampling rate [Hz]; `null` for a motion without time stamps. */
  rate: number | null = null;
  /** Time of each sample [s]; `null` for a motion without time stamps. */
  times: Float64Array | null = null;
  #abort: AbortController | null = null;

  clear(): void {
    this.#abort?.abort();
    this.#abort = null;
    this.state = 'none';
    this.count = this.total = 0;
    this.columns = [];
    this.times = null;
    this.error = null;
    this.version += 1;
  }

  /** Ends the computation; samples that have arrived are kept. */
  cancel(): void {
    this.#abort?.abort();
    this.#abort = null;
    if (this.state === 'loading') this.state = this.count > 0 ? 'ready' : 'none';
  }

  async load(robot: RobotSource | null, motion: Motion, model: ModelChoice, quantities: readonly string[] = api.QUANTITIES): Promise<void> {
    this.clear();
    const abort = new AbortController();
    this.#abort = abort;
    this.state = 'loading';
    try {
      const { metadata, fields, batches } = await readArrow(await api.study(robot, motion, model, quantities, abort.signal));
      if (abort.signal.aborted) return;
      const total = Number(metadata.get('samples'));
      this.rate = motion.kind === 'key-poses' ? api.KEY_RATE_HZ : null;
      const { rate } = this;
      this.times = rate === null ? null : Float64Array.from({ length: total }, (_, i) => i / rate);
      this.columns = fields.map((name) => column(name, total));
      this.total = total;
      let count = 0;
      let updated = -Infinity;
      let resumed = performance.now();
      for await (const batch of batches) {
        if (abort.signal.aborted) return;
        for (const one of this.columns) one.values.set(batch.getChild(one.name)!.toArray() as ArrayLike<number>, count);
        count += batch.numRows;
        const now = performance.now();
        if (count === total || now - updated > REDRAW_MS) {
          updated = now;
          this.count = count;
          this.version += 1;
        }
        // Batches that have arrived are read without a pause; the page handles events in between.
        if (now - resumed > MAX_BLOCKING_MS) {
          await otherEvents();
          resumed = performance.now();
        }
      }
      this.state = 'ready';
    } catch (error) {
      if (abort.signal.aborted) return;
      this.state = 'failed';
      this.error = error instanceof Error ? error.message : String(error);
      if (error instanceof api.ConnectionError) throw error;
    }
  }

  /** The command of a sample; `null` for a sample without a solution. */
  command(sample: number): ApiCommand | null {
    const value = (name: string) => this.columns.find((one) => one.name === name)?.values[sample];
    const rods = ['q1_m', 'q2_m', 'q3_m'].map(value);
    // An unreachable sample has no rod lengths.
    if (sample >= this.count || !rods.every(Number.isFinite)) return null;
    return { kind: 'rods', rods_m: rods as number[] };
  }

  columnsOf(quantity: string): Column[] {
    return this.columns.filter((one) => one.quantity === quantity);
  }
}
