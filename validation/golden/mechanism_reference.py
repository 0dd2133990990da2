#!/usr/bin/env python3
"""Reference mobility and motion of the catalogue of mechanisms in crates/jointplay-format/robots/.

An implementation of its own, kept apart from the Rust crates so that the two
can be set against each other.  It shares no code with them and no method
either: the unknowns are the poses of the links, not the joint coordinates;
a joint is the set of equations that it imposes on two poses; loops never
appear.  Joint coordinates are measured afterwards, between the poses found.

    python3 validation/golden/mechanism_reference.py

needs numpy and scipy and Python 3.11, takes no arguments, checks every
mechanism against its [expected] numbers, and writes next to itself

    mechanisms.csv        freedoms, rank, mobilities and redundancy
    mechanism_drive.csv   joint coordinates of those with one drive

It ends with status 1 if any expected number differs.  Inside, lengths are
in units of each mechanism's own length, angles in rad; files are in m and rad.
"""

import ast
import math
import platform
import sys
import tomllib
from pathlib import Path

import numpy
import scipy
from scipy.spatial.transform import Rotation

DATE = "2026-11-21"
HERE = Path(__file__).resolve().parent
ROBOTS = HERE.parent.parent / "crates/jointplay-format/robots"

LENGTH = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "in": 0.0254}
ANGLE = {"deg": math.pi / 180.0, "rad": 1.0}
FREEDOMS = {
    "revolute": 1, "prismatic": 1, "helical": 1, "cylindrical": 2, "universal": 2,
    "spherical": 3, "planar": 3, "fixed": 0, "floating": 6,
}
SINGLE = ("revolute", "prismatic", "helical")

# Singular values below this part of the greatest count as zero. Between the
# two kinds there are at least three decades in every mechanism (checked).
RANK_THRESHOLD = 1e-7
CLOSED = 1e-13
# Length of the steps of the local dimension test; motions count whose
# displacement is a fair part of it, so that curvature (of order STEP^2) and
# what is left of slowly converging ones (of order sqrt(CLOSED)) do not.
STEP = 1e-3
MOVED = 0.05

# --------------------------------------------------------------------------
# Expressions
# --------------------------------------------------------------------------


class Expressions:
    """Evaluates numbers and expressions over a file's parameters."""

    def __init__(self, parameters, angle):
        self.raw, self.values, self.open = parameters, {}, []
        turn = lambda f: (lambda v: f(v * angle))
        back = lambda f: (lambda *v: f(*v) / angle)
        self.functions = {
            "sin": turn(math.sin), "cos": turn(math.cos), "tan": turn(math.tan),
            "asin": back(math.asin), "acos": back(math.acos), "atan": back(math.atan),
            "atan2": back(math.atan2), "sqrt": math.sqrt, "abs": abs, "min": min,
            "max": max, "hypot": math.hypot,
        }

    def __call__(self, value):
        if isinstance(value, (int, float)):
            return float(value)
        return self.walk(ast.parse(value.replace("^", "**").strip(), mode="eval").body)

    def vector(self, values):
        return numpy.array([self(v) for v in values])

    def name(self, name):
        if name == "pi" and name not in self.raw:
            return math.pi
        if name not in self.values:
            if name in self.open:
                raise ValueError(f"parameters in a circle: {self.open}")
            self.open.append(name)
            self.values[name] = self(self.raw[name])
            self.open.pop()
        return self.values[name]

    def walk(self, node):
        if isinstance(node, ast.Constant):
            return float(node.value)
        if isinstance(node, ast.Name):
            return self.name(node.id)
        if isinstance(node, ast.UnaryOp):
            v = self.walk(node.operand)
            return -v if isinstance(node.op, ast.USub) else v
        if isinstance(node, ast.BinOp):
            a, b = self.walk(node.left), self.walk(node.right)
            return {
                ast.Add: lambda: a + b, ast.Sub: lambda: a - b, ast.Mult: lambda: a * b,
                ast.Div: lambda: a / b, ast.Pow: lambda: a**b,
            }[type(node.op)]()
        if isinstance(node, ast.Call):
            return self.functions[node.func.id](*[self.walk(a) for a in node.args])
        raise ValueError(f"cannot evaluate {ast.dump(node)}")


