// Panes: parts of a view with a picture of their own. All of them have one canvas and one camera, and each has a stage.

import { Vector2, type Camera, type WebGLRenderer } from 'three';
import type { Box } from '../lib/labelLayout';
import type { TextContext } from '../lib/svgContext';
import type { Overlay } from './labels';
import type { Occlusion } from './occlusion';
import type { Stage } from './stage';

export interface Pane {
  stage: Stage;
  /** Place in the view [px]. */
  box: Box;
  overlay: Overlay;
  /** Name in pictures for export; the page shows it as an element. */
  title?: string;
}

interface Size {
  width: number;
  height: number;
}

/** Arrangement of two panes: next to each other, or one above the other. */
export type Arrangement = 'row' | 'column';

/** Views of a smaller width have one pane above the other [px]. */
const NARROW = 600;

/** Pixels of the canvas per pixel of the view from which occlusion has half of the resolution. */
const FINE = 1.5;

/** Space of the title at the upper left of a pane [px]. */
const TITLE = { left: 14, baseline: 24 } as const;

export const widthOf = ({ left, right }: Box): number => right - left;
export const heightOf = ({ top, bottom }: Box): number => bottom - top;
export const wholeOf = ({ width, height }: Size): Box => ({ left: 0, top: 0, right: width, bottom: height });

/** Arrangement of the panes of a view on the page. */
export const arrangementOf = (width: number): Arrangement => (width < NARROW ? 'column' : 'row');

const half = ({ width, height }: Size, arrangement: Arrangement): Size => (arrangement === 'row' ? { width: width / 2, height } : { width, height: height / 2 });

/** Arrangement of the panes of a picture: the one whose panes are nearest in shape to those of the view, or else that of the view. */
export function pictureArrangement(picture: Size, view: Size): Arrangement {
  const shown = arrangementOf(view.width);
  const slope = ({ width, height }: Size) => Math.log(width / height);
  const deviation = (arrangement: Arrangement) => Math.abs(slope(half(picture, arrangement)) - slope(half(view, shown)));
  const other = shown === 'row' ? 'column' : 'row';
  return deviation(other) < deviation(shown) - 1e-6 ? other : shown;
}

/** The two panes of a view. */
export function split(size: Size, arrangement: Arrangement): [Box, Box] {
  const { width, height } = half(size, arrangement);
  const first = { left: 0, top: 0, right: width, bottom: height };
  return [first, { left: size.width - width, top: size.height - height, right: size.width, bottom: size.height }];
}

/** Occlusion of a frame: whether it is computed, or used only where the last one is that of the frame. */
export interface OcclusionOfFrame {
  occlusion: Occlusion;
  computes: boolean;
  /** Whether half of the resolution is enough: a quarter of the time. */
  isCoarse: boolean;
}

/** Renders each pane in its part of the canvas. */
export function renderPanes(renderer: WebGLRenderer, panes: readonly Pane[], camera: Camera, size: Size, { occlusion, computes, isCoarse }: OcclusionOfFrame): void {
  const canvas = renderer.getSize(new Vector2());
  // The renderer has pixels of its own in pictures for export.
  const scale = canvas.width / size.width;
  const ratio = scale * renderer.getPixelRatio();
  const places = panes.map(({ stage, box }) => ({ stage, place: { left: ratio * box.left, right: ratio * box.right, bottom: ratio * (size.height - box.bottom), top: ratio * (size.height - box.top) } }));
  occlusion.prepare(renderer, places, camera, isCoarse || ratio >= FINE ? 2 : 1, computes);
  renderer.setScissorTest(panes.length > 1);
  for (const { stage, box } of panes) {
    stage.updateShadows(renderer, !computes);
    const place = [scale * box.left, canvas.height - scale * box.bottom, scale * widthOf(box), scale * heightOf(box)] as const;
    renderer.setViewport(...place);
    renderer.setScissor(...place);
    renderer.render(stage.scene, camera);
  }
  renderer.setScissorTest(false);
  renderer.setViewport(0, 0, canvas.width, canvas.height);
}

/** Paints a line between panes. */
export function paintDivider(context: TextContext, panes: readonly Pane[], colour: string): void {
  const [first, second] = panes.map(({ box }) => box).sort((a, b) => a.left - b.left || a.top - b.top);
  if (!first || !second) return;
  context.strokeStyle = colour;
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(second.left, second.top);
  if (second.left > first.left) context.lineTo(second.left, second.bottom);
  else context.lineTo(second.right, second.top);
  context.stroke();
}

/** Paints the titles of panes, shortened to their widths. */
export function paintTitles(context: TextContext, panes: readonly Pane[], ink: { text: string; halo: string }): void {
  context.textBaseline = 'alphabetic';
  context.font = '600 14px system-ui, sans-serif';
  context.lineJoin = 'round';
  context.lineWidth = 4;
  for (const { box, title } of panes) {
    if (!title) continue;
    const room = widthOf(box) - 2 * TITLE.left;
    let text = title;
    while (text.length > 1 && context.measureText(text).width > room) text = `${text.replace(/…$/, '').slice(0, -1)}…`;
    const [x, y] = [box.left + TITLE.left, box.top + TITLE.baseline];
    context.strokeStyle = ink.halo;
    context.strokeText(text, x, y);
    context.fillStyle = ink.text;
    context.fillText(text, x, y);
  }
}

/** Takes the wheel over a pane to the same place of the whole canvas: the controls zoom to the cursor with one camera for all panes. */
export function redirectWheel(canvas: HTMLCanvasElement, paneAt: (event: MouseEvent) => Box | null): void {
  let redirected = false;
  canvas.addEventListener(
    'wheel',
    (event) => {
      const box = redirected ? null : paneAt(event);
      if (!box) return;
      event.stopImmediatePropagation();
      event.preventDefault();
      const whole = canvas.getBoundingClientRect();
      const clientX = whole.left + ((event.clientX - whole.left - box.left) / widthOf(box)) * whole.width;
      const clientY = whole.top + ((event.clientY - whole.top - box.top) / heightOf(box)) * whole.height;
      const { deltaX, deltaY, deltaMode, ctrlKey, shiftKey, metaKey, altKey } = event;
      redirected = true;
      canvas.dispatchEvent(new WheelEvent('wheel', { deltaX, deltaY, deltaMode, ctrlKey, shiftKey, metaKey, altKey, clientX, clientY, bubbles: true, cancelable: true }));
      redirected = false;
    },
    { capture: true, passive: false },
  );
}
