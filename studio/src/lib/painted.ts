/**
 * Makes something whose drawings in two dimensions are painted by the processor.
 *
 * Where no graphics card helps, a browser that hands long lines to its graphics stands still for seconds until they are drawn;
 * by the processor they take milliseconds, there as elsewhere.
 * What is made asks for its canvas itself, and cannot be told.
 */
export function painted<T>(make: () => T): T {
  const { prototype } = HTMLCanvasElement;
  const { getContext } = prototype;
  const asked = getContext as (this: HTMLCanvasElement, kind: string, attributes?: object) => RenderingContext | null;
  prototype.getContext = function (this: HTMLCanvasElement, kind: string, attributes?: object) {
    return asked.call(this, kind, kind === '2d' ? { ...attributes, willReadFrequently: true } : attributes);
  } as typeof getContext;
  try {
    return make();
  } finally {
    prototype.getContext = getContext;
  }
}
