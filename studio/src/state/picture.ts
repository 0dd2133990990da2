// Pictures of the 3D views as files.

import { withResolution } from '../lib/png';
import { pictureSvg, SvgContext, type TextContext } from '../lib/svgContext';
import type { Picture } from '../scene/picture';
import { pictureSettings } from './pictureSettings.svelte';

/** A view that pictures with vectors can be made of. */
export interface VectorView extends Pick<PicturedView, 'viewSize'> {
  renderPicture(canvas: HTMLCanvasElement, picture: Picture, smooth: boolean, vectors: TextContext): boolean;
}

/** A view that pictures can be made of. */
export interface PicturedView {
  /** Size of the view on the page [px]. */
  readonly viewSize: { width: number; height: number };
  /** Renders the view for export; returns whether it has a scene. */
  renderPicture(canvas: HTMLCanvasElement, picture: Picture, smooth?: boolean): boolean;
}

/** The view as PNG in the size that the user chose, without handles, with a note. */
export async function pictureFile(view: PicturedView, note: string): Promise<Blob> {
  const { dpi, ...size } = pictureSettings.of(view.viewSize);
  const { transparent, labels } = pictureSettings.value;
  const canvas = document.createElement('canvas');
  view.renderPicture(canvas, { ...size, transparent, labels, note });
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, 'image/png'));
  if (!blob) throw new Error('this browser cannot save a picture of this size');
  return new Blob([withResolution(new Uint8Array(await blob.arrayBuffer()), dpi)], { type: 'image/png' });
}

/** The view as SVG: the scene as an embedded PNG, and axes, labels and note as vectors. */
export async function pictureVectors(view: VectorView, note: string): Promise<Blob> {
  const size = pictureSettings.of(view.viewSize);
  const { transparent, labels } = pictureSettings.value;
  const canvas = document.createElement('canvas');
  const measuring = document.createElement('canvas').getContext('2d');
  if (!measuring) throw new Error('this browser cannot measure texts');
  const vectors = new SvgContext((font, text) => {
    measuring.font = font;
    return measuring.measureText(text);
  });
  view.renderPicture(canvas, { ...size, transparent, labels, note }, true, vectors);
  return new Blob([pictureSvg(size, canvas.toDataURL('image/png'), vectors.elements)], { type: 'image/svg+xml' });
}
