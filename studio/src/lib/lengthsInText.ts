// Lengths in messages of the server, which are in mm and µm.

import type { LengthUnit } from './units';

const NUMBER = String.raw`[−-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?`;
/** A number, a range or coordinates, with their unit: `0.5 mm`, `1 to 3 mm`, `x 1, y 2, z 3 mm`, `20 mm/s²`. */
const LENGTHS = new RegExp(String.raw`(?<![\p{L}\d_.])(${NUMBER}(?:(?: to |, [xyz] )${NUMBER})*) (mm|µm)(?![\p{L}\d])`, 'gu');
/** Size of an inch in mm, and of a thousandth of an inch in µm. */
const SIZE = 25.4;
/** Significant digits that a number has at least. */
const LEAST_DIGITS = 4;
/** Decimals in addition to those of mm and of µm. */
const MORE_DECIMALS = { mm: 2, µm: 1 } as const;

function converted(number: string, unit: 'mm' | 'µm'): string {
  const value = Number(number.replace('−', '-')) / SIZE;
  if (value === 0) return '0';
  const decimals = (number.split('e')[0]!.split('.')[1] ?? '').length + MORE_DECIMALS[unit];
  const digits = LEAST_DIGITS - 1 - Math.floor(Math.log10(Math.abs(value)));
  const text = number.includes('e') ? value.toPrecision(LEAST_DIGITS) : value.toFixed(Math.min(Math.max(decimals, digits), 12));
  const short = text.includes('.') && !text.includes('e') ? text.replace(/\.?0+$/, '') : text;
  return number.startsWith('−') ? short.replace('-', '−') : short;
}

/** A message with its lengths in the display unit. Names of parts have no spaces, and contain no lengths with a unit. */
export function lengthsIn(text: string, unit: LengthUnit): string {
  if (unit === 'mm') return text;
  return text.replace(LENGTHS, (_, numbers: string, from: 'mm' | 'µm') => `${numbers.replace(new RegExp(NUMBER, 'g'), (one) => converted(one, from))} ${from === 'mm' ? 'in' : 'mil'}`);
}
