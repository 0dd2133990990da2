// The simulated controller of this server: its hosts, and the robot of one of them at the present time.

import * as api from '../api/client';
import { ApiError, type ControllerDocument, type HostDocument } from '../api/client';
import type { Frame } from '../lib/kinematics';
import type { Slot } from '../lib/parts';

/** Interval between requests while the robot moves, while it is at rest, and while the page is hidden [ms]. */
const MOVING_MS = 40;
const RESTING_MS = 250;
const HIDDEN_MS = 2000;
/** Interval between requests for the list of hosts [ms]. */
const LIST_MS = 500;

export class ControllerMonitor {
  document = $state.raw<ControllerDocument | null>(null);
  /** The robot of the displayed host; `null` without a connected host. */
  host = $state.raw<HostDocument | null>(null);
  /** Number of the chosen host; without one, the host that connected last is displayed. */
  chosen = $state<number | null>(null);
  /** Whether the view shows the robot of the host in place of that of the program. */
  shown = $state(true);
  readonly frames: readonly Frame[] | null = $derived(this.shown ? (this.host?.frames ?? null) : null);
  /** Slots of the resting wafers. */
  readonly restingWafers: ReadonlyMap<string, Slot> = $derived(new Map((this.host?.resting ?? []).map(({ wafer, station, slot }) => [wafer, { station, slot }])));
  #timer: ReturnType<typeof setTimeout> | undefined;
  #isOpen = false;
  #listed_ms = -Infinity;

  /** Follows the controller until it is closed. */
  open(): void {
    this.#isOpen = true;
    void this.#poll();
  }

  close(): void {
    this.#isOpen = false;
    clearTimeout(this.#timer);
  }

  choose(number: number): void {
    this.chosen = number;
    this.shown = true;
  }

  async #poll(): Promise<void> {
    try {
      if (this.document === null || performance.now() - this.#listed_ms > LIST_MS) await this.#list();
      const hosts = this.document?.hosts ?? [];
      const number = hosts.find((one) => one.number === this.chosen)?.number ?? hosts.at(-1)?.number;
      this.host = number === undefined ? null : await api.hostOfController(number);
    } catch (error) {
      // The host has disconnected; without a server, the page reports that it is disconnected.
      this.host = null;
      this.#listed_ms = error instanceof ApiError ? -Infinity : performance.now();
    }
    if (!this.#isOpen) return;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#poll(), document.hidden ? HIDDEN_MS : this.host?.command ? MOVING_MS : RESTING_MS);
  }

  async #list(): Promise<void> {
    this.document = await api.controller();
    this.#listed_ms = performance.now();
    if (!this.document.hosts.some(({ number }) => number === this.chosen)) this.chosen = null;
  }
}
