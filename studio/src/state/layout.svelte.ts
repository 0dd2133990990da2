// How the page is arranged; kept between visits, and no part of undo.

import { load, save } from '../lib/settings';
import type { ShortcutSheet } from './shortcuts';
import { PanelLayout } from './panelLayout.svelte';

const flag = (value: unknown) => typeof value === 'boolean';

/** The panels beside the picture, as they stand at first. */
export const PANELS = ['pose', 'virtualization', 'displacement', 'mobility', 'sensitivity'] as const;
export type PanelName = (typeof PANELS)[number];

/** Those beside the picture of the cell. */
export const CELL_PANELS = ['check', 'jog', 'stations'] as const;
export type CellPanelName = (typeof CELL_PANELS)[number];

class Layout {
  plots = $state(true);
  /** Which part of the page is shown, where there is a cell. */
  part = $state<'robot' | 'cell'>(load('part', 'cell', (value) => value === 'robot' || value === 'cell'));
  plotsHeight = $state(load('plotsHeight', 300, (value) => typeof value === 'number' && value >= 160));
  readonly panels = new PanelLayout('', PANELS, ['left', 'right']);
  readonly cellPanels = new PanelLayout('cell.', CELL_PANELS, ['right']);
  docksShown = $state(load('docksShown', true, flag));
  /** Whether the cell's axes are plotted below their bars, and how high both are. */
  cellPlots = $state(load('cell.plots', false, flag));
  tracksHeight = $state(load('cell.tracks', 210, (value) => typeof value === 'number' && value >= 140));
  /** Nothing has been drawn in 3D yet. */
  opening = $state(true);
  helpOpen = $state(false);
  /** The keys of the view on show; without one, those of the robot. */
  sheet = $state.raw<ShortcutSheet | null>(null);
  explainOpen = $state(false);
  storyShown = $state(load('story', true, flag));
  handles = $state(load('handles', true, flag));
  /** The plot shown alone, if one is. */
  alone = $state<string | null>(null);

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

  /** Plots need room. */
  setCellPlots(shown: boolean): void {
    this.cellPlots = shown;
    save('cell.plots', shown);
    this.setTracksHeight(shown ? Math.max(this.tracksHeight, 400) : 210);
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
