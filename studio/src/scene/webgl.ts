// The first WebGL context of the page. It is created while the rest of the page is loading:
// without a graphics card, its creation takes the browser a noticeable time.

/** A canvas with its WebGL context. */
export interface WebGLCanvas {
  canvas: HTMLCanvasElement;
  context: WebGL2RenderingContext;
  /** Whether the processor renders the pictures. */
  software: boolean;
}

let prepared: WebGLCanvas | null = null;

function create(antialias: boolean): Omit<WebGLCanvas, 'software'> | null {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('webgl2', { alpha: true, antialias }) as WebGL2RenderingContext | null;
  return context && { canvas, context };
}

/** A new context; with smoothed edges where a graphics card renders them at no cost. */
function open(): WebGLCanvas | null {
  const made = create(false);
  if (!made) return null;
  const { context } = made;
  const details = context.getExtension('WEBGL_debug_renderer_info');
  const name = String(context.getParameter(details ? details.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  if (/swiftshader|llvmpipe|softpipe|software|basic render/i.test(name)) return { ...made, software: true };
  context.getExtension('WEBGL_lose_context')?.loseContext();
  const smooth = create(true);
  return smooth && { ...smooth, software: false };
}

/** Creates the context that the first view takes. */
export function prepareContext(): void {
  prepared = open();
}

/** The prepared context, or a new one; `null` in browsers without WebGL 2. */
export function takeContext(): WebGLCanvas | null {
  const taken = prepared ?? open();
  prepared = null;
  return taken;
}
