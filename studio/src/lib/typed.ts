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
