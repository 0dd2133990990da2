/**
 * The name of a part in the picture, from its name in a check result.
 *
 * The check names a wafer by the effector that carries it at the start ("wafer from A"), and without its slot in a station of one slot;
 * the picture has "wafer of A", and always the number of the slot.
 */
export function partName(name: string, stations: readonly { name: string; slots: number }[]): string {
  if (name.startsWith('wafer from ')) return `wafer of ${name.slice('wafer from '.length)}`;
  const single = stations.some(({ name: station, slots }) => slots === 1 && name === `wafer of ${station}`);
  return single ? `${name} 1` : name;
}
