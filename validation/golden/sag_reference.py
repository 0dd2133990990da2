#!/usr/bin/env python3
"""How far wafers sag and arms droop, by other methods.

Writes next to itself

    sag.csv     round plates under their own weight, on their edge, three points, two rails
    droop.csv   cantilevers with their own weight and a load at the tip

    python3 validation/golden/sag_reference.py

needs numpy and scipy, and takes no arguments. Plates by Ritz's method: the
energy of polynomials over the disc, Zernike's, is made least, with the supports
as constraints; rails push and do not pull, which makes it a quadratic programme.
No solution for a point force is used: the polynomials follow the kink of the
second derivative at a support slowly, with an error as the square of one over
their degree, which is extrapolated from two degrees. Beams by collocation of the
boundary value problem, not by its closed form.
"""

import platform
from pathlib import Path

import numpy
import scipy
from scipy.integrate import solve_bvp
from scipy.optimize import nnls
from scipy.special import eval_jacobi

DATE = "2026-11-22"
HERE = Path(__file__).resolve().parent
# Highest degree of the polynomials, and points of half a rail.
DEGREE = 80
RAIL_POINTS = 40

POISSON = (0.18, 0.28)
POINTS = (0.3, 0.5, 0.68, 0.8, 1.0)
RAILS = (0.3, 0.5, 0.7, 0.9)

# Per metre and newton: stiffness EI, mass by length, load, reaches.
BEAMS = ((1500.0, 2.5, 0.0), (1500.0, 2.5, 0.128), (900.0, 4.0, 0.35))
REACHES = (0.2, 0.45, 0.7437)
GRAVITY = 9.80665


class Waves:
    """Polynomials f(r) cos(m θ), m fixed: Zernike's, with two derivatives."""

    def __init__(self, m):
        self.m = m
        self.count = (DEGREE - m) // 2 + 1

    def at(self, r):
        """Values, first and second derivatives by r, a column a polynomial."""
        r = numpy.atleast_1d(numpy.asarray(r, dtype=float))
        m, x = self.m, 2 * r * r - 1
        f, d, s = (numpy.empty((r.size, self.count)) for _ in range(3))
        power = [r ** (m - k) if m >= k else numpy.zeros_like(r) for k in range(3)]
        for k in range(self.count):
            p = eval_jacobi(k, 0, m, x)
            p1 = (k + m + 1) / 2 * eval_jacobi(k - 1, 1, m + 1, x) if k > 0 else 0 * x
            p2 = (k + m + 1) * (k + m + 2) / 4 * eval_jacobi(k - 2, 2, m + 2, x) if k > 1 else 0 * x
            # x' = 4 r, x'' = 4.
            f[:, k] = power[0] * p
            d[:, k] = m * power[1] * p + power[0] * p1 * 4 * r
            s[:, k] = m * (m - 1) * power[2] * p + 2 * m * power[1] * p1 * 4 * r + power[0] * (p2 * 16 * r * r + 4 * p1)
        return f, d, s

    def stiffness(self, poisson):
        """Twice the bending energy, as a quadratic form, D = 1."""
        nodes, weights = numpy.polynomial.legendre.leggauss(DEGREE + 4)
        r, weights = (nodes + 1) / 2, weights / 2 * (nodes + 1) / 2
        f, d, s = self.at(r)
        column = r[:, None]
        across = d / column - self.m ** 2 * f / column ** 2
        twist = self.m * (d / column - f / column ** 2)
        round_it = 2 * numpy.pi if self.m == 0 else numpy.pi
        def form(a, b):
            return round_it * (a.T * weights) @ b
        bending = form(s + across, s + across)
        bending -= (1 - poisson) * (form(s, across) + form(across, s) - 2 * form(twist, twist))
        return (bending + bending.T) / 2


