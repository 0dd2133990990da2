// Layout of the page; stored in the browser and not part of undo.

import { tick } from 'svelte';
import { MediaQuery } from 'svelte/reactivity';
import type { CellLink } from '../lib/cellLink';
import type { Side } from '../lib/docks';
import type { MechanismLink } from '../lib/mechanismLink';
import { load, save } from '../lib/settings';
import type { ShortcutSheet } from './shortcuts';
import { PanelLayout } from './panelLayout.svelte';

const flag = (value: unknown) => typeof value === 'boolean';

/** Panels of the robot view in their initial order. */
export const PANELS = ['pose', 'virtualization', 'displacement', 'mobility', 'sensitivity'] as const;
export type PanelName = (typeof PANELS)[number];

/** Panels of the cell view in their initial order. */
export const CELL_PANELS = ['check', 'play', 'jog', 'stations'] as const;
export type CellPanelName = (typeof CELL_PANELS)[number];
/** Panels of the cell view of a server with a simulated controller. */
export const CONTROLLER_PANELS = ['controller', ...CELL_PANELS] as const;
export type ControllerPanelName = (typeof CONTROLLER_PANELS)[number];

/** Panels of the view of mechanisms in their initial order. */
export const MECHANISM_PANELS = ['joints', 'point', 'mobility', 'motions', 'suggest', 'modes', 'comparison', 'parameters'] as const;
export type MechanismPanelName = (typeof MECHANISM_PANELS)[number];

/** Windows with too little space for panels next to the view and below it: their panels are drawers. The style sheets have the same query. */
const COMPACT = '(max-width: 900px) and (max-height: 560px)';
/** Identifiers of the drawers and of the buttons that open them. */
export const drawerId = (side: Side) => `drawer-${side}`;
export const drawerButtonId = (side: Side) => `open-drawer-${side}`;

/** Views of the page. */
export type Part = 'robot' | 'mechanism' | 'cell';
const isPart = (value: unknown): value is Part => value === 'robot' || value === 'mechanism' || value === 'cell';
const PART_OF_TAB = 'jointplay.studio.part';

/** The view that was chosen in this tab, which survives a reload. */
function partOfTab(): Part | null {
  try {
    const part = sessionStorage.getItem(PART_OF_TAB);
    return isPart(part) ? part : null;
  } catch {
    return null;
  }
}

class Layout {
  plots = $state(true);
  /** The view that was chosen in this tab; `null` until one is. */
  chosenPart = $state<Part | null>(partOfTab());
  /** The view that was last chosen in any tab. */
  readonly #lastPart = load<Part>('part', 'cell', isPart);
  plotsHeight = $state(load('plotsHeight', 300, (value) => typeof value === 'number' && value >= 160));
  readonly panels = new PanelLayout('', PANELS, ['left', 'right']);
  readonly #cellPanels = new PanelLayout('cell.', CELL_PANELS, ['right']);
  readonly #controllerPanels = new PanelLayout('controller.', CONTROLLER_PANELS, ['right']);
  /** Whether the server has a simulated controller. */
  controller = $state(false);
  readonly mechanismPanels = new PanelLayout('mechanism.', MECHANISM_PANELS, ['right']);
  readonly #compact = new MediaQuery(COMPACT);
  /** The open drawer of a small window. */
  drawer = $state<Side | null>(null);
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
  /** A link to the cell view that is still to be opened. */
  cellLink = $state.raw<CellLink | null>(null);
  /** Whether the dialog for opening files is shown. */
  openShown = $state(false);
  /** Files that were dropped on the page, for the dialog to open. */
  droppedFiles = $state.raw<readonly File[]>([]);
  /** Whether the robot file is shown next to the view. */
  robotEditor = $state(false);
  /** A link to the view of mechanisms that is still to be opened. */
  mechanismLink = $state.raw<MechanismLink | null>(null);
  introductionShown = $state(load('introduction', true, flag));
  handles = $state(load('handles', true, flag));
  /** The maximized plot. */
  maximizedPlot = $state<string | null>(null);

  get cellPanels(): PanelLayout {
    return this.controller ? this.#controllerPanels : this.#cellPanels;
  }

  /** The view for a server with or without a mechanism and a cell. */
  part({ mechanism, cell }: { mechanism: boolean; cell: boolean }): Part {
    const part = this.chosenPart ?? (mechanism ? 'mechanism' : this.#lastPart === 'robot' ? 'robot' : 'cell');
    return part === 'cell' && !cell ? 'robot' : part;
  }

  setPart(part: Part): void {
    this.chosenPart = part;
    this.drawer = null;
    save('part', part);
    try {
      sessionStorage.setItem(PART_OF_TAB, part);
    } catch {
      // Storage may be unavailable, for example in private windows.
    }
  }

  /** Whether panels are drawers. */
  get compact(): boolean {
    return this.#compact.current;
  }

  /** Opens a drawer in place of another one, with the focus in it, or closes it. */
  toggleDrawer(side: Side): void {
    this.drawer = this.drawer === side ? null : side;
    if (this.drawer) void tick().then(() => document.getElementById(drawerId(side))?.focus());
  }

  /** Closes the open drawer; the focus returns to its button. */
  closeDrawer(): void {
    if (this.drawer) document.getElementById(drawerButtonId(this.drawer))?.focus();
    this.drawer = null;
  }

  /** Shows what a control refers to, where it is in a drawer. */
  reveal(side: Side): void {
    if (this.compact) this.drawer = side;
  }

  toggleDocks(): void {
    this.docksShown = !this.docksShown;
    save('docksShown', this.docksShown);
  }

  /** Restores the initial layout. */
  reset(): void {
    this.panels.reset();
    this.cellPanels.reset();
    this.mechanismPanels.reset();
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
