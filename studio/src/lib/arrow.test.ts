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

/** The same bytes as a stream of bytes, as responses are. */
const ofBytes = (bytes: Uint8Array, size: number) => {
  let at = 0;
  const source: UnderlyingByteSource = {
    type: 'bytes',
    pull(controller) {
      if (at >= bytes.length) {
        controller.close();
        controller.byobRequest?.respond(0);
      } else controller.enqueue(bytes.slice(at, (at += size)));
    },
  };
  return new ReadableStream(source);
};

/** A stream of several batches with one schema: that of the first one. */
function joined(tables: Uint8Array[]): Uint8Array {
  const heads = tables.map((one) => 8 + new DataView(one.buffer, one.byteOffset).getUint32(4, true));
  // The last eight bytes are the end of the stream.
  return new Uint8Array([...tables[0]!.slice(0, heads[0]), ...tables.flatMap((one, i) => [...one.slice(heads[i], -8)]), ...tables[0]!.slice(-8)]);
}

for (const size of [7, 64, 1 << 21])
  test(`batches of different lengths from pieces of ${size} bytes are read into the same memory`, async () => {
    const lengths = [10, 4, 90_000, 3];
    const value = (batch: number, i: number) => batch + i / 7;
    const tables = lengths.map((length, batch) => tableToIPC(tableFromArrays({ q_1: Float64Array.from({ length }, (_, i) => value(batch, i)) }), { format: 'stream' }) as Uint8Array);
    const { fields, batches } = await readArrow(ofBytes(joined(tables), size));
    expect(fields).toEqual(['q_1']);
    const found: number[][] = [];
    for await (const batch of batches) found.push(Array.from(batch.getChild('q_1')!.toArray() as Float64Array));
    expect(found).toEqual(lengths.map((length, batch) => Array.from({ length }, (_, i) => value(batch, i))));
  });

test('a stream of bytes that ends early is an error', async () => {
  const broken = async () => {
    const { batches } = await readArrow(ofBytes(bytes.slice(0, bytes.length - 40), 64));
    for await (const batch of batches) expect(batch.numRows).toBe(10);
  };
  await expect(broken()).rejects.toThrow('ended early');
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
