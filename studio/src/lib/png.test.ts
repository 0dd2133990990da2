import { crc32 } from 'node:zlib';
import { deflateSync } from 'node:zlib';
import { expect, test } from 'vitest';
import { onPaper, pictureSizeProblem, withResolution } from './png';

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

test.each([
  [{ width: 1200, height: 800, dpi: 300 }, null],
  [{ width: 16, height: 16384, dpi: 10 }, null],
  [{ width: null, height: 800, dpi: 300 }, 'width must be a number'],
  [{ width: 1200, height: Infinity, dpi: 300 }, 'height must be a number'],
  [{ width: 1200, height: 800, dpi: NaN }, 'resolution must be a number'],
  [{ width: '1200', height: 800, dpi: 300 }, 'width must be a number'],
  [{ width: 8, height: 800, dpi: 300 }, 'from 16 to 16384 pixels, got 8'],
  [{ width: 1200, height: -800, dpi: 300 }, 'height must be from'],
  [{ width: 1200, height: 800, dpi: 0 }, 'from 10 to 2400 dpi, got 0'],
  [{ width: 1200.5, height: 800, dpi: 300 }, 'whole number'],
  [{ width: 16384, height: 16384, dpi: 300 }, '64 million pixels, got 268.4 million'],
])('the size %o of a picture is checked', (size, problem) => {
  const found = pictureSizeProblem(size);
  if (problem === null) expect(found).toBeNull();
  else expect(found).toContain(problem);
});
