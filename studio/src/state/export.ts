// Files for export: poses, time series, figures.

import * as api from '../api/client';
import { figureSvg } from '../lib/plotsvg';
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
  return api.forward(studio.file.source, studio.pose.rods_m, api.modelChoice(model, solver, metric), signal);
}

export async function seriesFile(studio: Studio, kind: 'csv' | 'parquet', signal: AbortSignal): Promise<Blob> {
  const { motion, model, solver, metric } = studio.document;
  if (!motion) throw new Error('time series need a motion: select one first');
  return api.studyFile(studio.file.source, motion, api.modelChoice(model, solver, metric), kind, signal);
}

/** Pixels of a PNG figure per unit of the SVG figure. */
const PIXEL_RATIO = 2;

/** The visible plots as one SVG figure, in their current ranges. */
export function figure(shown: typeof Plots): Blob {
  return new Blob([figureSvg([...shown.values()].map((draw) => draw()))], { type: 'image/svg+xml' });
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
