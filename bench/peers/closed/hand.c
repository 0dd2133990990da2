/* The closed equations in hand-written C: pose by pose with LANES 1, otherwise LANES poses at once in vectors of the compiler.
 *
 * The code is optimized: law of cosines instead of points, no roots, series for sines and cosines of the small angles
 * between sockets, a first step from nominal with a constant matrix, and symmetric 3×3 systems by their adjugate with a
 * single division. TEXTBOOK disables the series and the constant first step.
 */
#include "closed.h"

#include <math.h>
#include <string.h>

#ifndef LANES
#define LANES 1
#endif

#if LANES == 1
typedef double real;
#define ANY(condition) (condition)
static inline double magnitude(double a) { return fabs(a); }
static inline double larger(double a, double b) { return a > b ? a : b; }
static inline int within(double a, double bound) { return a <= bound; }
#else
typedef double real __attribute__((vector_size(8 * LANES)));
typedef long long mask __attribute__((vector_size(8 * LANES)));
static inline real choose(mask where, real a, real b) {
  return (real)(((mask)a & where) | ((mask)b & ~where));
}
static inline real magnitude(real a) { return (real)((mask)a & 0x7fffffffffffffffLL); }
static inline real larger(real a, real b) { return choose(a > b, a, b); }
/* Whether all lanes are within the bound; NaN is not. */
static inline int within(real a, double bound) {
  mask in = a <= bound;
  long long all = -1;
  for (int v = 0; v < LANES; ++v) all &= in[v];
  return all != 0;
}
#endif

/* Largest angle between neighbouring sockets for which the series are exact to round-off [rad]. */
#ifdef TEXTBOOK
#define SERIES -1.0
#else
#define SERIES 0.25
#endif
#define STEPS 50

/* Constants of the robot, the same for all poses; sides in the order 01, 12, 20. */
struct constants {
  double radius[3], cosine[3], sine[3];
  double level[3];     /* |B_j − B_i|² */
  double half_gap[3];  /* largest |F|/2 of a side within the gap: |L − l| = |F|/(L + l), and L ≥ √level */
  double nominal[3];   /* |p_j − p_i|²/2 at nominal */
  double first[6][3];  /* matrix of the first step: ∂(X − X_0)/∂(F/2) */
  double stiffness;    /* 1/ρ² */
};

static inline void series(real a, real *s, real *c) {
  real z = a * a;
  *s = a + a * z * (-1. / 6 + z * (1. / 120 + z * (-1. / 5040 + z * (1. / 362880 + z * (-1. / 39916800)))));
  *c = 1. + z * (-1. / 2 + z * (1. / 24 + z * (-1. / 720 + z * (1. / 40320 + z * (-1. / 3628800 + z * (1. / 479001600))))));
}

static inline void sine_cosine(real a, real *s, real *c) {
  if (__builtin_expect(!within(magnitude(a), SERIES), 0)) {
#if LANES == 1
    *s = sin(a);
    *c = cos(a);
#else
    for (int v = 0; v < LANES; ++v) {
      (*s)[v] = sin(a[v]);
      (*c)[v] = cos(a[v]);
    }
#endif
    return;
  }
  series(a, s, c);
}

/* Half of the squared side i–j, and half of its derivatives by l_i, l_j and φ_j; the derivative by φ_i is minus the last. */
struct side {
  real square, by_i, by_j, by_turn;
};

static inline struct side side_of(real li, real lj, real s, real c, double cosine, double sine) {
  real along = cosine * c - sine * s, across = sine * c + cosine * s;
  return (struct side){0.5 * (li * li + lj * lj) - li * lj * along, li - lj * along, lj - li * along, li * lj * across};
}

/* W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ b, with half of J and half of b. */
static inline void step_of(const struct side *at, const real *b, double stiffness, real *step) {
  real k01 = stiffness * at[0].by_turn, k12 = stiffness * at[1].by_turn, k20 = stiffness * at[2].by_turn;
  real xx = at[0].by_i * at[0].by_i + at[0].by_j * at[0].by_j + 2. * (k01 * at[0].by_turn);
  real yy = at[1].by_i * at[1].by_i + at[1].by_j * at[1].by_j + 2. * (k12 * at[1].by_turn);
  real zz = at[2].by_i * at[2].by_i + at[2].by_j * at[2].by_j + 2. * (k20 * at[2].by_turn);
  real xy = at[0].by_j * at[1].by_i - k01 * at[1].by_turn;
  real yz = at[1].by_j * at[2].by_i - k12 * at[2].by_turn;
  real xz = at[0].by_i * at[2].by_j - k01 * at[2].by_turn;
  real cxx = yy * zz - yz * yz, cxy = xz * yz - xy * zz, cxz = xy * yz - yy * xz;
  real cyy = xx * zz - xz * xz, cyz = xy * xz - xx * yz, czz = xx * yy - xy * xy;
  real inverse = 1. / (xx * cxx + xy * cxy + xz * cxz);
  real p = (cxx * b[0] + cxy * b[1] + cxz * b[2]) * inverse;
  real q = (cxy * b[0] + cyy * b[1] + cyz * b[2]) * inverse;
  real r = (cxz * b[0] + cyz * b[1] + czz * b[2]) * inverse;
  step[0] = at[0].by_i * p + at[2].by_j * r;
  step[1] = at[1].by_i * q + at[0].by_j * p;
  step[2] = at[2].by_i * r + at[1].by_j * q;
  step[3] = k20 * r - k01 * p;
  step[4] = k01 * p - k12 * q;
  step[5] = k12 * q - k20 * r;
}

