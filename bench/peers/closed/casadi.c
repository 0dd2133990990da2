/* The closed equations as C code that CasADi generates (casadi_source.py), in hand-written loops. */
#include "closed.h"

#include GENERATED

/* Largest angle between neighbouring sockets for which the series are exact to round-off [rad]. */
#define SERIES 0.25
#define STEPS 50
#define FAR 1e300

static inline double one_newton(const double rods[3], double x[6]) {
  double share, widest;
  const double *arg[2] = {rods, x};
  double *res[3] = {x, &share, &widest};
  newton(arg, res, 0, 0, 0);
  return widest <= SERIES ? share : FAR;
}

/* Continues the iteration from x, with sine and cosine of the library. */
static double rest_of_newton(const double rods[3], double x[6], double share) {
  double next[6];
  const double *arg[2] = {rods, x};
  double *res[2] = {next, &share};
  for (int steps = 0; !(share <= 1) && steps < STEPS; ++steps) {
    step(arg, res, 0, 0, 0);
    for (int m = 0; m < 6; ++m) x[m] = next[m];
  }
  return share;
}

static double one_least(const double rods[3], double x[6], double gap) {
  double share = FAR, moved = FAR, widest = FAR, next[6];
  const double *arg[2] = {rods, x};
  double *from_rods[1] = {x}, *res[4] = {next, &share, &moved, &widest};
  start(arg, from_rods, 0, 0, 0);
  for (int steps = 0; !(share <= 1 && moved <= gap * gap) && steps < STEPS; ++steps) {
    near(arg, res, 0, 0, 0);
    if (!(widest <= SERIES)) pull(arg, res, 0, 0, 0);
    for (int m = 0; m < 6; ++m) x[m] = next[m];
  }
  return share;
}

size_t closed_many(const struct closed_robot *robot, enum closed_want want, size_t count, const double *const rods[3],
                   double *const out[]) {
  size_t solved = 0;
  const double gap = robot->gap;
  if (want == CLOSED_POSE) return 0;
  const double *const restrict qa = rods[0], *const restrict qb = rods[1], *const restrict qc = rods[2];
  double *const restrict la = out[0], *const restrict lb = out[1], *const restrict lc = out[2];
  double *const restrict pa = out[3], *const restrict pb = out[4], *const restrict pc = out[5];
  double *const restrict residual = out[6];
  if (want == CLOSED_X) {
    for (size_t k = 0; k < count; ++k) {
      const double q[3] = {qa[k], qb[k], qc[k]};
      double x[6];
      double share = one_newton(q, x);
      la[k] = x[0], lb[k] = x[1], lc[k] = x[2], pa[k] = x[3], pb[k] = x[4], pc[k] = x[5];
      residual[k] = share * gap;
    }
  }
  for (size_t k = 0; k < count; ++k) {
    const double q[3] = {qa[k], qb[k], qc[k]};
    double x[6];
    if (want == CLOSED_LEAST) {
      residual[k] = one_least(q, x, gap) * gap;
    } else if (!(residual[k] <= gap)) {
      x[0] = la[k], x[1] = lb[k], x[2] = lc[k], x[3] = pa[k], x[4] = pb[k], x[5] = pc[k];
      residual[k] = rest_of_newton(q, x, residual[k] / gap) * gap;
    } else {
      ++solved;
      continue;
    }
    la[k] = x[0], lb[k] = x[1], lc[k] = x[2], pa[k] = x[3], pb[k] = x[4], pc[k] = x[5];
    solved += residual[k] <= gap;
  }
  return solved;
}

int closed_one(const struct closed_robot *robot, const double rods[3], double x[6]) {
  (void)robot;
  return rest_of_newton(rods, x, one_newton(rods, x)) <= 1;
}
