"""Compare the collision check with another library, over random cells with deflecting arms and tilted platforms.

Each cell has a robot of its own, with one arm or two, links of random lengths, a droop by cantilever or by table, and
random boxes, cylinders and capsules on its links and around them.
`jointplay cell check` gives the minimum distance of every pair and its time; `jointplay cell export` gives the same
motion as glTF.
From the nodes of the glTF alone, coal (https://github.com/coal-library/coal) computes the distance of each such pair at
its time, which must be the same, and at even times, at which no pair may be nearer than the check reports.

Run by `exported.py` in its environment: `python distances.py COMMAND [CELLS [FIRST]]`.
"""

from __future__ import annotations

import json
import math
import random
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import coal
import numpy as np

CELLS = 200
# Keys a second: those of the check. Between keys, cubics round off the kinks of tables of droop, by some micrometres.
RATE = 1000
# glTF has single precision, of 0.1 µm at a metre.
SAME = 2.5e-6
# Times of a motion at which all pairs are looked at.
TIMES = 24
WAFER = 0.3, 0.000775

LIMITS = "empty = {{ velocity_{0}_s = {1}, acceleration_{0}_s2 = {2}, jerk_{0}_s3 = {3} }}\n"
LOADED = LIMITS.replace("empty", "loaded")


def limits(unit: str, speed: float) -> str:
    values = unit, speed, 5 * speed, 50 * speed
    return LIMITS.format(*values) + LOADED.format(*values)


def robot(draw: random.Random, arms: int) -> str:
    """The text of a robot file."""
    text = 'kind = "hybrid"\nname = "random"\ngpr = "gpr"\n[rods]\nhome_mm = 500.0\n' + limits("mm", 300.0)
    names = ["T", "R", "S"][: arms + 1]
    for name in names:
        text += f'[[axis]]\nname = "{name}"\nkind = "turn"\nrange_deg = [-190.0, 190.0]\nhome_deg = 0.0\n'
        text += limits("deg", 300.0)
    for arm in range(arms):
        motor, length = names[arm + 1], draw.uniform(180, 280)
        text += f'[[arm]]\nname = "{"AB"[arm]}"\nmount_mm = [0.0, 0.0, {60 + 130 * arm}.0]\n'
        if draw.random() < 0.5:
            stiffness, mass = draw.uniform(200, 1500), draw.uniform(1, 3)
            text += f'droop = {{ kind = "cantilever", stiffness_n_m2 = {stiffness}, mass_kg_m = {mass} }}\n'
        else:
            rows = []
            for reach in range(0, 1001, 50):
                drop, slope = draw.uniform(0, 3) * reach / 1000, draw.uniform(0, 5) * reach / 1000
                rows.append(
                    f"{{ reach_mm = {reach}.0, empty_drop_mm = {drop}, empty_slope_mrad = {slope}, "
                    f"loaded_drop_mm = {1.5 * drop}, loaded_slope_mrad = {1.4 * slope}, load_g = 500.0 }}"
                )
            text += f'droop = {{ kind = "table", row = [{", ".join(rows)}] }}\n'
        for zero, drives, rise in [
            (-90, f"T = 1, {motor} = 1", 0),
            (180, f"{motor} = -2", 15),
            (-90, f"{motor} = 1", 20),
        ]:
            text += f'[[arm.joint]]\nkind = "turn"\nzero_deg = {zero}.0\ndrives = {{ {drives} }}\n'
            text += f"rise_mm = {rise}.0\n" + (f"length_mm = {length}\n" if rise < 20 else "")
        text += f'[[arm.effector]]\nname = "{"AB"[arm]}"\nwafer_center_mm = [{draw.uniform(200, 300)}, 0.0, 10.0]\n'
        text += 'support = { kind = "edge" }\nfriction = 0.9\n'
    return text


def shape(draw: random.Random, size: float) -> tuple[str, coal.CollisionGeometry, np.ndarray]:
    """A shape: its text in a cell file, and the same for coal with its pose in the frame of the shape [m]."""
    pose = np.eye(4)
    kind = draw.randrange(3)
    if kind == 0:
        sides = [draw.uniform(0.1, 1) * size for _ in range(3)]
        return f"box = {{ size_mm = {[1e3 * side for side in sides]} }}", coal.Box(*sides), pose
    if kind == 1:
        radius, height = draw.uniform(0.1, 0.5) * size, draw.uniform(0.1, 1) * size
        text = f"cylinder = {{ radius_mm = {1e3 * radius}, height_mm = {1e3 * height} }}"
        return text, coal.Cylinder(radius, height), pose
    ends = [np.array([draw.uniform(-0.5, 0.5) * size for _ in range(3)]) for _ in range(2)]
    radius, axis = draw.uniform(0.05, 0.2) * size, ends[1] - ends[0]
    length = float(np.linalg.norm(axis))
    across = np.linalg.svd(axis[None] / length)[2][1:]
    turn = np.stack([across[0], np.cross(axis / length, across[0]), axis / length], axis=1)
    pose[:3, :3], pose[:3, 3] = turn, (ends[0] + ends[1]) / 2
    low, high = [[1e3 * float(value) for value in end] for end in ends]
    text = f"capsule = {{ from_mm = {low}, to_mm = {high}, radius_mm = {1e3 * radius} }}"
    return text, coal.Capsule(radius, length), pose


