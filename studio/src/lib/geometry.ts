// Geometry of the display. All displayed values come from the server.

export type Point = [number, number];
export type Triple = [number, number, number];

/** Displayed position of a ball in the platform plane: its displacement from the nominal socket is scaled by the play scale. */
export function displayedBall(nominal: Point, actual: Point, playScale: number): Point {
  return [nominal[0] + playScale * (actual[0] - nominal[0]), nominal[1] + playScale * (actual[1] - nominal[1])];
}

/** The convex outline of circles of one radius about given points, counter-clockwise. */
export function outline(points: Point[], radius: number, steps = 24): Point[] {
  const corners = hull(points);
  const count = corners.length;
  const line: Point[] = [];
  for (let i = 0; i < count; i++) {
    const at = corners[i] as Point;
    const before = corners[(i + count - 1) % count] as Point;
    const after = corners[(i + 1) % count] as Point;
    const start = Math.atan2(at[1] - before[1], at[0] - before[0]) - Math.PI / 2;
    let end = Math.atan2(after[1] - at[1], after[0] - at[0]) - Math.PI / 2;
    if (end < start) end += 2 * Math.PI;
    for (let step = 0; step <= steps; step++) {
      const angle = start + ((end - start) * step) / steps;
      line.push([at[0] + radius * Math.cos(angle), at[1] + radius * Math.sin(angle)]);
    }
  }
  return line;
}

/** The largest half-angle of a cut-out [rad]. */
const CUT_HALF_ANGLE = 0.7;

/**
 * The outline of a plate around points, cut open to a round hole at each of its corners, counter-clockwise; the cuts face outwards.
 * Points that are no corners get a closed hole.
 */
export function cutPlate(points: Point[], radius: number, hole: number, steps = 24): { line: Point[]; holes: Point[]; cuts: { from: number; to: number }[] } {
  const corners = hull(points);
  const line: Point[] = [];
  const cuts: { from: number; to: number }[] = points.map(() => ({ from: 0, to: 0 }));
  corners.forEach((at, i) => {
    const before = corners[(i + corners.length - 1) % corners.length] as Point;
    const after = corners[(i + 1) % corners.length] as Point;
    const start = Math.atan2(at[1] - before[1], at[0] - before[0]) - Math.PI / 2;
    let end = Math.atan2(after[1] - at[1], after[0] - at[0]) - Math.PI / 2;
    if (end < start) end += 2 * Math.PI;
    const middle = (start + end) / 2;
    const half = Math.min(CUT_HALF_ANGLE, 0.45 * (end - start));
    const arc = (of: number, from: number, to: number) => {
      for (let step = 0; step <= steps; step++) {
        const angle = from + ((to - from) * step) / steps;
        line.push([at[0] + of * Math.cos(angle), at[1] + of * Math.sin(angle)]);
      }
    };
    arc(radius, start, middle - half);
    // Around the hole on its inner side.
    arc(hole, middle - half, middle + half - 2 * Math.PI);
    arc(radius, middle + half, end);
    cuts[points.indexOf(at)] = { from: middle - half, to: middle + half };
  });
  return { line, holes: points.filter((point) => !corners.includes(point)), cuts };
}

/** Convex hull, counter-clockwise. */
export function hull(points: Point[]): Point[] {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turn = (o: Point, a: Point, b: Point) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
  const half = (order: Point[]) => {
    const chain: Point[] = [];
    for (const point of order) {
      while (chain.length > 1 && turn(chain.at(-2) as Point, chain.at(-1) as Point, point) <= 0) chain.pop();
      chain.push(point);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

/**
 * The path of a socket from its nominal position to its ball, one polyline for each joint of the model, in the platform plane.
 * The path starts at (0, 0) and ends at `delta`, the displayed displacement of the socket.
 */
export function jointPaths(model: string, nominal: Point, delta: Point): Point[][] {
  const radius = Math.hypot(...nominal);
  const out: Point = radius > 0 ? [nominal[0] / radius, nominal[1] / radius] : [1, 0];
  const side: Point = [-out[1], out[0]];
  const along = delta[0] * out[0] + delta[1] * out[1];
  const across = delta[0] * side[0] + delta[1] * side[1];
  switch (model) {
    case 'planar':
      return [
        [
          [0, 0],
          [delta[0], 0],
        ],
        [[delta[0], 0], delta],
      ];
    case 'polar': {
      // A displacement along the radius, then an arc about the platform centre.
      const steps = 16;
      const arc: Point[] = [];
      for (let step = 0; step <= steps; step++) {
        const part = step / steps;
        const sag = radius > 0 ? (across * across * part * (1 - part)) / (2 * radius) : 0;
        arc.push([
          out[0] * (along + sag) + side[0] * across * part,
          out[1] * (along + sag) + side[1] * across * part,
        ]);
      }
      return [[[0, 0], [out[0] * along, out[1] * along]], arc];
    }
    default:
      return [[[0, 0], delta]];
  }
}
