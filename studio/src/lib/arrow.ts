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

/** Reads the schema of a stream, then its batches one by one; each is valid until the next one. */
export async function readArrow(stream: ReadableStream<Uint8Array>): Promise<Batches> {
  const messages = splitMessages(stream);
  const first = await messages.next();
  const schemaMessage = (first.value as Uint8Array).slice();
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

/** Bytes that are read from a stream at once. */
const PIECE = 1 << 20;

/** The pieces of a stream one by one; each is valid until the next one is read. */
interface Pieces {
  next(): Promise<Uint8Array | undefined>;
  cancel(): Promise<void>;
}

/** Reads a stream; one of bytes, such as a response, into the same memory again and again. */
function pieces(stream: ReadableStream<Uint8Array>): Pieces {
  let memory = new ArrayBuffer(PIECE);
  try {
    const reader = stream.getReader({ mode: 'byob' });
    return {
      async next() {
        const { value } = await reader.read(new Uint8Array(memory));
        if (!value?.length) return undefined;
        memory = value.buffer;
        return value;
      },
      cancel: () => reader.cancel(),
    };
  } catch {
    const reader = stream.getReader();
    return { next: async () => (await reader.read()).value, cancel: () => reader.cancel() };
  }
}

/** Splits a stream into messages, each with its header and valid until the next one. */
async function* splitMessages(stream: ReadableStream<Uint8Array>): AsyncGenerator<Uint8Array> {
  const source = pieces(stream);
  let piece: Uint8Array = new Uint8Array();
  let memory = new Uint8Array();
  /** Fills an array from a position on; returns whether there was enough. Each byte is copied once. */
  async function fill(target: Uint8Array, from = 0): Promise<boolean> {
    for (let at = from; at < target.length; ) {
      if (piece.length === 0) {
        const next = await source.next();
        if (!next) return false;
        piece = next;
      }
      const taken = piece.subarray(0, target.length - at);
      target.set(taken, at);
      piece = piece.subarray(taken.length);
      at += taken.length;
    }
    return true;
  }
  try {
    for (const prefix = new Uint8Array(8); await fill(prefix); ) {
      const view = new DataView(prefix.buffer);
      if (view.getUint32(0, true) !== CONTINUATION) throw new Error('the samples are not in the Arrow streaming format');
      const head = view.getUint32(4, true);
      if (head === 0) return;
      const header = new Uint8Array(8 + head);
      header.set(prefix);
      if (!(await fill(header, 8))) break;
      const length = header.length + bodyLength(header.subarray(8));
      if (memory.length < length) memory = new Uint8Array(length);
      const message = memory.subarray(0, length);
      message.set(header);
      if (!(await fill(message, header.length))) break;
      yield message;
    }
    throw new Error('the stream of samples ended early');
  } finally {
    // If reading ended early, this notifies the server, which stops the computation.
    await source.cancel().catch(() => undefined);
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
