import { expect, test } from 'vitest';
import { textOf } from './textFile';

const file = (...bytes: number[]) => new File([Uint8Array.from(bytes)], 'mine.toml');

test('the text of a file is read', async () => {
  expect(await textOf(file(0x6d, 0xc3, 0xbc, 0x0a))).toBe('mü\n');
  // A byte order mark is not part of the text.
  expect(await textOf(file(0xef, 0xbb, 0xbf, 0x61))).toBe('a');
  expect(await textOf(file())).toBe('');
});

test('a file in another encoding is refused, and not changed', async () => {
  // "mü" in Latin-1, the start of a PNG picture, and text in UTF-16.
  for (const bytes of [[0x6d, 0xfc], [0x89, 0x50, 0x4e, 0x47], [0x61, 0x00]]) await expect(textOf(file(...bytes))).rejects.toThrow('mine.toml is not a text file in UTF-8.');
});

test('a file that cannot be read is reported as such', async () => {
  const lost = { name: 'lost.toml', arrayBuffer: () => Promise.reject(new DOMException('deleted', 'NotFoundError')) } as unknown as File;
  await expect(textOf(lost)).rejects.toThrow('deleted');
});
