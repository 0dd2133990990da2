"""Closed equations of the Python workers: constants of the robot, and equations over NumPy-like arrays.

    F_ij(X) = L_ij² − |p_j(X) − p_i(X)|²,   p_k = l_k u(β_k + φ_k),   L_ij² = |B_j − B_i|² + (q_j − q_i)²
    newton:  X ← X   + W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ F                J = ∂|p_j − p_i|²/∂X
    least:   X ← X_0 + W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ (J (X − X_0) + F)

As in C: law of cosines instead of points, half of F and J, and a first step with a constant matrix.
"""

from dataclasses import dataclass

import numpy as np

NEXT = (1, 2, 0)
# Largest angle between neighbouring sockets for which the series are exact to round-off [rad].
SERIES = 0.25


class Series:
    """Series for sine and cosine of small angles, for programs with slow functions."""

    @staticmethod
    def sin(a):
        z = a * a
        return a + a * z * (-1 / 6 + z * (1 / 120 + z * (-1 / 5040 + z * (1 / 362880 - z / 39916800))))

    @staticmethod
    def cos(a):
        z = a * a
        tail = 1 / 24 + z * (-1 / 720 + z * (1 / 40320 + z * (-1 / 3628800 + z / 479001600)))
        return 1 + z * (-0.5 + z * tail)


@dataclass
class Constants:
    """Constants of the sides 01, 12, 20, and the matrix of the first step from nominal."""

    radius: tuple
    cosine: tuple
    sine: tuple
    level: tuple
    half_gap: tuple
    nominal: tuple
    stiffness: float
    first: tuple
    metric: float
    gap: float


def constants(work):
    unit = work.direction
    cosine = [unit[k] @ unit[NEXT[k]] for k in range(3)]
    sine = [unit[k, 0] * unit[NEXT[k], 1] - unit[k, 1] * unit[NEXT[k], 0] for k in range(3)]
    level = [float(np.sum((work.base[NEXT[k]] - work.base[k]) ** 2)) for k in range(3)]
    own = Constants(
        radius=tuple(map(float, work.radius)),
        cosine=tuple(map(float, cosine)),
        sine=tuple(map(float, sine)),
        level=tuple(level),
        half_gap=tuple(work.gap * np.sqrt(level)),
        nominal=(0.0,) * 3,
        stiffness=1 / work.metric**2,
        first=(),
        metric=work.metric,
        gap=work.gap,
    )
    at = sides(np, own, [*own.radius, 0.0, 0.0, 0.0])
    own.nominal = tuple(float(side[0]) for side in at)
    columns = [step(own, at, [float(k == row) for row in range(3)]) for k in range(3)]
    own.first = tuple(tuple(float(column[m]) for column in columns) for m in range(6))
    return own


def sides(xp, own, x):
    """Half of each squared side, and half of its derivatives by l_i, l_j and φ_j; the derivative by φ_i is minus the last."""
    at = []
    for i, j in enumerate(NEXT):
        turn = x[3 + j] - x[3 + i]
        s, c = xp.sin(turn), xp.cos(turn)
        along, across = own.cosine[i] * c - own.sine[i] * s, own.sine[i] * c + own.cosine[i] * s
        li, lj = x[i], x[j]
        at.append((0.5 * (li * li + lj * lj) - li * lj * along, li - lj * along, lj - li * along, li * lj * across))
    return at


def step(own, at, b):
    """Minimum-norm step W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ b."""
    (_, i0, j0, t0), (_, i1, j1, t1), (_, i2, j2, t2) = at
    k0, k1, k2 = own.stiffness * t0, own.stiffness * t1, own.stiffness * t2
    xx, yy, zz = i0 * i0 + j0 * j0 + 2 * k0 * t0, i1 * i1 + j1 * j1 + 2 * k1 * t1, i2 * i2 + j2 * j2 + 2 * k2 * t2
    xy, yz, xz = j0 * i1 - k0 * t1, j1 * i2 - k1 * t2, i0 * j2 - k0 * t2
    cxx, cxy, cxz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - yy * xz
    cyy, cyz, czz = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    inverse = 1 / (xx * cxx + xy * cxy + xz * cxz)
    p = (cxx * b[0] + cxy * b[1] + cxz * b[2]) * inverse
    q = (cxy * b[0] + cyy * b[1] + cyz * b[2]) * inverse
    r = (cxz * b[0] + cyz * b[1] + czz * b[2]) * inverse
    return (
        i0 * p + j2 * r,
        i1 * q + j0 * p,
        i2 * r + j1 * q,
        k2 * r - k0 * p,
        k0 * p - k1 * q,
        k1 * q - k2 * r,
    )


def halves(own, rods):
    """Half of the squared sides that the rods determine."""
    return [0.5 * (own.level[k] + (rods[NEXT[k]] - rods[k]) ** 2) for k in range(3)]


def start(own, wanted):
    """X after the first step from nominal, with a constant matrix."""
    b = [wanted[k] - own.nominal[k] for k in range(3)]
    x = [row[0] * b[0] + row[1] * b[1] + row[2] * b[2] for row in own.first]
    return [x[k] + own.radius[k] for k in range(3)] + x[3:]


def pulled(own, at, b, x):
    """Right-hand side of `step` for the least displacement: J (X − X_0) + F."""
    shift = [x[k] - own.radius[k] for k in range(3)]
    return [
        b[i] + at[i][1] * shift[i] + at[i][2] * shift[j] + at[i][3] * (x[3 + j] - x[3 + i]) for i, j in enumerate(NEXT)
    ]


def answers(x, residual, gap):
    """X of each pose, None without a solution."""
    rows = np.stack([np.asarray(column) for column in x], axis=1)
    return [row if ended <= gap else None for row, ended in zip(rows, np.asarray(residual))]


# Unit of displacements and gaps for optimisers, which need numbers of the order of one [m].
UNIT = 1e-3


def from_scaled(own, y):
    """X from scaled displacements in the metric."""
    return [own.radius[k] + UNIT * y[k] for k in range(3)] + [UNIT / own.metric * y[k] for k in range(3, 6)]


def scaled_sides(xp, own, y):
    """Half of the squared sides, scaled so that a gap is a length, and their derivatives by y."""
    at = sides(xp, own, from_scaled(own, y))
    values, rows = [], []
    for i, (j, (square, by_i, by_j, by_turn)) in enumerate(zip(NEXT, at)):
        weight = own.gap / own.half_gap[i]
        row = [0.0] * 6
        row[i], row[j] = by_i * weight, by_j * weight
        row[3 + i], row[3 + j] = -by_turn * weight / own.metric, by_turn * weight / own.metric
        values.append(square * (weight / UNIT))
        rows.append(row)
    return values, rows


def scaled_wanted(own, rods):
    return [half * own.gap / own.half_gap[k] / UNIT for k, half in enumerate(halves(own, rods))]