class Plate:
    """A disc of radius 1 with q = D = 1, of a symmetry."""

    def __init__(self, poisson, symmetry):
        self.waves = [Waves(m) for m in range(0, DEGREE + 1, symmetry)]
        self.blocks = [wave.stiffness(poisson) for wave in self.waves]
        # The first polynomial is a constant, which bends nothing: it follows from the balance of forces.
        self.pinv = [numpy.linalg.inv(block[1:, 1:] if k == 0 else block) for k, block in enumerate(self.blocks)]

    def row(self, r, angle):
        """Height at a point, by the coefficients."""
        return [wave.at(r)[0][0] * numpy.cos(wave.m * angle) for wave in self.waves]

    def weight(self):
        """What the weight does to each coefficient, downward; of all polynomials, only the constant has a mean."""
        weight = [numpy.zeros(wave.count) for wave in self.waves]
        weight[0][0] = numpy.pi
        return weight

    def bent(self, load):
        """Coefficients by a load that is balanced, up to a constant."""
        bent = []
        for k, (inverse, one) in enumerate(zip(self.pinv, load)):
            bent.append(numpy.concatenate([[0.0], inverse @ one[1:]]) if k == 0 else inverse @ one)
        return bent

    def on(self, places):
        """Coefficients on supports that push up and never pull."""
        rows = [self.row(*place) for place in places]
        compliance = numpy.array([[sum(a @ b for a, b in zip(row, self.bent(other))) for other in rows] for row in rows])
        # Least ½ fᵀ G f with Σ f = the weight, f ≥ 0: as least squares of L⁻¹, the sum held by a large weight.
        compliance = (compliance + compliance.T) / 2
        weighed = compliance + 1e-12 * numpy.trace(compliance) * numpy.eye(len(rows))
        factor = numpy.linalg.cholesky(weighed).T
        heavy = 1e4 * numpy.abs(factor).max()
        matrix = numpy.vstack([factor, heavy * numpy.ones(len(rows))])
        forces, _ = nnls(matrix, numpy.concatenate([numpy.zeros(len(rows)), [heavy * numpy.pi]]), maxiter=10000)
        forces *= numpy.pi / forces.sum()
        load = [-one for one in self.weight()]
        for force, row in zip(forces, rows):
            load = [one + force * other for one, other in zip(load, row)]
        shape = self.bent(load)
        touched = max(range(len(rows)), key=lambda k: forces[k])
        shape[0][0] -= sum(a @ b for a, b in zip(rows[touched], shape))
        return shape

    def on_edge(self):
        """Coefficients where all of the edge is held, which leaves waves out."""
        first = self.waves[0].at(1.0)[0][0]
        load = -self.weight()[0]
        size = first.size
        system = numpy.block([[self.blocks[0], -first[:, None]], [first[None, :], numpy.zeros((1, 1))]])
        solved = numpy.linalg.solve(system, numpy.concatenate([load, [0.0]]))
        return [solved[:size]] + [numpy.zeros(wave.count) for wave in self.waves[1:]]

    def summary(self, shape, symmetry):
        """Centre, lowest, highest, mean, and root of the mean square from the mean."""
        nodes, weights = numpy.polynomial.legendre.leggauss(DEGREE + 4)
        r, weights = (nodes + 1) / 2, weights * (nodes + 1) / 2
        by_wave = [wave.at(r)[0] @ one for wave, one in zip(self.waves, shape)]
        mean = weights @ by_wave[0]
        square = weights @ by_wave[0] ** 2 + sum(weights @ one ** 2 / 2 for one in by_wave[1:])
        radii = numpy.linspace(0, 1, 401)
        angles = numpy.linspace(0, numpy.pi / symmetry, 181)
        grid = sum(
            (wave.at(radii)[0] @ one)[:, None] * numpy.cos(wave.m * angles)[None, :]
            for wave, one in zip(self.waves, shape))
        return grid[0, 0], grid.min(), grid.max(), mean, numpy.sqrt(square - mean ** 2)


