#!/usr/bin/env python3
"""Durations of straight lines compared with optima that other programs find for the same paths.

    python3 bench/trajectories.py --help
    python3 bench/trajectories.py --command target/release/jointplay

For each reference line of bench/lines/, `jointplay cell export` writes the positions of all axes as CSV.
The path is a quintic spline through these positions over their own arc length; the times of jointplay are used for nothing
but the comparison. For each path two optima are computed:

- TOPP-RA (toppra on PyPI): velocity and acceleration limits alone;
- direct transcription in time: 120 intervals with constant jerk of the path parameter, velocity, acceleration and jerk limits
  at both ends and in the middle of each, solved by IPOPT (casadi on PyPI).

The comparison with TOPP-RA uses a second motion, planned with jerk limits a hundred times as high.
Results: bench/results/trajectories.md and trajectories.json, from which the table of the documentation and the values of the test
crates/jointplay-format/tests/line_times.rs are copied.
"""

import argparse
import csv
import datetime
import importlib.metadata
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
LINES = HERE / "lines"
INTERVALS = 120
JERK_FACTOR = 100.0


def path_of(positions):
    """A quintic spline, from 0 to 1, through positions of all axes in the order of a motion."""
    import numpy as np
    from scipy.interpolate import make_interp_spline

    span = np.ptp(positions, axis=0).max()
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1) / span
    length = np.concatenate([[0.0], np.cumsum(steps)])
    length /= length[-1]
    # Samples are dense near rest: points at nearly equal distances condition the spline better.
    points = 40
    wanted = np.searchsorted(length, np.arange(1, points) / points)
    keep = np.unique(np.concatenate([[0], wanted, [len(length) - 1]]))
    return make_interp_spline(length[keep], positions[keep], k=5)


def by_toppra(path, limits):
    """Least duration under velocity and acceleration limits (s)."""
    import numpy as np
    import toppra
    from toppra import algorithm, constraint

    toppra.setup_logging("ERROR")
    knots = np.linspace(0, 1, 401)
    spline = toppra.SplineInterpolator(knots, path(knots))
    bounds = [np.stack([-limits[:, order], limits[:, order]], axis=1) for order in (0, 1)]
    constraints = [
        constraint.JointVelocityConstraint(bounds[0]),
        constraint.JointAccelerationConstraint(bounds[1]),
    ]
    grid = np.linspace(0, 1, 2001)
    instance = algorithm.TOPPRA(constraints, spline, gridpoints=grid, parametrizer="ParametrizeConstAccel")
    return instance.compute_trajectory(0, 0).duration


