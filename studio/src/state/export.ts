// Files for export: poses, time series, figures.

import * as api from '../api/client';
import { FACTORS } from '../lib/figures';
import { decimate } from '../lib/decimate';
import { figureSvg } from '../lib/plotsvg';
import { SERIES } from '../lib/series';
import { sampleAt } from '../lib/times';
import type { plots as Plots } from './plots';
import type { Studio } from './studio.svelte';

export function download(blob: Blob, name: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** The current pose, as `jointplay forward --format json` writes it. */
export async function forwardDocument(studio: Studio, signal: AbortSignal): Promise<Blob> {
  const { model, solver, metric } = studio.document;
  if (!studio.pose) throw new Error('no pose has been computed yet');
  return api.forward(studio.pose.rods_m, api.modelChoice(model, solver, metric), signal);
}

export async function seriesFile(studio: Studio, kind: 'csv' | 'parquet', signal: AbortSignal): Promise<Blob> {
  const { motion, model, solver, metric } = studio.document;
  if (!motion) throw new Error('time series need a motion: select one first');
  return api.studyFile(motion, api.modelChoice(model, solver, metric), kind, signal);
}

/** Maximum number of points of one line of an exported plot. */
const MAX_POINTS = 1200;
/** Pixels of a PNG figure per unit of the SVG figure. */
const PIXEL_RATIO = 2;

/** The visible plots as one SVG figure, in their current ranges. */
export function figure(shown: typeof Plots, studio: Studio): Blob {
  const drawings = [...shown.values()].map(({ plot, kind }) => {
    const all = studio.study.columnsOf(kind.quantity);
    const columns = all.filter((_, i) => plot.series[i + 1]?.show);
    const { min: from, max: to } = plot.scales['x'] as { min: number; max: number };
    const { min: low, max: high } = plot.scales['y'] as { min: number; max: number };
    // Over time, or over the indices of samples.
    const { times, count } = studio.study;
    const x = (sample: number) => times?.[sample] ?? sample;
    const [first, end] = times ? [sampleAt(times, from), Math.min(sampleAt(times, to) + 2, count)] : [from, to + 1];
    const selected = decimate(columns.map(({ values }) => values), first, end, MAX_POINTS / 8, times ?? null);
    return {
      title: `${kind.title}, ${studio.document.model}`,
      x: { title: times ? 'time [s]' : 'sample', range: [from, to] as [number, number] },
      y: { title: kind.unit, range: [low, high] as [number, number] },
      series: columns.map((column) => ({
        name: column.symbol,
        colour: SERIES.light[all.indexOf(column) % 6] as string,
        dash: [[], [8, 4], [2, 3], [8, 3, 2, 3], [12, 4], [5, 2]][all.indexOf(column) % 6] as number[],
        points: selected.map((i) => [x(i), (column.values[i] as number) * FACTORS[kind.unit]] as [number, number]),
      })),
    };
  });
  return new Blob([figureSvg(drawings)], { type: 'image/svg+xml' });
}

/** A figure as PNG, in a resolution for printing. */
export async function rasterized(figure: Blob): Promise<Blob> {
  const image = new Image();
  image.src = URL.createObjectURL(figure);
  try {
    await image.decode();
  } finally {
    URL.revokeObjectURL(image.src);
  }
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width: image.width * PIXEL_RATIO, height: image.height * PIXEL_RATIO });
  canvas.getContext('2d')?.drawImage(image, 0, 0, canvas.width, canvas.height);
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, 'image/png'));
  if (!blob) throw new Error('this browser cannot render the figure');
  return blob;
}
