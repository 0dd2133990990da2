// Changes of the text of the cell that the server makes: one after another. Undo cancels those that are pending.

export class TextChanges {
  /** Number of changes whose text has not arrived yet. */
  pending = $state(0);
  #last: Promise<void> = Promise.resolve();
  #abort = new AbortController();

  /** Resolves when all changes have arrived or were cancelled. */
  get finished(): Promise<void> {
    return this.#last;
  }

  /** Makes a change after all pending ones. */
  add(change: (signal: AbortSignal) => Promise<void>): Promise<void> {
    const { signal } = this.#abort;
    this.pending += 1;
    this.#last = this.#last.then(async () => {
      try {
        if (!signal.aborted) await change(signal);
      } finally {
        this.pending -= 1;
      }
    });
    return this.#last;
  }

  /** Cancels all pending changes; returns whether there were any. */
  cancel(): boolean {
    if (this.pending === 0) return false;
    this.#abort.abort();
    this.#abort = new AbortController();
    return true;
  }
}
