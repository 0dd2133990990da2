// Unsaved texts, stored in the browser until they are saved or discarded.

import { load, remove, save } from './settings';

/** Largest draft that is stored [characters]: browsers store about five million for all drafts and files. */
const LONGEST = 1_500_000;

interface Stored {
  /** Time of storage [ms since 1970]. */
  stored_ms: number;
}

/** The unsaved text of one file. */
export interface TextDraft extends Stored {
  name: string;
  text: string;
  /** The text as it was opened or saved. */
  saved: string;
  /** Whether it is that of the file of the server. */
  ofServer: boolean;
}

/** The unsaved texts of a cell. */
export interface CellDraft extends Stored {
  cell: string;
  program: string;
  /** Taught points of planes with too few points [m], by station. */
  points: Record<string, number[][]>;
  /** Version of the files that the draft is based on. */
  version: string;
}

/** The draft under one key, and that of an earlier visit, which waits for a decision. */
export class DraftStore<T extends Stored> {
  readonly #key: string;
  readonly #isDraft: (value: Partial<T>) => boolean;
  /** The draft that this page stored or took up last: another page of the browser may have stored its own since then. */
  #own: string | null = null;

  private constructor(key: string, isDraft: (value: Partial<T>) => boolean) {
    this.#key = `draft.${key}`;
    this.#isDraft = isDraft;
  }

  /** The draft of a robot or a mechanism: one for all files of a kind. */
  static ofText(kind: 'robot' | 'mechanism'): DraftStore<TextDraft> {
    return new DraftStore<TextDraft>(kind, ({ name, text, saved, ofServer }) => [name, text, saved].every(isText) && typeof ofServer === 'boolean');
  }

  /** The draft of a cell: one for each cell file of the server. */
  static ofCell(identity: string): DraftStore<CellDraft> {
    return new DraftStore<CellDraft>(identity, ({ cell, program, version, points }) => [cell, program, version].every(isText) && typeof points === 'object' && points !== null);
  }

  get #earlierKey(): string {
    return `${this.#key}.older`;
  }

  #load(key: string): T | null {
    return load<T | null>(key, null, (value) => {
      const draft = value as Partial<T> | null;
      return typeof draft === 'object' && draft !== null && Number.isFinite(draft.stored_ms) && this.#isDraft(draft);
    });
  }

  get current(): T | null {
    return this.#load(this.#key);
  }

  /** The draft of an earlier visit. */
  get earlier(): T | null {
    return this.#load(this.#earlierKey);
  }

  /** The current draft, which this page continues. */
  takeUp(): T | null {
    const { current } = this;
    this.#own = JSON.stringify(current);
    return current;
  }

  store(draft: T): void {
    const stored = JSON.stringify(draft);
    if (stored.length > LONGEST) return;
    save(this.#key, draft);
    this.#own = stored;
  }

  /** Removes the draft of this page; that of another page remains. */
  remove(): void {
    if (JSON.stringify(this.current) === this.#own) remove(this.#key);
  }

  removeEarlier(): void {
    remove(this.#earlierKey);
  }

  /** The current draft is from now on that of an earlier visit: new edits do not replace it. */
  postpone(): void {
    const { current } = this;
    if (current === null) return;
    save(this.#earlierKey, current);
    remove(this.#key);
  }
}

const isText = (value: unknown) => typeof value === 'string';