def by_transcription(path, limits, guess):
    """Least duration under velocity, acceleration and jerk limits (s).

    Normalized time from 0 to 1; s, v, a and j are the path parameter and its derivatives by it, T is the duration:
    |q' v| ≤ V T, |q'' v² + q' a| ≤ A T², |q''' v³ + 3 q'' v a + q' j| ≤ J T³.
    """
    import casadi as ca
    import numpy as np

    axes, n, h = limits.shape[0], INTERVALS, 1.0 / INTERVALS

    def derivative(order):
        spline = path.derivative(order)
        coefficients = spline.c[: len(spline.t) - spline.k - 1].ravel()
        s = ca.MX.sym("s")
        value = ca.bspline(s, ca.DM(coefficients), [list(spline.t)], [spline.k], axes, {})
        return ca.Function(f"q{order}", [s], [value]).map(n)

    derivatives = [derivative(order) for order in (1, 2, 3)]
    duration = ca.MX.sym("T")
    s, v, a = (ca.MX.sym(name, n + 1) for name in "sva")
    j = ca.MX.sym("j", n)
    conditions, lower, upper = [], [], []

    def add(expression, low, high):
        conditions.append(expression)
        lower.append(np.full(expression.shape[0], low))
        upper.append(np.full(expression.shape[0], high))

    def advanced(t):
        return (
            s[:-1] + t * v[:-1] + t**2 / 2 * a[:-1] + t**3 / 6 * j,
            v[:-1] + t * a[:-1] + t**2 / 2 * j,
            a[:-1] + t * j,
        )

    for end, state in zip(advanced(h), (s, v, a)):
        add(state[1:] - end, 0.0, 0.0)
    for share in (0.0, 0.5, 1.0):
        position, rate, acceleration = advanced(share * h)
        q1, q2, q3 = (of(position.T) for of in derivatives)
        rate, acceleration, jerk = (ca.repmat(one.T, axes, 1) for one in (rate, acceleration, j))
        values = (
            q1 * rate,
            q2 * rate**2 + q1 * acceleration,
            q3 * rate**3 + 3 * q2 * rate * acceleration + q1 * jerk,
        )
        for order, value in enumerate(values):
            share_of_limit = ca.vec(value * ca.repmat(ca.DM(1 / limits[:, order]), 1, n))
            add(share_of_limit - duration ** (order + 1), -np.inf, 0.0)
            add(share_of_limit + duration ** (order + 1), 0.0, np.inf)
    t = np.linspace(0, 1, n + 1)
    middle = (t[1:] + t[:-1]) / 2
    start = np.concatenate([
        [1.5 * guess],
        35 * t**4 - 84 * t**5 + 70 * t**6 - 20 * t**7,
        140 * t**3 - 420 * t**4 + 420 * t**5 - 140 * t**6,
        420 * t**2 - 1680 * t**3 + 2100 * t**4 - 840 * t**5,
        840 * middle - 5040 * middle**2 + 8400 * middle**3 - 4200 * middle**4,
    ])
    low = np.concatenate([[1e-3], np.zeros(2 * n + 2), np.full(2 * n + 1, -np.inf)])
    high = np.concatenate([[100.0], np.ones(n + 1), np.full(3 * n + 2, np.inf)])
    for first, ends in ((1, (0.0, 1.0)), (n + 2, (0.0, 0.0)), (2 * n + 3, (0.0, 0.0))):
        for index, value in zip((first, first + n), ends):
            low[index] = high[index] = value
    options = {"print_time": 0, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.max_iter": 1000,
               "ipopt.tol": 1e-6, "ipopt.mu_strategy": "adaptive"}
    problem = {"x": ca.vertcat(duration, s, v, a, j), "f": duration, "g": ca.vertcat(*conditions)}
    solver = ca.nlpsol("solver", "ipopt", problem, options)
    found = solver(x0=start, lbx=low, ubx=high, lbg=np.concatenate(lower), ubg=np.concatenate(upper))
    if not solver.stats()["success"]:
        raise RuntimeError(f"IPOPT: {solver.stats()['return_status']}")
    return float(found["f"])


class Robot:
    """Names and limits of the axes of a robot file."""

    def __init__(self, file):
        robot = tomllib.loads(file.read_text())
        self.names, self.limits, self.drives = ["q1", "q2", "q3"], {}, {}
        self.arms = {}
        for name in self.names:
            self.limits[name] = [robot["rods"][load] for load in ("empty", "loaded")]
        for axis in robot["axis"]:
            self.names.append(axis["name"])
            self.limits[axis["name"]] = [axis["empty"], axis["loaded"]]
        for arm in robot["arm"]:
            axes = {axis for joint in arm["joint"] for axis, ratio in joint.get("drives", {}).items() if ratio}
            for effector in arm["effector"]:
                self.arms[effector["name"]] = axes

    def limits_of(self, loaded_effector):
        """Velocity, acceleration and jerk limits of all axes, in the units of files."""
        rows = []
        for name in self.names:
            is_loaded = loaded_effector and (name in ("q1", "q2", "q3") or name in self.arms[loaded_effector])
            limits = self.limits[name][1 if is_loaded else 0]
            rows.append([next(value for key, value in limits.items() if key.startswith(kind))
                         for kind in ("velocity", "acceleration", "jerk")])
        return rows


VARIANTS = [
    ("dual-arm", "cantilever"),
    ("dual-arm", "rigid"),
    ("radial-arm", "cantilever"),
    ("scara-3r", "cantilever"),
    ("scara-4r", "cantilever"),
]


def robot_text(robot, droop, jerk_factor):
    """Robot file of the catalogue, with other droop and jerk limits, and friction that never slows a line."""
    text = (HERE.parent / "robots" / f"{robot}.toml").read_text()
    if droop == "rigid":
        text = re.sub(r"droop = \{[^\n]*\}", 'droop = { kind = "rigid" }', text)
    text = re.sub(r"friction = [0-9.]+", "friction = 10.0", text)
    return re.sub(r"(jerk_\w+ = )([0-9.]+)", lambda found: f"{found[1]}{float(found[2]) * jerk_factor}", text)


