// Conversion of the state of the cell view to the readable fragment of a URL, and back.

import { cameraText, hashParts, numbers, parseCamera, rounded, toHash, type CameraPose } from './hashParts';
import { partKey, partOfKey, type Part } from './parts';
import { clampedScale } from './playScale';

export const CELL_TABS = ['program', 'steps', 'parts', 'cell'] as const;
export type CellTab = (typeof CELL_TABS)[number];

export interface CellLink {
  /** Name of the cell file, or `example`. */
  cell: string;
  /** Current time [s]. */
  time: number;
  /** The open text or list. */
  tab: CellTab;
  /** Number of the selected instruction, from 1. */
  instruction: number | null;
  selected: Part | null;
  /** Time range of chart and plots [s]. */
  range: [number, number] | null;
  /** Play scale of the picture. */
  play: number;
  /** Position and target of the camera [m]. */
  camera: CameraPose | null;
}

const KEY = 'cell';

/** Whether a fragment is a link to the cell view. */
export const isCellLink = (hash: string): boolean => hash.startsWith(`#${KEY}=`);

export function toCellHash({ cell, time, tab, instruction, selected, range, play, camera }: CellLink): string {
  const parts: [string, string][] = [[KEY, encodeURIComponent(cell)], ['time', rounded(time, 6)], ['tab', tab]];
  if (instruction !== null) parts.push(['instruction', String(instruction)]);
  if (selected !== null) parts.push(['selected', encodeURIComponent(partKey(selected))]);
  if (range) parts.push(['range', range.map((value) => rounded(value, 6)).join(',')]);
  if (play !== 1) parts.push(['play', rounded(play, 3)]);
  if (camera) parts.push(['view', cameraText(camera)]);
  return toHash(parts);
}

/** Parses a link to the cell view; missing and invalid parts have their defaults. */
export function fromCellHash(hash: string): CellLink | null {
  if (!isCellLink(hash)) return null;
  const parts = hashParts(hash);
  const range = numbers(parts.get('range'), 2);
  const instruction = Number(parts.get('instruction') ?? NaN);
  return {
    cell: parts.get(KEY) ?? '',
    time: Math.max(0, numbers(parts.get('time'), 1)?.[0] ?? 0),
    tab: CELL_TABS.find((name) => name === parts.get('tab')) ?? 'program',
    instruction: Number.isInteger(instruction) && instruction >= 1 ? instruction : null,
    selected: partOfKey(parts.get('selected') ?? ''),
    range: range && range[0]! >= 0 && range[1]! > range[0]! ? [range[0]!, range[1]!] : null,
    play: clampedScale(numbers(parts.get('play'), 1)?.[0] ?? 1),
    camera: parseCamera(parts.get('view')),
  };
}
