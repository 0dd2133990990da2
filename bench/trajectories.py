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

The comparison with TOPP-RA uses a second motion, planned with jerk limits a hundred times as high. A third motion carries wafers
on little friction between level stations; the transcription then bounds the acceleration of the wafer's centre too. The loaded turn
between both stations, with the arm partly extended, is compared in the same manner, on the path of jointplay.
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
FRICTION = 0.12
# Distance of the wafer from the first axis in the compared turns (mm).
TURN_RADIUS = 400.0
# Durations from which IPOPT starts, one after the other until it finds an optimum, by that of jointplay.
START_FACTORS = (1.5, 1.1, 2.5, 4.0)
GRAVITY = 9.80665
WAFER_RADIUS = 0.15
PAD_RADIUS = 0.12


def path_of(positions, values=None):
    """A quintic spline, from 0 to 1, through positions of all axes in the order of a motion, or through other values there."""
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
    return make_interp_spline(length[keep], (positions if values is None else values)[keep], k=5)


def by_toppra(path, limits):
    """Least duration under velocity and acceleration limits (s); None where TOPP-RA finds none.

    On the finest grid, round-off of an axis that moves by micrometres can leave its solver without a solution: a coarser one follows.
    """
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
    for intervals in (2000, 1000, 400):
        grid = np.linspace(0, 1, intervals + 1)
        instance = algorithm.TOPPRA(constraints, spline, gridpoints=grid, parametrizer="ParametrizeConstAccel")
        found = instance.compute_trajectory(0, 0)
        if found:
            return found.duration
    return None


