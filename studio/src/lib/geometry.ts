// Shapes to draw. What they show comes from the server; nothing here is a result.

export type Point = [number, number];
export type Triple = [number, number, number];

export interface Play {
  /** Nominal sockets, in the platform plane. */
  nominal: Point[];
  /** Sockets after the virtual joints have moved, in the platform plane. */
  moved: Point[];
}

/** Where socket `limb` as built is drawn beside its ball, play drawn so many times its size. */
export function seat(ball: Triple, gap: Triple, exaggeration: number): Triple {
  return [ball[0] - exaggeration * gap[0], ball[1] - exaggeration * gap[1], ball[2] - exaggeration * gap[2]];
}

/**
 * The matrix, column by column, that carries three points of the platform plane where they are drawn.
 * With exaggerated play the platform drawn is not rigid: it shrinks away from its balls as the real one does, only more.
 */
export function planeMap(from: [Point, Point, Point], to: [Triple, Triple, Triple], normal: Triple): number[] {
  const [a, b, c] = from;
  const [p, q, r] = to;
  const u: Point = [b[0] - a[0], b[1] - a[1]];
  const v: Point = [c[0] - a[0], c[1] - a[1]];
  const area = u[0] * v[1] - u[1] * v[0];
  const x: number[] = [];
  const y: number[] = [];
  const origin: number[] = [];
  for (let i = 0; i < 3; i++) {
    const along = (q[i] as number) - (p[i] as number);
    const across = (r[i] as number) - (p[i] as number);
    x[i] = (along * v[1] - across * u[1]) / area;
    y[i] = (across * u[0] - along * v[0]) / area;
    origin[i] = (p[i] as number) - (x[i] as number) * a[0] - (y[i] as number) * a[1];
  }
  return [...x, 0, ...y, 0, ...normal, 0, ...origin, 1];
}

/** The outline of circles of one radius about the given points, held by a stretched string; counter-clockwise. */
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
 * The way of one socket from where it was built to its ball, joint by joint as the model has them, in the platform plane;
 * begins at (0, 0), and the last stretch ends at `delta`, the socket's displacement as it is drawn.
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
      // A slide along the radius, then an arc about the platform's centre: drawn with its true curvature.
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
