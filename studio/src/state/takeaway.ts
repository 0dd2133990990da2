// Files that a person takes along.

import * as api from '../api/client';
import { FACTORS } from '../lib/figures';
import { decimate } from '../lib/decimate';
import { plotSvg } from '../lib/plotsvg';
import { SERIES } from '../lib/series';
import type { plots as Plots } from './plots';
import type { Studio } from './studio.svelte';

export function download(blob: Blob, name: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** The pose shown, as `jointplay forward --format json` writes it. */
export async function forwardDocument(studio: Studio): Promise<Blob> {
  const { model, solver, metric } = studio.document;
  if (!studio.pose) throw new Error('there is no pose yet');
  return api.forward(studio.pose.rods_m, api.modelChoice(model, solver, metric));
}

export async function seriesFile(studio: Studio, kind: 'csv' | 'parquet'): Promise<Blob> {
  const { motion, model, solver, metric } = studio.document;
  if (!motion) throw new Error('there is no motion to take series of');
  return api.studyFile(motion, api.modelChoice(model, solver, metric), kind);
}

/** Points of one line of a printed plot, at most. */
const POINTS = 1200;

export async function plotBlobs(shown: typeof Plots, kind: 'svg' | 'png', studio: Studio): Promise<{ name: string; blob: Blob }[]> {
  const made: { name: string; blob: Blob }[] = [];
  for (const [id, { plot, kind: what }] of shown) {
    if (kind === 'png') {
      const canvas = document.createElement('canvas');
      const source = plot.ctx.canvas;
      Object.assign(canvas, { width: source.width, height: source.height });
      const context = canvas.getContext('2d') as CanvasRenderingContext2D;
      context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--panel').trim();
      context.fillRect(0, 0, canvas.width, canvas.height);
      context.drawImage(source, 0, 0);
      const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, 'image/png'));
      if (blob) made.push({ name: `${id}.png`, blob });
      continue;
    }
    const columns = studio.study.of(what.quantity).filter((_, i) => plot.series[i + 1]?.show);
    const { min: from, max: to } = plot.scales['x'] as { min: number; max: number };
    const { min: low, max: high } = plot.scales['y'] as { min: number; max: number };
    const kept = decimate(columns.map(({ values }) => values), from, to + 1, POINTS / 8);
    const all = studio.study.of(what.quantity);
    const svg = plotSvg({
      title: `${what.title}, ${studio.document.model}`,
      x: { title: 'sample', range: [from, to] },
      y: { title: what.unit, range: [low, high] },
      series: columns.map((column) => ({
        name: column.symbol,
        colour: SERIES.light[all.indexOf(column) % 6] as string,
        dash: [[], [8, 4], [2, 3], [8, 3, 2, 3], [12, 4], [5, 2]][all.indexOf(column) % 6] as number[],
        points: kept.map((i) => [i, (column.values[i] as number) * FACTORS[what.unit]]),
      })),
    });
    made.push({ name: `${id}.svg`, blob: new Blob([svg], { type: 'image/svg+xml' }) });
  }
  return made;
}
