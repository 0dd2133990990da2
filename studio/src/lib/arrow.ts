// Reader of Arrow streams: each batch is available as soon as it has arrived completely.

import { tableFromIPC, type Table } from '@uwdata/flechette';

const CONTINUATION = 0xffff_ffff;
/** Field 3 of Arrow's `Message` table, `bodyLength`: its position in the list of offsets of the table. */
const BODY_LENGTH = 4 + 2 * 3;

export interface Batches {
  metadata: Map<string, string>;
  /** Names of the columns. */
  fields: string[];
  batches: AsyncGenerator<Table>;
}

/** Reads the schema of a stream, then its batches one by one. */
export async function readArrow(stream: ReadableStream<Uint8Array>): Promise<Batches> {
  const messages = splitMessages(stream);
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

/** Splits a stream into messages, each with its header. */
async function* splitMessages(stream: ReadableStream<Uint8Array>): AsyncGenerator<Uint8Array> {
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
      // A copy, for the alignment of its columns.
      yield held.slice(0, whole);
      held = held.slice(whole);
    }
    throw new Error('the stream of samples ended early');
  } finally {
    // If reading ended early, this notifies the server, which stops the computation.
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
