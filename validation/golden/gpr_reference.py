#!/usr/bin/env python3
"""Reference kinematics of the three-rod GPR in 50-digit arithmetic.

An implementation of its own, kept apart from the Rust crates so that the two
can be set against each other.  It shares no code with them and, where it can,
no method either: sockets are complex numbers, all derivatives come from one
rule, and the least-norm solution comes from the Lagrange conditions.

    python3 validation/golden/gpr_reference.py

needs only mpmath, takes no arguments, and writes next to itself

    gpr-robots.csv       the robots: sockets and base points
    gpr-forward.csv      rods, sides, X and pose: five models, two solvers
    gpr-mobility.csv     singular values and rank of dPhi/dP
    gpr-sensitivity.csv  non-zero singular values of dX/dP

Source of the mathematics: [Virtualization], "Virtualization for the Purposes
of Modeling and Computer Simulation of a Class of Overconstrained Robots", with
the corrections named in README.md.  Lengths are in mm and angles in rad inside;
degrees only in the files, in columns with that unit.
"""

import os
import platform
from dataclasses import dataclass

import mpmath
from mpmath import mp, mpf, mpc

mp.dps = 50
DATE = "2026-11-21"
HERE = os.path.dirname(os.path.abspath(__file__))

# --------------------------------------------------------------------------
# Robots
# --------------------------------------------------------------------------


def unit(theta):
    """The unit vector of direction theta, as a complex number."""
    return mpc(mpmath.cos(theta), mpmath.sin(theta))


@dataclass
class Robot:
    """Socket k lies at radius r[k] and angle beta[k] of the platform frame;
    the axis of rod k crosses the base plane at base[k] = B_kx + i B_ky."""

    name: str
    r: list
    beta: list
    base: list

    @property
    def mean_radius(self):
        return sum(self.r) / 3

    @property
    def sockets(self):
        return [r * unit(b) for r, b in zip(self.r, self.beta)]


def make_robot(name, radii, angles_deg, base=None):
    """Numbers are given as decimal strings, so that they are exact.
    Without base points, each one lies under its socket."""
    r = [mpf(s) for s in radii]
    beta = [mpmath.radians(mpf(s)) for s in angles_deg]
    if base is None:
        points = [a * unit(b) for a, b in zip(r, beta)]
    else:
        points = [mpc(mpf(x), mpf(y)) for x, y in base]
    return Robot(name, r, beta, points)


def robots():
    return [
        # The robot of [Virtualization].
        make_robot("symmetric", ["93.218"] * 3, ["0", "120", "240"]),
        # Radii and angles off by up to 2 % and 2 degrees, base points within
        # about 0.1 mm of the sockets.
        make_robot(
            "skewed",
            ["93.9", "92.6", "94.8"],
            ["0.7", "118.6", "241.9"],
            [("93.93", "1.12"), ("-44.38", "81.24"), ("-44.61", "-83.68")],
        ),
        # A platform and a base which fit worse: base points up to 0.5 mm away
        # from the sockets, and the base axis away from the triangle's centre.
        make_robot(
            "misfit",
            ["91.5", "94.9", "93.1"],
            ["-2.4", "123.3", "238.2"],
            [("91.12", "-3.61"), ("-52.34", "79.62"), ("-48.71", "-79.35")],
        ),
    ]


# --------------------------------------------------------------------------
# Virtualizations: X -> sockets in the platform plane
# --------------------------------------------------------------------------
#
# X = (a_1, a_2, a_3) or (a_1, a_2, a_3, b_1, b_2, b_3).  Socket k depends on
# a_k and b_k alone.  `socket` returns its place together with the first and
# second derivatives: p, [p_a, p_b], [[p_aa, p_ab], [p_ba, p_bb]].

MODELS = ("radial", "polar", "offset", "planar")


def nominal(model, robot):
    zeros = [mpf(0)] * 3
    if model == "radial":
        return list(robot.r)
    if model == "polar":
        return list(robot.r) + zeros
    return zeros + zeros


