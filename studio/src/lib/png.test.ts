import { crc32 } from 'node:zlib';
import { deflateSync } from 'node:zlib';
import { expect, test } from 'vitest';
import { onPaper, withResolution } from './png';

/** A chunk with the checksum of another implementation. */
function chunk(name: string, data: Uint8Array): Uint8Array {
  const body = Buffer.concat([Buffer.from(name, 'latin1'), data]);
  const [length, sum] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(data.length);
  sum.writeUInt32BE(crc32(body));
  return Buffer.concat([length, body, sum]);
}

const png = new Uint8Array(
  Buffer.concat([
    Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]),
    chunk('IHDR', new Uint8Array([0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0])),
    chunk('IDAT', deflateSync(new Uint8Array([0, 128]))),
    chunk('IEND', new Uint8Array()),
  ]),
);

test('the resolution is a chunk after the header', () => {
  const file = withResolution(png, 300);
  const data = Buffer.alloc(9);
  data.writeUInt32BE(11811, 0);
  data.writeUInt32BE(11811, 4);
  data[8] = 1;
  expect(Buffer.from(file.subarray(33, 54))).toEqual(Buffer.from(chunk('pHYs', data)));
  expect(Buffer.from(file.subarray(0, 33))).toEqual(Buffer.from(png.subarray(0, 33)));
  expect(Buffer.from(file.subarray(54))).toEqual(Buffer.from(png.subarray(33)));
});

test('the size on paper in pixels', () => {
  expect(onPaper(25.4, 2, 300)).toEqual({ width: 300, height: 150, dpi: 300 });
  expect(onPaper(170, 4 / 3, 600)).toEqual({ width: 4016, height: 3012, dpi: 600 });
});
