// The unsaved text of a robot or a mechanism: stored in the browser, and offered at the next visit.

import { DraftStore, type TextDraft } from '../lib/draft';

/** The shown text, with what a draft needs. */
type ShownText = Omit<TextDraft, 'stored_ms'>;

export class TextDrafts {
  /** Unsaved text of an earlier visit. */
  offered = $state.raw<TextDraft | null>(null);
  readonly #store: DraftStore<TextDraft>;
  readonly #shown: () => ShownText | null;
  /** Whether the stored draft is that of this page. */
  #hasStored = false;

  /** `shown`: the shown text; `null` until it is loaded. */
  constructor(kind: 'robot' | 'mechanism', shown: () => ShownText | null) {
    this.#store = DraftStore.ofText(kind);
    this.#shown = shown;
    for (const event of ['beforeunload', 'pagehide']) window.addEventListener(event, () => this.store());
  }

  /** Offers the draft of an earlier visit, unless it is the shown text. */
  offer(): void {
    if (this.#hasStored) return;
    this.#store.postpone();
    const { earlier } = this.#store;
    this.offered = earlier?.text === this.#shown()?.text ? null : earlier;
  }

  /** Stores the shown text if it is unsaved. */
  store(): void {
    const shown = this.#shown();
    if (!shown) return;
    const unsaved = shown.text !== shown.saved;
    if (unsaved) this.#store.store({ ...shown, stored_ms: Date.now() });
    // The draft of an earlier visit remains until it is restored or discarded.
    else if (this.#hasStored) this.#store.remove();
    this.#hasStored = unsaved;
  }

  /** The offered draft, which the caller shows; it is no longer offered. */
  take(): TextDraft | null {
    const { offered } = this;
    this.discard();
    return offered;
  }

  /** Removes the offered draft. */
  discard(): void {
    this.offered = null;
    this.#store.removeEarlier();
  }
}
