// Layout of the page; stored in the browser and not part of undo.

import { load, save } from '../lib/settings';
import type { ShortcutSheet } from './shortcuts';
import { PanelLayout } from './panelLayout.svelte';

const flag = (value: unknown) => typeof value === 'boolean';

/** Panels of the robot view in their initial order. */
export const PANELS = ['pose', 'virtualization', 'displacement', 'mobility', 'sensitivity'] as const;
export type PanelName = (typeof PANELS)[number];

/** Panels of the cell view in their initial order. */
export const CELL_PANELS = ['check', 'jog', 'stations'] as const;
export type CellPanelName = (typeof CELL_PANELS)[number];

class Layout {
  plots = $state(true);
  /** The current view, if there is a cell. */
  part = $state<'robot' | 'cell'>(load('part', 'cell', (value) => value === 'robot' || value === 'cell'));
  plotsHeight = $state(load('plotsHeight', 300, (value) => typeof value === 'number' && value >= 160));
  readonly panels = new PanelLayout('', PANELS, ['left', 'right']);
  readonly cellPanels = new PanelLayout('cell.', CELL_PANELS, ['right']);
  docksShown = $state(load('docksShown', true, flag));
  /** Whether the axis plots of the cell are visible, and the height of chart and plots [px]. */
  cellPlots = $state(load('cell.plots', false, flag));
  tracksHeight = $state(load('cell.tracks', 210, (value) => typeof value === 'number' && value >= 140));
  /** Whether the first 3D frame is still to be rendered. */
  opening = $state(true);
  helpOpen = $state(false);
  /** Shortcuts of the current view; `null` for those of the robot view. */
  shortcuts = $state.raw<ShortcutSheet | null>(null);
  explainOpen = $state(false);
  introductionShown = $state(load('introduction', true, flag));
  handles = $state(load('handles', true, flag));
  /** The maximized plot. */
  maximizedPlot = $state<string | null>(null);

  setPart(part: 'robot' | 'cell'): void {
    this.part = part;
    save('part', part);
  }

  toggleDocks(): void {
    this.docksShown = !this.docksShown;
    save('docksShown', this.docksShown);
  }

  /** Restores the initial layout. */
  reset(): void {
    this.panels.reset();
    this.cellPanels.reset();
    this.setPlotsHeight(300);
    if (!this.docksShown) this.toggleDocks();
  }

  setPlotsHeight(height: number): void {
    this.plotsHeight = Math.round(Math.min(Math.max(height, 160), window.innerHeight - 330));
    save('plotsHeight', this.plotsHeight);
  }

  setTracksHeight(height: number): void {
    this.tracksHeight = Math.round(Math.min(Math.max(height, 140), window.innerHeight - 240));
    save('cell.tracks', this.tracksHeight);
  }

  /** Shows or hides the axis plots, with a height that fits them. */
  setCellPlots(shown: boolean): void {
    this.cellPlots = shown;
    save('cell.plots', shown);
    this.setTracksHeight(shown ? Math.max(this.tracksHeight, 400) : 210);
  }

  setIntroduction(shown: boolean): void {
    this.introductionShown = shown;
    save('introduction', shown);
  }

  setHandles(shown: boolean): void {
    this.handles = shown;
    save('handles', shown);
  }
}

export const layout = new Layout();
