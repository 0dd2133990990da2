// The columns of a study, identified by their names.

import { symbol } from './joints';

export type Quantity = 'rods' | 'sides' | 'virtual_linear' | 'virtual_angular' | 'center_shift' | 'torsion' | 'displacement' | 'other';

export interface Column {
  name: string;
  /** Symbol in legends. */
  symbol: string;
  quantity: Quantity;
  /** Values in SI units. */
  values: Float64Array;
}

const DIGITS = '₀₁₂₃₄₅₆₇₈₉';
const subscript = (digits: string) => [...digits].map((digit) => DIGITS[Number(digit)]).join('');

const KINDS: [RegExp, Quantity, (found: string[]) => string][] = [
  [/^q(\d)_m$/, 'rods', ([, limb]) => `q${subscript(limb!)}`],
  [/^L(\d\d)_m$/, 'sides', ([, pair]) => `L${subscript(pair!)}`],
  [/^([a-z]+)(\d)_m$/, 'virtual_linear', ([, name, limb]) => symbol(name!, Number(limb) - 1)],
  [/^([a-z]+)(\d)_rad$/, 'virtual_angular', ([, name, limb]) => symbol(name!, Number(limb) - 1)],
  [/^origin_([xy])_m$/, 'center_shift', ([, axis]) => axis!],
  [/^torsion_rad$/, 'torsion', () => 'τ'],
  [/^displacement_m$/, 'displacement', () => '‖ΔX‖'],
];

export function column(name: string, samples: number): Column {
  const values = new Float64Array(samples);
  for (const [pattern, quantity, call] of KINDS) {
    const found = pattern.exec(name);
    if (found) return { name, symbol: call([...found]), quantity, values };
  }
  return { name, symbol: name, quantity: 'other', values };
}
