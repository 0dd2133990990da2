// The plots of the robot view, and the figures of the paper.

import type { Quantity } from './columns';
import type { PlotUnit } from './channels';
import type { Virtualization } from './document';

export interface PlotKind {
  id: string;
  title: string;
  quantity: Quantity;
  unit: PlotUnit;
  /** Whether every model has the quantity, with the same meaning: they can be compared. */
  compared?: true;
}

export const PLOTS: PlotKind[] = [
  { id: 'rods', title: 'Rods q', quantity: 'rods', unit: 'mm' },
  { id: 'linear', title: 'X, linear', quantity: 'virtual_linear', unit: 'mm' },
  { id: 'angular', title: 'X, angular', quantity: 'virtual_angular', unit: '°' },
  { id: 'sides', title: 'Sides L', quantity: 'sides', unit: 'mm' },
  { id: 'shift', title: 'Centre shift', quantity: 'center_shift', unit: 'µm', compared: true },
  { id: 'torsion', title: 'Torsion τ', quantity: 'torsion', unit: 'mrad', compared: true },
  { id: 'displacement', title: 'Displacement ‖ΔX‖', quantity: 'displacement', unit: 'µm', compared: true },
];

export interface PaperFigure {
  number: number;
  title: string;
  plot: string;
  model: Virtualization;
}

export const FIGURES: PaperFigure[] = [
  { number: 5, title: 'rods q', plot: 'rods', model: 'polar' },
  { number: 6, title: 'l of the polar model', plot: 'linear', model: 'polar' },
  { number: 7, title: 'φ of the polar model', plot: 'angular', model: 'polar' },
  { number: 8, title: 'sides L, polar model', plot: 'sides', model: 'polar' },
  { number: 9, title: 'dr of the offset model', plot: 'linear', model: 'offset' },
  { number: 10, title: 'dφ of the offset model', plot: 'angular', model: 'offset' },
  { number: 11, title: 'sides L, offset model', plot: 'sides', model: 'offset' },
];

/** The range of an axis for values from `low` to `high`, with a margin and a minimum span. */
export function verticalRange(low: number | null, high: number | null, least: number): [number, number] {
  const [from, to] = [low ?? 0, high ?? 0];
  const [middle, half] = [(from + to) / 2, Math.max((to - from) * 0.58, least / 2)];
  return [middle - half, middle + half];
}

/** Decimals that distinguish numbers at equal distances, and write a distance such as 0.025 in full. */
export function decimalsOf(step: number): number {
  const least = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  const scaled = step * 10 ** least;
  return Math.abs(scaled - Math.round(scaled)) > 1e-6 * scaled ? least + 1 : least;
}

export { FACTORS, MIN_SPAN } from './channels';