def drooping(stiffness, by_length, load, reach):
    """Drop and slope at the end of a cantilever, by collocation."""
    own = by_length * GRAVITY / stiffness
    tip = load * GRAVITY / stiffness
    def beam(_, y):
        return numpy.vstack([y[1], y[2], y[3], numpy.full_like(y[0], own)])
    def ends(a, b):
        return numpy.array([a[0], a[1], b[2], b[3] + tip])
    at = numpy.linspace(0, reach, 41)
    found = solve_bvp(beam, ends, at, numpy.zeros((4, at.size)), tol=1e-12, max_nodes=20000)
    assert found.success, found.message
    return found.y[0, -1], found.y[1, -1]


HEAD = """\
# {name}
# Source: plates by Ritz's method with Zernike polynomials up to degree {degree}, beams by collocation.
# Command: python3 validation/golden/sag_reference.py
# Tool: numpy {numpy}, scipy {scipy}, Python {python}
# Date: {date}
"""

SAG = """\
# Units: q a^4/D, up positive, with a the radius, q the weight of a unit of area and D the bending stiffness; at: radius of the points, or half the distance of the rails, in a.
# Tolerance: {tolerance}
# Rails: {rail} points of half a rail push up where they push at all.
# Extrapolated from degrees {half} and {degree}: the first differs from that by {far:.1e} of the greatest depth at most, the second by {near:.1e}.
support,at,poisson,center,lowest,highest,mean,deviation
"""

TOLERANCE = "absolute; 3e-6: a tenth of what the extrapolation changes, and what points for a rail do; 1.5e-5 for lowest and highest, which are looked for on a grid, of 1/48 by 2.8 degrees at the coarser side."

DROOP = """\
# Units: N m^2, kg/m, kg, m, rad; down positive.
# Tolerance: 1e-9 of the value, for which the mesh was refined.
stiffness,mass_by_length,load,reach,drop,slope
"""


def sags(degree):
    """All rows of plates, with polynomials up to a degree."""
    global DEGREE
    kept, DEGREE = DEGREE, degree
    rows = []
    for poisson in POISSON:
        even, threefold = Plate(poisson, 2), Plate(poisson, 3)
        rows.append(("edge", 1.0, poisson, threefold.summary(threefold.on_edge(), 3)))
        for radius in POINTS:
            shape = threefold.on([(radius, 0.0)])
            rows.append(("three-points", radius, poisson, threefold.summary(shape, 3)))
        for half in RAILS:
            chord = (1 - half ** 2) ** 0.5
            along = chord * numpy.linspace(0, 1, RAIL_POINTS)
            places = [(numpy.hypot(half, y), numpy.arctan2(y, half)) for y in along]
            rows.append(("two-rails", half, poisson, even.summary(even.on(places), 2)))
    DEGREE = kept
    return rows


def main():
    def head(name):
        return HEAD.format(
            name=name, degree=DEGREE, numpy=numpy.__version__, scipy=scipy.__version__,
            python=platform.python_version(), date=DATE)

    fine, coarse = sags(DEGREE), sags(DEGREE // 2)
    rows, far, near = [], 0.0, 0.0
    for row, other in zip(fine, coarse):
        one, two = numpy.array(row[3]), numpy.array(other[3])
        numbers = one + (one - two) / 3
        depth = numpy.abs(numbers[:3]).max()
        far = max(far, numpy.abs(two - numbers).max() / depth)
        near = max(near, numpy.abs(one - numbers).max() / depth)
        rows.append((*row[:3], numbers))
    text = head("sag.csv") + SAG.format(
        rail=RAIL_POINTS, half=DEGREE // 2, degree=DEGREE, far=far, near=near, tolerance=TOLERANCE)
    for support, at, poisson, numbers in rows:
        text += f"{support},{at!r},{poisson!r},{','.join(repr(float(v)) for v in numbers)}\n"
    (HERE / "sag.csv").write_text(text)
    text = head("droop.csv") + DROOP
    for beam in BEAMS:
        for reach in REACHES:
            numbers = [*beam, reach, *drooping(*beam, reach)]
            text += ",".join(repr(float(v)) for v in numbers) + "\n"
    (HERE / "droop.csv").write_text(text)


if __name__ == "__main__":
    main()
