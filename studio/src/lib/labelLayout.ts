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
}

/** A placed label: the box of its text, and whether a line has to connect it with its point. */
export interface PlacedLabel {
  index: number;
  box: Box;
  leader: boolean;
}

/** Distances of alternative places from the preferred one, and the number of directions. */
const DISTANCES = [16, 30, 46, 64, 84, 106];
const DIRECTIONS = 12;
/** Beyond this distance between point and text, a line connects them. */
const LEADER = 26;
const GAP = 2;

const overlap = (a: Box, b: Box) => a.left < b.right + GAP && b.left < a.right + GAP && a.top < b.bottom + GAP && b.top < a.bottom + GAP;

/** Distance of a point from a box. */
export function distanceTo(box: Box, x: number, y: number): number {
  return Math.hypot(Math.max(box.left - x, x - box.right, 0), Math.max(box.top - y, y - box.bottom, 0));
}

/**
 * Places labels in their order: the first ones get the best places. A label without any free place is omitted.
 */
export function placeLabels(requests: readonly LabelRequest[], view: Box, occupied: readonly Box[] = []): PlacedLabel[] {
  const taken = [...occupied];
  const placed: PlacedLabel[] = [];
  requests.forEach(({ x, y, width, height, offset: [right, down] }, index) => {
    const at = (dx: number, dy: number): Box => {
      const left = Math.min(Math.max(x + dx - width / 2, view.left), view.right - width);
      const top = Math.min(Math.max(y + dy - height / 2, view.top), view.bottom - height);
      return { left, top, right: left + width, bottom: top + height };
    };
    const candidates = [at(right, down)];
    // Alternatives start in the preferred direction.
    const start = Math.atan2(down, right);
    for (const distance of DISTANCES)
      for (let i = 0; i < DIRECTIONS; i++) {
        const angle = start + (i % 2 === 0 ? 1 : -1) * Math.ceil(i / 2) * ((2 * Math.PI) / DIRECTIONS);
        candidates.push(at(right + distance * Math.cos(angle), down + distance * Math.sin(angle)));
      }
    const box = candidates.find((one) => one.left >= view.left && one.top >= view.top && !taken.some((other) => overlap(one, other)));
    if (!box) return;
    taken.push(box);
    placed.push({ index, box, leader: distanceTo(box, x, y) > LEADER });
  });
  return placed;
}

/** A part of a text: normal or subscript. */
export interface TextPart {
  text: string;
  subscript: boolean;
}

/** Splits a text at its subscripts: `O_b`, `l₁`. */
export function textParts(text: string): TextPart[] {
  const parts: TextPart[] = [];
  for (const [, subscript, digits, plain] of text.matchAll(/_(\w)|([₀-₉]+)|([^_₀-₉]+|_)/g)) {
    if (plain !== undefined) parts.push({ text: plain, subscript: false });
    else parts.push({ text: subscript ?? [...digits!].map((digit) => String(digit.charCodeAt(0) - 0x2080)).join(''), subscript: true });
  }
  return parts;
}