static inline void sides_at(const struct constants *is, const real *x, struct side *at) {
  for (int k = 0; k < 3; ++k) {
    int j = (k + 1) % 3;
    real s, c;
    sine_cosine(x[3 + j] - x[3 + k], &s, &c);
    at[k] = side_of(x[k], x[j], s, c, is->cosine[k], is->sine[k]);
  }
}

/* X after the first step from nominal, and half of the squared sides that the rods determine. */
static inline void begin(const struct constants *is, const real *rods, real *x, real *wanted) {
  real b[3];
  for (int k = 0; k < 3; ++k) {
    real rise = rods[(k + 1) % 3] - rods[k];
    wanted[k] = 0.5 * (is->level[k] + rise * rise);
    b[k] = wanted[k] - is->nominal[k];
  }
#ifdef TEXTBOOK
  for (int m = 0; m < 6; ++m) x[m] = (real){0};
#else
  for (int m = 0; m < 6; ++m) x[m] = is->first[m][0] * b[0] + is->first[m][1] * b[1] + is->first[m][2] * b[2];
#endif
  for (int k = 0; k < 3; ++k) x[k] += is->radius[k];
}

/* The largest residual as a fraction of the allowed one, so that one comparison is sufficient. */
static inline real share_of(const struct constants *is, const real *b) {
  return larger(larger(magnitude(b[0]) * (1. / is->half_gap[0]), magnitude(b[1]) * (1. / is->half_gap[1])),
                magnitude(b[2]) * (1. / is->half_gap[2]));
}

/* Computes X and the residual from the rods. */
static inline void solve(const struct constants *is, int least, const real *rods, double metric, double gap, real *x,
                         real *residual) {
  real wanted[3], b[3], step[6];
  struct side at[3];
  begin(is, rods, x, wanted);
  int settled = !least;
  for (int steps = 0;; ++steps) {
    sides_at(is, x, at);
    for (int k = 0; k < 3; ++k) b[k] = wanted[k] - at[k].square;
    real share = share_of(is, b);
    *residual = share * gap;
    if ((settled && within(share, 1.)) || steps == STEPS) return;
    if (!least) {
      step_of(at, b, is->stiffness, step);
      for (int m = 0; m < 6; ++m) x[m] += step[m];
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      int j = (k + 1) % 3;
      b[k] += at[k].by_i * (x[k] - is->radius[k]) + at[k].by_j * (x[j] - is->radius[j]) +
              at[k].by_turn * (x[3 + j] - x[3 + k]);
    }
    step_of(at, b, is->stiffness, step);
    real moved = (real){0};
    for (int m = 0; m < 6; ++m) {
      real now = m < 3 ? step[m] + is->radius[m] : step[m];
      real change = m < 3 ? now - x[m] : metric * (now - x[m]);
      moved += change * change;
      x[m] = now;
    }
    settled = within(moved, gap * gap);
  }
}

static inline real root(real a) {
#if LANES == 1
  return sqrt(a);
#else
  real r;
  for (int v = 0; v < LANES; ++v) r[v] = sqrt(a[v]);
  return r;
#endif
}

/* Computes from rods and X the rotation (by rows) and the point of the pose that maps the sockets onto the balls. */
static inline void place(const struct closed_robot *robot, const real *rods, const real *x, real *pose) {
  real px[3], py[3];
  for (int k = 0; k < 3; ++k) {
    real s, c;
    sine_cosine(x[3 + k], &s, &c);
    px[k] = x[k] * (robot->direction[k][0] * c - robot->direction[k][1] * s);
    py[k] = x[k] * (robot->direction[k][1] * c + robot->direction[k][0] * s);
  }
  double ax = robot->base[1][0] - robot->base[0][0], ay = robot->base[1][1] - robot->base[0][1];
  double bx = robot->base[2][0] - robot->base[0][0], by = robot->base[2][1] - robot->base[0][1];
  double area = ax * by - ay * bx;
  real az = rods[1] - rods[0], bz = rods[2] - rods[0];
  real nx = ay * bz - az * by, ny = az * bx - ax * bz;
  real upright = (area > 0 ? 1. : -1.) / root(nx * nx + ny * ny + area * area);
  nx *= upright, ny *= upright;
  real nz = area * upright;
  real shrink = 1. / root(ax * ax + ay * ay + az * az);
  real ex = ax * shrink, ey = ay * shrink, ez = az * shrink;
  real hx = ny * ez - nz * ey, hy = nz * ex - nx * ez, hz = nx * ey - ny * ex;
  real fx = (px[1] - px[0]) * shrink, fy = (py[1] - py[0]) * shrink;
  pose[0] = ex * fx - hx * fy, pose[1] = ex * fy + hx * fx, pose[2] = nx;
  pose[3] = ey * fx - hy * fy, pose[4] = ey * fy + hy * fx, pose[5] = ny;
  pose[6] = ez * fx - hz * fy, pose[7] = ez * fy + hz * fx, pose[8] = nz;
  real mx = (px[0] + px[1] + px[2]) * (1. / 3), my = (py[0] + py[1] + py[2]) * (1. / 3);
  double cx = (robot->base[0][0] + robot->base[1][0] + robot->base[2][0]) / 3;
  double cy = (robot->base[0][1] + robot->base[1][1] + robot->base[2][1]) / 3;
  pose[9] = cx - pose[0] * mx - pose[1] * my;
  pose[10] = cy - pose[3] * mx - pose[4] * my;
  pose[11] = (rods[0] + rods[1] + rods[2]) * (1. / 3) - pose[6] * mx - pose[7] * my;
}

