import { beforeEach, expect, test } from 'vitest';
import { DraftStore, type CellDraft, type TextDraft } from './draft';

const stored = new Map<string, string>();
beforeEach(() => {
  stored.clear();
  globalThis.localStorage = {
    getItem: (key: string) => stored.get(key) ?? null,
    setItem: (key: string, value: string) => void stored.set(key, value),
    removeItem: (key: string) => void stored.delete(key),
  } as unknown as Storage;
});

const cell = (program = 'HOME\n'): CellDraft => ({ cell: 'cell', program, points: { LP1: [[0, 0, 1]] }, version: 'v1', stored_ms: 1 });
const text = (name: string, length = 4): TextDraft => ({ name, text: 'x'.repeat(length), saved: '', ofServer: true, stored_ms: 1 });

test('a draft belongs to one cell file, or to one kind of files', () => {
  const store = DraftStore.ofCell('a');
  store.store(cell());
  expect(store.current).toEqual(cell());
  expect(DraftStore.ofCell('b').current).toBeNull();
  const robots = DraftStore.ofText('robot');
  robots.store(text('bench.toml'));
  expect(robots.current).toEqual(text('bench.toml'));
  expect(DraftStore.ofText('mechanism').current).toBeNull();
  store.remove();
  expect(store.current).toBeNull();
  expect(robots.current).toEqual(text('bench.toml'));
});

/** Before, a page that had saved its file removed the unsaved text of another page. */
test('a page removes its own draft only', () => {
  const [one, other] = [DraftStore.ofCell('a'), DraftStore.ofCell('a')];
  one.store(cell('HOME\n# one\n'));
  other.remove();
  expect(one.current?.program).toBe('HOME\n# one\n');
  other.store(cell('HOME\n# other\n'));
  one.remove();
  expect(other.current?.program).toBe('HOME\n# other\n');
  other.remove();
  expect(other.current).toBeNull();
  // A draft of an earlier visit that a page continues is its own.
  one.store(cell());
  const later = DraftStore.ofCell('a');
  expect(later.takeUp()).toEqual(cell());
  later.remove();
  expect(later.current).toBeNull();
});

test('a draft of an earlier visit is not overwritten by new edits', () => {
  for (const store of [DraftStore.ofText('robot'), DraftStore.ofText('mechanism')]) {
    store.store(text('first'));
    store.postpone();
    expect([store.current, store.earlier]).toEqual([null, text('first')]);
    // Without a new draft, the earlier one remains.
    store.postpone();
    store.store(text('second'));
    expect([store.current, store.earlier]).toEqual([text('second'), text('first')]);
    store.removeEarlier();
    expect([store.current, store.earlier]).toEqual([text('second'), null]);
  }
});

test('texts that would fill the storage of the browser are not stored', () => {
  const store = DraftStore.ofText('mechanism');
  store.store(text('long', 1_400_000));
  expect(store.current?.name).toBe('long');
  store.store(text('longer', 2_000_000));
  expect(store.current?.name).toBe('long');
});

test('invalid drafts are ignored', () => {
  for (const value of ['', 'null', '{}', '[]', '1', '{"cell": 1}', '{"cell":"","program":"","version":"v1","points":null,"stored_ms":1}', '{"name":"a","text":"","saved":"","ofServer":1,"stored_ms":1}']) {
    stored.set('jointplay.studio.draft.a', value);
    stored.set('jointplay.studio.draft.robot', value);
    expect(DraftStore.ofCell('a').current, value).toBeNull();
    expect(DraftStore.ofText('robot').current, value).toBeNull();
  }
});
