#!/usr/bin/env python3
"""Share of random cells that jointplay plans, of those in which a grid search over postures proves that a path exists.

    python3 bench/random_cells.py --help
    python3 bench/random_cells.py --command target/release/jointplay --cells 200

A random cell has three stations anywhere in reach, entered radially or along a line of any direction, a random retract distance, and
axis limits that are a random share of those of the robot file. A wafer visits all three stations.

The grid search knows nothing of jointplay but the robot file. It moves the wafer's centre in steps of 10 mm along the line of each
station; its states are the directions of the effector and, with four joints, of the third link on a grid, with the elbow to either
side. Two neighbouring states differ by at most two cells of the grid and 0.3 rad in each joint, and all joints stay 0.01 rad
within their limits. Between the stations every joint-space line is within the limits, because these are an interval for each axis:
a path through the cell exists where one along every line does. The search finds no paths through a stretched arm, or across the ends
of its range of revolutions: it proves that a path exists, never that none does.

Results: bench/results/random-cells.md.
"""

import argparse
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROBOTS = HERE.parent / "crates/jointplay-format/robots"
STEP_MM = 10.0
MARGIN = 0.01
LARGEST_STEP = 0.3
# Cosine of the elbow angle beyond which the two links count as stretched or folded.
STRETCHED = 0.9994
CASES = [
    ("dual-arm", "radial"), ("radial-arm", "radial"),
    ("scara-3r", "radial"), ("scara-3r", "line"), ("scara-4r", "radial"), ("scara-4r", "line"),
]


class Arm:
    """The first arm of a robot file, its joints in the order of the links."""

    def __init__(self, robot):
        arm = robot["arm"][0]
        self.joints = arm["joint"]
        assert arm.get("mount_mm", [0.0, 0.0])[:2] == [0.0, 0.0], "the first axis is that of the platform"
        center = arm["effector"][0]["wafer_center_mm"]
        self.center = np.array(center[:2])
        self.links = [np.array([joint.get("length_mm", 0.0), joint.get("offset_mm", 0.0)]) for joint in self.joints]
        self.effector = math.hypot(center[0], center[1])
        self.effector_direction = math.atan2(center[1], center[0])
        self.ranges = {axis["name"]: np.radians(axis["range_deg"]) for axis in robot["axis"] if "range_deg" in axis}
        self.lengths = [joint.get("length_mm", 0.0) for joint in self.joints]
        self.drives = [joint["drives"] for joint in self.joints]
        self.zeros = [math.radians(joint.get("zero_deg", 0.0)) for joint in self.joints]
        self.is_coupled = any(len(drives) > 1 or any(abs(ratio) != 1 for ratio in drives.values()) for drives in self.drives)

    def range_of(self, joint):
        (axis, _), = self.drives[joint].items()
        return self.ranges[axis]


def two_links(first, second, x, y):
    """Shoulder and elbow angles to points, with the elbow to both sides; NaN out of reach."""
    cosine = (x * x + y * y - first**2 - second**2) / (2 * first * second)
    with np.errstate(invalid="ignore"):
        bend = np.where(np.abs(cosine) <= STRETCHED, np.arccos(np.clip(cosine, -1, 1)), np.nan)
    for elbow in (bend, -bend):
        yield np.arctan2(y, x) - np.arctan2(second * np.sin(elbow), first + second * np.cos(elbow)), elbow


def wrapped(angle, lowest):
    """Angles in the revolution that starts at an angle."""
    return lowest + np.mod(angle - lowest, 2 * math.pi)


def postures(arm, point, direction, lowest):
    """Joint angles on the grid, with both elbows: first axis elbow, last axis joints; NaN where there are none.

    direction: of the effector, where the line prescribes it
    lowest: start of the revolution of the first joint
    """
    count = len(arm.joints)
    cells = 240 if count == 3 else 72
    grid = 2 * math.pi * np.arange(cells) / cells
    effector = np.array([direction]) if direction is not None else grid
    x = point[0] - arm.effector * np.cos(effector)
    y = point[1] - arm.effector * np.sin(effector)
    if count == 4:
        third = grid[None, :]
        x = x[:, None] - arm.lengths[2] * np.cos(third)
        y = y[:, None] - arm.lengths[2] * np.sin(third)
        effector = effector[:, None]
    found = []
    for shoulder, elbow in two_links(arm.lengths[0], arm.lengths[1], x, y):
        angles = [wrapped(shoulder, lowest), elbow]
        before = shoulder + elbow
        if count == 4:
            angles.append(wrapped(third - before, -math.pi))
            before = third
        angles.append(wrapped(effector - before - arm.effector_direction, -math.pi))
        joints = np.stack(np.broadcast_arrays(*angles), axis=-1)
        for joint in range(count):
            low, high = arm.range_of(joint)
            value = joints[..., joint]
            with np.errstate(invalid="ignore"):
                outside = ~((value >= low + MARGIN) & (value <= high - MARGIN))
            joints[outside] = np.nan
        found.append(joints)
    return np.stack(found)


