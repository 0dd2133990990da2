// The plots that are shown, those that the user defined, and named layouts; stored in the browser.

import { isOwnPlot, type OwnPlot } from '../lib/channels';
import { VIRTUALIZATIONS, type Virtualization } from '../lib/document';
import { load, save } from '../lib/settings';
import { layout, PANELS } from './layout.svelte';

const MOST_OWN = 24;
const MOST_LAYOUTS = 24;
const LONGEST_NAME = 40;

const isHidden = (value: unknown) => Array.isArray(value) && value.every((id) => typeof id === 'string');
const areModels = (value: unknown) => Array.isArray(value) && value.every((name) => VIRTUALIZATIONS.includes(name as Virtualization));
const areOwn = (value: unknown) => Array.isArray(value) && value.length <= MOST_OWN && value.every(isOwnPlot);

/** A named arrangement of the robot view. */
export interface NamedLayout {
  name: string;
  hidden: string[];
  own: OwnPlot[];
  models: Virtualization[];
  plotsHeight: number;
  robotEditor: boolean;
  docks: { left: string[]; right: string[] };
  closed: Record<string, boolean>;
}

function isNamedLayout(value: unknown): value is NamedLayout {
  const { name, hidden, own, models, plotsHeight, robotEditor, docks, closed } = (value ?? {}) as Partial<NamedLayout>;
  const isSide = (side: unknown) => Array.isArray(side) && side.every((panel) => PANELS.includes(panel as (typeof PANELS)[number]));
  return (
    typeof name === 'string' && name.length > 0 && name.length <= LONGEST_NAME && isHidden(hidden) && areOwn(own) && areModels(models) &&
    Number.isFinite(plotsHeight) && typeof robotEditor === 'boolean' && isSide(docks?.left) && isSide(docks?.right) && typeof closed === 'object' && closed !== null
  );
}

class PlotLayout {
  /** Plots that are not shown. */
  hidden = $state.raw<string[]>(load('plots.hidden', ['displacement'], isHidden));
  own = $state.raw<OwnPlot[]>(load('plots.own', [], areOwn));
  /** Models that are plotted in addition to the selected one. */
  models = $state.raw<Virtualization[]>(load('plots.models', [], areModels));
  layouts = $state.raw<NamedLayout[]>(load('layouts', [], (value) => Array.isArray(value) && value.length <= MOST_LAYOUTS && value.every(isNamedLayout)));
  /** Sample with which values at the cursor are compared. */
  reference = $state<number | null>(null);
  valuesShown = $state(load('plots.values', false, (value) => typeof value === 'boolean'));

  isShown(id: string): boolean {
    return !this.hidden.includes(id);
  }

  show(id: string, shown: boolean): void {
    this.hidden = shown ? this.hidden.filter((one) => one !== id) : [...new Set([...this.hidden, id])];
    save('plots.hidden', this.hidden);
  }

  setModels(models: Virtualization[]): void {
    this.models = models;
    save('plots.models', models);
  }

  setValuesShown(shown: boolean): void {
    this.valuesShown = shown;
    save('plots.values', shown);
  }

  /** Adds a plot; returns why it cannot be added. */
  add(plot: Omit<OwnPlot, 'id'>): string | null {
    if (this.own.length >= MOST_OWN) return `There are ${MOST_OWN} plots already, which is the maximum.`;
    const numbers = this.own.map(({ id }) => Number(id.replace('own-', '')));
    this.own = [...this.own, { ...plot, id: `own-${Math.max(0, ...numbers) + 1}` }];
    save('plots.own', this.own);
    return null;
  }

  remove(id: string): void {
    this.own = this.own.filter((one) => one.id !== id);
    save('plots.own', this.own);
  }

  /** Saves the present arrangement under a name, in place of an earlier one; returns why it cannot be saved. */
  saveAs(name: string): string | null {
    const trimmed = name.trim();
    if (trimmed === '') return 'A layout needs a name.';
    if (trimmed.length > LONGEST_NAME) return `The name has ${trimmed.length} characters, at most ${LONGEST_NAME} are allowed.`;
    const others = this.layouts.filter((one) => one.name !== trimmed);
    if (others.length >= MOST_LAYOUTS) return `There are ${MOST_LAYOUTS} layouts already, which is the maximum.`;
    const { docks, closed } = layout.panels;
    const { hidden, own, models } = this;
    this.layouts = [...others, { name: trimmed, hidden, own, models, plotsHeight: layout.plotsHeight, robotEditor: layout.robotEditor, docks, closed: { ...closed } }];
    save('layouts', this.layouts);
    return null;
  }

  restore({ hidden, own, models, plotsHeight, robotEditor, docks, closed }: NamedLayout): void {
    Object.assign(this, { hidden, own });
    save('plots.hidden', hidden);
    save('plots.own', own);
    this.setModels(models);
    layout.setPlotsHeight(plotsHeight);
    layout.robotEditor = robotEditor;
    layout.maximizedPlot = null;
    layout.panels.restore(docks, closed);
  }

  forget(name: string): void {
    this.layouts = this.layouts.filter((one) => one.name !== name);
    save('layouts', this.layouts);
  }
}

export const plotLayout = new PlotLayout();
