// Whether the server answers. All requests report here, and one loop waits for its return.

/** How often a server that does not answer is asked again [ms]. */
const RETRY_MS = 1000;
/** How often a server that answers is asked whether it is still there, while nothing else asks it [ms]. */
const BEAT_MS = 3000;

export class Connection {
  state = $state<'starting' | 'connected' | 'disconnected'>('starting');
  readonly #probe: () => Promise<unknown>;
  readonly #returned = new Set<() => void>();
  #timer: ReturnType<typeof setTimeout> | undefined;

  /** `probe` asks the server anything; it rejects where there is no answer at all. */
  constructor(probe: () => Promise<unknown>) {
    this.#probe = probe;
  }

  /** Calls `act` each time the server answers again after it did not. */
  onReturn(act: () => void): void {
    this.#returned.add(act);
  }

  /** A request was answered, be it by a refusal. */
  answered(): void {
    const back = this.state === 'disconnected';
    this.state = 'connected';
    this.#schedule(BEAT_MS);
    if (back) for (const act of this.#returned) act();
  }

  /** A request was not answered. */
  failed(): void {
    // Before the first answer there is nothing on show that could be outdated.
    if (this.state === 'connected') this.state = 'disconnected';
    this.#schedule(RETRY_MS);
  }

  #schedule(delay_ms: number): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#ask(), delay_ms);
  }

  async #ask(): Promise<void> {
    const starting = this.state === 'starting';
    try {
      await this.#probe();
    } catch {
      this.failed();
      return;
    }
    this.answered();
    if (starting) for (const act of this.#returned) act();
  }
}

export const connection = new Connection(() => fetch('./api/v1/robot', { cache: 'no-store' }));
