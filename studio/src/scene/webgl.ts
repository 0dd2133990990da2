// The page's first means of drawing in 3D, made while the rest of the page is still being fetched:
// where no graphics card helps, the browser takes a while for it.

/** What a picture is drawn with. */
export const ATTRIBUTES: { alpha: boolean; antialias: boolean } = { alpha: true, antialias: true };

export interface Graphics {
  canvas: HTMLCanvasElement;
  context: WebGL2RenderingContext;
}

let made: Graphics | null = null;

/** Begins; whoever draws first takes it. */
export function prepareContext(): void {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('webgl2', ATTRIBUTES) as WebGL2RenderingContext | null;
  made = context && { canvas, context };
}

/** What was made, once; later pictures, and browsers without, have to see for themselves. */
export function takeContext(): Graphics | null {
  const taken = made;
  made = null;
  return taken;
}
