// State of the connection to the server. All requests report here, and one loop polls the server.

/** Interval between requests while the server does not respond [ms]. */
const RETRY_MS = 1000;
/** Interval after which an idle connection is probed [ms]. */
const HEARTBEAT_MS = 3000;

export class Connection {
  state = $state<'starting' | 'connected' | 'disconnected'>('starting');
  readonly #probe: () => Promise<Response>;
  readonly #reconnected = new Set<() => void>();
  readonly #probed = new Set<(response: Response) => void>();
  #timer: ReturnType<typeof setTimeout> | undefined;

  /** `probe` sends any request; its promise rejects if the server does not respond. */
  constructor(probe: () => Promise<Response>) {
    this.#probe = probe;
  }

  /** Calls `act` after each reconnection. */
  onReconnect(act: () => void): void {
    this.#reconnected.add(act);
  }

  /** Calls `act` with a copy of each successful response to a probe of the connected server. */
  onProbe(act: (response: Response) => void): void {
    this.#probed.add(act);
  }

  /** The server has responded to a request, with success or an error. */
  responded(): void {
    const reconnected = this.state === 'disconnected';
    this.state = 'connected';
    this.#schedule(HEARTBEAT_MS);
    if (reconnected) for (const act of this.#reconnected) act();
  }

  /** The server has not responded to a request. */
  failed(): void {
    // Before the first response no displayed value can be outdated.
    if (this.state === 'connected') this.state = 'disconnected';
    this.#schedule(RETRY_MS);
  }

  #schedule(delay_ms: number): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#poll(), delay_ms);
  }

  async #poll(): Promise<void> {
    const { state } = this;
    const starting = state === 'starting';
    let response: Response;
    try {
      response = await this.#probe();
    } catch {
      this.failed();
      return;
    }
    this.responded();
    if (state === 'connected' && response.ok) for (const act of this.#probed) act(response.clone());
    if (starting) for (const act of this.#reconnected) act();
  }
}

export const connection = new Connection(() => fetch('./api/v1/robot', { cache: 'no-store' }));
