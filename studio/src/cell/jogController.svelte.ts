// Jogs the robot of the cell: one request at a time, and only the last pending one is kept.

import * as api from '../api/client';
import { ApiError, type Jog, type JogDocument } from '../api/client';
import type { CellTexts } from '../api/client';

/** The part of the session that jogging depends on. */
export interface JogContext {
  /** Texts and key of the displayed plan. */
  readonly planned: { texts: CellTexts; key: string } | null;
  /** Whether the cell is valid. */
  readonly jogAvailable: boolean;
  readonly playback: { readonly time: number; readonly playing: boolean };
  /** Whether the displayed plan may differ from that of the current inputs. */
  readonly outdated: boolean;
  failed(error: unknown): void;
}

interface JogRequest {
  to: Jog | null;
  /** Whether to start from the pose of the program and not from the jogged pose. */
  fromProgram: boolean;
}

export class JogController {
  /** The last response of the server. */
  document = $state.raw<JogDocument | null>(null);
  /** Whether the robot was jogged away from the program. */
  active = $state(false);
  /** The pending target; input fields show it at once, so that quick steps add up. */
  target = $state.raw<Jog | null>(null);
  /** Name of the jogged effector; the first one if empty. */
  effector = $state('');
  /** Station and slot of the relative coordinates. */
  station = $state('');
  slot = $state(1);
  /** Whether the robot stops before a contact. */
  stopAtContact = $state(true);
  /** Whether the last response belongs to the last request. */
  #current = $state(false);

  readonly #context: JogContext;
  #pending: JogRequest | null = null;
  #requesting = false;
  /** Resolves when all requests are answered. */
  #finished: Promise<void> = Promise.resolve();
  /** Time at which the robot left the program [s]. */
  #departureTime = 0;

  constructor(context: JogContext) {
    this.#context = context;
  }

  get positions(): number[] | null {
    return this.document?.axes.map(({ position }) => position) ?? null;
  }

  /** Whether the check of the pose may differ from that of the current inputs. */
  get outdated(): boolean {
    return !this.#current || this.#context.outdated || this.#context.playback.playing;
  }

  /** The current pose as a pose for teaching. */
  taughtBy({ axes }: JogDocument, slot: number): api.TaughtBy {
    const effector = this.effector ? { effector: this.effector } : {};
    return { positions: axes.map(({ position }) => position), time_s: this.active ? this.#departureTime : this.#context.playback.time, slot, ...effector };
  }

  /** Jogs toward a target. */
  moveTo(to: Jog): void {
    if (!this.active) this.#departureTime = this.#context.playback.time;
    this.active = true;
    this.target = to;
    this.#enqueue({ to, fromProgram: false });
  }

  /** Requests the current pose again, after a change of cell, effector or slot. */
  refresh(): void {
    this.#enqueue({ to: null, fromProgram: !this.active });
  }

  /** Returns the robot to the pose of the program. */
  release(): void {
    if (!this.active) return;
    this.active = false;
    this.target = null;
    this.#enqueue({ to: null, fromProgram: true });
  }

  /** The current pose relative to a slot; the displayed state does not change. */
  async queryFrom(station: string, slot: number): Promise<JogDocument | null> {
    // Pending motions are completed first.
    await this.#finished;
    const { planned } = this.#context;
    if (!planned) return null;
    try {
      return await api.jog(planned, { ...this.#startState(!this.active), seen_from: { station, slot } });
    } catch (error) {
      this.#context.failed(error);
      return null;
    }
  }

  #startState(fromProgram: boolean): api.JogParameters {
    const effector = this.effector ? { effector: this.effector } : {};
    const from = this.positions;
    if (fromProgram || !from) return { time_s: this.#context.playback.time, ...effector };
    return { time_s: this.#departureTime, from, ...effector };
  }

  #enqueue(question: JogRequest): void {
    // A pending motion is not replaced by a request for the current pose.
    if (question.to === null && this.#pending?.to && !question.fromProgram) return;
    this.#pending = question;
    this.#current = false;
    if (!this.#requesting) this.#finished = this.#processQueue();
  }

  async #processQueue(): Promise<void> {
    this.#requesting = true;
    while (this.#pending) {
      const { to, fromProgram } = this.#pending;
      this.#pending = null;
      const { planned, jogAvailable } = this.#context;
      if (!planned || !jogAvailable) break;
      try {
        const reference = this.station ? { seen_from: { station: this.station, slot: this.slot } } : {};
        this.document = await api.jog(planned, { ...this.#startState(fromProgram), ...reference, ...(to ? { to, stop_at_contact: this.stopAtContact } : {}) });
        this.#current = this.#pending === null;
      } catch (error) {
        // The cell may have changed: an unknown slot, axis or effector is reset.
        if (error instanceof ApiError && error.field?.startsWith('seen_from')) this.station = '';
        else if (error instanceof ApiError && error.field?.startsWith('from')) this.active = false;
        else if (error instanceof ApiError && error.field === 'effector') this.effector = '';
        else if (to || !(error instanceof ApiError)) this.#context.failed(error);
        // After a rejected motion the robot keeps its pose, which is checked again.
        if (error instanceof ApiError && (to || error.field)) this.#pending ??= { to: null, fromProgram: !this.active };
      }
    }
    this.target = null;
    this.#requesting = false;
  }
}
