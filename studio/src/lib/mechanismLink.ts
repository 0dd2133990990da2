// Conversion of the state of the view of mechanisms to the readable fragment of a URL, and back.

import { cameraText, hashParts, numbers, parseCamera, toHash, type CameraPose } from './hashParts';
import { clampedScale } from './playScale';

export const MECHANISM_TABS = ['catalogue', 'tree', 'text'] as const;
export type MechanismTab = (typeof MECHANISM_TABS)[number];
export const SELECTION_KINDS = ['link', 'joint', 'virtual'] as const;

export interface MechanismLink {
  /** Name of the file or of the entry of the catalogue. */
  name: string;
  /** Compressed text; `null` for an entry of the catalogue, and for a text that is too long for a link. */
  packed: string | null;
  /** Values of parameters in place of those of the text. */
  parameters: Record<string, number>;
  /** Coordinates of the configuration [m, rad]. */
  coordinates: number[] | null;
  /** Play scale of the picture. */
  play: number;
  tab: MechanismTab;
  selected: { kind: (typeof SELECTION_KINDS)[number]; name: string } | null;
  camera: CameraPose | null;
}

const KEY = 'mechanism';

/** Longest compressed text of a link. */
const MAX_PACKED = 20_000;

export function toMechanismHash({ name, packed, parameters, coordinates, play, tab, selected, camera }: MechanismLink): string {
  const parts: [string, string][] = [[KEY, encodeURIComponent(name)], ['tab', tab]];
  const set = Object.entries(parameters);
  if (set.length > 0) parts.push(['parameters', set.map(([name, value]) => `${encodeURIComponent(name)}:${value}`).join(',')]);
  // All digits: the loops of the configuration stay closed.
  if (coordinates && coordinates.length > 0) parts.push(['at', coordinates.join(',')]);
  if (play !== 1) parts.push(['play', String(play)]);
  if (selected) parts.push(['selected', `${selected.kind}:${encodeURIComponent(selected.name)}`]);
  if (camera) parts.push(['view', cameraText(camera)]);
  if (packed !== null) parts.push(['text', packed]);
  return toHash(parts);
}

/** Parses a link to the view of mechanisms; missing and invalid parts have their defaults. `null` for links to other views. */
export function fromMechanismHash(hash: string): MechanismLink | null {
  if (!hash.startsWith(`#${KEY}=`)) return null;
  const parts = hashParts(hash);
  const parameters = (parts.get('parameters') ?? '').split(',').flatMap((part): [string, number][] => {
    const [, name, value] = /^(.+):([^:]+)$/.exec(part) ?? [];
    return name !== undefined && Number.isFinite(Number(value)) ? [[name, Number(value)]] : [];
  });
  const [, kind, selected] = /^(\w+):(.+)$/.exec(parts.get('selected') ?? '') ?? [];
  const selection = SELECTION_KINDS.find((one) => one === kind);
  const packed = parts.get('text');
  return {
    name: parts.get(KEY) ?? '',
    packed: packed && packed.length <= MAX_PACKED && /^[\w-]+$/.test(packed) ? packed : null,
    parameters: Object.fromEntries(parameters),
    coordinates: numbers(parts.get('at'), null),
    play: clampedScale(numbers(parts.get('play'), 1)?.[0] ?? 1),
    tab: MECHANISM_TABS.find((tab) => tab === parts.get('tab')) ?? 'tree',
    selected: selection && selected ? { kind: selection, name: selected } : null,
    camera: parseCamera(parts.get('view')),
  };
}

/** A text, compressed for a link; `null` if it is too long. */
export async function packText(text: string): Promise<string | null> {
  const bytes = new Uint8Array(await new Response(new Blob([text]).stream().pipeThrough(new CompressionStream('deflate-raw'))).arrayBuffer());
  const packed = btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join('')).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
  return packed.length <= MAX_PACKED ? packed : null;
}

/**
 * The text of a link; at most `limit` bytes of it are unpacked.
 *
 * Throws an error for a text that is damaged or too long.
 */
export async function unpackText(packed: string, limit: number): Promise<string> {
  const bytes = Uint8Array.from(atob(packed.replaceAll('-', '+').replaceAll('_', '/')), (letter) => letter.charCodeAt(0));
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw')).getReader();
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += value.length;
    if (length > limit) {
      await reader.cancel();
      throw new Error('the text of the link is too long');
    }
    parts.push(value);
  }
  return new TextDecoder('utf-8', { fatal: true }).decode(await new Blob(parts).arrayBuffer());
}
