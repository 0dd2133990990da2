// The selected part of the cell, and hiding it or all others.

import type { PlanDocument, StationDocument } from '../api/client';
import { keysOfPart, stationOfPart, type Part } from '../lib/parts';
import type { ViewTools } from './viewTools.svelte';

/** The part of the session that the selection depends on. */
export interface SelectionContext {
  readonly stations: StationDocument[];
  readonly bodies: PlanDocument['bodies'];
  readonly plan: PlanDocument | null;
  readonly tools: ViewTools;
  /** The 3D view, with the keys of all its parts. */
  readonly view: { readonly parts: ReadonlySet<string> } | null;
}

export class PartSelection {
  readonly #context: SelectionContext;
  part = $state.raw<Part | null>(null);
  /** The selected station, or the station of the selected slot. */
  station = $derived.by(() => stationOfPart(this.part, this.#context.stations));
  /** Keys of the selected part and of all parts that belong to it. */
  highlighted = $derived.by(() => {
    const { stations, bodies, plan } = this.#context;
    return keysOfPart(this.part, { stations, bodies, robot: plan?.robot ?? null });
  });

  constructor(context: SelectionContext) {
    this.#context = context;
  }

  /** Hides all parts but the selected one, or shows all parts again. */
  isolate(): void {
    const { tools, view } = this.#context;
    if (tools.hidden.size > 0) tools.showAll();
    else if (this.part !== null) tools.isolate(this.highlighted, view?.parts ?? []);
  }

  /** Keys of the selected parts that are drawn. */
  get #drawn(): string[] {
    const drawn = this.#context.view?.parts;
    return [...this.highlighted].filter((key) => drawn?.has(key) ?? true);
  }

  /** Whether the selected part is hidden. */
  get isHidden(): boolean {
    return this.#context.tools.isHidden(this.#drawn);
  }

  /** Hides the selected part, or shows it again. */
  toggleHidden(): void {
    if (this.part !== null) this.#context.tools.toggleHidden(this.#drawn);
  }
}
