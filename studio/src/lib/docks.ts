// Panels at each side of the view, from top to bottom.

export type Side = 'left' | 'right';
export type Docks = Record<Side, string[]>;

export const otherSide = (side: Side): Side => (side === 'left' ? 'right' : 'left');

/** A layout with each known panel exactly once: unknown panels are omitted, missing ones are appended at the right. */
export function validDocks(found: unknown, known: readonly string[]): Docks {
  const seen = new Set<string>();
  const side = (name: Side) => {
    const list = (found as Partial<Docks> | null)?.[name];
    return (Array.isArray(list) ? list : []).filter((one) => known.includes(one) && !seen.has(one) && seen.add(one));
  };
  const docks = { left: side('left'), right: side('right') };
  return { ...docks, right: [...docks.right, ...known.filter((one) => !seen.has(one))] };
}

/** Side and index of a panel. */
export function findPanel(docks: Docks, name: string): { side: Side; index: number } {
  const side = docks.left.includes(name) ? 'left' : 'right';
  return { side, index: docks[side].indexOf(name) };
}

/** The layout with one panel inserted before the one at `index`. */
export function insertPanel(docks: Docks, name: string, side: Side, index: number): Docks {
  const previous = findPanel(docks, name);
  const target = previous.side === side && previous.index < index ? index - 1 : index;
  const others = { left: docks.left.filter((one) => one !== name), right: docks.right.filter((one) => one !== name) };
  const list = others[side];
  const position = Math.min(Math.max(target, 0), list.length);
  return { ...others, [side]: [...list.slice(0, position), name, ...list.slice(position)] };
}
