// Tools of the 3D view of a cell: play scale, hidden parts, section plane, followed part, path of a wafer, measuring.

import { partKey, type Part } from '../lib/parts';

export const SECTION_AXES = ['x', 'y', 'z'] as const;
export type SectionAxis = (typeof SECTION_AXES)[number];

/** A plane normal to an axis of the base frame; the part beyond it is not drawn. */
export interface Section {
  axis: SectionAxis;
  /** Position along the axis [m]. */
  at: number;
}

/** A point that moves with its part: its position in the base frame [m]; `null` once the part is removed. */
export type PointOfPart = () => number[] | null;

/** A clicked point. */
interface ClickedPoint {
  /** Name of the part. */
  part: string;
  now: PointOfPart;
  /** Position in the base frame [m]. */
  point: number[];
}

export class ViewTools {
  /** Factor by which the picture enlarges the play of the platform. */
  playScale = $state(1);
  /** Keys of the hidden parts. */
  hidden = $state.raw<ReadonlySet<string>>(new Set());
  section = $state.raw<Section | null>(null);
  /** The part that the camera follows. */
  followed = $state.raw<Part | null>(null);
  /** Name of the wafer whose path is drawn. */
  traced = $state<string | null>(null);
  /** Whether the minimum distance in the shown pose is drawn as a line. */
  nearestShown = $state(true);
  /** The pair whose distance is drawn; `null` for the pair with the smallest distance. */
  pair = $state.raw<readonly Part[] | null>(null);
  /** Name of the station whose plane is taught by clicked points; `null` if clicks do not teach. */
  teaching = $state<string | null>(null);
  /** Whether clicks measure distances. */
  measuring = $state(false);
  /** The clicked points [m], at most two, with the parts they are on. */
  points = $state.raw<ClickedPoint[]>([]);
  /** Distance of the two clicked points, and its components [m]. */
  distance = $derived.by(() => {
    const [from, to] = this.points;
    if (!from || !to) return null;
    const by = to.point.map((value, k) => value - from.point[k]!);
    return { length: Math.hypot(...by), by };
  });

  isHidden(keys: readonly string[]): boolean {
    return keys.length > 0 && keys.every((key) => this.hidden.has(key));
  }

  /** Hides the parts with the given keys, or shows them again. */
  toggleHidden(keys: readonly string[]): void {
    const hide = !this.isHidden(keys);
    const hidden = new Set(this.hidden);
    for (const key of keys) if (hide) hidden.add(key);
    else hidden.delete(key);
    this.hidden = hidden;
  }

  /** Hides all parts but those with the given keys. */
  isolate(keys: ReadonlySet<string>, all: Iterable<string>): void {
    this.hidden = new Set([...all].filter((key) => !keys.has(key)));
  }

  showAll(): void {
    this.hidden = new Set();
  }

  /** Resets the tools that refer to parts of a cell that is no longer shown. */
  leaveCell(): void {
    this.showAll();
    this.setMeasuring(false);
    this.followed = null;
    this.traced = null;
    this.pair = null;
    this.teaching = null;
  }

  /** Adds a clicked point; a third one begins another measurement. */
  measure(part: string, now: PointOfPart): void {
    const point = now();
    if (!point) return;
    const clicked = { part, now, point };
    this.points = this.points.length >= 2 ? [clicked] : [...this.points, clicked];
  }

  /** Moves the clicked points with their parts; without one of the parts, there is no measurement. */
  partsMoved(): void {
    if (this.points.length === 0) return;
    const moved = this.points.flatMap(({ part, now }) => {
      const point = now();
      return point ? [{ part, now, point }] : [];
    });
    this.points = moved.length === this.points.length ? moved : [];
  }

  /** Draws the distance of a pair, or that of the nearest pair again. */
  togglePair(pair: readonly Part[]): void {
    this.pair = this.isPair(pair) ? null : pair;
    if (this.pair) this.nearestShown = true;
  }

  isPair(pair: readonly Part[]): boolean {
    return this.pair?.map(partKey).join('\0') === pair.map(partKey).join('\0');
  }

  /** Begins or ends teaching the plane of a station by clicked points. */
  toggleTeaching(station: string): void {
    const begins = this.teaching !== station;
    this.setMeasuring(false);
    this.teaching = begins ? station : null;
  }

  setMeasuring(measuring: boolean): void {
    this.measuring = measuring;
    if (measuring) this.teaching = null;
    this.points = [];
  }
}
