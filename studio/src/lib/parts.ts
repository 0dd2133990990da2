// Identity of the parts of a cell. Names are unique within one kind only: a body may have the name of a station.

export const PART_KINDS = ['robot', 'axis', 'platform', 'arm', 'link', 'effector', 'station', 'slot', 'wafer', 'zone', 'body'] as const;
export type PartKind = (typeof PART_KINDS)[number];

export interface Part {
  readonly kind: PartKind;
  /** Name among the parts of this kind; of a slot, the name of its station. */
  readonly name: string;
  /** Number of a slot, from 1. */
  readonly slot?: number;
}

/** A slot of a station. */
export interface Slot {
  readonly station: string;
  /** Number from 1. */
  readonly slot: number;
}

/** Text of a part, different for different parts: for sets, maps and links. */
export function partKey({ kind, name, slot }: Part): string {
  return slot === undefined ? `${kind}:${name}` : `${kind}:${slot}:${name}`;
}

/** The part with a key; `null` for other texts. */
export function partOfKey(key: string): Part | null {
  const [, word, number, name] = /^([a-z]+):(?:(\d+):)?(.+)$/s.exec(key) ?? [];
  if (word === 'slot') return number !== undefined && Number(number) >= 1 ? { kind: 'slot', name: name!, slot: Number(number) } : null;
  // The name of any other part may begin with a number.
  const kind = PART_KINDS.find((one) => one === word);
  return kind ? { kind, name: key.slice(kind.length + 1) } : null;
}

export function samePart(a: Part | null, b: Part | null): boolean {
  return a === b || (a !== null && b !== null && partKey(a) === partKey(b));
}

/** Name of a part for display. */
export function partTitle({ name, slot }: Part): string {
  return slot === undefined ? name : `${name} ${slot}`;
}

/** Names of a pair of parts for display; with their kinds if they are equal. */
export function pairTitle(pair: readonly Part[]): string {
  const titles = pair.map(partTitle);
  return (new Set(titles).size < titles.length ? pair.map((part) => `${part.kind} ${partTitle(part)}`) : titles).join(' – ');
}

/** What the parts of a cell consist of. */
export interface CellParts {
  stations: readonly { name: string; slots: number }[];
  bodies: readonly { name: string; attached_to: string; station: string | null }[];
  robot: { name: string; axes: readonly { name: string }[]; arms: readonly { name: string; links: readonly string[]; effectors: readonly string[] }[] } | null;
}

/** Number of the axes that are rods of the platform; they are the first ones. */
const RODS = 3;

/** Keys of a part and of all parts that belong to it: slots and bodies of a station, links of an arm, bodies on a link. */
export function keysOfPart(part: Part | null, { stations, bodies, robot }: CellParts): ReadonlySet<string> {
  if (part === null) return new Set();
  const { kind, name } = part;
  const found: Part[] = [part];
  if (kind === 'station') {
    const slots = stations.find((station) => station.name === name)?.slots ?? 0;
    for (let slot = 1; slot <= slots; slot += 1) found.push({ kind: 'slot', name, slot });
    for (const body of bodies) if (body.station === name) found.push({ kind: 'body', name: body.name });
  }
  const isRobot = kind === 'robot';
  for (const arm of robot?.arms ?? []) {
    const links = isRobot || (kind === 'arm' && arm.name === name) ? arm.links : kind === 'effector' && arm.effectors.includes(name) ? arm.links.slice(-1) : [];
    for (const link of links) found.push({ kind: 'link', name: link });
  }
  if (isRobot) {
    found.push({ kind: 'platform', name: 'platform' });
    for (const axis of robot?.axes.slice(0, RODS) ?? []) found.push({ kind: 'axis', name: axis.name });
  }
  const frames = new Set(found.filter((one) => one.kind === 'link' || one.kind === 'platform').map((one) => one.name));
  for (const body of bodies) if (body.station === null && frames.has(body.attached_to)) found.push({ kind: 'body', name: body.name });
  return new Set(found.map(partKey));
}

/** The selected station, or the station of the selected slot. */
export function stationOfPart<T extends { name: string }>(part: Part | null, stations: readonly T[]): T | null {
  return part?.kind === 'station' || part?.kind === 'slot' ? (stations.find(({ name }) => name === part.name) ?? null) : null;
}
