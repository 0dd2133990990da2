"""Checks the answers of every program by the same independent equations.

The equations here are independent: points and their distances, solved by NumPy, with nothing from any worker.
"""

import numpy as np

NEXT = [1, 2, 0]
STEPS = 100


def gpr(work, answers, newton, least):
    """Errors of answers, which are X (6 numbers: l, then φ), or rotation, point and X (18).

    Gaps are errors of the sides, and with a pose distances of sockets from balls; distances from reference solutions multiply angles by the socket radius.
    """
    answered = [k for k, answer in enumerate(answers) if answer]
    if not answered:
        return {"answered": 0, "closed": 0}
    rows = np.array([answers[k] for k in answered])
    x, rods = rows[:, -6:], work.poses[answered]
    gaps = np.abs(lengths(sockets(work, x)) - lengths(balls(work, rods))).max(axis=1)
    if rows.shape[1] == 18:
        rotation, point = rows[:, :9].reshape(-1, 3, 3), rows[:, 9:12]
        flat = np.concatenate([sockets(work, x), np.zeros((len(answered), 3, 1))], axis=2)
        placed = flat @ rotation.transpose(0, 2, 1) + point[:, None, :]
        gaps = np.maximum(gaps, np.abs(placed - balls(work, rods)).max(axis=(1, 2)))
    arc = np.concatenate([np.ones(3), work.radius])
    return {
        "answered": len(answered),
        "closed": int((gaps <= work.gap).sum()),
        "largest_gap_m": float(gaps.max()),
        "median_gap_m": float(np.median(gaps)),
        "from_newton_m": float(np.abs((x - newton[answered]) * arc).max()),
        "from_least_m": float(np.abs((x - least[answered]) * arc).max()),
    }


def inverse(work, answers):
    """Differences between rod lengths of the answers and those that jointplay computes pose by pose."""
    answered = [k for k, answer in enumerate(answers) if answer]
    differences = np.abs(np.array([answers[k] for k in answered]) - work.poses[answered]).max(axis=1)
    return {"answered": len(answered), "closed": int((differences <= work.gap).sum()), "largest_gap_m": float(differences.max())}


def reference(work, least):
    """Reference solution X of every pose, by Newton's iteration or with the least displacement; not optimized for speed."""
    wanted = lengths(balls(work, work.poses)) ** 2
    nominal = np.concatenate([work.radius, np.zeros(3)])
    compliance = np.concatenate([np.ones(3), np.full(3, work.metric**-2)])
    x = np.tile(nominal, (len(wanted), 1))
    going = np.ones(len(x), dtype=bool)
    for _ in range(STEPS):
        own = x[going]
        points = sockets(work, own)
        gap = wanted[going] - lengths(points) ** 2
        jacobian = derivatives(work, own, points)
        target = gap + np.einsum("nij,nj->ni", jacobian, own - nominal) if least else gap
        weighted = compliance[:, None] * jacobian.transpose(0, 2, 1)
        found = np.einsum("nij,nj->ni", weighted, np.linalg.solve(jacobian @ weighted, target[..., None])[..., 0])
        found = nominal + found if least else own + found
        # Newton's iteration ends when the sides are within the gap, as in all programs; the least displacement ends at round-off.
        met = np.abs(np.sqrt(wanted[going]) - lengths(points)).max(axis=1) <= work.gap
        done = np.abs(found - own).max(axis=1) <= 1e-15 if least else met
        x[going] = np.where((met & ~np.array(least))[:, None], own, found)
        going[going] = ~done
        if not going.any():
            return x
    # The iteration of the least displacement fluctuates at the size of round-off.
    return x


def balls(work, rods):
    base = np.broadcast_to(work.base, (len(rods), 3, 2))
    return np.concatenate([base, rods[:, :, None]], axis=2)


def sockets(work, x):
    """Sockets p_k(X) in the platform plane."""
    heading = np.arctan2(work.direction[:, 1], work.direction[:, 0]) + x[:, 3:]
    return x[:, :3, None] * np.stack([np.cos(heading), np.sin(heading)], axis=2)


def lengths(points):
    """Lengths of the sides 01, 12, 20."""
    return np.linalg.norm(points[:, NEXT] - points, axis=2)


def derivatives(work, x, points):
    """Derivatives of the squared sides by X, one row for each side."""
    edges = 2 * (points[:, NEXT] - points)
    along = points / x[:, :3, None]
    across = np.stack([-points[..., 1], points[..., 0]], axis=2)
    jacobian = np.zeros((len(x), 3, 6))
    for i, j in enumerate(NEXT):
        for first, moving in ((0, along), (3, across)):
            jacobian[:, i, first + j] = np.einsum("nk,nk->n", edges[:, i], moving[:, j])
            jacobian[:, i, first + i] = -np.einsum("nk,nk->n", edges[:, i], moving[:, i])
    return jacobian


def linkage(work, answers):
    """Largest gaps of the loops, of points in metres and of directions in radians."""
    gaps = [float(np.abs(work.gaps(np.array(answer))).max()) for answer in answers if answer]
    return {
        "answered": len(gaps),
        "closed": sum(gap <= work.gap for gap in gaps),
        "largest_gap": max(gaps, default=None),
    }
