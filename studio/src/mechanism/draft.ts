// Unsaved text of a mechanism, stored in the browser until it is saved or discarded.

import { load, remove, save } from '../lib/settings';

export interface MechanismDraft {
  name: string;
  text: string;
  /** The text as it was opened or saved. */
  saved: string;
  ofServer: boolean;
  /** Time of storage [ms since 1970]. */
  stored_ms: number;
}

const KEY = 'mechanism.draft';
/** Largest text that is stored [characters]: browsers store about five million for all drafts and files. */
const LONGEST = 1_000_000;

function isDraft(value: unknown): boolean {
  const { name, text, saved, ofServer, stored_ms } = (value ?? {}) as Partial<MechanismDraft>;
  return [name, text, saved].every((one) => typeof one === 'string') && typeof ofServer === 'boolean' && Number.isFinite(stored_ms);
}

export const readMechanismDraft = (): MechanismDraft | null => load<MechanismDraft | null>(KEY, null, (value) => value === null || isDraft(value));

export function storeMechanismDraft(draft: MechanismDraft): void {
  if (draft.text.length + draft.saved.length <= LONGEST) save(KEY, draft);
}

export const removeMechanismDraft = (): void => remove(KEY);