def shifted(values, shift, axes):
    for axis, by in zip(axes, shift):
        values = np.roll(values, by, axis=axis)
    return values


def grid_path(arm, points, direction):
    """Whether the grid search finds a path of postures along points."""
    axes = [axis for axis, count in ((1, direction is None), (2, len(arm.joints) == 4)) if count]
    reach = 2 if len(arm.joints) == 3 else 1
    shifts = [[]]
    for _ in axes:
        shifts = [one + [by] for one in shifts for by in range(-reach, reach + 1)]
    low, high = arm.range_of(0)
    for lowest in {-math.pi, 0.0, -2 * math.pi, low}:
        reached = None
        for point in points:
            joints = postures(arm, point, direction, lowest)
            is_valid = ~np.isnan(joints[..., 0])
            if reached is not None:
                follows = np.zeros_like(is_valid)
                for shift in shifts:
                    old = shifted(before, shift, axes)
                    with np.errstate(invalid="ignore"):
                        near = (np.abs(joints - old) < LARGEST_STEP).all(axis=-1)
                    follows |= near & shifted(reached, shift, axes)
                is_valid &= follows
            reached, before = is_valid, joints
            if not reached.any():
                break
        if reached.any():
            return True
    return False


def coupled_path(arm, points):
    """Whether an arm whose motors move the wafer along one radius passes through points on a radius."""
    names = list(dict.fromkeys(name for drives in arm.drives for name in drives))
    turn, extension = arm.ranges[names[0]], arm.ranges[names[1]]

    def center(value):
        position, angle, link = np.zeros(2), 0.0, np.zeros(2)
        for drives, zero, own in zip(arm.drives, arm.zeros, [*arm.links[:-1], arm.center]):
            position = position + rotated(link, angle)
            angle += zero + drives.get(names[1], 0.0) * value
            link = own
        return position + rotated(link, angle)

    samples = [center(value) for value in np.linspace(extension[0] + MARGIN, extension[1] - MARGIN, 500)]
    far = max(samples, key=np.linalg.norm)
    radius = far / np.linalg.norm(far)
    along = [float(sample @ radius) for sample in samples]
    assert max(abs(sample[0] * radius[1] - sample[1] * radius[0]) for sample in samples) < 1e-6, "not radial"
    azimuth = math.atan2(points[-1][1], points[-1][0]) - math.atan2(radius[1], radius[0])
    wanted = [float(np.hypot(*point)) for point in points]
    for sign in (1, -1):
        # Every value between the least and the largest one is passed.
        passes = min(along) <= min(sign * one for one in wanted) and max(sign * one for one in wanted) <= max(along)
        turns = azimuth + (0.0 if sign == 1 else math.pi) + 2 * math.pi * np.arange(-2, 3)
        if passes and ((turns > turn[0] + MARGIN) & (turns < turn[1] - MARGIN)).any():
            return True
    return False


def rotated(vector, angle):
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([cosine * vector[0] - sine * vector[1], sine * vector[0] + cosine * vector[1]])


def random_cell(random, robot_name, approach):
    """Texts of a robot and a cell, and the lines of its stations in the plane of the arm (mm)."""
    text = (ROBOTS / f"{robot_name}.toml").read_text()
    robot = tomllib.loads(text)
    names = [axis["name"] for axis in robot["axis"]]

    def narrowed(name, share, text):
        pattern = rf'(name = "{name}"\nkind = "turn"\nrange_deg = )\[([-0-9.]+), ([-0-9.]+)\]\nhome_deg = ([-0-9.]+)'
        def replaced(found):
            low, high = share * float(found[2]), share * float(found[3])
            home = min(max(float(found[4]), low), high)
            return f"{found[1]}[{low}, {high}]\nhome_deg = {home}"
        return re.sub(pattern, replaced, text)

    if approach == "line" or robot_name.startswith("scara"):
        text = narrowed(names[0], random.uniform(0.6, 1.0), text)
        for name in names[1:-1]:
            text = narrowed(name, random.uniform(0.5, 1.0), text)
    arm = Arm(tomllib.loads(text))
    reach = sum(arm.lengths) + arm.effector
    retract = random.uniform(10.0, 450.0)
    stations, lines = [], []
    for index in range(3):
        while True:
            azimuth = random.uniform(-math.pi, math.pi)
            distance = random.uniform(350.0, 0.99 * reach)
            oblique = random.uniform(-0.6, 0.6) if approach == "line" else 0.0
            point = distance * np.array([math.cos(azimuth), math.sin(azimuth)])
            direction = azimuth + oblique
            along = np.array([math.cos(direction), math.sin(direction)])
            # Nearest point on the line at the retract distance.
            forward = float(point @ along)
            across = abs(float(point[0] * along[1] - point[1] * along[0]))
            if across >= retract - 1.0 and approach == "line":
                retract = min(450.0, across + random.uniform(5.0, 100.0))
                if across >= retract - 1.0:
                    continue
            # In front of the first axis; radially, on the same side of it as the slot.
            length = forward - math.sqrt(max(retract**2 - across**2, 0.0))
            if length > 50.0:
                break
        stations.append((point, direction, retract))
        steps = max(2, math.ceil(length / STEP_MM) + 1)
        lines.append(([point - along * (length * (1 - k / (steps - 1))) for k in range(steps)], direction))
    cell = ['kind = "cell"', 'name = "random"', 'robot = "robot.toml"', "[wafer]", "diameter_mm = 300.0", "thickness_mm = 0.775",
            'material = "silicon"', "[budgets]", "virtual_joint_norm_um = 60.0", "min_distance_mm = 1.0", "slot_min_distance_mm = 1.0",
            "plane_urad = 20.0"]
    for index, (point, direction, retract) in enumerate(stations):
        cell += ["[[station]]", f'name = "S{index}"', f"position_mm = [{point[0]}, {point[1]}, 520.0]",
                 f"heading_deg = {math.degrees(direction) - 90.0}", "stroke = { below_mm = 4.0, above_mm = 3.0, speed_mm_s = 20.0 }",
                 f"retract_mm = {retract}", f'approach = "{approach}"']
        if index == 0:
            cell.append('wafers = "all"')
    return text, "\n".join(cell) + "\n", arm, lines


