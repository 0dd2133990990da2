// Places of labels: none overlaps another one or an occupied area, and none leaves the view. Units: px.

export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** A label that is to be placed: a text at a point. */
export interface LabelRequest {
  /** The labelled point. */
  x: number;
  y: number;
  width: number;
  height: number;
  /** Preferred position of the centre of the text, relative to the point. */
  offset: [number, number];
  /** The label may cover avoided areas: it stays near its point while parts move past it. */
  stays?: boolean;
}

/** A placed label: the box of its text, and whether a line has to connect it with its point. */
export interface PlacedLabel {
  index: number;
  box: Box;
  leader: boolean;
}

/** A convex polygon by its corners, in order; two corners are a line. */
export type Polygon = readonly (readonly [number, number])[];

/** Distances of alternative places from the preferred one, and the number of directions. */
const DISTANCES = [16, 30, 46, 64, 84, 106];
/** Further distances, for labels of points within avoided areas; lines are avoided nearby or not at all. */
const FURTHER_DISTANCES = [130, 160, 190, 225, 260, 300];
const DIRECTIONS = 12;
/** Beyond this distance between point and text, a line connects them. */
const LEADER = 26;
const GAP = 2;

/** The box around a polygon. */
function around(polygon: Polygon): Box {
  const [x, y] = [polygon.map(([x]) => x), polygon.map(([, y]) => y)];
  return { left: Math.min(...x), top: Math.min(...y), right: Math.max(...x), bottom: Math.max(...y) };
}

const overlap = (a: Box, b: Box) => a.left < b.right + GAP && b.left < a.right + GAP && a.top < b.bottom + GAP && b.top < a.bottom + GAP;

/** Distance of a point from a box. */
export function distanceTo(box: Box, x: number, y: number): number {
  return Math.hypot(Math.max(box.left - x, x - box.right, 0), Math.max(box.top - y, y - box.bottom, 0));
}

/** Corners of a box, grown by the gap. */
const corners = ({ left, top, right, bottom }: Box): Polygon => [
  [left - GAP, top - GAP],
  [right + GAP, top - GAP],
  [right + GAP, bottom + GAP],
  [left - GAP, bottom + GAP],
];

/** Whether two convex polygons intersect: no edge of either separates them. */
export function intersect(a: Polygon, b: Polygon): boolean {
  for (const polygon of [a, b])
    for (let i = 0; i < polygon.length; i++) {
      const [from, to] = [polygon[i]!, polygon[(i + 1) % polygon.length]!];
      const normal = [from[1] - to[1], to[0] - from[0]] as const;
      const range = (points: Polygon) => {
        const along = points.map(([x, y]) => x * normal[0] + y * normal[1]);
        return [Math.min(...along), Math.max(...along)] as const;
      };
      const [[leastA, mostA], [leastB, mostB]] = [range(a), range(b)];
      if (mostA < leastB || mostB < leastA) return false;
    }
  return true;
}

/** The point of a box that is nearest to a point: the end of a leader line. */
export const leaderEnd = (box: Box, x: number, y: number): [number, number] => [Math.min(Math.max(x, box.left), box.right), Math.min(Math.max(y, box.top), box.bottom)];

/**
 * Places labels in their order: the first ones get the best places. A label without any free place is omitted.
 *
 * Labels do not cover avoided areas as long as there is another place; the first area is the most important one.
 */
export function placeLabels(requests: readonly LabelRequest[], view: Box, occupied: readonly Box[] = [], avoided: readonly Polygon[] = []): PlacedLabel[] {
  const taken = [...occupied];
  const texts: Polygon[] = [];
  const leaders: Polygon[] = [];
  const placed: PlacedLabel[] = [];
  const areas = avoided.map((area) => ({ area, bounds: around(area) }));
  requests.forEach(({ x, y, width, height, offset: [right, down], stays = false }, index) => {
    const distances = !stays && avoided.some((area) => area.length > 2) ? [...DISTANCES, ...FURTHER_DISTANCES] : DISTANCES;
    const at = (dx: number, dy: number): Box => {
      const left = Math.min(Math.max(x + dx - width / 2, view.left), view.right - width);
      const top = Math.min(Math.max(y + dy - height / 2, view.top), view.bottom - height);
      return { left, top, right: left + width, bottom: top + height };
    };
    const candidates = [at(right, down)];
    // Alternatives start in the preferred direction.
    const start = Math.atan2(down, right);
    for (const distance of distances)
      for (let i = 0; i < DIRECTIONS; i++) {
        const angle = start + (i % 2 === 0 ? 1 : -1) * Math.ceil(i / 2) * ((2 * Math.PI) / DIRECTIONS);
        candidates.push(at(right + distance * Math.cos(angle), down + distance * Math.sin(angle)));
      }
    const free = candidates.filter((one) => one.left >= view.left && one.top >= view.top && !taken.some((other) => overlap(one, other)));
    const leaderOf = (box: Box): Polygon => [[x, y], leaderEnd(box, x, y)];
    const otherPoints = requests.flatMap((one) => (Math.hypot(one.x - x, one.y - y) < 2 * GAP ? [] : [corners({ left: one.x, top: one.y, right: one.x, bottom: one.y })]));
    const isFar = (box: Box) => distanceTo(box, x, y) > LEADER;
    /** Neither its leader line crosses other labels and their points, nor others cross this label. */
    const isClear = (box: Box) => !leaders.some((line) => intersect(line, corners(box))) && !(isFar(box) && [...texts, ...leaders, ...otherPoints].some((other) => intersect(leaderOf(box), other)));
    // Only areas that are near enough to be covered by one of the places.
    const reach = around(free.flatMap(corners));
    const near = stays ? [] : areas.filter(({ bounds }) => overlap(bounds, reach));
    const avoids = (some: typeof areas) => (box: Box) => !some.some(({ area, bounds }) => overlap(bounds, box) && intersect(area, corners(box)));
    const [all, first] = [avoids(near), avoids(stays ? [] : areas.slice(0, 1))];
    const box = free.find((one) => all(one) && isClear(one)) ?? free.find((one) => first(one) && isClear(one)) ?? free.find(first) ?? free.find(isClear) ?? free[0];
    if (!box) return;
    taken.push(box);
    texts.push(corners(box));
    if (isFar(box)) leaders.push(leaderOf(box));
    placed.push({ index, box, leader: isFar(box) });
  });
  return placed;
}

/** A part of a text: normal or subscript. */
export interface TextPart {
  text: string;
  subscript: boolean;
}

/** Splits a text at its subscripts: of a symbol such as `O_b`, and `l₁`. Names such as `motor_a` have none. */
export function textParts(text: string): TextPart[] {
  const symbol = /^(\p{L})_(\w)$/u.exec(text);
  if (symbol) return [{ text: symbol[1]!, subscript: false }, { text: symbol[2]!, subscript: true }];
  const parts: TextPart[] = [];
  for (const [, digits, plain] of text.matchAll(/([₀-₉]+)|([^₀-₉]+)/g)) {
    if (plain !== undefined) parts.push({ text: plain, subscript: false });
    else parts.push({ text: [...digits!].map((digit) => String(digit.charCodeAt(0) - 0x2080)).join(''), subscript: true });
  }
  return parts;
}
