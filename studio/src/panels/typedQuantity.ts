// The value of a number as typed into a field.

import * as api from '../api/client';
import { TYPED_UNITS, plainNumber, quantityAtEnd, withDecimalPoints } from '../lib/typed';
import { degrees, inFileUnit, inUnit, millimetres, type FileUnits } from '../lib/units';

/** Unit of a field; `null` for numbers without a unit, and the units of a file for its parameters, which may be lengths, angles or numbers. */
export type FieldUnit = keyof typeof TYPED_UNITS | null | FileUnits;

/** Without the rounding errors of a conversion: 1/2 is 0.5. */
const tidy = (value: number) => Number(value.toPrecision(14));

/** The value of a text in the unit of its field; texts other than plain numbers are evaluated by the server. */
export function typedQuantity(typed: string, unit: FieldUnit): number | Promise<number> {
  const plain = plainNumber(typed);
  if (plain !== null) return plain;
  const text = withDecimalPoints(typed);
  if (unit === null) return number(text);
  if (typeof unit === 'object') return parameter(text, unit);
  return api.quantity(text, TYPED_UNITS[unit]).then((value) => tidy(unit === '°' ? degrees(value) : inUnit(millimetres(value), unit === 'in' ? 'inch' : 'mm')));
}

/** A number without a unit; angles of functions are in degrees, or in the unit of a file. */
async function number(text: string, angle: FileUnits['angle'] = 'deg'): Promise<number> {
  if (quantityAtEnd(text) !== null) throw new Error(`“${text}” has a unit: type a number or an expression without one`);
  const value = await api.quantity(text, angle);
  return tidy(angle === 'deg' ? degrees(value) : value);
}

async function parameter(text: string, units: FileUnits): Promise<number> {
  const quantity = quantityAtEnd(text);
  if (quantity === null) return number(text, units.angle);
  return tidy(inFileUnit(await api.quantity(text, quantity === 'length' ? 'mm' : 'deg'), quantity === 'length' ? units.length : units.angle));
}
