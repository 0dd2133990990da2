"""Reader of the workload files of the bench, and the protocol of a Python worker.

A worker prints `ready`, then reads commands: `run N` computes the whole work N times, `write FILE` writes the answers, and with some workers `call N` performs N single calls.
"""

import sys
from dataclasses import dataclass

import numpy as np

ITERATIONS = 50


class Numbers:
    """Reader of the words of a file in sequence."""

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
        """Reads a rotation matrix and a point."""
        return self.numbers(9).reshape(3, 3), self.numbers(3)


@dataclass
class Gpr:
    """Workload of the three-rod robot: its dimensions, and the rods of each pose."""

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
        """Ball centres, one row for each."""
        return np.column_stack([self.base, rods])

    @property
    def compliance(self):
        """Compliance of the rotation and the slide of each limb in the metric of the least displacement."""
        return np.tile([1 / self.metric**2, 1.0], 3)


@dataclass
class Body:
    """Body with the joint to its parent (−1: the base): a rotation `R` about z, a slide `P` along z, or a ball joint `S`."""

    parent: int
    kind: str
    driven: bool
    rotation: np.ndarray
    point: np.ndarray

    @property
    def width(self):
        """Number of coordinates of the joint; those of a ball joint are a quaternion, w first."""
        return 4 if self.kind == "S" else 1


@dataclass
class Cut:
    """Joint that closes a loop, a hinge `R` or a ball joint `S`: two bodies, and the frame of the joint on each."""

    kind: str
    bodies: tuple
    frames: tuple

    @property
    def rows(self):
        return 5 if self.kind == "R" else 3


@dataclass
class Linkage:
    """Workload of a mechanism: its bodies and cuts, and the initial guess of each position."""

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
        """Closure residuals of the loops: of a point, and for a hinge of two directions."""
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
    """Quaternion w, x, y, z of a rotation matrix."""
    import scipy.spatial.transform

    return scipy.spatial.transform.Rotation.from_matrix(rotation).as_quat(scalar_first=True)


def least_step(gap, platform, virtual_part, compliance):
    """Step of platform and virtual joints that closes the linearized gap, with a minimum-norm step of the virtual joints.

    The free platform closes as much of the gap as possible; the virtual joints close the rest.
    """
    q, r = np.linalg.qr(platform, mode="complete")
    rotated, virtual_part = q.T @ gap, q.T @ virtual_part
    open_part = virtual_part[6:]
    weighted = compliance[:, None] * open_part.T
    give = -weighted @ np.linalg.solve(open_part @ weighted, rotated[6:])
    return np.linalg.solve(r[:6], -(rotated[:6] + virtual_part[:6] @ give)), give


def serve(solve, stride=1, call=None, rows=None):
    """Runs the protocol of one worker.

    `solve()` computes the whole work; `rows` converts its result to a list of answers, None without a solution, and is not timed.
    `call(k)` computes one position by a single call.
    """
    rows = rows or (lambda answers: answers)
    print("ready" if stride == 1 else f"ready {stride}", flush=True)
    answers = []
    for line in sys.stdin:
        command, argument = line.split()
        if command == "run":
            for _ in range(int(argument)):
                answers = solve()
            print("done", flush=True)
        elif command == "call" and call:
            for k in range(int(argument)):
                call(k)
            print("done", flush=True)
        elif command == "write":
            with open(argument, "w") as file:
                for answer in rows(answers):
                    row = [] if answer is None else answer
                    print(*(f"{number:.17g}" for number in row), file=file)
            print("done", flush=True)
        else:
            sys.exit(f"expected run N, call N or write FILE, got {line!r}")
