#!/usr/bin/env python3
"""Durations of straight lines compared with optima that other programs and methods find.

    python3 bench/trajectories.py --help
    python3 bench/trajectories.py --command target/release/jointplay
    python3 bench/trajectories.py --command target/release/jointplay --write

For each reference line below, `jointplay cell export` writes the axis positions of the motion as CSV.
The path is a spline through these positions over their own arc length; timing of jointplay is not used further.
Two optima are computed for the path:

- TOPP-RA (toppra on PyPI): velocity and acceleration limits alone, a lower bound for any motion with jerk limits,
  compared with jointplay at jerk limits a hundred times as high;
- direct transcription: the jerk of the path parameter is constant in each of 160 intervals of time; the duration is minimized by a
  sequence of linear programs with a trust region (HiGHS in SciPy), for velocity, acceleration and jerk limits.

Needs numpy, scipy and toppra.
"""

import argparse
import csv
import importlib.metadata
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import numpy as np
from scipy import sparse
from scipy.interpolate import CubicSpline, make_interp_spline
from scipy.optimize import linprog

HERE = pathlib.Path(__file__).resolve().parent


class Path:
    """A path q(s), s from 0 to 1, with its first three derivatives."""

    def __init__(self, positions):
        """Positions of the moving axes in the order of the motion; a quintic spline over their normalized arc length."""
        span = np.ptp(positions, axis=0)
        steps = np.linalg.norm(np.diff(positions, axis=0) / span.max(), axis=1)
        length = np.concatenate([[0.0], np.cumsum(steps)])
        length /= length[-1]
        # Samples near rest are dense: points at nearly equal distances condition the spline better.
        keep, last = [0], 0.0
        for k in range(1, len(length) - 1):
            if length[k] - last >= 1 / 120 and 1.0 - length[k] >= 0.5 / 120:
                keep.append(k)
                last = length[k]
        keep.append(len(length) - 1)
        self.spline = make_interp_spline(length[keep], positions[keep], k=5)

    def __call__(self, s, order=0):
        return self.spline(np.clip(s, 0.0, 1.0), order)


def slowdown(path, limits, s, rate, acceleration, jerk):
    """Factor by which a motion of the path parameter has to be slowed to be within all limits."""
    q1, q2, q3 = (path(s, order) for order in (1, 2, 3))
    rate, acceleration, jerk = (value[:, None] for value in (rate, acceleration, jerk))
    velocity = np.abs(q1 * rate) / limits[:, 0]
    accelerations = np.abs(q2 * rate**2 + q1 * acceleration) / limits[:, 1]
    jerks = np.abs(q3 * rate**3 + 3 * q2 * rate * acceleration + q1 * jerk) / limits[:, 2]
    return max(velocity.max(), accelerations.max() ** 0.5, jerks.max() ** (1 / 3))


