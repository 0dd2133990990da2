// What the plots of the robot view show.

import { FACTORS, MIN_SPAN, channelName, displayedUnit, kindOf, parseChannel, UNITS, type OwnPlot, type PlotUnit } from '../lib/channels';
import type { Column } from '../lib/columns';
import { VIRTUALIZATIONS, type Virtualization } from '../lib/document';
import { PLOTS } from '../lib/figures';
import { SERIES } from '../lib/series';
import type { LengthUnit } from '../lib/units';
import { MODEL_COLOURS, type Theme } from '../scene/palette';
import { legible } from '../scene/robotScene';

/** Dashes of lines of one colour. */
export const DASHES = [[], [8, 4], [2, 3], [8, 3, 2, 3], [12, 4], [5, 2]];

export interface ContentLine {
  name: string;
  symbol: string;
  values: ArrayLike<number>;
  factor: number;
  colour: string;
  dash: number[];
}

export interface PlotContent {
  id: string;
  title: string;
  unit: PlotUnit;
  minSpan: number;
  lines: ContentLine[];
  /** The quantity of the horizontal axis; `null` for samples or time. */
  x: { title: string; unit: PlotUnit; values: ArrayLike<number>; factor: number; minSpan: number } | null;
}

/** The columns of the selected model, and those of the models compared with it. */
export interface Columns {
  selected: Virtualization;
  own: readonly Column[];
  compared: readonly { model: Virtualization; columns: readonly Column[] }[];
}

/** The contents of all plots that have data. */
export function plotContents({ selected, own, compared }: Columns, plots: readonly OwnPlot[], theme: Theme, length: LengthUnit): PlotContent[] {
  const series = (column: Column, i: number, factor: number): ContentLine => ({ name: column.name, symbol: column.symbol, values: column.values, factor, colour: SERIES[theme][i % 6]!, dash: DASHES[i % 6]! });
  const kinds = PLOTS.map(({ id, title, quantity, unit: metric, compared: comparable }): PlotContent => {
    const unit = displayedUnit(metric, length);
    const of = (columns: readonly Column[]) => columns.filter((one) => one.quantity === quantity);
    const factor = FACTORS[unit];
    const lines =
      comparable && compared.length > 0
        ? [{ model: selected, columns: own }, ...compared]
            .sort((a, b) => VIRTUALIZATIONS.indexOf(a.model) - VIRTUALIZATIONS.indexOf(b.model))
            .flatMap(({ model, columns }) => of(columns).map((column, i): ContentLine => ({ name: model === selected ? column.name : `${model}:${column.name}`, symbol: `${model} ${column.symbol}`, values: column.values, factor, colour: legible(MODEL_COLOURS[theme][model]!, theme), dash: DASHES[i % 6]! })))
        : of(own).map((column, i) => series(column, i, factor));
    return { id, title, unit, minSpan: MIN_SPAN[unit], lines, x: null };
  });
  const find = (key: string): Column | undefined => {
    const { model, column } = parseChannel(key);
    const columns = model === null || model === selected ? own : compared.find((one) => one.model === model)?.columns;
    return columns?.find(({ name }) => name === column);
  };
  const defined = plots.map(({ id, x: horizontal, y, unit: metric }): PlotContent => {
    const unit = displayedUnit(metric, length);
    const lines = y.flatMap((key, i) => {
      const column = find(key);
      if (!column) return [];
      const { model } = parseChannel(key);
      return [{ ...series(column, i, FACTORS[unit]), name: key, symbol: model ? `${model} ${column.symbol}` : column.symbol }];
    });
    const column = horizontal === null ? null : find(horizontal);
    const xUnit = column ? displayedUnit(UNITS[kindOf(column.name)][0]!, length) : null;
    const x = column && xUnit ? { title: channelName(column), unit: xUnit, values: column.values, factor: FACTORS[xUnit], minSpan: MIN_SPAN[xUnit] } : null;
    // Without its horizontal quantity, such as a joint of another model, a plot has no data.
    const known = horizontal === null || x !== null;
    return { id, title: lines.map(({ symbol }) => symbol).join(', '), unit, minSpan: MIN_SPAN[unit], lines: known ? lines : [], x };
  });
  return [...kinds, ...defined].filter(({ lines }) => lines.length > 0);
}
