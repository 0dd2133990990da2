// Changes of entries of the cell file, which the server writes into its text, one after another.

import * as api from '../api/client';
import { ApiError, ConnectionError, type CellTexts, type StationDocument } from '../api/client';
import type { CameraPose } from '../lib/hashParts';
import type { Part } from '../lib/parts';
import { CONTACT_FIELD, contactNoteLine, type ContactRequest } from './contactNote';
import type { JogController } from './jogController.svelte';
import { TextChanges } from './textChanges.svelte';

/** The part of the session that changes of entries depend on. */
export interface CellChangesContext {
  texts: CellTexts;
  notice: string | null;
  readonly jog: Pick<JogController, 'positions' | 'queryFrom'>;
  readonly stations: readonly StationDocument[];
  /** The 3D view, while there is one, and its camera when it was last closed. */
  readonly view: { readonly cameraPose: CameraPose } | null;
  readonly camera: CameraPose | null;
  /** Adds an edit in progress to the undo history. */
  completeEdit(): void;
  /** Completes an edit: adds it to the undo history and plans it. */
  commit(): void;
  /** Shows the stations as they were planned. */
  forgetChanged(): void;
  readonly selection: { part: Part | null };
  showLine(line: number, kind: 'program' | 'cell'): void;
  failed(error: unknown): void;
}

export class CellChanges {
  readonly #context: CellChangesContext;
  readonly #pending = new TextChanges();
  /** The pending request to teach a station in contact. */
  #contact = $state.raw<ContactRequest | null>(null);
  /** The pending request to teach in contact, while text and pose are those that were checked. */
  contact = $derived.by(() => {
    const { jog, texts } = this.#context;
    const request = this.#contact;
    if (!request || request.cell !== texts.cell) return null;
    return jog.positions?.every((value, k) => Math.abs(value - request.positions[k]!) < 1e-9) ? request : null;
  });

  constructor(context: CellChangesContext) {
    this.#context = context;
  }

  /** Number of changes whose text has not arrived yet. */
  get pending(): number {
    return this.#pending.pending;
  }

  /** Resolves when all changes have arrived or were cancelled. */
  get finished(): Promise<void> {
    return this.#pending.finished;
  }

  /** Cancels all pending changes; returns whether there were any. */
  cancel(): boolean {
    return this.#pending.cancel();
  }

  /** Rejects the pending request to teach in contact. */
  cancelContact(): void {
    this.#contact = null;
  }

  /**
   * Writes new values of a station into the text of the cell, after all pending changes.
   *
   * A contact in the pose `taught_by` requires a confirmation. `taken` is called when the text has arrived, in the same undo step.
   */
  setStation(station: string, change: api.StationChange, taken: () => void = () => undefined): Promise<void> {
    this.#contact = null;
    this.#context.completeEdit();
    return this.#pending.add((signal) => this.#setStation(station, change, taken, signal));
  }

  /** Adds, duplicates or removes an entry of the cell file, and selects the new one. */
  changeEntry(change: api.EntryChange): Promise<void> {
    const context = this.#context;
    context.completeEdit();
    return this.#pending.add(async (signal) => {
      try {
        const { name } = await this.#write((cell) => api.changeEntry(cell, change, signal));
        context.selection.part = name === null ? null : { kind: change.list, name };
        context.commit();
      } catch (error) {
        context.forgetChanged();
        if (error instanceof ConnectionError) context.notice = 'The cell was not changed: the server does not respond.';
        else context.failed(error);
      }
    });
  }

  /** Adds a station where the wafer of the effector is. */
  async addStation(): Promise<void> {
    const { stations, jog } = this.#context;
    const [station] = stations;
    const here = station && (await jog.queryFrom(station.name, 1))?.from_slot?.station_if_here;
    await this.changeEntry({ action: 'add', list: 'station', ...(here ? { position_m: here.position_m, heading_rad: here.heading_rad } : {}) });
  }

  /** Adds a body where the camera looks. */
  addBody(): Promise<void> {
    const { view, camera } = this.#context;
    const { target } = view?.cameraPose ?? camera ?? { target: [0, 0, 0] };
    return this.changeEntry({ action: 'add', list: 'body', position_m: target.map((m) => Math.round(m * 1000) / 1000) });
  }

  /** Replaces the text of the cell by that of an answer. If the text was edited in the meantime, the change is applied to the new text. */
  async #write<T extends { cell: string }>(change: (cell: string) => Promise<T>): Promise<T> {
    const context = this.#context;
    for (;;) {
      const before = context.texts.cell;
      const answer = await change(before);
      if (context.texts.cell !== before) continue;
      context.texts = { ...context.texts, cell: answer.cell };
      return answer;
    }
  }

  async #setStation(station: string, change: api.StationChange, taken: () => void, signal: AbortSignal): Promise<void> {
    const context = this.#context;
    try {
      const { cell, contacts } = await this.#write(async (before) => {
        const answer = await api.setStation(before, station, change, signal);
        // The comment of an earlier point is preserved.
        const { taught_by, ...values } = change;
        return taught_by && answer.contacts.length === 0 && !change.position_m ? { ...answer, cell: (await api.setStation(before, station, values, signal)).cell } : answer;
      });
      taken();
      context.commit();
      if (contacts.length > 0) context.showLine(contactNoteLine(cell, station), 'cell');
    } catch (error) {
      context.forgetChanged();
      const by = change.taught_by;
      if (by && error instanceof ApiError && error.field === CONTACT_FIELD)
        this.#contact = {
          station,
          message: error.message,
          cell: context.texts.cell,
          positions: by.positions,
          confirm: () => {
            this.#contact = null;
            void this.setStation(station, { ...change, taught_by: { ...by, confirm_contact: true } }, taken);
          },
        };
      else if (error instanceof ConnectionError) context.notice = `${station} was not changed: the server does not respond.`;
      else context.failed(error);
    }
  }
}
