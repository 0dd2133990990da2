// Layout of the panels of one view; stored in the browser and not part of undo.

import { findPanel, insertPanel, otherSide, validDocks, type Docks, type Side } from '../lib/docks';
import { load, save } from '../lib/settings';

const object = (value: unknown) => typeof value === 'object' && value !== null;
const size = (value: unknown) => typeof value === 'number' && Number.isFinite(value);
const WIDTH = { min: 300, initial: 372, max: 640 } as const;

export class PanelLayout {
  closed = $state<Record<string, boolean>>({});
  docks = $state.raw<Docks>({ left: [], right: [] });
  widths = $state<Record<Side, number>>({ left: WIDTH.initial, right: WIDTH.initial });
  /** The dragged panel and its target position. */
  dragged = $state.raw<{ name: string; side: Side; index: number } | null>(null);

  readonly #prefix: string;
  readonly #panels: readonly string[];
  readonly #sides: readonly Side[];

  /** Panels in their initial order; `prefix` separates their settings from those of other views. */
  constructor(prefix: string, panels: readonly string[], sides: readonly Side[]) {
    this.#prefix = prefix;
    this.#panels = panels;
    this.#sides = sides;
    this.closed = load(`${prefix}closed`, {}, object);
    this.docks = validDocks(load(`${prefix}docks`, null, object), panels);
    for (const side of sides) this.widths[side] = load(`${prefix}width.${side}`, WIDTH.initial, size);
  }

  #save(key: string, value: unknown): void {
    save(this.#prefix + key, value);
  }

  toggleSection(name: string): void {
    this.closed = { ...this.closed, [name]: !this.closed[name] };
    this.#save('closed', this.closed);
  }

  /** Expands a panel. */
  open(name: string): void {
    if (this.closed[name]) this.toggleSection(name);
  }

  /** Inserts a panel before the one at `index`. */
  insert(name: string, side: Side, index: number): void {
    this.docks = insertPanel(this.docks, name, side, index);
    this.#save('docks', this.docks);
  }

  /** Moves a panel one position up or down, or to the other side. */
  move(name: string, direction: 'up' | 'down' | 'across'): void {
    const { side, index } = findPanel(this.docks, name);
    if (direction !== 'across') this.insert(name, side, direction === 'up' ? index - 1 : index + 2);
    else if (this.#sides.includes(otherSide(side))) this.insert(name, otherSide(side), index);
  }

  setWidth(side: Side, to: number): void {
    this.widths[side] = Math.round(Math.min(Math.max(to, WIDTH.min), WIDTH.max));
    this.#save(`width.${side}`, this.widths[side]);
  }

  /** Takes over an arrangement of the panels. */
  restore(docks: Docks, closed: Record<string, boolean>): void {
    this.docks = validDocks(docks, this.#panels);
    this.closed = { ...closed };
    this.#save('docks', this.docks);
    this.#save('closed', this.closed);
  }

  /** Restores the initial layout. */
  reset(): void {
    this.docks = validDocks(null, this.#panels);
    this.closed = {};
    this.#save('docks', this.docks);
    this.#save('closed', this.closed);
    for (const side of this.#sides) this.setWidth(side, WIDTH.initial);
  }
}
