// Resolution of PNG files.

/** Bytes before the first chunk after the header: signature, and the chunk IHDR. */
const HEADER = 8 + 25;
const METRES_PER_INCH = 0.0254;

function crc(bytes: Uint8Array): number {
  let rest = 0xffffffff;
  for (const byte of bytes) {
    rest ^= byte;
    for (let bit = 0; bit < 8; bit++) rest = rest & 1 ? (rest >>> 1) ^ 0xedb88320 : rest >>> 1;
  }
  return ~rest >>> 0;
}

/** A PNG file with its resolution [pixels per inch], which programs use for its size on paper. */
export function withResolution(png: Uint8Array<ArrayBuffer>, dpi: number): Uint8Array<ArrayBuffer> {
  const perMetre = Math.round(dpi / METRES_PER_INCH);
  const chunk = new Uint8Array(21);
  const view = new DataView(chunk.buffer);
  view.setUint32(0, 9);
  chunk.set([0x70, 0x48, 0x59, 0x73], 4);
  view.setUint32(8, perMetre);
  view.setUint32(12, perMetre);
  // The unit is the metre.
  chunk[16] = 1;
  view.setUint32(17, crc(chunk.subarray(4, 17)));
  const file = new Uint8Array(png.length + chunk.length);
  file.set(png.subarray(0, HEADER));
  file.set(chunk, HEADER);
  file.set(png.subarray(HEADER), HEADER + chunk.length);
  return file;
}

/** Size of a picture. */
export interface PictureSize {
  /** Pixels. */
  width: number;
  height: number;
  dpi: number;
}

/** Resolution of a picture whose texts have the size of those on the screen. */
export const SCREEN_DPI = 96;
const MM_PER_INCH = 25.4;

/** Size in pixels of a picture of a width on paper. */
export function onPaper(width_mm: number, aspect: number, dpi: number): PictureSize {
  const width = Math.round((width_mm / MM_PER_INCH) * dpi);
  return { width, height: Math.round(width / aspect), dpi };
}
