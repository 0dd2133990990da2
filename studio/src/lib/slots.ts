// Slots of stations in the 3D scene.

/** Name of a slot, as in the 3D scene of the server. */
export function slotName(station: string, slot: number): string {
  return `${station} ${slot}`;
}

/** Names of all slots of a station. */
export function slotNames({ name, slots }: { name: string; slots: number }): string[] {
  return Array.from({ length: slots }, (_, k) => slotName(name, k + 1));
}

/** The station with a name, or with a slot of that name. */
export function stationOf<T extends { name: string; slots: number }>(stations: readonly T[], selected: string | null): T | null {
  if (selected === null) return null;
  return stations.find(({ name }) => name === selected) ?? stations.find((station) => slotNames(station).includes(selected)) ?? null;
}