def by_transcription(path, limits, guess, center=None):
    """Least duration under velocity, acceleration and jerk limits (s), and with the friction of a level wafer; None where none is found.

    center: the wafer's centre (m) and its heading (rad) over the path parameter. For the force f = c̈ + g e_z per mass, and the
    moment that turns a disc about its centre, M = R² / 2 · heading'', |f_t| + |M| / b ≤ µ f_n with the radius b of the pads.

    Normalized time from 0 to 1; s, v, a and j are the path parameter and its derivatives by it, T is the duration:
    |q' v| ≤ V T, |q'' v² + q' a| ≤ A T², |q''' v³ + 3 q'' v a + q' j| ≤ J T³.
    """
    import casadi as ca
    import numpy as np

    axes, n, h = limits.shape[0], INTERVALS, 1.0 / INTERVALS

    def derivative(of, order):
        spline = of.derivative(order)
        coefficients = spline.c[: len(spline.t) - spline.k - 1].ravel()
        s = ca.MX.sym("s")
        value = ca.bspline(s, ca.DM(coefficients), [list(spline.t)], [spline.k], spline.c.shape[1], {})
        return ca.Function(f"q{order}", [s], [value]).map(n)

    derivatives = [derivative(path, order) for order in (1, 2, 3)]
    turns = center is not None and np.ptp(center(np.linspace(0, 1, 50))[:, 3]) > 1e-6
    of_center = [derivative(center, order) for order in (1, 2)] if center else []
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
        if center:
            c1, c2 = (of(position.T) for of in of_center)
            four = [ca.repmat(one.T, 4, 1) for one in (rate, acceleration)]
            x, y, z, turn = ca.vertsplit(c2 * four[0] ** 2 + c1 * four[1])
            available = FRICTION * (z + GRAVITY * duration**2)
            for sign in (-1.0, 1.0) if turns else (0.0,):
                moment = sign * WAFER_RADIUS**2 / 2 * turn / PAD_RADIUS
                add((available - moment).T, 0.0, np.inf)
                add((x**2 + y**2 - (available - moment) ** 2).T, -np.inf, 0.0)
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
    shape = np.concatenate([
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
    options = {"print_time": 0, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.max_iter": 300,
               "ipopt.tol": 1e-6, "ipopt.mu_strategy": "adaptive"}
    problem = {"x": ca.vertcat(duration, s, v, a, j), "f": duration, "g": ca.vertcat(*conditions)}
    solver = ca.nlpsol("solver", "ipopt", problem, options)
    for factor in START_FACTORS:
        start = np.concatenate([[factor * guess], shape])
        found = solver(x0=start, lbx=low, ubx=high, lbg=np.concatenate(lower), ubg=np.concatenate(upper))
        if not solver.stats()["success"]:
            why = solver.stats()["return_status"]
        elif found["f"] > 1.01 * guess:
            # Slower than a motion that is known.
            why = "a local one"
        else:
            return float(found["f"])
    print(f"no optimum found by IPOPT: {why}", file=sys.stderr)
    return None


class Robot:
    """Names and limits of the axes of a robot file."""

    def __init__(self, file):
        robot = tomllib.loads(file.read_text())
        self.names, self.limits, self.drives = ["q1", "q2", "q3"], {}, {}
        self.arms, self.heading = {}, {}
        for name in self.names:
            self.limits[name] = [robot["rods"][load] for load in ("empty", "loaded")]
        for axis in robot["axis"]:
            self.names.append(axis["name"])
            self.limits[axis["name"]] = [axis["empty"], axis["loaded"]]
        for arm in robot["arm"]:
            axes = {axis for joint in arm["joint"] for axis, ratio in joint.get("drives", {}).items() if ratio}
            for effector in arm["effector"]:
                self.arms[effector["name"]] = axes
                self.heading[effector["name"]] = [
                    sum(joint["drives"].get(axis, 0.0) for joint in arm["joint"] if joint["kind"] == "turn") for axis in self.names]

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


def robot_text(robot, droop, jerk_factor, friction):
    """Robot file of the catalogue, with other droop, jerk limits and friction."""
    text = (HERE.parent / "crates/jointplay-format/robots" / f"{robot}.toml").read_text()
    if droop == "rigid":
        text = re.sub(r"droop = \{[^\n]*\}", 'droop = { kind = "rigid" }', text)
    text = re.sub(r"friction = [0-9.]+", f"friction = {friction}", text)
    return re.sub(r"(jerk_\w+ = )([0-9.]+)", lambda found: f"{found[1]}{float(found[2]) * jerk_factor}", text)


def lines_of(command, robot, droop, work, jerk_factor=1.0, friction=None, turn_radius=None):
    """Straight lines of the program: phase, duration, limits of the moving axes, positions of these axes, and centres of wafers.

    friction: of a wafer carried between level stations; without it no friction slows a line.
    turn_radius: retract distance (mm) at which the robot turns; with it, the loaded turn is returned in place of the lines.
    """
    import numpy as np

    folder = work / f"{robot}-{droop}-{jerk_factor}-{friction}-{turn_radius}"
    folder.mkdir()
    cell = (LINES / "lines.toml").read_text()
    if turn_radius:
        cell = re.sub("retract_mm = .*", f"retract_mm = {turn_radius}", cell)
    (folder / "lines.toml").write_text(re.sub(r"tilt = .*", "", cell) if friction else cell)
    (folder / "lines.program").write_text((LINES / "lines.program").read_text())
    (folder / "robot.toml").write_text(robot_text(robot, droop, jerk_factor, friction or 10.0))
    described = Robot(folder / "robot.toml")
    files = [folder / "lines.toml", folder / "lines.program"]
    checked = subprocess.run([command, "cell", "check", *files, "--format", "json"], capture_output=True, text=True)
    if not checked.stdout:
        sys.exit(checked.stderr)
    out = folder / "export"
    subprocess.run([command, "cell", "export", *files, "--to", "csv", "--rate", "4000", "--despite-errors", "--out", out],
                   check=True, stdout=subprocess.DEVNULL)
    with open(next(out.glob("*.csv"))) as file:
        rows = csv.reader(file)
        header = next(rows)
        columns = [next(k for k, name in enumerate(header) if re.fullmatch(f"{axis}_(mm|deg)", name))
                   for axis in described.names]
        columns += [header.index(f"A_{axis}_mm") for axis in "xyz"]
        samples = np.array([[float(row[k]) for k in (0, *columns)] for row in rows])
    found = []
    for instruction in json.loads(checked.stdout)["instructions"]:
        verb = instruction["text"].split()[0]
        for segment in instruction["segments"]:
            is_turn = segment["path"] == "joint" and segment["phase"] == "turn" and verb == "PUT"
            is_line = segment["path"] == "line" and segment["phase"] in ("extend", "retract")
            if not (is_turn if turn_radius else is_line):
                continue
            start, end = segment["start_s"], segment["start_s"] + segment["duration_s"]
            inside = (samples[:, 0] > start - 1e-9) & (samples[:, 0] < end + 1e-9)
            positions = samples[inside, 1:-3]
            heading = np.radians(positions @ described.heading["A"])
            centers = np.column_stack([samples[inside, -3:] / 1e3, heading])
            is_loaded = is_turn or (verb == "GET") == (segment["phase"] == "retract")
            limits = np.array(described.limits_of("A" if is_loaded else None))
            moving = np.ptp(positions, axis=0) > 1e-6
            found.append({
                "robot": robot, "droop": droop,
                "line": f"{verb} {segment['phase']}",
                "duration_s": segment["duration_s"], "limited_by": segment["limited_by"],
                "positions": positions[:, moving], "limits": limits[moving],
                "centers": centers, "is_loaded": is_loaded,
            })
    return found


def compare(command, work):
    """Rows of the table."""
    rows = []
    for robot, droop in VARIANTS:
        limited = lines_of(command, robot, droop, work)
        free = lines_of(command, robot, droop, work, jerk_factor=JERK_FACTOR)
        slippery = lines_of(command, robot, droop, work, friction=FRICTION)
        for one, other, third in zip(limited, free, slippery):
            path = path_of(one["positions"])
            optimum = by_transcription(path, one["limits"], one["duration_s"])
            without_jerk = by_toppra(path_of(other["positions"]), other["limits"])
            row = {key: one[key] for key in ("robot", "droop", "line", "duration_s", "limited_by")}
            row |= {"transcription_s": optimum, "without_jerk_s": other["duration_s"], "toppra_s": without_jerk}
            if third["is_loaded"]:
                path, center = (path_of(third["positions"], values) for values in (None, third["centers"]))
                row |= {"slippery_s": third["duration_s"],
                        "slippery_transcription_s": by_transcription(path, third["limits"], third["duration_s"], center)}
            rows.append(row)
            print(f"{robot:10} {droop:10} {row['line']:12} " + "   ".join(comparisons(row)), flush=True)
        for turn in lines_of(command, robot, droop, work, friction=FRICTION, turn_radius=TURN_RADIUS):
            path, center = (path_of(turn["positions"], values) for values in (None, turn["centers"]))
            row = {key: turn[key] for key in ("robot", "droop", "line", "limited_by")}
            row |= {"slippery_s": turn["duration_s"],
                    "slippery_transcription_s": by_transcription(path, turn["limits"], turn["duration_s"], center)}
            rows.append(row)
            print(f"{robot:10} {droop:10} {row['line']:12} " + "   ".join(comparisons(row)), flush=True)
    return rows


PAIRS = [("duration_s", "transcription_s"), ("without_jerk_s", "toppra_s"), ("slippery_s", "slippery_transcription_s")]


def comparisons(row):
    """Durations by jointplay and by the other program with the excess, for each kind of limits; empty where a line was not compared."""
    cells = []
    for own, other in PAIRS:
        if row.get(other):
            cells += [f"{row[own]:.4f}", f"{row[other]:.4f}", f"{100 * (row[own] / row[other] - 1):.1f} %"]
        else:
            cells += ["", "", ""]
    return cells


def table(rows):
    """The rows as Markdown."""
    head = ["robot", "droop", "line", "jointplay (s)", "transcription (s)", "excess", "jerk × 100: jointplay (s)", "TOPP-RA (s)", "excess",
            f"friction {FRICTION}: jointplay (s)", "transcription (s)", "excess"]
    text = ["| " + " | ".join(head) + " |", "| --- | --- | --- |" + " ---: |" * 9]
    for row in rows:
        cells = [row["robot"], row["droop"], row["line"], *comparisons(row)]
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
