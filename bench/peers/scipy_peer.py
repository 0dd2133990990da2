"""Worker for the workloads of the bench with SciPy alone: least squares over the coordinates.

python scipy_peer.py gpr FILE, python scipy_peer.py linkage FILE; slsqp FILE and trust-constr FILE for the closed equations of the robot
For the least displacement of the robot, least squares of gaps and weak springs precede least squares of the gaps alone; for the closed equations an optimiser finds it.
"""

import math
import sys

import closed_equations
import numpy as np
import work as workload
from scipy.optimize import NonlinearConstraint, least_squares, minimize

# Computes every 40th pose only, because of the computation time.
STRIDE = 40
TIGHT = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}


def gpr(path):
    work = workload.Gpr.read(path)

    def pose(unknowns):
        vector, point = unknowns[:3], np.array([0, 0, work.height]) + unknowns[3:6] * scale
        angle = np.linalg.norm(vector)
        quaternion = np.append(np.cos(angle / 2), np.sinc(angle / (2 * np.pi)) / 2 * vector)
        return workload.ball(quaternion), point

    scale = work.radius.mean()
    heading = np.arctan2(work.direction[:, 1], work.direction[:, 0])

    def gaps(unknowns, balls):
        rotation, point = pose(unknowns)
        turned, slid = unknowns[6::2] / work.metric * scale + heading, work.radius + unknowns[7::2] * scale
        sockets = np.column_stack([slid * np.cos(turned), slid * np.sin(turned), np.zeros(3)])
        return (sockets @ rotation.T + point - balls).ravel() / scale

    def one(rods):
        balls = work.balls(rods)

        def springs(unknowns):
            return np.concatenate([gaps(unknowns, balls), 1e-4 * unknowns[6:]])

        near = least_squares(springs, np.zeros(12), method="lm", **TIGHT).x
        found = least_squares(gaps, near, args=(balls,), **TIGHT).x
        if not np.abs(gaps(found, balls)).max() * scale <= work.gap:
            return None
        rotation, point = pose(found)
        slid, turned = work.radius + found[7::2] * scale, found[6::2] / work.metric * scale
        return [*rotation.ravel(), *point, *slid, *turned]

    def every():
        answers = [None] * len(work.poses)
        answers[::STRIDE] = [one(rods) for rods in work.poses[::STRIDE]]
        return answers

    return every, STRIDE


def closed(path, method):
    """Least displacement under the closed equations, with exact derivatives."""
    work = workload.Gpr.read(path)
    own = closed_equations.constants(work)

    def values(y):
        return np.array(closed_equations.scaled_sides(math, own, y.tolist())[0])

    def jacobian(y):
        return np.array(closed_equations.scaled_sides(math, own, y.tolist())[1])

    def cost(y):
        return y @ y / 2, y

    def one(rods):
        wanted = np.array(closed_equations.scaled_wanted(own, rods))
        if method == "SLSQP":
            sides = {"type": "eq", "fun": lambda y: values(y) - wanted, "jac": jacobian}
            options = {"ftol": 1e-10, "maxiter": 200}
            return minimize(cost, np.zeros(6), jac=True, method=method, constraints=sides, options=options).x
        sides = NonlinearConstraint(values, wanted, wanted, jac=jacobian)
        options = {"gtol": 1e-11, "xtol": 1e-14, "maxiter": 500}
        identity = {"hess": lambda y: np.eye(6)}
        return minimize(cost, np.zeros(6), jac=True, method=method, constraints=sides, options=options, **identity).x

    def rows(found):
        answers = [None] * len(work.poses)
        answers[::STRIDE] = [closed_equations.from_scaled(own, y) for y in found]
        return answers

    return lambda: [one(rods) for rods in work.poses[::STRIDE]], rows


def linkage(path):
    work = workload.Linkage.read(path)
    at = np.cumsum([0] + [body.width for body in work.bodies])
    free = np.concatenate([range(a, b) for body, a, b in zip(work.bodies, at, at[1:]) if not body.driven])
    balls = [slice(a, a + 4) for body, a in zip(work.bodies, at) if body.kind == "S"]

    def one(guess):
        def gaps(unknowns):
            values = guess.copy()
            values[free] = unknowns
            # Unit norms of quaternions are additional equations, so that the norms do not drift.
            return np.concatenate([work.gaps(values), [values[own] @ values[own] - 1 for own in balls]])

        found = least_squares(gaps, guess[free], **TIGHT).x
        values = guess.copy()
        values[free] = found
        return values if np.abs(gaps(found)).max() <= work.gap else None

    every = 10

    def all_of_them():
        answers = [None] * len(work.guesses)
        answers[::every] = [one(guess) for guess in work.guesses[::every]]
        return answers

    return all_of_them, every


if __name__ == "__main__":
    what, path = sys.argv[1:]
    if what in ("slsqp", "trust-constr"):
        solve, rows = closed(path, {"slsqp": "SLSQP"}.get(what, what))
        workload.serve(solve, STRIDE, rows=rows)
    else:
        workload.serve(*{"gpr": gpr, "linkage": linkage}[what](path))
