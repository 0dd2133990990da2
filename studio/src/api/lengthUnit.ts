// The unit of lengths in messages of the server, which each request names in a header.

import { unitName, type LengthUnit } from '../lib/units';

/** Name of the header. */
const HEADER = 'length-unit';

export class MessageUnit {
  #unit: LengthUnit = 'mm';
  readonly #changed = new Set<() => void>();

  /** Calls `act` after each change of the unit, to request messages again. */
  onChange(act: () => void): void {
    this.#changed.add(act);
  }

  set(unit: LengthUnit): void {
    if (unit === this.#unit) return;
    this.#unit = unit;
    for (const act of this.#changed) act();
  }

  /** The header of a request. */
  get header(): Record<string, string> {
    return { [HEADER]: unitName(this.#unit) };
  }
}

export const messageUnit = new MessageUnit();
