import { beforeEach, expect, test } from 'vitest';
import { readDrafts, removeDraft, removeOlderDraft, storeDraft, type Draft } from './draft';

const stored = new Map<string, string>();
beforeEach(() => {
  stored.clear();
  globalThis.localStorage = {
    getItem: (key: string) => stored.get(key) ?? null,
    setItem: (key: string, value: string) => void stored.set(key, value),
    removeItem: (key: string) => void stored.delete(key),
  } as unknown as Storage;
});

const draft = (version: string, program = 'HOME\n'): Draft => ({ cell: 'cell', program, points: { LP1: [[0, 0, 1]] }, version, stored_ms: 1 });

test('a draft belongs to one version of one file', () => {
  storeDraft('a', draft('v1'));
  expect(readDrafts('a', 'v1')).toEqual({ current: draft('v1'), older: null });
  expect(readDrafts('b', 'v1')).toEqual({ current: null, older: null });
  removeDraft('a');
  expect(readDrafts('a', 'v1')).toEqual({ current: null, older: null });
});

test('a draft of another version is not overwritten by new edits', () => {
  storeDraft('a', draft('v1', 'old'));
  expect(readDrafts('a', 'v2')).toEqual({ current: null, older: draft('v1', 'old') });
  storeDraft('a', draft('v2', 'new'));
  expect(readDrafts('a', 'v2')).toEqual({ current: draft('v2', 'new'), older: draft('v1', 'old') });
  removeOlderDraft('a');
  expect(readDrafts('a', 'v2')).toEqual({ current: draft('v2', 'new'), older: null });
});

test('invalid drafts are ignored', () => {
  for (const text of ['', 'null', '{}', '{"cell": 1}', '{"cell":"","program":"","version":"v1","points":null,"stored_ms":1}']) {
    stored.set('jointplay.studio.draft.a', text);
    expect(readDrafts('a', 'v1'), text).toEqual({ current: null, older: null });
  }
});