def socket(model, robot, k, x):
    beta = robot.beta[k]
    zero = mpc(0)
    if model == "radial":
        e = unit(beta)
        return x[k] * e, [e], [[zero]]
    a, b = x[k], x[k + 3]
    if model == "planar":
        return robot.r[k] * unit(beta) + mpc(a, b), [mpc(1), mpc(0, 1)], [[zero] * 2] * 2
    # polar: a e^(i(beta+b)); offset: the same, added to the nominal socket.
    e = unit(beta + b)
    centre = robot.r[k] * unit(beta) if model == "offset" else zero
    ie = mpc(0, 1) * e
    return centre + a * e, [e, a * ie], [[zero, ie], [ie, -a * e]]


def dot(z, w):
    """The scalar product of two plane vectors written as complex numbers."""
    return z.real * w.real + z.imag * w.imag


SIDES = ((0, 1), (1, 2), (2, 0))  # L12, L23, L31


def squared_sides(model, robot, x):
    """|p_j - p_i|^2 for the three sides, the gradients (3 x M), and the three
    Hessians (M x M)."""
    n = len(x)
    local = [socket(model, robot, k, x) for k in range(3)]
    values, jac, hessians = [], mpmath.zeros(3, n), []
    for row, (i, j) in enumerate(SIDES):
        d = local[j][0] - local[i][0]
        values.append(dot(d, d))
        hess = mpmath.zeros(n, n)
        # d depends on the coordinates of j with sign +, of i with sign -.
        for s, k in ((1, j), (-1, i)):
            for c, first in enumerate(local[k][1]):
                jac[row, k + 3 * c] = 2 * s * dot(d, first)
                for c2, second in enumerate(local[k][2][c]):
                    hess[k + 3 * c, k + 3 * c2] += 2 * s * dot(d, second)
                for s2, k2 in ((1, j), (-1, i)):
                    for c2, other in enumerate(local[k2][1]):
                        hess[k + 3 * c, k2 + 3 * c2] += 2 * s * s2 * dot(first, other)
        hessians.append(hess)
    return values, jac, hessians


def weights(model, rho):
    """The diagonal of W: the norm is sum of lengths^2 + rho^2 * angles^2."""
    if model == "radial":
        return [mpf(1)] * 3
    if model == "planar":
        return [mpf(1)] * 6
    return [mpf(1)] * 3 + [rho**2] * 3


def right_inverse(jac, w):
    """W^-1 J^T (J W^-1 J^T)^-1: of all dX with J dX = given, the one of least
    W-norm."""
    jt = jac.T.copy()
    for row, weight in enumerate(w):
        for c in range(3):
            jt[row, c] /= weight
    return jt * mpmath.inverse(jac * jt)


# --------------------------------------------------------------------------
# Solvers for F(X, L) = 0
# --------------------------------------------------------------------------


def tolerance():
    return mpmath.ldexp(1, -mp.prec + 12)


def solve_newton(model, robot, rho, sides, steps=None, step_on="F", start=None):
    """The iteration of [Virtualization], IV.B, from the nominal X:

        X <- X - (dF/dX)^+ F(X, L),   F_ij = |p_j - p_i|^2 - L_ij^2,

    the pseudo-inverse that of least W-norm at the current X.  Read to the
    letter, with dF/dL = -2 diag(L(X)) at the current X, the print has

        X <- X + (dF/dX)^+ 2 diag(L(X)) (L - L(X)),

    which is Newton's step on the lengths instead of on their squares, the same
    linearly: step_on="L", kept for comparison.
    """
    x = mpmath.matrix(nominal(model, robot) if start is None else start)
    w = weights(model, rho)
    for _ in range(steps if steps is not None else 60):
        values, jac, _ = squared_sides(model, robot, x)
        if step_on == "F":
            f = [want**2 - v for v, want in zip(values, sides)]
        else:
            now = [mpmath.sqrt(v) for v in values]
            f = [2 * l * (want - l) for l, want in zip(now, sides)]
        dx = right_inverse(jac, w) * mpmath.matrix(f)
        x += dx
        if steps is None and mpmath.norm(dx, mpmath.inf) < 100 * tolerance():
            return x
    if steps is None:
        raise RuntimeError(f"no convergence: {robot.name} {model}")
    return x


