// The series of a motion, as they arrive from the server.

import * as api from '../api/client';
import type { ModelChoice, ApiCommand } from '../api/client';
import { readArrow } from '../lib/arrow';
import { column, type Column } from '../lib/columns';
import type { Motion } from '../lib/document';

export type StudyState = 'none' | 'loading' | 'ready' | 'failed';

/** Plots are drawn anew this often while samples arrive: a million of them come in hundreds of batches. */
const REDRAW_MS = 400;
/** How long samples are read at a stretch. */
const TURN_MS = 8;

export class Study {
  state = $state<StudyState>('none');
  /** Samples that have arrived, and how many there will be. */
  count = $state(0);
  total = $state(0);
  error = $state<string | null>(null);
  /** Grows with each batch, so that plots know when to draw anew. */
  version = $state(0);
  columns: Column[] = [];
  /** Samples a second, of a motion that has a time of its own. */
  rate: number | null = null;
  /** The time of each sample [s], of a motion that has a time of its own. */
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

  /** Ends the computation; what has arrived stays. */
  cancel(): void {
    this.#abort?.abort();
    this.#abort = null;
    if (this.state === 'loading') this.state = this.count > 0 ? 'ready' : 'none';
  }

  async load(motion: Motion, model: ModelChoice): Promise<void> {
    this.clear();
    const abort = new AbortController();
    this.#abort = abort;
    this.state = 'loading';
    try {
      const { metadata, fields, batches } = await readArrow(await api.study(motion, model, abort.signal));
      if (abort.signal.aborted) return;
      const total = Number(metadata.get('samples'));
      this.rate = motion.kind === 'key-poses' ? api.KEY_RATE_HZ : null;
      const { rate } = this;
      this.times = rate === null ? null : Float64Array.from({ length: total }, (_, i) => i / rate);
      this.columns = fields.map((name) => column(name, total));
      this.total = total;
      let at = 0;
      let told = -Infinity;
      let turn = performance.now();
      for await (const batch of batches) {
        if (abort.signal.aborted) return;
        for (const one of this.columns) one.values.set(batch.getChild(one.name)!.toArray() as ArrayLike<number>, at);
        at += batch.numRows;
        const now = performance.now();
        if (at === total || now - told > REDRAW_MS) {
          told = now;
          this.count = at;
          this.version += 1;
        }
        // What has arrived already is read without a pause: the page gets its turn all the same.
        if (now - turn > TURN_MS) {
          await new Promise((next) => setTimeout(next));
          turn = performance.now();
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

  /** What the robot is told at a sample. */
  command(sample: number): ApiCommand | null {
    const value = (name: string) => this.columns.find((one) => one.name === name)?.values[sample];
    const rods = ['q1_m', 'q2_m', 'q3_m'].map(value);
    // A sample that cannot be reached has no rods.
    if (sample >= this.count || !rods.every(Number.isFinite)) return null;
    return { kind: 'rods', rods_m: rods as number[] };
  }

  of(quantity: string): Column[] {
    return this.columns.filter((one) => one.quantity === quantity);
  }
}
