// Quantities of studies as channels of plots: their names, units and kinds of values.

import type { Column } from './columns';
import type { Virtualization } from './document';
import type { LengthUnit } from './units';

export type ChannelKind = 'length' | 'angle' | 'time' | 'number';
export type PlotUnit = 'mm' | 'µm' | 'in' | 'mil' | 'mrad' | '°' | 's' | '1';

/** Units in which values of a kind can be plotted; the first one is the default. */
export const UNITS: Record<ChannelKind, PlotUnit[]> = { length: ['mm', 'µm'], angle: ['°', 'mrad'], time: ['s'], number: ['1'] };

/** Conversion factors from SI to the units of plots. */
export const FACTORS: Record<PlotUnit, number> = { mm: 1e3, µm: 1e6, in: 1e3 / 25.4, mil: 1e6 / 25.4, mrad: 1e3, '°': 180 / Math.PI, s: 1, '1': 1 };

/** The smallest span of an axis in its unit: 2 nm or 20 nrad; smaller values are rounding errors, of about 1e-15 m and 1e-11 rad. */
export const MIN_SPAN: Record<PlotUnit, number> = { mm: 2e-6, µm: 2e-3, in: 2e-6 / 25.4, mil: 2e-3 / 25.4, mrad: 2e-5, '°': 1.2e-6, s: 1e-6, '1': 1e-12 };

/** The unit in which a plot is displayed: lengths follow the length unit of the page. */
export function displayedUnit(unit: PlotUnit, length: LengthUnit): PlotUnit {
  if (length === 'mm') return unit;
  return unit === 'mm' ? 'in' : unit === 'µm' ? 'mil' : unit;
}

/** The kind of the values of a column, by the unit in its name. */
export function kindOf(column: string): ChannelKind {
  return column.endsWith('_m') ? 'length' : column.endsWith('_rad') ? 'angle' : column.endsWith('_s') ? 'time' : 'number';
}

/** A column of the study of the selected model, or of another one. */
export interface Channel {
  /** `null` for the selected model. */
  model: Virtualization | null;
  column: string;
}

export const channelKey = ({ model, column }: Channel): string => (model ? `${model}:${column}` : column);

export function parseChannel(key: string): Channel {
  const at = key.indexOf(':');
  return at < 0 ? { model: null, column: key } : { model: key.slice(0, at) as Virtualization, column: key.slice(at + 1) };
}

const WORDS: Record<string, string> = { azimuth_rad: 'tilt direction γ', tilt_rad: 'tilt angle α', axis_height_m: 'height', time_s: 'time', origin_x_m: 'centre shift x', origin_y_m: 'centre shift y', origin_z_m: 'centre height', torsion_rad: 'torsion τ', displacement_m: '‖ΔX‖' };

/** Name of a column in lists. */
export const channelName = (column: Pick<Column, 'name' | 'symbol'>): string => WORDS[column.name] ?? column.symbol;

/** A plot that the user defined: quantities against the sample or time, or against another quantity. */
export interface OwnPlot {
  id: string;
  /** Key of the channel of the horizontal axis; `null` for samples or time. */
  x: string | null;
  /** Keys of the plotted channels, all of one kind. */
  y: string[];
  unit: PlotUnit;
}

const LONGEST = 12;
const isKey = (value: unknown): value is string => typeof value === 'string' && /^([a-z]+:)?[A-Za-z0-9_]{1,40}$/.test(value);

/** Whether a stored value is a plot. */
export function isOwnPlot(value: unknown): value is OwnPlot {
  const { id, x, y, unit } = (value ?? {}) as Partial<OwnPlot>;
  if (typeof id !== 'string' || !(x === null || isKey(x)) || !Array.isArray(y) || y.length === 0 || y.length > LONGEST || !y.every(isKey)) return false;
  const kinds = new Set(y.map((key) => kindOf(parseChannel(key).column)));
  return kinds.size === 1 && UNITS[[...kinds][0]!].includes(unit as PlotUnit);
}
