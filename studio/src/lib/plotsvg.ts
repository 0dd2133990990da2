// Plots as SVG for publications: black on white.

import { fixed } from './units';

export interface Drawing {
  title: string;
  x: { title: string; range: [number, number] };
  y: { title: string; range: [number, number] };
  series: { name: string; colour: string; dash: number[]; points: [number, number][] }[];
}

/** Dimensions of a plot [px]. */
export const SIZE = { width: 720, height: 360, left: 84, right: 16, top: 34, bottom: 48 };

/** Round tick values within a range, about `about` of them. */
export function ticks(low: number, high: number, about: number): number[] {
  const rough = (high - low) / about;
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((times) => times * power >= rough) as number);
  const found: number[] = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + step * 1e-9; i++) found.push(i * step);
  return found;
}

/** Plots in one figure, stacked vertically. */
export function figureSvg(drawings: Drawing[]): string {
  const { width } = SIZE;
  const height = SIZE.height * drawings.length;
  const placed = drawings.map((drawing, i) => `<g transform="translate(0 ${i * SIZE.height})">${plot(drawing)}</g>`);
  return (
    `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="sans-serif" font-size="12" fill="#222">` +
    `<style>.grid{stroke:#ddd;fill:none}</style><rect width="100%" height="100%" fill="#fff"/>${placed.join('')}</svg>\n`
  );
}

function plot({ title, x, y, series }: Drawing): string {
  const { width, height, left, right, top, bottom } = SIZE;
  const toX = (value: number) => left + ((value - x.range[0]) / (x.range[1] - x.range[0] || 1)) * (width - left - right);
  const toY = (value: number) => height - bottom - ((value - y.range[0]) / (y.range[1] - y.range[0] || 1)) * (height - top - bottom);
  const at = (value: number) => Number(value.toFixed(2));
  const parts: string[] = [];
  const xTicks = ticks(...x.range, 8);
  const yTicks = ticks(...y.range, 6);
  const decimals = (values: number[]) => {
    const step = Math.abs((values[1] ?? 1) - (values[0] ?? 0)) || 1;
    return Math.min(Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)), 9);
  };
  for (const value of xTicks) {
    parts.push(`<path class="grid" d="M${at(toX(value))} ${top}V${height - bottom}"/>`);
    parts.push(`<text x="${at(toX(value))}" y="${height - bottom + 17}" text-anchor="middle">${fixed(value, decimals(xTicks))}</text>`);
  }
  for (const value of yTicks) {
    parts.push(`<path class="grid" d="M${left} ${at(toY(value))}H${width - right}"/>`);
    parts.push(`<text x="${left - 8}" y="${at(toY(value) + 4)}" text-anchor="end">${fixed(value, decimals(yTicks))}</text>`);
  }
  parts.push(`<rect x="${left}" y="${top}" width="${width - left - right}" height="${height - top - bottom}" fill="none" stroke="#444"/>`);
  let along = left;
  for (const { name, colour, dash, points } of series) {
    const style = `fill="none" stroke="${colour}" stroke-width="1.5"${dash.length > 0 ? ` stroke-dasharray="${dash.join(' ')}"` : ''}`;
    if (points.length > 0) parts.push(`<path ${style} d="M${points.map(([a, b]) => `${at(toX(a))} ${at(toY(b))}`).join('L')}"/>`);
    parts.push(`<path ${style} d="M${along} ${top - 10}h24"/><text x="${along + 30}" y="${top - 6}">${escape(name)}</text>`);
    along += 44 + 7 * name.length;
  }
  parts.push(`<text x="${(left + width - right) / 2}" y="${height - 10}" text-anchor="middle">${escape(x.title)}</text>`);
  parts.push(`<text transform="translate(18 ${(top + height - bottom) / 2}) rotate(-90)" text-anchor="middle">${escape(y.title)}</text>`);
  parts.push(`<text x="${width - right}" y="${top - 6}" text-anchor="end" font-weight="600">${escape(title)}</text>`);
  return parts.join('');
}

function escape(text: string): string {
  return text.replace(/&/g, '&amp;').replace(/</g, '&lt;');
}
