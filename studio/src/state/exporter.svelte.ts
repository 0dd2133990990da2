// Exports of a view: one at a time, each can be cancelled; a film records the view.

import { download } from './export';
import { pictureFile, pictureVectors, type PicturedView, type VectorView } from './picture';
import { VideoRecorder, type RecordedView } from './recorder.svelte';

export class Exporter {
  /** What is being exported; empty if nothing is. */
  busy = $state('');
  readonly recorder = new VideoRecorder();
  readonly #failed: (message: string) => void;
  #abort: AbortController | null = null;

  constructor(failed: (message: string) => void) {
    this.#failed = failed;
  }

  /** Exports something, unless another export is running. */
  async run(what: string, work: (signal: AbortSignal) => Promise<void>): Promise<void> {
    if (this.busy) return;
    const abort = new AbortController();
    this.#abort = abort;
    this.busy = what;
    try {
      await work(abort.signal);
    } catch (error) {
      if (!abort.signal.aborted) this.#failed(`Not exported: ${error instanceof Error ? error.message : String(error)}`);
    } finally {
      this.#abort = null;
      this.busy = '';
    }
  }

  /** Ends the running export without a file. */
  cancel(): void {
    this.#abort?.abort();
  }

  /** A file that is made while the user waits. */
  async file(what: string, make: (signal: AbortSignal) => Promise<{ blob: Blob; name: string }>): Promise<void> {
    await this.run(what, async (signal) => {
      const { blob, name } = await make(signal);
      signal.throwIfAborted();
      download(blob, name);
    });
  }

  /** The view as a picture. */
  async picture(view: PicturedView | null, note: string, name: string): Promise<void> {
    if (view) await this.file('view', async () => ({ blob: await pictureFile(view, note), name }));
  }

  /** The view as a picture with labels as vectors. */
  async vectors(view: VectorView | null, note: string, name: string): Promise<void> {
    if (view) await this.file('view', async () => ({ blob: await pictureVectors(view, note), name }));
  }

  /**
   * Records a view until it is stopped; `once` plays a motion and reports its end.
   *
   * If the view is removed, the film ends there.
   */
  async film(view: RecordedView | null, note: () => string, name: string, once: ((ended: () => void) => void) | null): Promise<void> {
    if (this.recorder.running) return this.recorder.stop();
    if (!view) return;
    await this.run('video', async () => {
      const recording = await this.recorder.start(view, note, (blob, extension) => download(blob, `${name}.${extension}`));
      if (recording) once?.(() => void this.recorder.stop());
    });
  }
}
