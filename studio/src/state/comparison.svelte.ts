// Studies of other models over the same motion, for plots with several models.

import * as api from '../api/client';
import type { ModelChoice, RobotSource } from '../api/client';
import { VIRTUALIZATIONS, type Motion, type Virtualization } from '../lib/document';
import { Study } from './study.svelte';

/** Most samples of a motion whose models are compared: all four then take about 200 MB. */
export const MOST_COMPARED = 500_000;

export class Comparison {
  readonly studies: Record<Virtualization, Study> = { radial: new Study(), polar: new Study(), offset: new Study(), planar: new Study() };
  #keys: Partial<Record<Virtualization, string>> = {};

  /** Loads the studies of some models, and drops those of the others. */
  async load(robot: RobotSource | null, motion: Motion | null, models: readonly Virtualization[], choice: (model: Virtualization) => ModelChoice): Promise<void> {
    await Promise.all(
      VIRTUALIZATIONS.map(async (model) => {
        const study = this.studies[model];
        if (!motion || !models.includes(model)) {
          delete this.#keys[model];
          return study.clear();
        }
        const key = JSON.stringify([robot, motion, choice(model)]);
        if (this.#keys[model] === key) return;
        this.#keys[model] = key;
        try {
          await study.load(robot, motion, choice(model), api.COMPARED_QUANTITIES);
        } catch (error) {
          // It is requested again after reconnection.
          delete this.#keys[model];
          if (!(error instanceof api.ConnectionError)) throw error;
        }
      }),
    );
  }

  /** Loads all studies again the next time: the robot of the server has changed. */
  forget(): void {
    this.#keys = {};
  }

  /** Changes when samples of any study arrive. */
  get version(): string {
    return VIRTUALIZATIONS.map((model) => this.studies[model].version).join();
  }
}
