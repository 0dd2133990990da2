// Arrow's streaming format as it arrives: cut into messages, each batch read as soon as it is whole.

import { tableFromIPC, type Table } from '@uwdata/flechette';

const CONTINUATION = 0xffff_ffff;
/** Field 3 of Arrow's `Message` table, `bodyLength`: its place in the table's list of offsets. */
const BODY_LENGTH = 4 + 2 * 3;

export interface Batches {
  metadata: Map<string, string>;
  /** Names of the columns. */
  fields: string[];
  batches: AsyncGenerator<Table>;
}

/** Reads a stream's schema, and then its batches one by one. */
export async function readArrow(stream: ReadableStream<Uint8Array>): Promise<Batches> {
  const messages = cut(stream);
  const first = await messages.next();
  const schemaMessage = first.value as Uint8Array;
  const { schema } = tableFromIPC([schemaMessage]);
  async function* batches() {
    for await (const message of messages) {
      const table = tableFromIPC([schemaMessage, message]);
      if (table.numRows > 0) yield table;
    }
  }
  return {
    metadata: schema.metadata ?? new Map(),
    fields: schema.fields.map(({ name }) => name),
    batches: batches(),
  };
}

/** The messages of a stream, each with its head. */
async function* cut(stream: ReadableStream<Uint8Array>): AsyncGenerator<Uint8Array> {
  const reader = stream.getReader();
  let held = new Uint8Array();
  let ended = false;
  async function hold(count: number): Promise<boolean> {
    const parts: Uint8Array[] = [held];
    let length = held.length;
    while (length < count && !ended) {
      const { value, done } = await reader.read();
      if (done) ended = true;
      else {
        parts.push(value);
        length += value.length;
      }
    }
    if (parts.length > 1) {
      held = new Uint8Array(length);
      let at = 0;
      for (const part of parts) {
        held.set(part, at);
        at += part.length;
      }
    }
    return length >= count;
  }
  try {
    while (await hold(8)) {
      const view = new DataView(held.buffer, held.byteOffset);
      if (view.getUint32(0, true) !== CONTINUATION) throw new Error('the samples are not in the Arrow streaming format');
      const head = view.getUint32(4, true);
      if (head === 0) return;
      if (!(await hold(8 + head))) break;
      const whole = 8 + head + bodyLength(held.subarray(8, 8 + head));
      if (!(await hold(whole))) break;
      // A copy, so that its columns begin where their numbers may.
      yield held.slice(0, whole);
      held = held.slice(whole);
    }
    throw new Error('the stream of samples ended early');
  } finally {
    // The reader left early: the server learns that nobody listens, and stops working.
    await reader.cancel().catch(() => undefined);
  }
}

function bodyLength(flatbuffer: Uint8Array): number {
  const view = new DataView(flatbuffer.buffer, flatbuffer.byteOffset);
  const table = view.getUint32(0, true);
  const offsets = table - view.getInt32(table, true);
  const known = view.getUint16(offsets, true);
  const at = BODY_LENGTH < known ? view.getUint16(offsets + BODY_LENGTH, true) : 0;
  return at === 0 ? 0 : Number(view.getBigInt64(table + at, true));
}
