// Files that were opened last, with their texts, stored in the browser.

import { load, save } from './settings';

export const KINDS = ['three_rods', 'mechanism', 'model', 'cell', 'program'] as const;
export type RecentKind = (typeof KINDS)[number];

export interface RecentFile {
  name: string;
  kind: RecentKind;
  text: string;
  /** Time of the last opening [ms since 1970]. */
  opened_ms: number;
}

const MOST = 8;
/** Largest text that is remembered, and of all together [characters]: browsers store about five million. */
const LONGEST = 300_000;
const LONGEST_TOGETHER = 1_000_000;

function isRecent(value: unknown): value is RecentFile {
  const { name, kind, text, opened_ms } = (value ?? {}) as Partial<RecentFile>;
  return typeof name === 'string' && typeof text === 'string' && text.length <= LONGEST && KINDS.includes(kind as RecentKind) && Number.isFinite(opened_ms);
}

export const recentFiles = (): RecentFile[] => load<RecentFile[]>('recent', [], (value) => Array.isArray(value) && value.length <= MOST && value.every(isRecent));

/** The list with one more file, the newest first; a file of the same name and kind is replaced. */
export function withRecent(list: readonly RecentFile[], file: RecentFile): RecentFile[] {
  const others = list.filter(({ name, kind }) => name !== file.name || kind !== file.kind);
  if (file.text.length > LONGEST) return others;
  const found: RecentFile[] = [];
  let length = 0;
  for (const one of [file, ...others].slice(0, MOST)) {
    length += one.text.length;
    if (length <= LONGEST_TOGETHER) found.push(one);
  }
  return found;
}

export function rememberFile(file: RecentFile): void {
  save('recent', withRecent(recentFiles(), file));
}

export function forgetFiles(): void {
  save('recent', []);
}
