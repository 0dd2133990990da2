// How the page is arranged; kept between visits, and no part of undo.

import { find, otherSide, put, tidy, type Docks, type Side } from '../lib/docks';
import { load, save } from '../lib/settings';

const object = (value: unknown) => typeof value === 'object' && value !== null;
const flag = (value: unknown) => typeof value === 'boolean';
const size = (value: unknown) => typeof value === 'number' && Number.isFinite(value);

/** The panels beside the picture, as they stand at first. */
export const PANELS = ['move', 'models', 'plane', 'mobility', 'bounds'] as const;
export type PanelName = (typeof PANELS)[number];

const WIDTH = { least: 300, usual: 372, most: 640 } as const;
const width = (side: Side) => load(`width.${side}`, WIDTH.usual, size);

class Layout {
  plots = $state(true);
  /** Which part of the page is shown, where there is a cell. */
  part = $state<'robot' | 'cell'>(load('part', 'cell', (value) => value === 'robot' || value === 'cell'));
  plotsHeight = $state(load('plotsHeight', 300, (value) => typeof value === 'number' && value >= 160));
  closed = $state<Record<string, boolean>>(load('closed', {}, object));
  docks = $state.raw<Docks>(tidy(load('docks', null, object), PANELS));
  widths = $state<Record<Side, number>>({ left: width('left'), right: width('right') });
  docksShown = $state(load('docksShown', true, flag));
  /** The panel that is dragged, and where it would come to stand. */
  dragged = $state.raw<{ name: string; side: Side; index: number } | null>(null);
  helpOpen = $state(false);
  explainOpen = $state(false);
  storyShown = $state(load('story', true, flag));
  handles = $state(load('handles', true, flag));
  /** The plot shown alone, if one is. */
  alone = $state<string | null>(null);

  toggleSection(name: string): void {
    this.closed = { ...this.closed, [name]: !this.closed[name] };
    save('closed', this.closed);
  }

  /** Puts a panel before the one that stands at `index` now. */
  put(name: string, side: Side, index: number): void {
    this.docks = put(this.docks, name, side, index);
    save('docks', this.docks);
  }

  /** Moves a panel one place up or down, or to the other side. */
  move(name: string, way: 'up' | 'down' | 'across'): void {
    const { side, index } = find(this.docks, name);
    if (way === 'across') this.put(name, otherSide(side), index);
    else this.put(name, side, way === 'up' ? index - 1 : index + 2);
  }

  setWidth(side: Side, to: number): void {
    this.widths[side] = Math.round(Math.min(Math.max(to, WIDTH.least), WIDTH.most));
    save(`width.${side}`, this.widths[side]);
  }

  setPart(part: 'robot' | 'cell'): void {
    this.part = part;
    save('part', part);
  }

  toggleDocks(): void {
    this.docksShown = !this.docksShown;
    save('docksShown', this.docksShown);
  }

  /** All panels where and as they are at first. */
  reset(): void {
    this.docks = tidy(null, PANELS);
    this.closed = {};
    save('docks', this.docks);
    save('closed', this.closed);
    for (const side of ['left', 'right'] as const) this.setWidth(side, WIDTH.usual);
    this.setPlotsHeight(300);
    if (!this.docksShown) this.toggleDocks();
  }

  setPlotsHeight(height: number): void {
    this.plotsHeight = Math.round(Math.min(Math.max(height, 160), window.innerHeight - 330));
    save('plotsHeight', this.plotsHeight);
  }

  setStory(shown: boolean): void {
    this.storyShown = shown;
    save('story', shown);
  }

  setHandles(shown: boolean): void {
    this.handles = shown;
    save('handles', shown);
  }
}

export const layout = new Layout();
