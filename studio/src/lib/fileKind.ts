// Kinds of files that are opened.

import { KINDS, type RecentKind } from './recentFiles';

/** Kind of a file whose text declares `declared`; `null` for a kind that no view shows. The extension decides for a program whose first command is invalid: it opens with its errors. */
export function kindOfFile(name: string, declared: string): RecentKind | null {
  if (declared === 'unknown' && /\.program$/i.test(name)) return 'program';
  return KINDS.find((one) => one === declared) ?? null;
}