# --------------------------------------------------------------------------
# Poses, frames and joints
# --------------------------------------------------------------------------


def unit(v):
    return v / numpy.linalg.norm(v)


def pose(rotation, point):
    t = numpy.eye(4)
    t[:3, :3], t[:3, 3] = rotation, point
    return t


def frame(expressions, table, second_axis):
    """A joint frame: z along the axis, x along zero or the second axis."""
    z = unit(expressions.vector(table.get("axis", [0, 0, 1])))
    if second_axis is not None:
        x = expressions.vector(second_axis)
        assert abs(unit(x) @ z) < 1e-6, "second axis not perpendicular"
    elif "zero" in table:
        x = expressions.vector(table["zero"])
    else:
        x = numpy.eye(3)[numpy.argmin(abs(z))]
    x = unit(x - (x @ z) * z)
    point = expressions.vector(table["point"]) if "point" in table else numpy.zeros(3)
    return pose(numpy.column_stack([x, numpy.cross(z, x), z]), point)


def turn_about_z(angle):
    return pose(Rotation.from_rotvec([0, 0, angle]).as_matrix(), [0, 0, 0])


class Joint:
    def __init__(self, table, expressions, angle):
        self.name, self.kind = table["name"], table["kind"]
        self.links = table["links"]
        self.freedoms = FREEDOMS[self.kind]
        self.actuated = table.get("actuated", False)
        self.lead = expressions(table["lead"]) if "lead" in table else 0.0
        if "frames" in table:
            self.frames = [frame(expressions, f, f.get("second_axis")) for f in table["frames"]]
        else:
            f = frame(expressions, table, table.get("second_axis"))
            self.frames = [f, f.copy()]
        self.guess = 0.0
        if "guess" in table:
            assert self.kind in SINGLE, "guesses of single freedoms only"
            self.guess = expressions(table["guess"]) * (1.0 if self.kind == "prismatic" else angle)

    def between(self, first, second):
        """Both joint frames in the base frame."""
        return first @ self.frames[0], second @ self.frames[1]

    def residual(self, first, second):
        a, b = self.between(first, second)
        ra, rb, d = a[:3, :3], b[:3, :3], a[:3, :3].T @ (b[:3, 3] - a[:3, 3])
        r = ra.T @ rb
        tilt = [r[0, 2], r[1, 2]]
        if self.kind == "revolute":
            return [*d, *tilt]
        if self.kind == "prismatic":
            return [d[0], d[1], *tilt, r[0, 1]]
        if self.kind == "helical":
            return [d[0], d[1], *tilt, d[2] - self.lead * math.atan2(r[1, 0], r[0, 0]) / (2 * math.pi)]
        if self.kind == "cylindrical":
            return [d[0], d[1], *tilt]
        if self.kind == "universal":
            return [*d, r[2, 0]]
        if self.kind == "spherical":
            return list(d)
        if self.kind == "planar":
            return [d[2], *tilt]
        if self.kind == "fixed":
            return [*d, *tilt, r[0, 1]]
        return []

    def coordinate(self, first, second):
        a, b = self.between(first, second)
        r = a[:3, :3].T @ b[:3, :3]
        if self.kind == "prismatic":
            return float(a[:3, 2] @ (b[:3, 3] - a[:3, 3]))
        return math.atan2(r[1, 0], r[0, 0])

    def motion(self, q):
        if self.kind == "prismatic":
            return pose(numpy.eye(3), [0, 0, q])
        t = turn_about_z(q)
        t[2, 3] = self.lead * q / (2 * math.pi)
        return t


