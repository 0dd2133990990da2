// A drawing context that writes SVG: lines, dots and texts stay vectors.

export type TextContext = Pick<
  CanvasRenderingContext2D,
  'font' | 'textBaseline' | 'lineJoin' | 'lineWidth' | 'strokeStyle' | 'fillStyle' | 'measureText' | 'beginPath' | 'moveTo' | 'lineTo' | 'arc' | 'stroke' | 'fill' | 'strokeText' | 'fillText'
>;

const escape = (text: string) => text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/"/g, '&quot;');
const short = (value: number) => String(Number(value.toFixed(2)));

export class SvgContext implements TextContext {
  font = '400 12px sans-serif';
  textBaseline: CanvasTextBaseline = 'alphabetic';
  lineJoin: CanvasLineJoin = 'round';
  lineWidth = 1;
  strokeStyle: string | CanvasGradient | CanvasPattern = '#000';
  fillStyle: string | CanvasGradient | CanvasPattern = '#000';
  readonly #measure: (font: string, text: string) => TextMetrics;
  readonly #parts: string[] = [];
  #path = '';
  #circles: string[] = [];
  /** Outline of the text that is drawn next. */
  #halo: { text: string; x: number; y: number; colour: string; width: number } | null = null;

  constructor(measure: (font: string, text: string) => TextMetrics) {
    this.#measure = measure;
  }

  /** The elements in the order in which they were drawn. */
  get elements(): string {
    return this.#parts.join('\n');
  }

  measureText(text: string): TextMetrics {
    return this.#measure(this.font, text);
  }

  beginPath(): void {
    this.#path = '';
    this.#circles = [];
  }

  moveTo(x: number, y: number): void {
    this.#path += `M${short(x)} ${short(y)}`;
  }

  lineTo(x: number, y: number): void {
    this.#path += `L${short(x)} ${short(y)}`;
  }

  /** Whole circles only. */
  arc(x: number, y: number, radius: number): void {
    this.#circles.push(`<circle cx="${short(x)}" cy="${short(y)}" r="${short(radius)}"`);
  }

  #paint(style: string): void {
    if (this.#path) this.#parts.push(`<path d="${this.#path}" ${style}/>`);
    for (const circle of this.#circles) this.#parts.push(`${circle} ${style}/>`);
  }

  stroke(): void {
    this.#paint(`fill="none" stroke="${escape(String(this.strokeStyle))}" stroke-width="${short(this.lineWidth)}" stroke-linejoin="${this.lineJoin}"`);
  }

  fill(): void {
    this.#paint(`fill="${escape(String(this.fillStyle))}"`);
  }

  strokeText(text: string, x: number, y: number): void {
    this.#halo = { text, x, y, colour: String(this.strokeStyle), width: this.lineWidth };
  }

  fillText(text: string, x: number, y: number): void {
    const [weight, size] = this.font.split(' ') as [string, string];
    const halo = this.#halo;
    const outlined = halo && halo.text === text && halo.x === x && halo.y === y;
    const outline = outlined ? ` stroke="${escape(halo.colour)}" stroke-width="${short(halo.width)}" stroke-linejoin="round" paint-order="stroke"` : '';
    // Programs differ in their support of baselines: the middle of a text is about 0.35 of its size above the baseline.
    const down = this.textBaseline === 'middle' ? 0.35 * Number.parseFloat(size) : 0;
    if (text.trim() !== '') this.#parts.push(`<text x="${short(x)}" y="${short(y + down)}" font-family="Helvetica, Arial, sans-serif" font-size="${Number.parseFloat(size)}" font-weight="${weight}" fill="${escape(String(this.fillStyle))}"${outline} xml:space="preserve">${escape(text)}</text>`);
    this.#halo = null;
  }
}

/** A picture as SVG: an embedded raster image below vectors, in the size of the image on paper. */
export function pictureSvg(size: { width: number; height: number; dpi: number; scale: number }, image: string, elements: string): string {
  const { width, height, dpi, scale } = size;
  const mm = (pixels: number) => short((pixels / dpi) * 25.4);
  const [w, h] = [width / scale, height / scale].map(short) as [string, string];
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${mm(width)}mm" height="${mm(height)}mm" viewBox="0 0 ${w} ${h}">\n<image width="${w}" height="${h}" preserveAspectRatio="none" href="${image}"/>\n${elements}\n</svg>\n`;
}