def lines_of(command, robot, droop, jerk_factor, work):
    """Straight lines of the program: phase, duration, limits of the moving axes, and positions of these axes."""
    import numpy as np

    folder = work / f"{robot}-{droop}-{jerk_factor}"
    folder.mkdir()
    for name in ("lines.toml", "lines.program"):
        (folder / name).write_text((LINES / name).read_text())
    (folder / "robot.toml").write_text(robot_text(robot, droop, jerk_factor))
    described = Robot(folder / "robot.toml")
    files = [folder / "lines.toml", folder / "lines.program"]
    checked = subprocess.run([command, "cell", "check", *files, "--format", "json"], capture_output=True, text=True)
    if not checked.stdout:
        sys.exit(checked.stderr)
    out = folder / "export"
    subprocess.run([command, "cell", "export", *files, "--to", "csv", "--rate", "4000", "--despite-errors", "--out", out],
                   check=True, capture_output=True)
    with open(out / "lines.csv") as file:
        rows = csv.reader(file)
        header = next(rows)
        columns = [next(k for k, name in enumerate(header) if re.fullmatch(f"{axis}_(mm|deg)", name))
                   for axis in described.names]
        samples = np.array([[float(row[k]) for k in (0, *columns)] for row in rows])
    found = []
    for instruction in json.loads(checked.stdout)["instructions"]:
        verb = instruction["text"].split()[0]
        for segment in instruction["segments"]:
            if segment["path"] != "line" or segment["phase"] not in ("extend", "retract"):
                continue
            start, end = segment["start_s"], segment["start_s"] + segment["duration_s"]
            inside = (samples[:, 0] > start - 1e-9) & (samples[:, 0] < end + 1e-9)
            positions = samples[inside, 1:]
            is_loaded = (verb == "GET") == (segment["phase"] == "retract")
            limits = np.array(described.limits_of("A" if is_loaded else None))
            moving = np.ptp(positions, axis=0) > 1e-6
            found.append({
                "robot": robot, "droop": droop,
                "line": f"{verb} {segment['phase']}",
                "duration_s": segment["duration_s"], "limited_by": segment["limited_by"],
                "positions": positions[:, moving], "limits": limits[moving],
            })
    return found


def compare(command, work):
    """Rows of the table."""
    rows = []
    for robot, droop in VARIANTS:
        limited = lines_of(command, robot, droop, 1.0, work)
        free = lines_of(command, robot, droop, JERK_FACTOR, work)
        for one, other in zip(limited, free):
            path = path_of(one["positions"])
            optimum = by_transcription(path, one["limits"], one["duration_s"])
            without_jerk = by_toppra(path_of(other["positions"]), other["limits"])
            row = {key: one[key] for key in ("robot", "droop", "line", "duration_s", "limited_by")}
            row |= {"transcription_s": optimum, "without_jerk_s": other["duration_s"], "toppra_s": without_jerk}
            rows.append(row)
            print(f"{robot:10} {droop:10} {row['line']:12} {row['duration_s']:.4f} {optimum:.4f} "
                  f"{100 * (row['duration_s'] / optimum - 1):+.2f} %   {other['duration_s']:.4f} {without_jerk:.4f} "
                  f"{100 * (other['duration_s'] / without_jerk - 1):+.2f} %", flush=True)
    return rows


def table(rows):
    """The rows as Markdown."""
    head = ["robot", "droop", "line", "jointplay (s)", "transcription (s)", "excess", "jerk × 100: jointplay (s)", "TOPP-RA (s)", "excess"]
    text = ["| " + " | ".join(head) + " |", "| --- | --- | --- |" + " ---: |" * 6]
    for row in rows:
        excess = [f"{100 * (row[a] / row[b] - 1):.1f} %" for a, b in (("duration_s", "transcription_s"), ("without_jerk_s", "toppra_s"))]
        cells = [row["robot"], row["droop"], row["line"], f"{row['duration_s']:.4f}", f"{row['transcription_s']:.4f}", excess[0],
                 f"{row['without_jerk_s']:.4f}", f"{row['toppra_s']:.4f}", excess[1]]
        text.append("| " + " | ".join(cells) + " |")
    return "\n".join(text) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", default="jointplay", help="the jointplay command [default: jointplay]")
    parser.add_argument("--write", action="store_true", help="write bench/results/trajectories.md and .json")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        rows = compare(arguments.command, pathlib.Path(work))
    if arguments.write:
        versions = {name: importlib.metadata.version(name) for name in ("numpy", "scipy", "toppra", "casadi")}
        document = {"date": datetime.date.today().isoformat(), "versions": versions, "intervals": INTERVALS, "lines": rows}
        (HERE / "results" / "trajectories.json").write_text(json.dumps(document, indent=1) + "\n")
        (HERE / "results" / "trajectories.md").write_text(table(rows))
    else:
        print(table(rows))


if __name__ == "__main__":
    main()
