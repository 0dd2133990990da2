import { expect, test } from 'vitest';
import { withRecent, type RecentFile } from './recentFiles';

const file = (name: string, length = 10, kind: RecentFile['kind'] = 'mechanism'): RecentFile => ({ name, kind, text: 'x'.repeat(length), opened_ms: 1 });

test('the newest file is first, and each one is there once', () => {
  let list: RecentFile[] = [];
  for (const name of ['a', 'b', 'c', 'a']) list = withRecent(list, file(name));
  expect(list.map(({ name }) => name)).toEqual(['a', 'c', 'b']);
  expect(withRecent(list, file('a', 10, 'cell'))).toHaveLength(4);
  for (let i = 0; i < 20; i++) list = withRecent(list, file(`n${i}`));
  expect(list).toHaveLength(8);
  expect(list[0]!.name).toBe('n19');
});

test('large texts are not stored, and all together have a limit', () => {
  expect(withRecent([file('a')], file('big', 300_001)).map(({ name }) => name)).toEqual(['a']);
  let list: RecentFile[] = [];
  for (let i = 0; i < 6; i++) list = withRecent(list, file(`n${i}`, 300_000));
  expect(list.map(({ name }) => name)).toEqual(['n5', 'n4', 'n3']);
});
