// Parts of the readable fragment of a URL: `#key=value&key=value`.

export interface CameraPose {
  /** Position and target of the camera, in the units of its scene. */
  eye: number[];
  target: number[];
}

/** The parts of a fragment by key. */
export function hashParts(hash: string): Map<string, string> {
  const parts = new Map<string, string>();
  for (const part of hash.replace(/^#/, '').split('&')) {
    const at = part.indexOf('=');
    if (at > 0) parts.set(part.slice(0, at), decoded(part.slice(at + 1)));
  }
  return parts;
}

export const toHash = (parts: readonly [string, string][]): string => '#' + parts.map(([key, value]) => `${key}=${value}`).join('&');

function decoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** Numbers separated by commas, of a given count; `null` if they are none. */
export function numbers(text: string | undefined, count: number | null): number[] | null {
  const words = (text ?? '').split(',');
  const values = words.map((word) => (word.trim() === '' ? NaN : Number(word)));
  return (count === null || values.length === count) && values.every((value) => Number.isFinite(value) && Math.abs(value) < 1e7) ? values : null;
}

export const rounded = (value: number, digits: number): string => String(Number(value.toFixed(digits)));

export const cameraText = ({ eye, target }: CameraPose): string => [...eye, ...target].map((value) => rounded(value, 5)).join(',');

/** A camera that does not coincide with its target. */
export function parseCamera(text: string | undefined): CameraPose | null {
  const view = numbers(text, 6);
  return view && view.slice(0, 3).some((value, k) => value !== view[k + 3]) ? { eye: view.slice(0, 3), target: view.slice(3) } : null;
}