static struct constants constants_of(const struct closed_robot *robot) {
  struct constants is = {.stiffness = 1 / (robot->metric * robot->metric)};
  struct side at[3];
  real x[6] = {0};
  for (int k = 0; k < 3; ++k) {
    int j = (k + 1) % 3;
    const double *own = robot->direction[k], *next = robot->direction[j];
    is.radius[k] = robot->radius[k];
    is.cosine[k] = own[0] * next[0] + own[1] * next[1];
    is.sine[k] = own[0] * next[1] - own[1] * next[0];
    double dx = robot->base[j][0] - robot->base[k][0], dy = robot->base[j][1] - robot->base[k][1];
    is.level[k] = dx * dx + dy * dy;
    is.half_gap[k] = robot->gap * sqrt(is.level[k]);
    x[k] = x[k] + robot->radius[k];
  }
  sides_at(&is, x, at);
#if LANES == 1
#define FIRST(a) (a)
#else
#define FIRST(a) ((a)[0])
#endif
  for (int k = 0; k < 3; ++k) {
    real b[3] = {0}, step[6];
    is.nominal[k] = FIRST(at[k].square);
    b[k] = b[k] + 1.;
    step_of(at, b, is.stiffness, step);
    for (int m = 0; m < 6; ++m) is.first[m][k] = FIRST(step[m]);
  }
  return is;
}

static inline size_t every(const struct closed_robot *robot, int least, int with_pose, size_t count,
                           const double *const rods[3], double *const out[]) {
  const struct constants is = constants_of(robot);
  const struct closed_robot own = *robot;
  size_t solved = 0;
  for (size_t first = 0; first < count; first += LANES) {
    size_t lanes = count - first < LANES ? count - first : LANES;
    real q[3], x[6], residual, pose[12];
    for (int k = 0; k < 3; ++k) {
      q[k] = (real){0} + rods[k][count - 1];
      memcpy(&q[k], rods[k] + first, lanes == LANES ? sizeof(real) : lanes * sizeof(double));
    }
    solve(&is, least, q, own.metric, own.gap, x, &residual);
    if (with_pose) place(&own, q, x, pose);
    if (lanes == LANES) {
      for (int m = 0; m < 6; ++m) memcpy(out[m] + first, &x[m], sizeof(real));
      memcpy(out[6] + first, &residual, sizeof(real));
      for (int m = 0; with_pose && m < 12; ++m) memcpy(out[7 + m] + first, &pose[m], sizeof(real));
    } else {
      for (int m = 0; m < 6; ++m) memcpy(out[m] + first, &x[m], lanes * sizeof(double));
      memcpy(out[6] + first, &residual, lanes * sizeof(double));
      for (int m = 0; with_pose && m < 12; ++m) memcpy(out[7 + m] + first, &pose[m], lanes * sizeof(double));
    }
    if (within(residual, own.gap)) {
      solved += lanes;
    } else {
      for (size_t v = 0; v < lanes; ++v) solved += out[6][first + v] <= own.gap;
    }
  }
  return solved;
}

size_t closed_many(const struct closed_robot *robot, enum closed_want want, size_t count, const double *const rods[3],
                   double *const out[]) {
  /* The compiler inlines and specializes each of the three calls. */
  if (want == CLOSED_X) return every(robot, 0, 0, count, rods, out);
  if (want == CLOSED_POSE) return every(robot, 0, 1, count, rods, out);
  return every(robot, 1, 0, count, rods, out);
}

int closed_one(const struct closed_robot *robot, const double rods[3], double x[6]) {
  static struct constants is;
  if (is.stiffness == 0) is = constants_of(robot);
  real q[3], own[6], residual;
  for (int k = 0; k < 3; ++k) q[k] = (real){0} + rods[k];
  solve(&is, 0, q, robot->metric, robot->gap, own, &residual);
  for (int m = 0; m < 6; ++m) x[m] = FIRST(own[m]);
  return within(residual, robot->gap);
}