class Mechanism:
    def __init__(self, path):
        table = tomllib.loads(path.read_text(encoding="utf-8"))
        self.kind = table["kind"]
        if self.kind != "mechanism":
            return
        self.id, self.name = path.stem, table["name"]
        self.expected = table.get("expected", {})
        units = table["units"]
        angle = ANGLE[units["angle"]]
        self.expressions = Expressions(table.get("parameters", {}), angle)
        self.joints = [Joint(j, self.expressions, angle) for j in table["joint"]]
        self.links = [table["base"]]
        for joint in self.joints:
            self.links += [l for l in joint.links if l not in self.links]
        for extra in table.get("virtual_joint", []):
            assert extra["joint"] in [j.name for j in self.joints]
        if "characteristic_length" in table:
            length = self.expressions(table["characteristic_length"])
        else:
            points = numpy.array([f[:3, 3] for j in self.joints for f in j.frames])
            length = max(numpy.linalg.norm(points - points.mean(axis=0), axis=1))
        for joint in self.joints:
            joint.lead /= length
            for f in joint.frames:
                f[:3, 3] /= length
            if joint.kind == "prismatic":
                joint.guess /= length
        self.length = length * LENGTH[units["length"]]
        self.index = {l: i for i, l in enumerate(self.links)}
        self.freedoms = sum(j.freedoms for j in self.joints)
        self.loops = len(self.joints) - len(self.links) + 1
        self.kutzbach = 6 * (len(self.links) - 1 - len(self.joints)) + self.freedoms

    # Poses are a list of 4 x 4 matrices, the base first. A displacement holds
    # six numbers for each other link: a rotation vector in the base frame
    # about the frame's origin, and a shift of that origin.

    def start(self, coordinates=None):
        """Poses of the links along a spanning tree, joints at their guesses."""
        if coordinates is None:
            coordinates = {j.name: j.guess for j in self.joints}
        poses = [numpy.eye(4)] + [None] * (len(self.links) - 1)
        while any(p is None for p in poses):
            before = sum(p is None for p in poses)
            for joint in self.joints:
                i, k = (self.index[l] for l in joint.links)
                across = joint.frames[0] @ joint.motion(coordinates[joint.name]) @ numpy.linalg.inv(joint.frames[1])
                if poses[i] is not None and poses[k] is None:
                    poses[k] = poses[i] @ across
                elif poses[k] is not None and poses[i] is None:
                    poses[i] = poses[k] @ numpy.linalg.inv(across)
            assert sum(p is None for p in poses) < before, "links in two pieces"
        return poses

    def moved(self, poses, displacement):
        out = [poses[0]]
        for i, p in enumerate(poses[1:]):
            d = displacement[6 * i : 6 * i + 6]
            r = Rotation.from_rotvec(d[:3]).as_matrix()
            out.append(pose(r @ p[:3, :3], p[:3, 3] + d[3:]))
        return out

    def residual(self, poses, drive=None):
        r = []
        for joint in self.joints:
            r += joint.residual(*(poses[self.index[l]] for l in joint.links))
        if drive is not None:
            joint, value = drive
            q = joint.coordinate(*(poses[self.index[l]] for l in joint.links))
            d = q - value
            r.append(d if joint.kind == "prismatic" else math.remainder(d, 2 * math.pi))
        return numpy.array(r)

    def jacobian(self, poses, drive=None):
        """Derivative of the residual, by central differences of fourth order."""
        n = 6 * (len(poses) - 1)
        h, columns = 2e-3, []
        for c in range(n):
            e = numpy.zeros(n)
            e[c] = h
            f = lambda s: self.residual(self.moved(poses, s * e), drive)
            columns.append((f(-2) - 8 * f(-1) + 8 * f(1) - f(2)) / (12 * h))
        return numpy.column_stack(columns)

    # ----------------------------------------------------------------------

    def close(self, poses, drive=None):
        """Gauss-Newton steps of least norm on poses, until closed.

        Returns the poses and the size of the residual. Small singular values
        take part only where without them the residual does not shrink: an
        overconstrained mechanism has some that vanish when it is closed, a
        infinitesimally mobile one some that must be followed down, halving the error at best.
        """
        r = self.residual(poses, drive)
        size = numpy.linalg.norm(r)
        for _ in range(80):
            if size < CLOSED:
                break
            u, s, v = numpy.linalg.svd(self.jacobian(poses, drive), full_matrices=False)
            tried = []
            for part in (1e-3, 1e-5, 1e-7, 1e-9):
                q = poses
                # A second, truncated step undoes what a long first one bends.
                for kept in (s > part * s[0], s > 1e-3 * s[0]):
                    e = self.residual(q, drive)
                    step = -v[kept].T @ ((u.T @ e)[kept] / s[kept])
                    longest = max(abs(step))
                    q = self.moved(q, step if longest < 0.5 else step * (0.5 / longest))
                tried.append((numpy.linalg.norm(self.residual(q, drive)), q))
                if tried[-1][0] < 0.6 * size:
                    break
            best, q = min(tried, key=lambda t: t[0])
            if best >= size:
                break
            poses, size = q, best
            r = self.residual(poses, drive)
        return poses, size

    def singular(self, poses):
        """Singular values and right singular vectors of the pose constraints."""
        _, s, v = numpy.linalg.svd(self.jacobian(poses))
        s = numpy.concatenate([s, numpy.zeros(len(v) - len(s))])
        return s / s[0], v

    def nullity(self, poses, strict=True):
        s, v = self.singular(poses)
        zero = s < RANK_THRESHOLD
        assert not strict or not any((s > RANK_THRESHOLD / 100) & (s < RANK_THRESHOLD * 100)), (self.id, s)
        return int(zero.sum()), v[zero]

    def difference(self, first, second):
        d = []
        for a, b in zip(first[1:], second[1:]):
            d += [*Rotation.from_matrix(b[:3, :3] @ a[:3, :3].T).as_rotvec(), *(b[:3, 3] - a[:3, 3])]
        return numpy.array(d)

    def finite(self, poses, random):
        """Local dimension of the closed configurations at these poses.

        Steps of length STEP along random instantaneous motions, and along
        each one of a basis, are closed again. The dimension is at most the
        number of directions in which the arrived configurations spread, and
        at most the greatest nullity at one of them. The two differ where
        branches cross, or where a infinitesimally mobile mechanism returns to its start.
        """
        h, basis = self.nullity(poses)
        if h == 0:
            return 0
        mix = random.standard_normal((3 * h + 3, h))
        mix = numpy.vstack([mix / numpy.linalg.norm(mix, axis=1)[:, None], numpy.eye(h)])
        differences, nullities = [], []
        for direction in mix @ basis:
            q, size = self.close(self.moved(poses, STEP * direction))
            assert size < 1e-11, (self.id, size)
            differences.append(self.difference(poses, q) / STEP)
            if len(differences) % 4 == 1:
                nullities.append(self.nullity(q, strict=False)[0])
        s = numpy.linalg.svd(numpy.array(differences), compute_uv=False) / math.sqrt(len(mix))
        return min(int((s > MOVED / math.sqrt(h)).sum()), max(nullities))

    def newton_from_guess(self):
        """Plain Newton on single-freedom joint coordinates, for guesses only.

        This is the one place where loops are closed in joint coordinates: it
        checks that the guesses in the files are near enough for it.
        """
        names = [j.name for j in self.joints]
        q = numpy.array([j.guess for j in self.joints])
        def gaps(q):
            coordinates = dict(zip(names, q))
            poses, out = self.start(coordinates), []
            for joint in self.joints:
                a, b = (poses[self.index[l]] for l in joint.links)
                across = joint.frames[0] @ joint.motion(coordinates[joint.name]) @ numpy.linalg.inv(joint.frames[1])
                e = numpy.linalg.inv(a @ across) @ b
                out += [e[2, 1] - e[1, 2], e[0, 2] - e[2, 0], e[1, 0] - e[0, 1], *e[:3, 3]]
            return numpy.array(out)
        for count in range(1, 31):
            r = gaps(q)
            if numpy.linalg.norm(r) < 1e-12:
                return count - 1, numpy.linalg.norm(q - [j.guess for j in self.joints])
            h = 1e-5
            jac = numpy.column_stack([(gaps(q + h * e) - gaps(q - h * e)) / (2 * h) for e in numpy.eye(len(q))])
            q = q + numpy.linalg.lstsq(jac, -r, rcond=1e-9)[0]
        raise ValueError(f"{self.id}: Newton does not close the loops from the guesses")


