// The robot of the cell moved by hand: one question at a time, and of those that wait only the last.

import * as api from '../api/client';
import { ApiError, type Jog, type JogDocument } from '../api/client';
import type { CellTexts } from '../api/client';

/** What the jogger needs to know of the session. */
export interface JogContext {
  /** The texts that the plan on show was made of, and its key. */
  readonly planned: { texts: CellTexts; key: string } | null;
  /** Whether the cell can be read. */
  readonly movable: boolean;
  readonly time: number;
  readonly playing: boolean;
  /** Whether the plan on show is not that of the texts. */
  readonly outdated: boolean;
  failed(error: unknown): void;
}

interface Question {
  to: Jog | null;
  /** From where the program has it, whatever was jogged before. */
  anew: boolean;
}

export class JogController {
  /** The robot as the server has it. */
  document = $state.raw<JogDocument | null>(null);
  /** Whether it has left the program. */
  active = $state(false);
  /** What is asked and not yet answered: fields show it at once, so that quick steps add up. */
  wanted = $state.raw<Jog | null>(null);
  /** The effector that is moved; the first where it has no name. */
  effector = $state('');
  /** The slot from which it is seen. */
  station = $state('');
  slot = $state(1);
  /** Whether the robot stops before two bodies touch; a real one has to. */
  stopAtContact = $state(true);
  /** Whether the document answers the last question. */
  #current = $state(false);

  readonly #context: JogContext;
  #next: Question | null = null;
  #busy = false;
  /** When all questions are answered. */
  #done: Promise<void> = Promise.resolve();
  /** The moment at which it left the program [s]. */
  #left = 0;

  constructor(context: JogContext) {
    this.#context = context;
  }

  get positions(): number[] | null {
    return this.document?.axes.map(({ position }) => position) ?? null;
  }

  /** Whether the check of the pose is not that of the state on the page. */
  get outdated(): boolean {
    return !this.#current || this.#context.outdated || this.#context.playing;
  }

  /** The pose of the robot as one to teach by. */
  taughtBy({ axes }: JogDocument, slot: number): api.TaughtBy {
    const effector = this.effector ? { effector: this.effector } : {};
    return { positions: axes.map(({ position }) => position), time_s: this.active ? this.#left : this.#context.time, slot, ...effector };
  }

  /** Toward a place. */
  move(to: Jog): void {
    if (!this.active) this.#left = this.#context.time;
    this.active = true;
    this.wanted = to;
    this.#ask({ to, anew: false });
  }

  /** Asks where the robot is: the cell, the effector or the slot is another one. */
  renew(): void {
    this.#ask({ to: null, anew: !this.active });
  }

  /** Back to where the program has it. */
  release(): void {
    if (!this.active) return;
    this.active = false;
    this.wanted = null;
    this.#ask({ to: null, anew: true });
  }

  /** The robot where it is, as seen from a slot; what is shown stays. */
  async look(station: string, slot: number): Promise<JogDocument | null> {
    // A move that is under way is a part of where it is.
    await this.#done;
    const { planned } = this.#context;
    if (!planned) return null;
    try {
      return await api.jog(planned, { ...this.#where(!this.active), seen_from: { station, slot } });
    } catch (error) {
      this.#context.failed(error);
      return null;
    }
  }

  #where(anew: boolean): api.JogParameters {
    const effector = this.effector ? { effector: this.effector } : {};
    const from = this.positions;
    if (anew || !from) return { time_s: this.#context.time, ...effector };
    return { time_s: this.#left, from, ...effector };
  }

  #ask(question: Question): void {
    // A move that waits is not lost to a mere look.
    if (question.to === null && this.#next?.to && !question.anew) return;
    this.#next = question;
    this.#current = false;
    if (!this.#busy) this.#done = this.#work();
  }

  async #work(): Promise<void> {
    this.#busy = true;
    while (this.#next) {
      const { to, anew } = this.#next;
      this.#next = null;
      const { planned, movable } = this.#context;
      if (!planned || !movable) break;
      try {
        const seen = this.station ? { seen_from: { station: this.station, slot: this.slot } } : {};
        this.document = await api.jog(planned, { ...this.#where(anew), ...seen, ...(to ? { to, stop_at_contact: this.stopAtContact } : {}) });
        this.#current = this.#next === null;
      } catch (error) {
        // A slot or an axis that is there no longer is no reason to stay without the robot.
        if (error instanceof ApiError && error.field?.startsWith('seen_from')) this.station = '';
        else if (error instanceof ApiError && error.field?.startsWith('from')) this.active = false;
        else if (error instanceof ApiError && error.field === 'effector') this.effector = '';
        else if (to || !(error instanceof ApiError)) this.#context.failed(error);
        // After a refused move the robot is where it was, which is checked again.
        if (error instanceof ApiError && (to || error.field)) this.#next ??= { to: null, anew: !this.active };
      }
    }
    this.wanted = null;
    this.#busy = false;
  }
}