def solve_least_norm(model, robot, rho, sides, start=None, check=True):
    """The X with F = 0 and least |X - X0|_W, from the Lagrange conditions

        W (X - X0) + J^T lambda = 0,   F = 0

    by Newton's method on all of X and lambda, with the exact second
    derivatives, from the `newton` solution.  The second-order condition is
    checked, so that what comes back is a strict local minimum.
    """
    x0 = mpmath.matrix(nominal(model, robot))
    w = weights(model, rho)
    n = len(w)
    x = start.copy() if start is not None else solve_newton(model, robot, rho, sides)
    lam = None
    for _ in range(60):
        values, jac, hessians = squared_sides(model, robot, x)
        weighted = mpmath.matrix([w[i] * (x[i] - x0[i]) for i in range(n)])
        if lam is None:
            lam = -(right_inverse(jac, w).T * weighted)
        gradient = weighted + jac.T * lam
        kkt = mpmath.zeros(n + 3, n + 3)
        for i in range(n):
            kkt[i, i] = w[i]
            for j in range(n):
                kkt[i, j] += sum(lam[s] * hessians[s][i, j] for s in range(3))
            for s in range(3):
                kkt[i, n + s] = kkt[n + s, i] = jac[s, i]
        rhs = [-gradient[i] for i in range(n)]
        rhs += [sides[s] ** 2 - values[s] for s in range(3)]
        step = mpmath.lu_solve(kkt, mpmath.matrix(rhs))
        x += step[:n]
        lam += step[n:]
        if mpmath.norm(step[:n], mpmath.inf) < 100 * tolerance():
            if check and n > 3 and least_curvature(model, robot, w, x, lam) <= 0:
                raise RuntimeError(f"not a minimum: {robot.name} {model}")
            return x
    raise RuntimeError(f"no convergence (Lagrange): {robot.name} {model}")


def least_curvature(model, robot, w, x, lam):
    """The least eigenvalue of the Lagrangian's Hessian on the tangent space of
    F = 0, in coordinates in which W is the unit matrix (so 1 at lambda = 0)."""
    n = len(w)
    _, jac, hessians = squared_sides(model, robot, x)
    root = [mpmath.sqrt(v) for v in w]
    scaled = mpmath.matrix(n, 3)
    hess = mpmath.eye(n)
    for i in range(n):
        for s in range(3):
            scaled[i, s] = jac[s, i] / root[i]
        for j in range(n):
            hess[i, j] += sum(lam[s] * hessians[s][i, j] for s in range(3)) / (root[i] * root[j])
    q, _ = mpmath.qr(scaled)
    tangent = q[:, 3:n]
    return min(mpmath.eigsy(tangent.T * hess * tangent, eigvals_only=True))


SOLVERS = {"newton": solve_newton, "least-norm": solve_least_norm}

# --------------------------------------------------------------------------
# Inverse kinematics, sides, pose
# --------------------------------------------------------------------------


def tilt_normal(yaw, pitch):
    s = mpmath.sin(pitch)
    return [s * mpmath.cos(yaw), s * mpmath.sin(yaw), mpmath.cos(pitch)]


def rods(robot, yaw, pitch, axis_height):
    """The rods which put the balls into the plane through (0, 0, axis_height)
    with the tilt's normal."""
    n = tilt_normal(yaw, pitch)
    return [axis_height - (n[0] * b.real + n[1] * b.imag) / n[2] for b in robot.base]


def balls(robot, q):
    return [mpmath.matrix([b.real, b.imag, h]) for b, h in zip(robot.base, q)]