# --------------------------------------------------------------------------
# The catalogue
# --------------------------------------------------------------------------


def studied(m, random):
    """Numbers of one mechanism, from its closed start."""
    poses, size = m.close(m.start())
    if size > 1e-12:
        print(f"{m.id}: closes only to {size:.1e}")
    h, _ = m.nullity(poses)
    rank = m.freedoms - h
    found = {
        "freedoms": m.freedoms, "rank": rank, "kutzbach": m.kutzbach,
        "instantaneous": h, "finite": m.finite(poses, random),
        "redundancy": 6 * m.loops - rank,
    }
    return poses, found


def generic(m, poses, random):
    """Nullity at a distant closed configuration, for information."""
    h, basis = m.nullity(poses)
    if h == 0:
        return h
    direction = random.standard_normal(h) @ basis
    q, size = m.close(m.moved(poses, 0.05 * unit(direction)))
    return m.nullity(q, strict=False)[0] if size < 1e-11 else None


def driven(m, poses):
    """Five configurations along the drive of a mechanism of mobility one."""
    drives = [j for j in m.joints if j.actuated]
    if len(drives) != 1 or drives[0].freedoms != 1:
        return None
    joint = drives[0]
    at = lambda p, j: j.coordinate(*(p[m.index[l]] for l in j.links))
    # Assembled, the drive is at its guess (0 where it has none).
    start = joint.guess
    here = at(poses, joint)
    steps = 20
    for i in range(1, steps + 1):
        target = here + (start - here) * i / steps
        poses, size = m.close(poses, (joint, target))
        assert size < 1e-11, (m.id, size)
    singles = [j for j in m.joints if j.kind in SINGLE]
    last = {j.name: at(poses, j) for j in singles}
    for j in singles:  # on the guess's turn
        if j.kind != "prismatic":
            last[j.name] = j.guess + math.remainder(last[j.name] - j.guess, 2 * math.pi)
    rows, pitch, fine = [], 0.05 if joint.kind != "prismatic" else 0.02, 10
    for i in range(4 * fine + 1):
        value = start + pitch * i / fine
        poses, size = m.close(poses, (joint, value))
        assert size < 1e-11, (m.id, i, size)
        stiff = numpy.linalg.svd(m.jacobian(poses, (joint, value)), compute_uv=False)
        assert stiff[6 * (len(poses) - 1) - 1] > 1e-3, (m.id, i, stiff)
        for j in singles:
            q = at(poses, j)
            if j.kind != "prismatic":
                q = last[j.name] + math.remainder(q - last[j.name], 2 * math.pi)
            last[j.name] = q
        if i % fine == 0:
            rows.append({j.name: last[j.name] * (m.length if j.kind == "prismatic" else 1.0) for j in singles})
    return joint, rows