PROGRAM = "HOME\nTRANSFER S0 TO S1 WITH A\nTRANSFER S1 TO S2 WITH A\nTRANSFER S2 TO S0 WITH A\nHOME\n"


def is_possible(arm, lines, approach):
    for points, direction in lines:
        if arm.is_coupled:
            if not coupled_path(arm, points):
                return False
        elif not grid_path(arm, points, direction if approach == "line" else None):
            return False
    return True


def refusal(command, folder, robot, cell):
    """First error of jointplay; none where it plans the program."""
    (folder / "robot.toml").write_text(robot)
    (folder / "cell.toml").write_text(cell)
    (folder / "cell.program").write_text(PROGRAM)
    files = [folder / "cell.toml", folder / "cell.program"]
    done = subprocess.run([command, "cell", "check", *files, "--format", "json"], capture_output=True, text=True)
    if done.returncode in (0, 1) and done.stdout:
        outside = [one["message"] for one in json.loads(done.stdout)["violations"] if one["kind"] == "position limit"]
        return outside[0] if outside else None
    # A message that is no refusal of the program would be a mistake of this file.
    return (done.stdout + done.stderr).strip() or f"exit code {done.returncode}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", default="jointplay", help="the jointplay command [default: jointplay]")
    parser.add_argument("--cells", type=int, default=100, help="possible cells of each kind [default: 100]")
    parser.add_argument("--seed", type=int, default=1, help="seed of the random numbers [default: 1]")
    parser.add_argument("--only", help="a robot, and nothing else")
    parser.add_argument("--save", type=pathlib.Path, help="folder for the cells that are refused")
    parser.add_argument("--write", action="store_true", help="write bench/results/random-cells.md")
    arguments = parser.parse_args()
    text = "| robot | approach | cells | possible by the grid search | planned | share |\n| --- | --- | ---: | ---: | ---: | ---: |\n"
    totals = [0, 0]
    for number, (robot_name, approach) in enumerate(CASES):
        if arguments.only not in (None, robot_name):
            continue
        random = np.random.default_rng([arguments.seed, number])
        drawn = possible = planned = 0
        with tempfile.TemporaryDirectory() as folder:
            while possible < arguments.cells and drawn < 40 * arguments.cells:
                drawn += 1
                robot, cell, arm, lines = random_cell(random, robot_name, approach)
                if not is_possible(arm, lines, approach):
                    continue
                possible += 1
                reason = refusal(arguments.command, pathlib.Path(folder), robot, cell)
                if reason is None:
                    planned += 1
                    continue
                print(f"{robot_name} {approach} {drawn}: {reason}", file=sys.stderr, flush=True)
                if arguments.save:
                    target = arguments.save / f"{robot_name}-{approach}-{drawn}"
                    target.mkdir(parents=True, exist_ok=True)
                    (target / "robot.toml").write_text(robot)
                    (target / "cell.toml").write_text(cell)
                    (target / "cell.program").write_text(PROGRAM)
        totals[0] += possible
        totals[1] += planned
        row = f"| {robot_name} | {approach} | {drawn} | {possible} | {planned} | {100 * planned / max(possible, 1):.1f} % |\n"
        text += row
        print(row, end="", flush=True)
    text += f"| all | | | {totals[0]} | {totals[1]} | {100 * totals[1] / max(totals[0], 1):.1f} % |\n"
    if arguments.write:
        (HERE / "results" / "random-cells.md").write_text(text)
    else:
        print(text)


if __name__ == "__main__":
    main()
