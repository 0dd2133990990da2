// What the cell's part of the page knows: two texts, what they come to, and the moment shown.

import * as api from '../api/client';
import { Away, type PlanDocument, type StationDocument } from '../api/client';
import { History } from '../lib/history';
import { readArrow } from '../lib/arrow';

interface Texts {
  cell: string;
  program: string;
}

/** How long nobody may type before the texts are planned anew. */
const REST_MS = 250;
const RETRY_MS = 1000;
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10] as const;

export interface Series {
  name: string;
  values: ArrayLike<number>;
}

export class Desk {
  file = $state<string | null>(null);
  texts = $state.raw<Texts>({ cell: '', program: '' });
  saved = $state.raw<Texts>({ cell: '', program: '' });
  plan = $state.raw<PlanDocument | null>(null);
  /** The stations of the last cell that could be read: what is wrong with it can be mended here too. */
  stations = $state.raw<StationDocument[]>([]);
  /** The cell in motion, as glTF. */
  shape = $state.raw<ArrayBuffer | null>(null);
  /** The motion sample by sample. */
  series = $state.raw<Series[]>([]);
  state = $state<'starting' | 'planning' | 'ready' | 'away'>('starting');
  notice = $state<string | null>(null);
  /** The moment shown [s]. */
  time = $state(0);
  playing = $state(false);
  loop = $state(true);
  speed = $state(1);
  /** The part or station that is chosen. */
  chosen = $state<string | null>(null);
  canUndo = $state(false);
  canRedo = $state(false);
  /** How long the last plan took, from the change to the answer [ms]. */
  took_ms = $state(0);
  changed = $derived(this.texts.cell !== this.saved.cell || this.texts.program !== this.saved.program);
  duration = $derived(this.plan?.report?.duration_s ?? 0);
  /** The step that runs at the moment shown. */
  step = $derived.by(() => {
    const steps = this.plan?.steps ?? [];
    let low = 0;
    let high = steps.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (steps[middle]!.start_s <= this.time) low = middle + 1;
      else high = middle;
    }
    return steps[low - 1] ?? null;
  });
  /** What is broken at the moment shown. */
  broken = $derived((this.plan?.report?.violations ?? []).filter(({ start_s, end_s }) => start_s - 1e-3 <= this.time && this.time <= end_s + 1e-3));

  #history = new History<Texts>(this.texts);
  #timer: ReturnType<typeof setTimeout> | undefined;
  #abort: AbortController | null = null;
  #frame = 0;
  #last = 0;

  async start(): Promise<void> {
    try {
      const { file, cell, program } = await api.cell();
      this.file = file;
      this.texts = this.saved = { cell, program };
      this.#history = new History(this.texts);
      await this.replan();
    } catch (error) {
      this.#failed(error, () => void this.start());
    }
  }

  #failed(error: unknown, again: () => void): void {
    if (error instanceof DOMException && error.name === 'AbortError') return;
    if (error instanceof Away) {
      this.state = 'away';
      clearTimeout(this.#timer);
      this.#timer = setTimeout(again, RETRY_MS);
    } else this.notice = error instanceof Error ? error.message : String(error);
  }

  /** Takes what was typed; it is planned when typing rests. */
  type(part: Partial<Texts>): void {
    this.texts = { ...this.texts, ...part };
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.settle(), REST_MS);
  }

  /** A change is whole: it can be undone, and is planned. */
  settle(): void {
    clearTimeout(this.#timer);
    if (this.#history.commit(this.texts)) this.#steps();
    void this.replan();
  }

  #steps(): void {
    this.canUndo = this.#history.canUndo;
    this.canRedo = this.#history.canRedo;
  }

  undo(): void {
    this.#restore(this.#history.undo());
  }

  redo(): void {
    this.#restore(this.#history.redo());
  }

  #restore(texts: Texts | undefined): void {
    if (!texts) return;
    this.texts = texts;
    this.#steps();
    void this.replan();
  }

  async replan(): Promise<void> {
    this.#abort?.abort();
    const abort = new AbortController();
    this.#abort = abort;
    this.state = 'planning';
    const begun = performance.now();
    try {
      const { texts } = this;
      const plan = await api.plan(texts, abort.signal);
      if (abort.signal.aborted) return;
      this.plan = plan;
      if (plan.stations.length > 0) this.stations = plan.stations;
      this.took_ms = performance.now() - begun;
      if (this.time > this.duration) this.seek(this.duration);
      // Where the cell cannot be read, the last one that could stays in view.
      if (!plan.problems.some(({ of }) => of === 'cell')) this.shape = await api.cellMotion(texts, abort.signal);
      this.series = plan.report ? await read(await api.cellSamples(texts, abort.signal)) : [];
      if (abort.signal.aborted) return;
      this.state = 'ready';
    } catch (error) {
      if (!abort.signal.aborted) this.#failed(error, () => void this.replan());
    }
  }

  /** New values of a station, written into the text of the cell. */
  async setStation(station: string, change: api.StationChange): Promise<void> {
    try {
      const { cell } = await api.setStation(this.texts.cell, station, change);
      this.texts = { ...this.texts, cell };
      this.settle();
    } catch (error) {
      this.#failed(error, () => undefined);
    }
  }

  async save(): Promise<void> {
    try {
      const { cell, program } = await api.saveCell(this.texts);
      this.saved = { cell, program };
      this.notice = null;
    } catch (error) {
      this.#failed(error, () => undefined);
    }
  }

  // Time

  seek(time: number): void {
    this.time = Math.min(Math.max(time, 0), this.duration);
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  play(): void {
    if (this.playing || this.duration === 0) return;
    if (this.time >= this.duration) this.time = 0;
    this.playing = true;
    this.#last = performance.now();
    this.#frame = requestAnimationFrame((now) => this.#tick(now));
  }

  pause(): void {
    this.playing = false;
    cancelAnimationFrame(this.#frame);
  }

  #tick(now: number): void {
    const passed = Math.min(Math.max(now - this.#last, 0), 250) / 1000;
    this.#last = now;
    let to = this.time + passed * this.speed;
    if (to >= this.duration) {
      if (this.loop) to %= this.duration || 1;
      else {
        this.seek(this.duration);
        this.pause();
        return;
      }
    }
    this.time = to;
    this.#frame = requestAnimationFrame((next) => this.#tick(next));
  }
}

async function read(stream: ReadableStream<Uint8Array>): Promise<Series[]> {
  const { fields, batches } = await readArrow(stream);
  for await (const batch of batches)
    return fields.map((name) => ({ name, values: batch.getChild(name)!.toArray() as ArrayLike<number> }));
  return [];
}

export const desk = new Desk();
