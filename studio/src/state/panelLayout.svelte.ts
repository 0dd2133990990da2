// Where the panels of one part of the page stand; kept between visits, and no part of undo.

import { find, otherSide, put, tidy, type Docks, type Side } from '../lib/docks';
import { load, save } from '../lib/settings';

const object = (value: unknown) => typeof value === 'object' && value !== null;
const size = (value: unknown) => typeof value === 'number' && Number.isFinite(value);
const WIDTH = { least: 300, usual: 372, most: 640 } as const;

export class PanelLayout {
  closed = $state<Record<string, boolean>>({});
  docks = $state.raw<Docks>({ left: [], right: [] });
  widths = $state<Record<Side, number>>({ left: WIDTH.usual, right: WIDTH.usual });
  /** The panel that is dragged, and where it would come to stand. */
  dragged = $state.raw<{ name: string; side: Side; index: number } | null>(null);

  readonly #prefix: string;
  readonly #panels: readonly string[];
  readonly #sides: readonly Side[];

  /** Panels as they stand at first; `prefix` tells their settings from those of other parts of the page. */
  constructor(prefix: string, panels: readonly string[], sides: readonly Side[]) {
    this.#prefix = prefix;
    this.#panels = panels;
    this.#sides = sides;
    this.closed = load(`${prefix}closed`, {}, object);
    this.docks = tidy(load(`${prefix}docks`, null, object), panels);
    for (const side of sides) this.widths[side] = load(`${prefix}width.${side}`, WIDTH.usual, size);
  }

  #save(key: string, value: unknown): void {
    save(this.#prefix + key, value);
  }

  toggleSection(name: string): void {
    this.closed = { ...this.closed, [name]: !this.closed[name] };
    this.#save('closed', this.closed);
  }

  /** Unfolds a panel. */
  open(name: string): void {
    if (this.closed[name]) this.toggleSection(name);
  }

  /** Puts a panel before the one that stands at `index` now. */
  put(name: string, side: Side, index: number): void {
    this.docks = put(this.docks, name, side, index);
    this.#save('docks', this.docks);
  }

  /** Moves a panel one place up or down, or to the other side. */
  move(name: string, way: 'up' | 'down' | 'across'): void {
    const { side, index } = find(this.docks, name);
    if (way !== 'across') this.put(name, side, way === 'up' ? index - 1 : index + 2);
    else if (this.#sides.includes(otherSide(side))) this.put(name, otherSide(side), index);
  }

  setWidth(side: Side, to: number): void {
    this.widths[side] = Math.round(Math.min(Math.max(to, WIDTH.least), WIDTH.most));
    this.#save(`width.${side}`, this.widths[side]);
  }

  /** All panels where and as they are at first. */
  reset(): void {
    this.docks = tidy(null, this.#panels);
    this.closed = {};
    this.#save('docks', this.docks);
    this.#save('closed', this.closed);
    for (const side of this.#sides) this.setWidth(side, WIDTH.usual);
  }
}