def cell(draw: random.Random, folder: Path) -> dict[str, tuple[coal.CollisionGeometry, np.ndarray]]:
    """Writes a robot, a cell and a program; what bodies are."""
    arms = 1 + (draw.random() < 0.5)
    (folder / "random.toml").write_text(robot(draw, arms))
    carried = [name for name in "AB"[:arms] if draw.random() < 0.5]
    text = f'kind = "cell"\nname = "random"\nrobot = "random.toml"\ncarried = {json.dumps(carried)}\n'
    text += '[wafer]\ndiameter_mm = 300.0\nthickness_mm = 0.775\nmaterial = "silicon"\n'
    text += "[budgets]\nvirtual_joint_norm_um = 200.0\nmin_distance_mm = 1.0\nslot_min_distance_mm = 1.0\nplane_urad = 1000.0\n"
    text += '[[station]]\nname = "P"\nposition_mm = [0.0, 600.0, 600.0]\n'
    text += "stroke = { below_mm = 4.0, above_mm = 3.0, speed_mm_s = 20.0 }\nretract_mm = 10.0\n"
    bodies = {}
    places = [f'on = {{ arm = "{"AB"[arm]}", link = {link} }}' for arm in range(arms) for link in (1, 2, 3, 3)]
    places += ['on = "platform"'] + [""] * 14
    turn = draw.uniform(-150, 150)
    for number, place in enumerate(places):
        of_world = not place
        text_of_shape, geometry, pose = shape(draw, 0.12 if of_world else 0.07)
        if of_world:
            # Above or below where the arms end up.
            out, angle = draw.uniform(0.3, 0.75), math.radians(turn + draw.uniform(-40, 40))
            at = [out * math.cos(angle), out * math.sin(angle), draw.uniform(0.5, 0.85)]
        else:
            at = [draw.uniform(-0.05, 0.25), draw.uniform(-0.06, 0.06), draw.uniform(-0.03, 0.03)]
        name = f"body-{number}"
        text += f'[[body]]\nname = "{name}"\n{place}\nposition_mm = {[1e3 * value for value in at]}\n'
        text += f"heading_deg = {draw.uniform(-180, 180)}\n"
        text += f"tilt = {{ azimuth_deg = {draw.uniform(-180, 180)}, angle_deg = {draw.uniform(0, 60)} }}\n{text_of_shape}\n"
        bodies[name] = geometry, pose
    (folder / "cell.toml").write_text(text)
    lines = [f"TILT {draw.uniform(0.2, 1.4)} deg TOWARD {draw.uniform(-180, 180)} deg"]
    moves = "".join(f" {name} {draw.uniform(-80, 80)} deg" for name in ["R", "S"][:arms])
    lines.append(f"MOVE T {turn} deg{moves}")
    draw.shuffle(lines)
    (folder / "cell.program").write_text("\n".join(lines) + "\n")
    disc = np.eye(4)
    disc[2, 3] = WAFER[1] / 2
    for name in carried:
        bodies[f"wafer of {name}"] = coal.Cylinder(WAFER[0] / 2, WAFER[1]), disc
    return bodies


def turned(quaternion: np.ndarray) -> np.ndarray:
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


