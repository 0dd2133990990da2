// Printed pages: the picture of the view, rendered for paper, above the panels with results.

import { flushSync } from 'svelte';
import type { PicturedView } from './picture';

/** What a view prints above its panels. */
export interface PrintedView {
  view: PicturedView | null;
  /** Name of what is shown. */
  title: string;
  /** What the picture needs to be understood, such as its play scale. */
  note: string;
}

/** Width of the picture, and its pixels per pixel of texts on the screen: 170 mm at 270 dpi. */
const WIDTH = 1800;
const SCALE = 2;
/** Least and greatest ratio of its width and height. */
const ASPECT = [1.25, 2.2] as const;

class Printing {
  /** Whether a page is being printed; it has light colors. */
  active = $state(false);
  title = $state('');
  /** Whether the page has the picture of a loaded view. */
  drawn = $state(false);
  /** The request to render a view that is not loaded yet. */
  #frame = 0;
  #printed: (() => PrintedView) | null = null;

  /** Chooses the view that is printed, until the returned function is called. */
  use(printed: () => PrintedView): () => void {
    this.#printed = printed;
    return () => {
      if (this.#printed === printed) this.#printed = null;
    };
  }

  /** Renders the picture of the page; browsers print it as soon as this function returns. A view that is not loaded yet is rendered once it is. */
  begin(canvas: HTMLCanvasElement): void {
    if (this.active) return;
    // The views take the light colors before the picture is rendered.
    flushSync(() => (this.active = true));
    // A script that prints does not wait for later changes of the page.
    flushSync(() => this.#render(canvas));
  }

  end(): void {
    cancelAnimationFrame(this.#frame);
    this.active = this.drawn = false;
  }

  #render(canvas: HTMLCanvasElement): void {
    const { view, title, note } = this.#printed?.() ?? { view: null, title: '', note: '' };
    this.title = title;
    const { width, height } = view?.viewSize ?? { width: 1, height: 1 };
    const aspect = Math.min(Math.max(width / Math.max(height, 1), ASPECT[0]), ASPECT[1]);
    this.drawn = view?.renderPicture(canvas, { width: WIDTH, height: Math.round(WIDTH / aspect), scale: SCALE, transparent: false, labels: true, note }) ?? false;
    if (!this.drawn) this.#frame = requestAnimationFrame(() => this.#render(canvas));
  }
}

export const printing = new Printing();
