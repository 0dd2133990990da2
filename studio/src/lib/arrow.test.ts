import { tableFromArrays, tableToIPC } from '@uwdata/flechette';
import { expect, test } from 'vitest';
import { readArrow } from './arrow';

/** Bytes handed out in pieces of so many, whatever the messages' bounds. */
function inPieces(bytes: Uint8Array, size: number, seen?: { cancelled: boolean }): ReadableStream<Uint8Array> {
  let at = 0;
  return new ReadableStream({
    pull(controller) {
      if (at >= bytes.length) return controller.close();
      controller.enqueue(bytes.slice(at, (at += size)));
    },
    cancel() {
      if (seen) seen.cancelled = true;
    },
  });
}

const table = tableFromArrays(
  { q_1: Float64Array.from({ length: 10 }, (_, i) => i / 3), azimuth: Float64Array.from({ length: 10 }, (_, i) => -i) },
);
const bytes = tableToIPC(table, { format: 'stream' }) as Uint8Array;

for (const size of [1, 7, 64, 1 << 20])
  test(`columns arrive in pieces of ${size} bytes`, async () => {
    const { fields, batches } = await readArrow(inPieces(bytes, size));
    expect(fields).toEqual(['q_1', 'azimuth']);
    const rows: number[] = [];
    for await (const batch of batches) rows.push(...(batch.getChild('q_1')!.toArray() as Float64Array));
    expect(rows).toEqual(Array.from({ length: 10 }, (_, i) => i / 3));
  });

test('a truncated stream is an error', async () => {
  const broken = async () => {
    const { batches } = await readArrow(inPieces(bytes.slice(0, bytes.length - 40), 64));
    for await (const batch of batches) expect(batch.numRows).toBe(10);
  };
  await expect(broken()).rejects.toThrow('ended early');
});

test('bytes in another format are an error', async () => {
  await expect(readArrow(inPieces(new TextEncoder().encode('{"title":"no"}'), 64))).rejects.toThrow('Arrow');
  await expect(readArrow(inPieces(new Uint8Array(), 64))).rejects.toThrow('ended early');
});

test('ending the iteration early cancels the stream', async () => {
  const seen = { cancelled: false };
  const { batches } = await readArrow(inPieces(new Uint8Array([...bytes, ...new Uint8Array(4096)]), 64, seen));
  for await (const _ of batches) break;
  expect(seen.cancelled).toBe(true);
});