class Gltf:
    """Nodes of an exported motion, and their poses in the base frame."""

    def __init__(self, data: bytes) -> None:
        length = int.from_bytes(data[12:16], "little")
        self.document = json.loads(data[20 : 20 + length])
        self.binary = data[20 + length + 8 :]
        self.nodes = self.document["nodes"]
        self.parents = {child: k for k, node in enumerate(self.nodes) for child in node.get("children", [])}
        self.tracks = {}
        for animation in self.document.get("animations", []):
            for channel in animation["channels"]:
                sampler = animation["samplers"][channel["sampler"]]
                times = self.numbers(sampler["input"])[:, 0]
                values = self.numbers(sampler["output"])
                target = channel["target"]
                track = times, values.reshape(len(times), 3, -1)
                self.tracks[target["node"], target["path"]] = track

    def numbers(self, accessor: int) -> np.ndarray:
        one = self.document["accessors"][accessor]
        view = self.document["bufferViews"][one["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[one["type"]]
        start = view.get("byteOffset", 0) + one.get("byteOffset", 0)
        flat = np.frombuffer(self.binary, "<f4", one["count"] * width, start)
        return flat.reshape(-1, width).astype(float)

    def value(self, node: int, path: str, at_rest: list[float], time: float) -> np.ndarray:
        if (node, path) not in self.tracks:
            return np.array(self.nodes[node].get(path, at_rest))
        times, keys = self.tracks[node, path]
        k = int(np.clip(np.searchsorted(times, time, "right") - 1, 0, len(times) - 2))
        dt = times[k + 1] - times[k]
        s = float(np.clip((time - times[k]) / dt, 0, 1))
        (_, p, m), (n, q, _) = keys[k], keys[k + 1]
        ahead = (2 * s**3 - 3 * s**2 + 1) * p + (s**3 - 2 * s**2 + s) * dt * m
        return ahead + (3 * s**2 - 2 * s**3) * q + (s**3 - s**2) * dt * n

    def pose(self, node: int, time: float, known: dict[int, np.ndarray]) -> np.ndarray:
        """In the base frame, which is the frame of the first node."""
        if node == 0:
            return np.eye(4)
        if node not in known:
            own = np.eye(4)
            own[:3, :3] = turned(self.value(node, "rotation", [0, 0, 0, 1], time))
            own[:3, 3] = self.value(node, "translation", [0, 0, 0], time)
            known[node] = self.pose(self.parents[node], time, known) @ own
        return known[node]


def run(command: str, *words: str | Path) -> str:
    done = subprocess.run([command, "cell", *map(str, words)], capture_output=True, text=True, check=False)
    # 1: something is violated, which half of these motions do.
    if done.returncode not in (0, 1):
        sys.exit(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def distance(one: coal.CollisionGeometry, at: np.ndarray, other: coal.CollisionGeometry, there: np.ndarray) -> float:
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    # By default its iteration ends at 1 µm.
    request.gjk_tolerance, request.gjk_max_iterations = 1e-8, 10_000
    poses = [coal.Transform3s(pose[:3, :3], pose[:3, 3]) for pose in (at, there)]
    return max(float(coal.distance(one, poses[0], other, poses[1], request, result)), 0.0)


def compare(command: str, seed: int) -> tuple[int, int, float]:
    """One cell: pairs compared, those of them apart, and the largest difference [m]."""
    draw = random.Random(seed)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        bodies = cell(draw, folder)
        report = json.loads(run(command, "check", folder / "cell.toml", "--format", "json"))
        where = ["--rate", str(RATE), "--out", folder / "out", "--despite-errors"]
        run(command, "export", folder / "cell.toml", "--to", "gltf", *where)
        (exported,) = (folder / "out").glob("*.glb")
        gltf = Gltf(exported.read_bytes())
    nodes = {node["name"]: k for k, node in enumerate(gltf.nodes) if k > 0}
    duration = gltf.document["asset"]["extras"]["duration_s"]

    def at(time: float) -> dict[str, np.ndarray]:
        known: dict[int, np.ndarray] = {}
        return {name: gltf.pose(nodes[name], time, known) @ bodies[name][1] for name in bodies}

    def between(pair: list[str], poses: dict[str, np.ndarray]) -> float:
        one, other = pair
        return distance(bodies[one][0], poses[one], bodies[other][0], poses[other])

    worst, apart = 0.0, 0
    pairs = report["distances"]
    for row in pairs:
        expected = max(row["distance_mm"], 0.0) * 1e-3
        found = between(row["bodies"], at(row["time_s"]))
        worst = max(worst, abs(found - expected))
        apart += expected > 0
        if not abs(found - expected) <= SAME:
            sys.exit(f"cell {seed}, {row['bodies']} at {row['time_s']} s: {found} by coal, {expected} by the check")
    for k in range(TIMES):
        poses = at(duration * (k + draw.random()) / TIMES)
        for row in pairs:
            least = max(row["distance_mm"] - row["within_mm"], 0.0) * 1e-3
            found = between(row["bodies"], poses)
            if not found >= least - SAME:
                sys.exit(f"cell {seed}, {row['bodies']}: {found} by coal, not below {least} by the check")
    return len(pairs), apart, worst


def main() -> None:
    command = str(Path(sys.argv[1]).resolve())
    count = int(sys.argv[2]) if len(sys.argv) > 2 else CELLS
    first = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    with ThreadPoolExecutor(3) as threads:
        found = list(threads.map(lambda seed: compare(command, seed), range(first, first + count)))
    pairs, apart, worst = sum(row[0] for row in found), sum(row[1] for row in found), max(row[2] for row in found)
    if apart < 4 * count:
        sys.exit(f"only {apart} distances above zero in {count} cells")
    print(f"coal agrees on {pairs} minimum distances in {count} cells, {apart} above zero: within {worst * 1e6:.2f} µm")


if __name__ == "__main__":
    main()
