// Analyses of the shown configuration, and the suggestion of virtual joints.

import * as api from '../api/client';
import type { ConfigurationDocument, MechanismSource } from '../api/client';

/** An analysis of one configuration, or why there is none. */
export interface Analysis<T> {
  of: ConfigurationDocument;
  result: T | null;
  problem: string | null;
}

/** The part of the session that analyses depend on. */
export interface AnalysesContext {
  /** The mechanism of requests. */
  readonly source: MechanismSource;
  /** Identifies the text with its parameters. */
  readonly sourceKey: string;
  /** Whether configuration and text may differ: the text may have errors. */
  readonly outdated: boolean;
  readonly controller: { readonly configuration: ConfigurationDocument | null; readonly moving: boolean; readonly playScale: number; animated: number | null };
  failed(error: unknown): void;
}

export class MechanismAnalyses {
  mobility = $state.raw<Analysis<api.MobilityOfMechanism> | null>(null);
  motions = $state.raw<Analysis<api.MotionsDocument> | null>(null);
  modes = $state.raw<Analysis<api.BranchesDocument> | null>(null);
  /** Play scale of the assembly modes. */
  modesScale = 1;
  /** Virtual joints for a text; they do not depend on the configuration. */
  suggestion = $state.raw<{ of: string; result: api.SuggestDocument | null; problem: string | null } | null>(null);
  /** The running analysis, for its button. */
  computing = $state<'motions' | 'modes' | 'suggestion' | null>(null);

  readonly #context: AnalysesContext;
  #mobilityAbort: AbortController | null = null;

  constructor(context: AnalysesContext) {
    this.#context = context;
  }

  /** Cancels the mobility that is being computed. */
  cancelMobility(): void {
    this.#mobilityAbort?.abort();
  }

  async computeMobility(): Promise<void> {
    const { source, controller, outdated } = this.#context;
    const { configuration } = controller;
    if (!configuration || controller.moving || outdated) return;
    const abort = new AbortController();
    this.#mobilityAbort = abort;
    const done = (result: api.MobilityOfMechanism | null, problem: string | null) => {
      if (!abort.signal.aborted && controller.configuration === configuration) this.mobility = { of: configuration, result, problem };
    };
    try {
      done(await api.mechanismMobility(source, configuration.coordinates, abort.signal), null);
    } catch (error) {
      if (error instanceof api.ApiError) done(null, error.message);
      else this.#context.failed(error);
    }
  }

  async #analyse<T>(what: 'motions' | 'modes', ask: (configuration: ConfigurationDocument) => Promise<T>): Promise<Analysis<T> | null> {
    const { controller: { configuration }, outdated } = this.#context;
    if (!configuration || outdated) return null;
    this.computing = what;
    try {
      return { of: configuration, result: await ask(configuration), problem: null };
    } catch (error) {
      if (error instanceof api.ApiError) return { of: configuration, result: null, problem: error.message };
      this.#context.failed(error);
      return null;
    } finally {
      this.computing = null;
    }
  }

  async computeMotions(): Promise<void> {
    const { source, controller } = this.#context;
    this.motions = await this.#analyse('motions', ({ coordinates }) => api.mechanismMotions(source, coordinates));
    if (this.motions?.result?.motions.length) controller.animated = 0;
  }

  async computeModes(): Promise<void> {
    const { source, controller } = this.#context;
    this.modesScale = controller.playScale;
    this.modes = await this.#analyse('modes', ({ coordinates }) => api.mechanismBranches(source, coordinates, controller.playScale));
  }

  async computeSuggestion(): Promise<void> {
    const { source, sourceKey: of } = this.#context;
    this.computing = 'suggestion';
    try {
      this.suggestion = { of, result: await api.suggestVirtualJoints(source, new AbortController().signal), problem: null };
    } catch (error) {
      if (error instanceof api.ApiError) this.suggestion = { of, result: null, problem: error.message };
      else this.#context.failed(error);
    } finally {
      this.computing = null;
    }
  }

  /** The text with the virtual joints of a suggested set; `null` if the text has changed since. */
  suggestedText(set: number): string | null {
    return this.suggestion?.of === this.#context.sourceKey ? (this.suggestion.result?.texts[set] ?? null) : null;
  }
}
