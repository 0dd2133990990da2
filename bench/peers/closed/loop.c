/* The closed equations in a loop over poses without branches, which the compiler vectorizes.
 *
 * The loop performs two Newton steps for each pose; hand.c solves the poses that have not converged, one by one.
 * Each number is a separate variable, because arrays prevent the vectorization.
 */
#define closed_many closed_many_by_hand
#include "hand.c"
#undef closed_many

struct three {
  double a, b, c;
};

static inline struct three times(const double m[3][3], struct three v) {
  return (struct three){m[0][0] * v.a + m[0][1] * v.b + m[0][2] * v.c, m[1][0] * v.a + m[1][1] * v.b + m[1][2] * v.c,
                        m[2][0] * v.a + m[2][1] * v.b + m[2][2] * v.c};
}

static inline struct side near(const struct constants *is, int k, double li, double lj, double turn) {
  double s, c;
  series(turn, &s, &c);
  return side_of(li, lj, s, c, is->cosine[k], is->sine[k]);
}

static inline double rise(double a, double b) { return (b - a) * (b - a); }

static size_t newton(const struct closed_robot *robot, size_t count, const double *const rods[3], double *const out[]) {
  const struct constants is = constants_of(robot);
  const double gap = robot->gap, metric = robot->metric, weight = is.stiffness;
  double first_l[3][3], first_p[3][3];
  memcpy(first_l, is.first, sizeof first_l);
  memcpy(first_p, is.first + 3, sizeof first_p);
  const double *restrict qa = rods[0], *restrict qb = rods[1], *restrict qc = rods[2];
  double *restrict la = out[0], *restrict lb = out[1], *restrict lc = out[2];
  double *restrict pa = out[3], *restrict pb = out[4], *restrict pc = out[5], *restrict residual = out[6];
#pragma omp simd
  for (size_t k = 0; k < count; ++k) {
    struct three w = {0.5 * (is.level[0] + rise(qa[k], qb[k])), 0.5 * (is.level[1] + rise(qb[k], qc[k])),
                      0.5 * (is.level[2] + rise(qc[k], qa[k]))};
    struct three b = {w.a - is.nominal[0], w.b - is.nominal[1], w.c - is.nominal[2]};
    struct three l = times(first_l, b), p = times(first_p, b);
    l.a += is.radius[0], l.b += is.radius[1], l.c += is.radius[2];
    double widest = larger(larger(fabs(p.b - p.a), fabs(p.c - p.b)), fabs(p.a - p.c));
    struct side x = near(&is, 0, l.a, l.b, p.b - p.a), y = near(&is, 1, l.b, l.c, p.c - p.b);
    struct side z = near(&is, 2, l.c, l.a, p.a - p.c);
    b = (struct three){w.a - x.square, w.b - y.square, w.c - z.square};
    double kx = weight * x.by_turn, ky = weight * y.by_turn, kz = weight * z.by_turn;
    double xx = x.by_i * x.by_i + x.by_j * x.by_j + 2. * (kx * x.by_turn);
    double yy = y.by_i * y.by_i + y.by_j * y.by_j + 2. * (ky * y.by_turn);
    double zz = z.by_i * z.by_i + z.by_j * z.by_j + 2. * (kz * z.by_turn);
    double xy = x.by_j * y.by_i - kx * y.by_turn, yz = y.by_j * z.by_i - ky * z.by_turn;
    double xz = x.by_i * z.by_j - kx * z.by_turn;
    double cxx = yy * zz - yz * yz, cxy = xz * yz - xy * zz, cxz = xy * yz - yy * xz;
    double cyy = xx * zz - xz * xz, cyz = xy * xz - xx * yz, czz = xx * yy - xy * xy;
    double inverse = 1. / (xx * cxx + xy * cxy + xz * cxz);
    struct three by = {(cxx * b.a + cxy * b.b + cxz * b.c) * inverse, (cxy * b.a + cyy * b.b + cyz * b.c) * inverse,
                       (cxz * b.a + cyz * b.b + czz * b.c) * inverse};
    l.a += x.by_i * by.a + z.by_j * by.c, l.b += y.by_i * by.b + x.by_j * by.a, l.c += z.by_i * by.c + y.by_j * by.b;
    p.a += kz * by.c - kx * by.a, p.b += kx * by.a - ky * by.b, p.c += ky * by.b - kz * by.c;
    widest = larger(larger(larger(widest, fabs(p.b - p.a)), fabs(p.c - p.b)), fabs(p.a - p.c));
    x = near(&is, 0, l.a, l.b, p.b - p.a), y = near(&is, 1, l.b, l.c, p.c - p.b), z = near(&is, 2, l.c, l.a, p.a - p.c);
    double share = larger(larger(fabs(w.a - x.square) * (1. / is.half_gap[0]), fabs(w.b - y.square) * (1. / is.half_gap[1])),
                          fabs(w.c - z.square) * (1. / is.half_gap[2]));
    la[k] = l.a, lb[k] = l.b, lc[k] = l.c, pa[k] = p.a, pb[k] = p.b, pc[k] = p.c;
    residual[k] = widest <= SERIES ? share * gap : 1.;
  }
  size_t solved = 0;
  for (size_t k = 0; k < count; ++k) {
    if (__builtin_expect(!(residual[k] <= gap), 0)) {
      double q[3] = {qa[k], qb[k], qc[k]}, x[6];
      solve(&is, 0, q, metric, gap, x, &residual[k]);
      la[k] = x[0], lb[k] = x[1], lc[k] = x[2], pa[k] = x[3], pb[k] = x[4], pc[k] = x[5];
    }
    solved += residual[k] <= gap;
  }
  return solved;
}

size_t closed_many(const struct closed_robot *robot, enum closed_want want, size_t count, const double *const rods[3],
                   double *const out[]) {
  return want == CLOSED_X ? newton(robot, count, rods, out) : closed_many_by_hand(robot, want, count, rods, out);
}
