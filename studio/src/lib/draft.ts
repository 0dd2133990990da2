// Unsaved texts of a cell, stored in the browser until they are saved or discarded.

import { load, remove, save } from './settings';

export interface Draft {
  cell: string;
  program: string;
  /** Taught points of planes with too few points [m], by station. */
  points: Record<string, number[][]>;
  /** Version of the files that the draft is based on. */
  version: string;
  /** Time of storage [ms since 1970]. */
  stored_ms: number;
}

const key = (identity: string) => `draft.${identity}`;
/** Key of a draft of another version of the files, which waits for a decision. */
const olderKey = (identity: string) => `draft.${identity}.older`;

function valid(value: unknown): boolean {
  const draft = value as Partial<Draft> | null;
  const texts = [draft?.cell, draft?.program, draft?.version];
  return texts.every((text) => typeof text === 'string') && typeof draft!.points === 'object' && draft!.points !== null && Number.isFinite(draft!.stored_ms);
}

/** The drafts of a file: that of its current version, and that of another version. */
export function readDrafts(identity: string, version: string): { current: Draft | null; older: Draft | null } {
  const found = load<Draft | null>(key(identity), null, valid);
  if (found !== null && found.version !== version) {
    save(olderKey(identity), found);
    remove(key(identity));
  }
  return {
    current: found?.version === version ? found : null,
    older: load<Draft | null>(olderKey(identity), null, valid),
  };
}

export function storeDraft(identity: string, draft: Draft): void {
  save(key(identity), draft);
}

export function removeDraft(identity: string): void {
  remove(key(identity));
}

export function removeOlderDraft(identity: string): void {
  remove(olderKey(identity));
}