def side_lengths(points):
    return [mpmath.norm(points[j] - points[i]) for i, j in SIDES]


def cross(a, b):
    return mpmath.matrix(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def triad(p):
    """Orthonormal axes tied to three points: along the first side, in the
    plane, and normal (counter-clockwise: up)."""
    e1 = (p[1] - p[0]) / mpmath.norm(p[1] - p[0])
    e3 = cross(p[1] - p[0], p[2] - p[0])
    e3 = e3 / mpmath.norm(e3)
    e2 = cross(e3, e1)
    m = mpmath.matrix(3, 3)
    for c, e in enumerate((e1, e2, e3)):
        for r in range(3):
            m[r, c] = e[r]
    return m


@dataclass
class Pose:
    origin: mpmath.matrix
    rotation: mpmath.matrix
    normal: list
    torsion: mpf
    misfit: mpf  # greatest distance |pose(p_k) - P_k|


def pose_of(model, robot, x, points):
    """The rigid transform which carries the sockets p_k(X) onto the balls."""
    local = []
    for k in range(3):
        p = socket(model, robot, k, x)[0]
        local.append(mpmath.matrix([p.real, p.imag, 0]))
    rotation = triad(points) * triad(local).T
    images = [rotation * p for p in local]
    origin = (points[0] + points[1] + points[2] - images[0] - images[1] - images[2]) / 3
    misfit = max(mpmath.norm(origin + im - p) for im, p in zip(images, points))
    n = [rotation[r, 2] for r in range(3)]
    return Pose(origin, rotation, n, torsion(rotation), misfit)


def torsion(rotation):
    """The torsion t in R = T Rz(t), T = Rz(yaw) Ry(pitch) Rz(-yaw) being the
    shortest rotation from e3 to the normal: T = 1 + [v] + [v]^2/(1 + n_z),
    v = e3 x n."""
    nx, ny, nz = (rotation[r, 2] for r in range(3))
    f = 1 / (1 + nz)
    t = mpmath.matrix(
        [[1 - nx * nx * f, -nx * ny * f, nx], [-nx * ny * f, 1 - ny * ny * f, ny], [-nx, -ny, nz]]
    )
    m = t.T * rotation
    return mpmath.atan2(m[1, 0], m[0, 0])


# --------------------------------------------------------------------------
# Mobility and sensitivity
# --------------------------------------------------------------------------
#
# P = (q1, q2, q3, r1, r2, r3), Phi = (nine rod equations, three sides).


def phi_by_p(robot, q):
    """dPhi/dP in mm: rods r_b + q e3 - r, then |r_j - r_i|^2 - L^2."""
    p = balls(robot, q)
    m = mpmath.zeros(12, 12)
    for k in range(3):
        m[3 * k + 2, k] = 1
        for c in range(3):
            m[3 * k + c, 3 + 3 * k + c] = -1
    for row, (i, j) in enumerate(SIDES):
        for c in range(3):
            d = 2 * (p[j][c] - p[i][c])
            m[9 + row, 3 + 3 * j + c] = d
            m[9 + row, 3 + 3 * i + c] = -d
    return m


def mobility_values(robot, q):
    """Singular values of dPhi/dP with P/R, rods/R and sides/R^2, R the mean
    socket radius: the rods' rows keep their entries, the sides' lose one R."""
    m = phi_by_p(robot, q)
    for row in range(9, 12):
        for c in range(12):
            m[row, c] /= robot.mean_radius
    return sorted(mpmath.svd_r(m, compute_uv=False), reverse=True)


RANK_THRESHOLD = mpf(10) ** -30


def rank_of(values):
    return sum(1 for v in values if v > RANK_THRESHOLD * values[0])


def x_by_p(model, robot, rho, x, q):
    """W^(1/2) dX/dP, dX/dP = -(dPhi/dX)^+ dPhi/dP.  Only the sides' rows of
    dPhi/dX are not zero, and they are -dF/dX, of rank 3; so the pseudo-inverse
    is that of dF/dX and acts on the sides' rows of dPhi/dP."""
    w = weights(model, rho)
    _, jac, _ = squared_sides(model, robot, x)
    m = right_inverse(jac, w) * phi_by_p(robot, q)[9:12, :]
    for i, weight in enumerate(w):
        for c in range(12):
            m[i, c] *= mpmath.sqrt(weight)
    return m


def sensitivity_values(model, robot, rho, x, q):
    m = x_by_p(model, robot, rho, x, q)
    return sorted(mpmath.svd_r(m, compute_uv=False), reverse=True)[:3]


# --------------------------------------------------------------------------
# Files
# --------------------------------------------------------------------------

# Numbers below this come from rounding only and are written as 0.  (Lengths
# are of the order of 100 mm and are good to about 1e-47 mm.)
NOISE = mpf(10) ** -40


def number(v):
    if v is None:
        return ""
    v = mpf(v)
    if abs(v) < NOISE:
        return "0"
    return mpmath.nstr(v, 20)


def write(name, header, columns, rows):
    with open(os.path.join(HERE, name), "w", encoding="ascii", newline="\n") as out:
        common = [
            "Source: [Virtualization], \"Virtualization for the Purposes of Modeling and "
            "Computer Simulation of a Class of Overconstrained Robots\";",
            "  computed independently of the Rust crates.",
            "Command: python3 validation/golden/gpr_reference.py",
            f"Tool: mpmath {mpmath.__version__}, {mp.dps} decimal digits; "
            f"Python {platform.python_version()}",
            f"Date: {DATE}",
            "Numbers: 20 significant digits (trailing zeros dropped); "
            "magnitudes below 1e-40 are written as 0.",
        ]
        for line in [name] + common + header:
            out.write(f"# {line}\n")
        out.write(",".join(columns) + "\n")
        for row in rows:
            out.write(",".join(v if isinstance(v, str) else number(v) for v in row) + "\n")


# yaw in degrees, pitch in degrees, axis height in mm
POSES = [
    ("0", "0", "500"),
    ("0", "2", "500"),
    ("0", "-2", "500"),
    ("90", "2", "500"),
    ("30", "1.5", "420"),
    ("137.5", "0.2", "500"),
    ("300", "0.001", "500"),
    ("200", "3.3", "650"),
    ("60", "5", "300"),
    ("180", "5", "500"),
    ("251.7", "4.4", "700"),
    ("345", "-1.2", "366.25"),
]

# model, characteristic length (None: no angle in X)
VARIANTS = [
    ("radial", lambda r: None),
    ("polar", lambda r: mpf(1)),
    ("polar", lambda r: r.mean_radius),
    ("offset", lambda r: mpf(1)),
    ("planar", lambda r: None),
]


def write_robots(all_robots):
    columns = ["robot"]
    columns += [f"r{k}_mm" for k in (1, 2, 3)] + [f"beta{k}_deg" for k in (1, 2, 3)]
    columns += [f"B{k}{c}_mm" for k in (1, 2, 3) for c in "xy"]
    rows = []
    for r in all_robots:
        row = [r.name] + list(r.r) + [mpmath.degrees(b) for b in r.beta]
        row += [v for b in r.base for v in (b.real, b.imag)]
        rows.append(row)
    write(
        "gpr-robots.csv",
        [
            "Units: mm, degrees. Socket k: radius r_k and angle beta_k in the platform frame;",
            "  B_k: where the axis of rod k crosses the base plane z = 0.",
            "Tolerance: none, these are inputs. The decimals are exact by definition, except B_k",
            "  of `symmetric`, which is r_k (cos beta_k, sin beta_k) rounded to 20 digits.",
        ],
        columns,
        rows,
    )


def write_forward(all_robots):
    columns = ["robot", "model", "rho_mm", "solver", "azimuth_deg", "tilt_deg", "axis_height_mm"]
    columns += ["q1_mm", "q2_mm", "q3_mm", "L12_mm", "L23_mm", "L31_mm"]
    columns += [f"x{i}" for i in range(1, 7)]
    columns += ["x_mm", "y_mm", "z_mm", "nx", "ny", "nz", "torsion_deg"]
    rows = []
    for robot in all_robots:
        for azimuth_deg, tilt_deg, height in POSES:
            yaw, pitch = mpmath.radians(mpf(azimuth_deg)), mpmath.radians(mpf(tilt_deg))
            q = rods(robot, yaw, pitch, mpf(height))
            points = balls(robot, q)
            sides = side_lengths(points)
            for model, rho_of in VARIANTS:
                rho = rho_of(robot)
                for solver, solve in SOLVERS.items():
                    x = solve(model, robot, rho, sides)
                    pose = pose_of(model, robot, x, points)
                    assert pose.misfit < mpf(10) ** -44, (robot.name, model, pose.misfit)
                    row = [robot.name, model, number(rho), solver, azimuth_deg, tilt_deg, height]
                    row += q + sides + list(x) + [None] * (6 - len(x))
                    row += list(pose.origin) + pose.normal + [mpmath.degrees(pose.torsion)]
                    rows.append(row)
    write("gpr-forward.csv", FORWARD_HEADER, columns, rows)


FORWARD_HEADER = [
    "Robots: gpr-robots.csv.",
    "Units: q, L, origin in mm; normal without unit; torsion in degrees; rho in mm, empty where X",
    "  has no angle.",
    "X: radial l1 l2 l3 (mm), x4..x6 empty; polar l1 l2 l3 (mm) phi1 phi2 phi3 (rad);",
    "  offset dr1 dr2 dr3 (mm) dphi1 dphi2 dphi3 (rad); planar u1 u2 u3 v1 v2 v3 (mm, platform",
    "  frame). Norm: sum of lengths^2 + rho^2 * sum of angles^2.",
    "Solver newton: X <- X - (dF/dX)^+ F(X, L) from the nominal X, F_ij = |p_j - p_i|^2 - L_ij^2,",
    "  run to convergence. (Stepping on lengths instead of their squares ends elsewhere on F = 0:",
    "  see README.md.)",
    "Solver least-norm: F = 0 with the least norm of X - X0, from the Lagrange conditions; the",
    "  local minimum next to the newton solution, second-order condition checked.",
    "Pose: the rigid transform which carries the sockets p_k(X) onto the balls P_k.",
    "  R = Rz(yaw) Ry(pitch) Rz(-yaw) Rz(torsion).",
    "Tolerances, absolute, for an implementation in double precision. In brackets the greatest",
    "  error of this same computation rounded to 53 bits; the rest is room for other formulas,",
    "  for metres inside, and for the last step of an iteration which stops early.",
    "  q 1e-11 mm (6e-14)         a few operations on numbers up to 700 mm",
    "  L 1e-11 mm (5e-14)         differences of coordinates, sides near 160 mm",
    "  lengths in X 1e-10 mm (6e-14), angles in X 1e-10 rad (2e-15; offset 2e-14, its angles rest",
    "                             on dr of a fraction of a mm): well-conditioned against L",
    "  origin 1e-10 mm (3e-13)    follows X and q",
    "  normal 1e-13 (6e-16)       differences of coordinates over about 100 mm",
    "  torsion 1e-10 deg (7e-14)    follows X, over about 100 mm",
]


def write_mobility(all_robots):
    columns = ["robot", "q1_mm", "q2_mm", "q3_mm"] + [f"s{i}" for i in range(1, 13)] + ["rank"]
    rows = []
    for robot in all_robots:
        five = mpf(500)
        configurations = [[five] * 3]
        for extra in ("1e-9", "1e-6", "1e-3"):
            configurations.append([five, five + mpf(extra), five])
        for yaw, pitch in (("30", "0.1"), ("0", "2"), ("75", "5")):
            configurations.append(
                rods(robot, mpmath.radians(mpf(yaw)), mpmath.radians(mpf(pitch)), five)
            )
        for q in configurations:
            values = mobility_values(robot, q)
            row = [robot.name] + q + [v if v > RANK_THRESHOLD * values[0] else 0 for v in values]
            rows.append(row + [str(rank_of(values))])
    write(
        "gpr-mobility.csv",
        [
            "Robots: gpr-robots.csv.",
            "Singular values of dPhi/dP, P = (q1 q2 q3 r1x r1y r1z r2x .. r3z), Phi = nine rod",
            "  equations r_b + q e3 - r, then |r_j - r_i|^2 - L_ij^2 in the order 12, 23, 31.",
            "Scale: P and the rods' rows divided by R, the sides' rows by R^2; R = mean socket",
            "  radius. Then the values have no unit.",
            "Configurations: level at 500 mm; rod 2 longer by 1e-9, 1e-6, 1e-3 mm; at axis height",
            "  500 mm (yaw, pitch) = (30, 0.1), (0, 2), (75, 5) degrees.",
            "Rank: values above 1e-30 of the greatest; those below are written as 0.",
            "Tolerance: 1e-13 absolute on every s (double-precision SVD of a matrix of norm near 5",
            "  is good to about 1e-15, and q of 500 mm, in double, to 1e-13 mm = 1e-15 R). Absolute",
            "  on purpose: at 1e-9 mm the smallest non-zero values are near 1e-11 and hold only two",
            "  or three digits in double precision. The rank exactly, with a threshold between.",
        ],
        columns,
        rows,
    )


def write_sensitivity(all_robots):
    columns = ["robot", "model", "rho_mm", "solver", "azimuth_deg", "tilt_deg", "axis_height_mm"]
    columns += ["q1_mm", "q2_mm", "q3_mm"] + [f"x{i}" for i in range(1, 7)] + ["s1", "s2", "s3"]
    rows = []
    for robot in all_robots:
        variants = VARIANTS[:4] + [("offset", lambda r: r.mean_radius)] + VARIANTS[4:]
        for solver, tilt_deg in (("nominal", "0"), ("newton", "2")):
            q = rods(robot, mpf(0), mpmath.radians(mpf(tilt_deg)), mpf(500))
            sides = side_lengths(balls(robot, q))
            for model, rho_of in variants:
                rho = rho_of(robot)
                if solver == "nominal":
                    x = mpmath.matrix(nominal(model, robot))
                else:
                    x = solve_newton(model, robot, rho, sides)
                row = [robot.name, model, number(rho), solver, "0", tilt_deg, "500"]
                row += q + list(x) + [None] * (6 - len(x))
                rows.append(row + sensitivity_values(model, robot, rho, x, q))
    write(
        "gpr-sensitivity.csv",
        [
            "Robots: gpr-robots.csv. X as in gpr-forward.csv: here nominal, or the newton solution.",
            "The three non-zero singular values of W^(1/2) dX/dP, dX/dP = -(dPhi/dX)^+ dPhi/dP with",
            "  the pseudo-inverse of least W-norm, W = diag(1, 1, 1, rho^2, rho^2, rho^2): angles",
            "  multiplied by rho, so that the values have no unit. P as in gpr-mobility.csv, in mm.",
            "At rho = 1 mm this is the plain matrix in mm and rad.",
            "Row solver = nominal: X nominal and P level; for robots other than `symmetric` the two",
            "  do not satisfy F = 0 exactly, and the derivatives are taken there all the same.",
            "Tolerance: 1e-9 relative (double-precision pseudo-inverse and SVD give about 1e-13; the",
            "  polar model's dPhi/dX at rho = 1 mm spreads over a factor of 100, squared if normal",
            "  equations are used; X itself is compared to 1e-9).",
        ],
        columns,
        rows,
    )


def main():
    all_robots = robots()
    write_robots(all_robots)
    write_forward(all_robots)
    write_mobility(all_robots)
    write_sensitivity(all_robots)


if __name__ == "__main__":
    main()
