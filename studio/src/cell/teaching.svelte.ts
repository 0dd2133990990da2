// Taught points of the planes of stations: three define a plane, fewer wait for the others.

import * as api from '../api/client';
import type { StationDocument } from '../api/client';

/** Minimum number of points that define a plane. */
export const MIN_PLANE_POINTS = 3;
/** Maximum distance of a taught point from the plane of all points, for stations without a threshold of their own [m]. */
const DEFAULT_THRESHOLD = 1e-4;

/** The part of the session that teaching depends on. */
export interface TeachingContext {
  readonly stations: readonly StationDocument[];
  /** `teaching`: name of the station that is taught by clicks. */
  readonly tools: { teaching: string | null };
  readonly changes: {
    setStation(station: string, change: api.StationChange, taken?: () => void): Promise<void>;
  };
  /** Completes an edit: adds it to the undo history and plans it. */
  commit(): void;
}

export class Teaching {
  /** Taught points of stations with too few points for a plane [m]. */
  points = $state.raw<Record<string, number[][]>>({});
  readonly #context: TeachingContext;

  constructor(context: TeachingContext) {
    this.#context = context;
  }

  /** All taught points of the plane of a station [m]. */
  pointsOf({ name, taught_m }: StationDocument): number[][] {
    return this.points[name] ?? taught_m;
  }

  /** Adds a point of the plane of a station; three points define it. */
  async teachPoint(station: StationDocument, point: number[], by: api.TaughtBy): Promise<void> {
    await this.teachPlane(station, [...this.pointsOf(station), point], by);
  }

  /** Adds a clicked point [m] to the plane of the station that is taught by clicks; without a point, ends teaching. */
  async teachClicked(point: number[] | null): Promise<void> {
    const { stations, tools } = this.#context;
    const station = stations.find(({ name }) => name === tools.teaching);
    // The picture has single precision.
    if (station && point) await this.teachPlane(station, [...this.pointsOf(station), point.map((m) => Number(m.toFixed(6)))]);
    else tools.teaching = null;
  }

  async teachPlane({ name, plane, taught_m }: StationDocument, points: number[][], by?: api.TaughtBy): Promise<void> {
    const { changes } = this.#context;
    const { [name]: _, ...others } = this.points;
    if (points.length >= MIN_PLANE_POINTS) {
      const threshold_m = plane ? plane.threshold_um / 1e6 : DEFAULT_THRESHOLD;
      const taken = () => (this.points = others);
      await changes.setStation(name, { taught: { points_m: points, threshold_m }, ...(by ? { taught_by: by } : {}) }, taken);
      return;
    }
    // Too few points for a plane: they are kept in addition to an existing plane.
    const waiting = points.length > 0 || taught_m.length > 0 ? { ...this.points, [name]: points } : others;
    const taken = () => (this.points = waiting);
    if (by) await changes.setStation(name, { taught_by: by }, taken);
    else {
      taken();
      this.#context.commit();
    }
  }
}
