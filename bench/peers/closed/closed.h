/* The closed equations of the three-rod robot, which the compiled workers of the bench solve.
 *
 *    F_ij(X) = L_ij² − |p_j(X) − p_i(X)|²,   p_k = l_k u(β_k + φ_k),   L_ij² = |B_j − B_i|² + (q_j − q_i)²
 *    newton:  X ← X   + W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ F                J = ∂|p_j − p_i|²/∂X
 *    least:   X ← X_0 + W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ (J (X − X_0) + F)
 */
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Dimensions of the robot [m], metric (length that multiplies angles) and allowed residual [m], from the work file. */
struct closed_robot {
  double radius[3], direction[3][2], base[3][2];
  double metric, gap;
};

enum closed_want { CLOSED_X, CLOSED_POSE, CLOSED_LEAST };

/* Number of output columns: 6 virtual joints (l, then φ), the residual, and for CLOSED_POSE the rotation (9, by rows) and
 * the point (3). The input has 3 columns of rods. */
enum { CLOSED_X_COLUMNS = 7, CLOSED_POSE_COLUMNS = 19 };

/* Solves count poses, each from nominal, and returns the number of poses with a residual within the gap. */
size_t closed_many(const struct closed_robot *robot, enum closed_want want, size_t count, const double *const rods[3],
                   double *const out[]);

/* Solves one pose: writes X to x, and returns 1 if the residual is within the gap. */
int closed_one(const struct closed_robot *robot, const double rods[3], double x[6]);

#ifdef __cplusplus
}
#endif
