// Numbers as typed into fields.

/** Units of fields, with the names that the server has for them. */
export const TYPED_UNITS = { mm: 'mm', in: 'in', '°': 'deg' } as const;

/** A plain number, with a point or a comma; `null` for any other text, which the server evaluates. */
export function plainNumber(text: string): number | null {
  const trimmed = text.trim().replace('−', '-');
  if (!/^[-+]?(\d+([.,]\d*)?|[.,]\d+)(e[-+]?\d+)?$/i.test(trimmed)) return null;
  const value = Number(trimmed.replace(',', '.'));
  return Number.isFinite(value) ? value : null;
}

/** An expression with decimal points in place of decimal commas; commas between arguments of functions, and those of numbers with two separators, remain. */
export function withDecimalPoints(text: string): string {
  /** For each open parenthesis, whether it begins the arguments of a function. */
  const open: boolean[] = [];
  let found = '';
  for (let i = 0; i < text.length; i += 1) {
    const char = text[i]!;
    if (char === '(') open.push(/[a-z_]\w*\s*$/i.test(text.slice(0, i)));
    else if (char === ')') open.pop();
    const before = /[\d.,]*$/.exec(text.slice(0, i))![0];
    const after = /^[\d.,]*/.exec(text.slice(i + 1))![0];
    const isDecimal = char === ',' && !open.includes(true) && /^\d*$/.test(before) && /^\d+$/.test(after);
    found += isDecimal ? (before === '' ? '0.' : '.') : char;
  }
  return found;
}

/** Quantity of the unit at the end of an expression; `null` without a unit. */
export function quantityAtEnd(text: string): 'length' | 'angle' | null {
  if (/(°|(?<![a-zµμ])([uµμm]?rad|deg))\s*$/i.test(text)) return 'angle';
  return /(?<![a-zµμ])([uµμm]?m|in|mil)\s*$/i.test(text) ? 'length' : null;
}

/** An angle of a direction [deg] between limits that are at least one turn apart: other angles are reduced by whole turns. */
export function directionWithin(deg: number, min: number, max: number): number {
  const turns = deg > max ? -Math.ceil((deg - max) / 360) : deg < min ? Math.ceil((min - deg) / 360) : 0;
  // Without the rounding errors of the sum.
  return turns === 0 ? deg : Number((deg + 360 * turns).toFixed(9));
}