class Transcription:
    """The shortest duration of a path: jerk of the path parameter constant in intervals of time, by sequential linear programming."""

    def __init__(self, path, limits, intervals=160):
        self.path, self.limits, self.count = path, limits, intervals
        self.h = 1.0 / intervals

    def integrate(self, jerk):
        """Parameter, rate and acceleration at all times from 0 to 1, from rest."""
        h = self.h
        acceleration = np.concatenate([[0.0], np.cumsum(jerk) * h])
        rate = np.concatenate([[0.0], np.cumsum(acceleration[:-1] * h + jerk * h**2 / 2)])
        s = np.concatenate([[0.0], np.cumsum(rate[:-1] * h + acceleration[:-1] * h**2 / 2 + jerk * h**3 / 6)])
        return s, rate, acceleration

    def states(self, jerk):
        """Both ends and the middle of all intervals: parameter, rate, acceleration and jerk."""
        s, rate, acceleration = self.integrate(jerk)
        shares = [0.0, 0.5, 1.0]
        out = []
        for share in shares:
            t = share * self.h
            out.append((
                s[:-1] + rate[:-1] * t + acceleration[:-1] * t**2 / 2 + jerk * t**3 / 6,
                rate[:-1] + acceleration[:-1] * t + jerk * t**2 / 2,
                acceleration[:-1] + jerk * t,
                jerk,
            ))
        return tuple(np.concatenate(parts) for parts in zip(*out))

    def duration(self, jerk):
        """Duration at which the motion with this shape is within all limits."""
        return slowdown(self.path, self.limits, *self.states(jerk))

    def solve(self, jerk, rounds=60, tolerance=2e-5):
        # Matrices from jerks to parameter, rate and acceleration at the times of the constraints.
        n, h = self.count, self.h
        lower = np.tri(n + 1, n, -1)
        accelerations = lower * h
        rates = np.zeros((n + 1, n))
        positions = np.zeros((n + 1, n))
        for k in range(n):
            ones = np.zeros(n)
            ones[k] = 1
            rates[k + 1] = rates[k] + accelerations[k] * h + ones * h**2 / 2
            positions[k + 1] = positions[k] + rates[k] * h + accelerations[k] * h**2 / 2 + ones * h**3 / 6
        eye = np.eye(n)
        maps = [[], [], []]
        for share in (0.0, 0.5, 1.0):
            t = share * h
            maps[0].append(positions[:-1] + rates[:-1] * t + accelerations[:-1] * t**2 / 2 + eye * t**3 / 6)
            maps[1].append(rates[:-1] + accelerations[:-1] * t + eye * t**2 / 2)
            maps[2].append(accelerations[:-1] + eye * t)
        to_s, to_rate, to_acceleration = (np.concatenate(one) for one in maps)
        to_jerk = np.concatenate([eye] * 3)
        ends = np.stack([positions[-1], rates[-1], accelerations[-1]])
        best, trust = self.duration(jerk), 0.05
        for _ in range(rounds):
            s, rate, acceleration, third = self.states(jerk)
            T = best
            blocks, bounds = [], []
            derivatives = [self.path(s, order) for order in range(5)]
            for axis, (v, a, j) in enumerate(self.limits):
                q1, q2, q3, q4 = (d[:, axis] for d in derivatives[1:])
                forms = [
                    (q1 * rate, [(q2 * rate, to_s), (q1, to_rate)], v, 1),
                    (q2 * rate**2 + q1 * acceleration,
                     [(q3 * rate**2 + q2 * acceleration, to_s), (2 * q2 * rate, to_rate), (q1, to_acceleration)], a, 2),
                    (q3 * rate**3 + 3 * q2 * rate * acceleration + q1 * third,
                     [(q4 * rate**3 + 3 * q3 * rate * acceleration + q2 * third, to_s),
                      (3 * q3 * rate**2 + 3 * q2 * acceleration, to_rate),
                      (3 * q2 * rate, to_acceleration), (q1, to_jerk)], j, 3),
                ]
                for value, terms, limit, power in forms:
                    scale = limit * T**power
                    active = np.abs(value) > 0.3 * scale
                    row = sum((factor[active, None] / scale) * matrix[active] for factor, matrix in terms)
                    # |value + row Δ| ≤ 1 + power ΔT/T
                    growth = np.full((row.shape[0], 1), -float(power))
                    blocks += [np.hstack([row, growth]), np.hstack([-row, growth])]
                    bounds += [1 - value[active] / scale, 1 + value[active] / scale]
            # Trust region on the path parameter and its rate.
            typical = np.abs(rate).max()
            for matrix, size in ((to_s, trust), (to_rate, 4 * trust * typical)):
                nodes = matrix[:n]
                wide = np.hstack([nodes, np.zeros((n, 1))])
                blocks += [wide, -wide]
                bounds += [np.full(n, size)] * 2
            matrix = np.vstack(blocks)
            matrix[np.abs(matrix) < 1e-9 * np.abs(matrix).max(axis=1, keepdims=True)] = 0
            size = np.abs(jerk).max()
            matrix[:, :n] *= size
            equal = np.hstack([ends * size, np.zeros((3, 1))])
            found = linprog(
                np.concatenate([np.zeros(n), [1.0]]), sparse.csr_matrix(matrix), np.concatenate(bounds),
                equal / size, np.zeros(3), bounds=[(None, None)] * n + [(-0.3, 0.0)], method="highs-ipm",
            )
            if found.status != 0:
                trust /= 4
                if trust < 1e-6:
                    break
                continue
            candidate = jerk + found.x[:n] * size
            duration = self.duration(candidate)
            if duration < best:
                gain = 1 - duration / best
                best, jerk = duration, candidate
                trust = min(2 * trust, 0.1)
                if gain < tolerance:
                    break
            else:
                trust /= 4
                if trust < 1e-6:
                    break
        return best, jerk


def smooth_start(intervals):
    """Jerks of the motion 35 t⁴ − 84 t⁵ + 70 t⁶ − 20 t⁷, corrected to end at rest at 1."""
    t = (np.arange(intervals) + 0.5) / intervals
    jerk = 840 * t - 5040 * t**2 + 8400 * t**3 - 4200 * t**4
    return jerk


def by_toppra(path, limits):
    """Least duration for velocity and acceleration limits alone (s)."""
    import toppra
    from toppra import algorithm, constraint
    toppra.setup_logging("ERROR")
    knots = np.linspace(0, 1, 801)
    interpolated = toppra.SplineInterpolator(knots, path(knots))
    velocity = constraint.JointVelocityConstraint(np.stack([-limits[:, 0], limits[:, 0]], axis=1))
    acceleration = constraint.JointAccelerationConstraint(np.stack([-limits[:, 1], limits[:, 1]], axis=1))
    grid = np.linspace(0, 1, 2001)
    instance = algorithm.TOPPRA([velocity, acceleration], interpolated, gridpoints=grid, parametrizer="ParametrizeConstAccel")
    return instance.compute_trajectory(0, 0).duration
