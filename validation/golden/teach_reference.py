#!/usr/bin/env python3
"""Frames of stations from taught points, and their uncertainty, by scipy.

Writes next to itself

    teach-points.csv    measured points of planes and reference points, with their noise
    teach-fits.csv      fitted planes, centres and headings, with standard deviations, chi-square and leverages

    python3 validation/golden/teach_reference.py

needs numpy and scipy, and takes no arguments. Planes are fitted by nonlinear
least squares of the orthogonal distances, over the slopes and the height of
z = a x + b y + c; centres and headings over a shift and an angle. Covariances are
inverses of JᵀJ with numerical Jacobians, leverages the diagonal of J (JᵀJ)⁻¹ Jᵀ.
No singular value decomposition of points and no closed form of a rotation is used.
"""

import platform
from pathlib import Path

import numpy
import scipy
from scipy.optimize import least_squares
from scipy.stats import chi2, norm, t

DATE = "2026-11-23"
HERE = Path(__file__).resolve().parent
CASES = 6


def head(what, columns):
    return (
        f"# {what}\n"
        "# Command: python3 validation/golden/teach_reference.py\n"
        f"# Tool: numpy {numpy.__version__}, scipy {scipy.__version__}, Python {platform.python_version()}\n"
        f"# Date: {DATE}\n"
        "# Units: m, rad.\n"
        + ",".join(columns)
        + "\n"
    )


def row(values):
    return ",".join(value if isinstance(value, str) else repr(value) for value in values) + "\n"


def solve(residual, start):
    found = least_squares(
        residual, start, jac="3-point", method="lm", xtol=3e-16, ftol=3e-16, gtol=3e-16, x_scale="jac"
    )
    covariance = numpy.linalg.inv(found.jac.T @ found.jac)
    leverages = numpy.diag(found.jac @ covariance @ found.jac.T)
    return found.x, covariance, leverages, float(found.fun @ found.fun)


def plane(points, noise):
    def residual(parameters):
        a, b, c = parameters
        scale = numpy.sqrt(1 + a * a + b * b)
        return (points[:, 2] - a * points[:, 0] - b * points[:, 1] - c) / scale / noise

    (a, b, c), covariance, leverages, chi = solve(residual, [0.0, 0.0, float(points[:, 2].mean())])
    normal = numpy.array([-a, -b, 1.0]) / numpy.sqrt(1 + a * a + b * b)
    return normal, c, covariance, leverages, chi


def lateral(nominal, measured, noise):
    def residual(parameters):
        x, y, turn = parameters
        cos, sin = numpy.cos(turn), numpy.sin(turn)
        off = measured - [x, y] - nominal @ numpy.array([[cos, sin], [-sin, cos]])
        return (off / noise[:, None]).ravel()

    return solve(residual, [0.0, 0.0, 0.0])


def main():
    generator = numpy.random.default_rng(19)
    points_text = head("Taught points", ["case", "kind", "x", "y", "z", "across", "inward", "noise"])
    fits_text = head(
        "Fits of taught points",
        ["case", "normal_x", "normal_y", "normal_z", "height_at_700_0", "height_deviation", "chi_square", "leverage_1",
         "leverage_2", "shift_x", "shift_y", "turn", "shift_x_deviation", "shift_y_deviation", "turn_deviation", "reference_chi_square"],
    )
    for case in range(CASES):
        count = 4 + case
        noise = generator.uniform(5e-6, 40e-6, count)
        angle = generator.uniform(0, 2 * numpy.pi, count)
        radius = generator.uniform(0.05, 0.15, count)
        slope = generator.uniform(-0.01, 0.01, 2)
        xy = numpy.column_stack([0.7 + radius * numpy.cos(angle), radius * numpy.sin(angle)])
        z = 0.62 + (xy - [0.7, 0.0]) @ slope
        points = numpy.column_stack([xy, z]) + generator.normal(size=(count, 3)) * noise[:, None]
        normal, c, covariance, leverages, chi = plane(points, noise)
        a, b = -normal[0] / normal[2], -normal[1] / normal[2]
        at = numpy.array([0.7, 0.0, 1.0])
        height = a * 0.7 + c
        # Vertical distance to distance along the normal.
        deviation = float(numpy.sqrt(at @ covariance @ at) * normal[2])
        # References in a level plane at the height of the wafer, the station along the base axes.
        references = 2 + case
        nominal = generator.uniform(-0.15, 0.15, (references, 2))
        shift, turn = generator.uniform(-5e-4, 5e-4, 2), generator.uniform(-2e-3, 2e-3)
        rotation = numpy.array([[numpy.cos(turn), -numpy.sin(turn)], [numpy.sin(turn), numpy.cos(turn)]])
        reference_noise = generator.uniform(5e-6, 40e-6, references)
        measured = nominal @ rotation.T + shift + generator.normal(size=(references, 2)) * reference_noise[:, None]
        (x, y, found), spread, _, reference_chi = lateral(nominal, measured, reference_noise)
        for (px, py, pz), one in zip(points.tolist(), noise.tolist()):
            points_text += row([str(case), "plane", px, py, pz, 0.0, 0.0, one])
        for (u, v), (mx, my), one in zip(nominal.tolist(), measured.tolist(), reference_noise.tolist()):
            points_text += row([str(case), "reference", mx, my, 0.0, u, v, one])
        deviations = numpy.sqrt(numpy.diag(spread)).tolist()
        fits_text += row(
            [str(case), *normal.tolist(), float(height), deviation, chi, *leverages[:2].tolist(), float(x), float(y), float(found),
             *deviations, reference_chi]
        )
    (HERE / "teach-points.csv").write_text(points_text)
    (HERE / "teach-fits.csv").write_text(fits_text)
    # Quantiles that the tests of the library print, for comparison by eye.
    print("normal 99.9 %:", norm.ppf(0.999), "t 95.45 % of 5:", t.ppf(0.977249868, 5), "chi-square 99.9 % of 5:", chi2.ppf(0.999, 5))


main()
