// The first WebGL context of the page. It is created while the rest of the page is loading:
// without a graphics card, its creation takes the browser a noticeable time.

/** Attributes of the WebGL contexts. */
export const CONTEXT_ATTRIBUTES: { alpha: boolean; antialias: boolean } = { alpha: true, antialias: true };

/** A canvas with its WebGL context. */
export interface WebGLCanvas {
  canvas: HTMLCanvasElement;
  context: WebGL2RenderingContext;
}

let prepared: WebGLCanvas | null = null;

/** Creates the context that the first view takes. */
export function prepareContext(): void {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('webgl2', CONTEXT_ATTRIBUTES) as WebGL2RenderingContext | null;
  prepared = context && { canvas, context };
}

/** The prepared context, once; `null` for later views and for browsers without WebGL 2. */
export function takeContext(): WebGLCanvas | null {
  const taken = prepared;
  prepared = null;
  return taken;
}
