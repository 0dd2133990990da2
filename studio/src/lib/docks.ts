// Which panels stand at which side of the picture, from top to bottom.

export type Side = 'left' | 'right';
export type Docks = Record<Side, string[]>;

export const otherSide = (side: Side): Side => (side === 'left' ? 'right' : 'left');

/** Each panel once: what is not known is left out, what is missing comes last at the right. */
export function tidy(found: unknown, known: readonly string[]): Docks {
  const seen = new Set<string>();
  const side = (name: Side) => {
    const list = (found as Partial<Docks> | null)?.[name];
    return (Array.isArray(list) ? list : []).filter((one) => known.includes(one) && !seen.has(one) && seen.add(one));
  };
  const docks = { left: side('left'), right: side('right') };
  return { ...docks, right: [...docks.right, ...known.filter((one) => !seen.has(one))] };
}

/** Where a panel stands. */
export function find(docks: Docks, name: string): { side: Side; index: number } {
  const side = docks.left.includes(name) ? 'left' : 'right';
  return { side, index: docks[side].indexOf(name) };
}

/** The same with one panel put before the one that stands at `index` now. */
export function put(docks: Docks, name: string, side: Side, index: number): Docks {
  const was = find(docks, name);
  const at = was.side === side && was.index < index ? index - 1 : index;
  const others = { left: docks.left.filter((one) => one !== name), right: docks.right.filter((one) => one !== name) };
  const list = others[side];
  const place = Math.min(Math.max(at, 0), list.length);
  return { ...others, [side]: [...list.slice(0, place), name, ...list.slice(place)] };
}
