// The value of a length or an angle as typed into a field.

import * as api from '../api/client';
import { TYPED_UNITS, plainNumber } from '../lib/typed';
import { degrees, inUnit, millimetres } from '../lib/units';

/** The value of a text in the unit of its field; texts other than plain numbers are evaluated by the server. */
export function typedQuantity(text: string, unit: keyof typeof TYPED_UNITS): number | Promise<number> {
  const plain = plainNumber(text);
  if (plain !== null) return plain;
  return api.quantity(text, TYPED_UNITS[unit]).then((value) => {
    // Without the rounding errors of the conversion: 1/2 is 0.5.
    const converted = unit === '°' ? degrees(value) : inUnit(millimetres(value), unit === 'in' ? 'inch' : 'mm');
    return Number(converted.toPrecision(14));
  });
}
