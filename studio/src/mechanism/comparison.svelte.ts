// Comparison of the shown state with a reference: an earlier state of the mechanism, or another mechanism.

import * as api from '../api/client';
import type { ConfigurationDocument, MechanismDocument, MobilityOfMechanism, PlacedDocument } from '../api/client';
import { load, save } from '../lib/settings';
import { isReferenceDisplay, type ReferenceDisplay } from './referenceDisplay';
import { mechanismSession as session } from './session.svelte';

/** A state that others are compared with. */
export interface Reference {
  document: MechanismDocument;
  configuration: ConfigurationDocument;
  /** Poses at the play scale at which it was taken. */
  poses: readonly PlacedDocument[];
  mobility: MobilityOfMechanism | null;
  /** Why there is no mobility. */
  problem: string | null;
}

/** Counts of a mobility; the finite one may be a range. */
export interface MobilityCounts {
  kutzbach: number;
  instantaneous: number;
  finite: string;
  redundant: number;
}

export function counts(mobility: MobilityOfMechanism | null): MobilityCounts | null {
  const found = mobility?.dense ?? mobility?.sparse;
  if (!found) return null;
  const finite = found.finite_mobility ?? `${found.finite_mobility_bounds[0]}–${found.finite_mobility_bounds[1]}`;
  return { kutzbach: found.kutzbach_mobility, instantaneous: found.instantaneous_mobility, finite: String(finite), redundant: found.redundancy };
}

class Comparison {
  reference = $state.raw<Reference | null>(null);
  /** How the reference is drawn in the view; remembered by the browser. */
  display = $state(load<ReferenceDisplay>('mechanism.reference', 'overlaid', isReferenceDisplay));
  /** Whether the view has a pane for the reference. */
  isSeparate = $derived(this.reference !== null && this.display === 'separate');

  setDisplay(display: ReferenceDisplay): void {
    this.display = display;
    save('mechanism.reference', display);
  }

  /** Takes the shown state as reference. */
  take(): void {
    const { document, outdated } = session;
    const { configuration, poses, moving } = session.controller;
    if (!document || !configuration || outdated || moving) return;
    const of = session.analyses.mobility?.of === configuration ? session.analyses.mobility : null;
    const reference: Reference = { document, configuration, poses: poses ?? configuration.poses, mobility: of?.result ?? null, problem: of?.problem ?? null };
    this.reference = reference;
    if (!of) void this.#analyse(reference);
  }

  async #analyse(reference: Reference): Promise<void> {
    const done = (mobility: MobilityOfMechanism | null, problem: string | null) => {
      if (this.reference === reference) this.reference = { ...reference, mobility, problem };
    };
    try {
      done(await api.mechanismMobility(session.source, reference.configuration.coordinates, new AbortController().signal), null);
    } catch (error) {
      done(null, error instanceof Error ? error.message : String(error));
    }
  }
}

export const comparison = new Comparison();
