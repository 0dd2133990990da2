// Shares of limits over a time range: tilt of the platform, and friction of each held wafer.

import * as api from '../api/client';
import { readArrow } from '../lib/arrow';

/** Pause after a change of the range before samples are requested [ms]. */
const PAUSE_MS = 200;
/** Sampling rate [Hz]; peaks between samples are added. */
const RATE_HZ = 25;
/** Ends of the names of columns. */
const SUFFIX = /_percent$/;

export interface BudgetSeries {
  times: Float64Array;
  /** Shares of limits [%]. */
  lines: { name: string; values: Float64Array }[];
}

export class Budgets {
  series = $state.raw<BudgetSeries | null>(null);
  #timer: ReturnType<typeof setTimeout> | undefined;
  #abort: AbortController | null = null;
  #loaded = '';
  readonly #failed: (error: unknown) => void;

  constructor(failed: (error: unknown) => void) {
    this.#failed = failed;
  }

  /** Requests the samples of a time range [s] of planned texts; without a range, there are none. */
  show(planned: { texts: api.CellTexts; key: string } | null, range: readonly [number, number] | null): void {
    const wanted = planned && range ? `${planned.key} ${range.join(' ')}` : '';
    if (wanted === this.#loaded) return;
    this.#loaded = wanted;
    clearTimeout(this.#timer);
    this.#abort?.abort();
    this.#abort = null;
    if (!planned || !range) this.series = null;
    else this.#timer = setTimeout(() => void this.#load(planned.texts, range), PAUSE_MS);
  }

  async #load(texts: api.CellTexts, range: readonly [number, number]): Promise<void> {
    const abort = new AbortController();
    this.#abort = abort;
    try {
      const { fields, batches } = await readArrow(await api.cellSamples(texts, range, ['time_s', 'budgets'], RATE_HZ, abort.signal));
      const parts = new Map(fields.map((name): [string, number[][]] => [name, []]));
      for await (const batch of batches) for (const [name, of] of parts) of.push(Array.from(batch.getChild(name)!.toArray() as ArrayLike<number>));
      if (abort.signal.aborted) return;
      const values = (name: string) => Float64Array.from((parts.get(name) ?? []).flat());
      this.series = { times: values('time_s'), lines: fields.filter((name) => SUFFIX.test(name)).map((name) => ({ name, values: values(name) })) };
    } catch (error) {
      if (abort.signal.aborted) return;
      this.#loaded = '';
      this.#failed(error);
    }
  }

  dispose(): void {
    this.show(null, null);
  }
}
