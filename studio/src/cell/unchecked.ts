// What the check of collisions does not include, because the cell file does not describe it.

import type { CellParts } from '../lib/parts';

/** Arms and surroundings without bodies; empty where each arm and the surroundings have some. */
export function withoutBodies({ bodies, robot }: Pick<CellParts, 'bodies' | 'robot'>): string[] {
  const attached = new Set(bodies.map(({ attached_to }) => attached_to));
  const arms = (robot?.arms ?? []).filter(({ links }) => !links.some((link) => attached.has(link))).map(({ name }) => `arm “${name}”`);
  const isEmpty = !bodies.some(({ attached_to, station }) => station !== null || attached_to === 'base');
  return isEmpty ? [...arms, 'the surroundings of the robot'] : arms;
}