def header(name, lines):
    return "\n".join([
        f"# {name}",
        "# Source: the mechanisms of crates/jointplay-format/robots/*.toml, each of which names its own source;",
        "#   computed independently of the Rust crates.",
        "# Command: python3 validation/golden/mechanism_reference.py",
        f"# Tool: numpy {numpy.__version__}, scipy {scipy.__version__}; Python {platform.python_version()}",
        f"# Date: {DATE}",
        *lines,
    ]) + "\n"


MOBILITY = [
    "# Units: none, all are counts.",
    "# freedoms: of all joints. loops: joints - links + 1. rank: freedoms - instantaneous.",
    "# instantaneous: nullity of the derivative of the joints' equations on the links' poses,",
    f"#   singular values below {RANK_THRESHOLD:g} of the greatest (none lies within a factor 100 of it).",
    "# finite: dimension in which closed configurations spread about the start: steps of",
    f"#   {STEP:g} lengths along random instantaneous motions, closed again. A local test.",
    "# redundancy: 6 loops - rank.",
    "# Lengths are divided by characteristic_length, or else by the greatest distance of a",
    "#   joint from the mean of all joints.",
    "# Tolerance: none, counts are exact.",
]
DRIVE = [
    "# Configurations of the mechanisms of mobility 1 with one actuated joint of one freedom.",
    "# step 0 has the drive at its guess (0 where the file gives none); then it is driven on",
    "#   in four equal steps, by continuation in ten parts of each.",
    "# joint, coordinate: every joint of one freedom in the file's order; the drive among them.",
    "#   Turns are continuous along the drive and start within half a turn of the guess.",
    "# Units: rad and m. Numbers: 15 digits after the point.",
    "# Tolerance: 1e-9 absolute. Loops are closed here to 1e-13 (in units of the mechanism's",
    "#   own length); the derivative of pose against closure is below 1e3 in all of them.",
]


