// Formatting of numbers. Values of the server are in m and rad.

export type LengthUnit = 'mm' | 'inch';

const DEGREE = Math.PI / 180;
const INCH_MM = 25.4;

export const metres = (mm: number): number => shifted(mm, -3);
export const millimetres = (m: number): number => shifted(m, 3);
export const radians = (deg: number): number => deg * DEGREE;
export const degrees = (rad: number): number => rad / DEGREE;

/** Shifts the decimal point without rounding: 93.218 mm and 0.093218 m are the same decimal number. */
function shifted(value: number, places: number): number {
  const [digits, exponent = '0'] = String(value).split('e');
  return Number(`${digits}e${Number(exponent) + places}`);
}

/** A number with a fixed number of decimals, a true minus sign and no negative zero. */
export function fixed(value: number, decimals: number): string {
  if (!Number.isFinite(value)) return '–';
  const text = value.toFixed(decimals);
  return /^-0\.?0*$/.test(text) ? text.slice(1) : text.replace('-', '−');
}

export function signed(value: number, decimals: number): string {
  const text = fixed(value, decimals);
  return text.startsWith('−') || /^0\.?0*$/.test(text) || text === '–' ? text : `+${text}`;
}

/** A length [m] in the selected unit. */
export function length(m: number, unit: LengthUnit, decimals = 3): string {
  return unit === 'mm' ? `${fixed(m * 1000, decimals)} mm` : `${fixed((m * 1000) / INCH_MM, decimals + 2)} in`;
}

/** The value of a number field for a length [mm]. */
export const inUnit = (mm: number, unit: LengthUnit): number => (unit === 'mm' ? mm : mm / INCH_MM);

/** The length [mm] of the value of a number field, rounded to 1 pm: 1 in is 25.4 mm. */
export const fromUnit = (value: number, unit: LengthUnit): number => (unit === 'mm' ? value : Number((value * INCH_MM).toFixed(9)));

/** Symbol of the unit in number fields. */
export const unitName = (unit: LengthUnit): 'mm' | 'in' => (unit === 'mm' ? 'mm' : 'in');

/** Units of the numbers of a file. */
export interface FileUnits {
  length: 'm' | 'mm' | 'um' | 'in';
  angle: 'deg' | 'rad';
}

/** A length [m] or an angle [rad] in a unit of a file. */
export function inFileUnit(value: number, unit: FileUnits['length'] | FileUnits['angle']): number {
  switch (unit) {
    case 'mm': return millimetres(value);
    case 'um': return shifted(value, 6);
    case 'in': return millimetres(value) / INCH_MM;
    case 'deg': return degrees(value);
    default: return value;
  }
}

/** Symbol of a unit of mechanism files. */
export const fileUnit = (unit: string): string => (unit === 'um' ? 'µm' : unit === 'deg' ? '°' : unit);

/** A value with a unit of mechanism files, as text: `12.5°`, `−3 in`. */
export const withFileUnit = (value: string, unit: string): string => `${value.replace(/^-/, '−')}${unit === 'deg' ? '' : ' '}${fileUnit(unit)}`;

/** A small length [m] in µm or thousandths of an inch. */
export function small(m: number, unit: LengthUnit, decimals = 1, plus = false): string {
  const write = plus ? signed : fixed;
  return unit === 'mm' ? `${write(m * 1e6, decimals)} µm` : `${write((m * 1e6) / 25.4, decimals + 1)} mil`;
}

/** An angle [rad] in degrees. */
export function angle(rad: number, decimals = 3): string {
  return `${fixed(rad / DEGREE, decimals)}°`;
}

/** A small angle [rad] in µrad, or in mrad from 1 mrad. */
export function smallAngle(rad: number, plus = false): string {
  const write = plus ? signed : fixed;
  return Math.abs(rad) < 1e-3 ? `${write(rad * 1e6, 1)} µrad` : `${write(rad * 1e3, 3)} mrad`;
}

/** An integer power of ten, as on a logarithmic axis. */
export function power(exponent: number): string {
  const digits = '⁰¹²³⁴⁵⁶⁷⁸⁹';
  const text = [...String(Math.abs(exponent))].map((digit) => digits[Number(digit)]).join('');
  return `10${exponent < 0 ? '⁻' : ''}${text}`;
}

/** Seconds as minutes and seconds. */
export function clock(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${fixed(seconds - 60 * minutes, 1).padStart(4, '0')}`;
}
