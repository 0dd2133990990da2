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

/** Largest edge of a picture [px], which every WebGL 2 graphics card reaches in practice, and its largest area. */
export const PICTURE_PIXELS = { least: 16, most: 16384, area: 64e6 } as const;
/** Resolutions of pictures [pixels per inch]. */
export const PICTURE_DPI = { least: 10, most: 2400 } as const;

/** Why pictures cannot have a size as typed by the user; `null` for a valid one. */
export function pictureSizeProblem(size: Record<keyof PictureSize, unknown>): string | null {
  const { least, most, area } = PICTURE_PIXELS;
  for (const [key, name, low, high] of [
    ['width', 'width', least, most],
    ['height', 'height', least, most],
    ['dpi', 'resolution', PICTURE_DPI.least, PICTURE_DPI.most],
  ] as const) {
    const value = size[key];
    const unit = key === 'dpi' ? 'dpi' : 'pixels';
    if (typeof value !== 'number' || !Number.isFinite(value)) return `The ${name} must be a number from ${low} to ${high} ${unit}.`;
    if (value < low || value > high) return `The ${name} must be from ${low} to ${high} ${unit}, got ${value}.`;
    if (key !== 'dpi' && !Number.isInteger(value)) return `The ${name} must be a whole number of pixels, got ${value}.`;
  }
  const pixels = (size.width as number) * (size.height as number);
  return pixels > area ? `A picture has at most ${area / 1e6} million pixels, got ${(pixels / 1e6).toFixed(1)} million.` : null;
}