def main():
    mobility, drive, failures = [], [], 0
    for path in sorted(ROBOTS.glob("*.toml")):
        if len(sys.argv) > 1 and path.stem not in sys.argv[1:]:
            continue
        m = Mechanism(path)
        if m.kind != "mechanism":
            continue
        random = numpy.random.default_rng(20261121)
        poses, found = studied(m, random)
        line = ", ".join(f"{k} {v}" for k, v in found.items())
        print(f"{m.id}: {line}; links {len(m.links)}, joints {len(m.joints)}, off start {generic(m, poses, random)}")
        for key, value in found.items():
            if m.expected.get(key) != value:
                print(f"  DIFFERS: expected.{key} = {m.expected.get(key)}, found {value}")
                failures += 1
        if any("guess" in t for t in tomllib.loads(path.read_text(encoding="utf-8"))["joint"]):
            count, distance = m.newton_from_guess()
            print(f"  Newton closes the guesses in {count} steps, moving them by {distance:.2e}")
        mobility.append([m.id, m.freedoms, m.loops] + [found[k] for k in ("rank", "instantaneous", "finite", "redundancy")])
        if found["finite"] == 1 and found["instantaneous"] == 1:
            rows = driven(m, poses)
            if rows is not None:
                joint, rows = rows
                for i, row in enumerate(rows):
                    drive += [[m.id, joint.name, i, n, f"{q:.15f}"] for n, q in row.items()]
    if len(sys.argv) > 1:
        return 1 if failures else 0
    with open(HERE / "mechanisms.csv", "w", encoding="utf-8", newline="\n") as out:
        out.write(header("mechanisms.csv", MOBILITY))
        out.write("name,freedoms,loops,rank,instantaneous,finite,redundancy\n")
        out.writelines(",".join(map(str, r)) + "\n" for r in mobility)
    with open(HERE / "mechanism_drive.csv", "w", encoding="utf-8", newline="\n") as out:
        out.write(header("mechanism_drive.csv", DRIVE))
        out.write("name,drive,step,joint,coordinate\n")
        out.writelines(",".join(map(str, r)) + "\n" for r in drive)
    print(f"{len(mobility)} mechanisms, {failures} numbers that differ")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
