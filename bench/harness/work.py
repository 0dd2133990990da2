"""The workload of the bench in text form, and the protocol of a Python worker.

A worker prints `ready`, then answers `run N` by doing all of its work N times, and `write FILE` by writing its answers; some also answer `call N` by N single calls.
"""

import sys
from dataclasses import dataclass

import numpy as np

ITERATIONS = 50


class Numbers:
    """Reads words one after the other."""

    def __init__(self, path):
        with open(path) as file:
            self.words = iter(file.read().split())

    def word(self):
        return next(self.words)

    def count(self):
        return int(self.word())

    def numbers(self, count):
        return np.array([float(self.word()) for _ in range(count)])

    def frame(self):
        """A rotation and a point."""
        return self.numbers(9).reshape(3, 3), self.numbers(3)


@dataclass
class Gpr:
    """The three-rod robot, and the rods of each pose."""

    radius: np.ndarray
    direction: np.ndarray
    base: np.ndarray
    metric: float
    height: float
    gap: float
    poses: np.ndarray

    @classmethod
    def read(cls, path):
        numbers = Numbers(path)
        limbs = numbers.numbers(15).reshape(3, 5)
        metric, height, gap = map(float, numbers.numbers(3))
        poses = numbers.numbers(3 * numbers.count()).reshape(-1, 3)
        return cls(limbs[:, 0], limbs[:, 1:3], limbs[:, 3:5], metric, height, gap, poses)

    def balls(self, rods):
        """Where the balls are: a row each."""
        return np.column_stack([self.base, rods])

    @property
    def compliance(self):
        """What a turn and a slide of each limb count for in the least displacement."""
        return np.tile([1 / self.metric**2, 1.0], 3)


@dataclass
class Body:
    """A body that hangs on another (−1: the base) by a turn `R` or slide `P` about or along z, or a ball `S`."""

    parent: int
    kind: str
    driven: bool
    rotation: np.ndarray
    point: np.ndarray

    @property
    def width(self):
        """How many numbers its coordinates are: a ball's are a quaternion, w first."""
        return 4 if self.kind == "S" else 1


@dataclass
class Cut:
    """What closes a loop, a hinge `R` or a ball `S`: the body and the joint's frame on it, twice."""

    kind: str
    bodies: tuple
    frames: tuple

    @property
    def rows(self):
        return 5 if self.kind == "R" else 3


@dataclass
class Linkage:
    """A mechanism, and the coordinates that each of its positions is searched from."""

    bodies: list
    cuts: list
    gap: float
    guesses: np.ndarray

    @classmethod
    def read(cls, path):
        numbers = Numbers(path)
        body_count, cut_count = numbers.count(), numbers.count()
        bodies = [Body(numbers.count(), numbers.word(), numbers.word() == "1", *numbers.frame()) for _ in range(body_count)]
        cuts = []
        for _ in range(cut_count):
            kind, *where = numbers.word(), numbers.count(), numbers.count()
            cuts.append(Cut(kind, tuple(where), (numbers.frame(), numbers.frame())))
        gap = float(numbers.word())
        steps = numbers.count()
        width = sum(body.width for body in bodies)
        return cls(bodies, cuts, gap, numbers.numbers(steps * width).reshape(steps, width))

    def place(self, values):
        """Rotation and point of each body."""
        placed, at = [], 0
        for body in self.bodies:
            rotation, point = (np.eye(3), np.zeros(3)) if body.parent < 0 else placed[body.parent]
            rotation, point = rotation @ body.rotation, point + rotation @ body.point
            own = values[at : at + body.width]
            at += body.width
            if body.kind == "P":
                point = point + rotation[:, 2] * own[0]
            else:
                rotation = rotation @ (turn(own[0]) if body.kind == "R" else ball(own))
            placed.append((rotation, point))
        return placed

    def gaps(self, values):
        """How far each loop is from closed: a point, and for a hinge two directions."""
        placed = self.place(values)
        gaps = []
        for cut in self.cuts:
            sides = []
            for body, (own_rotation, own_point) in zip(cut.bodies, cut.frames):
                rotation, point = placed[body] if body >= 0 else (np.eye(3), np.zeros(3))
                sides.append((rotation @ own_rotation, point + rotation @ own_point))
            gaps.extend(sides[1][1] - sides[0][1])
            if cut.kind == "R":
                gaps.extend(sides[0][0][:, :2].T @ sides[1][0][:, 2])
        return np.array(gaps)


def turn(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def ball(quaternion):
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(rotation):
    """w, x, y, z of a rotation matrix."""
    import scipy.spatial.transform

    return scipy.spatial.transform.Rotation.from_matrix(rotation).as_quat(scalar_first=True)


def least_step(gap, platform, virtual_part, compliance):
    """The step of platform and virtual joints that closes the linearized gap, with the least virtual joints.

    The platform is free: what it cannot reach is left to the virtual joints.
    """
    q, r = np.linalg.qr(platform, mode="complete")
    rotated, virtual_part = q.T @ gap, q.T @ virtual_part
    open_part = virtual_part[6:]
    weighted = compliance[:, None] * open_part.T
    give = -weighted @ np.linalg.solve(open_part @ weighted, rotated[6:])
    return np.linalg.solve(r[:6], -(rotated[:6] + virtual_part[:6] @ give)), give


def serve(solve, stride=1, call=None, rows=None):
    """Answers for one worker.

    `solve()` does all of the work; of what it gives `rows` makes a list of answers, None where there is none, outside of what is timed.
    `call(k)` asks for one position by itself.
    """
    rows = rows or (lambda answers: answers)
    print("ready" if stride == 1 else f"ready {stride}", flush=True)
    answers = []
    for line in sys.stdin:
        what, rest = line.split()
        if what == "run":
            for _ in range(int(rest)):
                answers = solve()
            print("done", flush=True)
        elif what == "call" and call:
            for k in range(int(rest)):
                call(k)
            print("done", flush=True)
        elif what == "write":
            with open(rest, "w") as file:
                for answer in rows(answers):
                    row = [] if answer is None else answer
                    print(*(f"{number:.17g}" for number in row), file=file)
            print("done", flush=True)
        else:
            sys.exit(f"expected run N, call N or write FILE, not {line!r}")
