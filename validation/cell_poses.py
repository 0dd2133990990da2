"""Compare the poses in tables of cells with the animated 3D scene and with forward kinematics of the robot's files.

The frames of rods, platform, links and effectors in the table of `jointplay cell export --poses` are those of
the glTF export of the same motion, and those that rods and motors give: the platform by the rigid fit of its sockets to
the tops of the rods, the links by the dimensions of the arms. The last link of an arm droops; its frame and that of its
effector are compared within the droop.

Run by `exported.py`, in its environment.
"""

from __future__ import annotations

import csv
import json
import sys
import tomllib
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
ROBOTS = ROOT / "crates" / "jointplay-format" / "robots"

# Single precision and omitted keys of the scene (m, 1); the largest droop of the example (m).
SCENE = 3e-6
DROOP = 1.5e-3
EXACT = 1e-9


def rotation(w: float, x: float, y: float, z: float) -> np.ndarray:
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


def pose(matrix: np.ndarray, origin: np.ndarray) -> np.ndarray:
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = matrix, origin
    return found


def about_z(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def in_table(row: dict[str, float], name: str) -> np.ndarray:
    """The pose of a frame in a row (m)."""
    origin = np.array([row[f"{name}_{axis}_mm"] for axis in "xyz"])
    return pose(rotation(*(row[f"{name}_q{part}"] for part in "wxyz")), 1e-3 * origin)


class Scene:
    """A binary glTF file with one animation of cubics, evaluated from its bytes."""

    def __init__(self, data: bytes) -> None:
        length = int.from_bytes(data[12:16], "little")
        self.document = json.loads(data[20 : 20 + length])
        self.bytes = data[28 + length :]
        nodes = self.document["nodes"]
        self.parents = {child: k for k, node in enumerate(nodes) for child in node.get("children", [])}
        (animation,) = self.document["animations"]
        self.channels = {}
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            target = (channel["target"]["node"], channel["target"]["path"])
            times, values = self.numbers(sampler["input"])[:, 0], self.numbers(sampler["output"])
            self.channels[target] = (sampler.get("interpolation", "LINEAR"), times, values)

    def numbers(self, accessor: int) -> np.ndarray:
        entry = self.document["accessors"][accessor]
        view = self.document["bufferViews"][entry["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[entry["type"]]
        start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
        flat = np.frombuffer(self.bytes, "<f4", entry["count"] * width, start)
        return flat.reshape(-1, width).astype(float)

    def value(self, node: int, path: str, time: float, rest: list[float]) -> np.ndarray:
        if (node, path) not in self.channels:
            return np.array(self.document["nodes"][node].get(path, rest), dtype=float)
        kind, times, values = self.channels[node, path]
        if kind == "CUBICSPLINE":
            before, points, after = values.reshape(-1, 3, values.shape[1]).transpose(1, 0, 2)
        else:
            points = values
        if time <= times[0] or len(times) == 1:
            return points[0]
        if time >= times[-1]:
            return points[-1]
        k = int(np.searchsorted(times, time, "right")) - 1
        step = times[k + 1] - times[k]
        s = (time - times[k]) / step
        if kind == "STEP":
            return points[k]
        if kind == "LINEAR":
            return points[k] + s * (points[k + 1] - points[k])
        return (
            (2 * s**3 - 3 * s**2 + 1) * points[k]
            + step * (s**3 - 2 * s**2 + s) * after[k]
            + (-2 * s**3 + 3 * s**2) * points[k + 1]
            + step * (s**3 - s**2) * before[k + 1]
        )

    def pose(self, node: int, time: float) -> np.ndarray:
        """The pose of a node in the base of the robot, whose node is the first."""
        if node == 0:
            return np.eye(4)
        x, y, z, w = self.value(node, "rotation", time, [0, 0, 0, 1])
        size = np.sqrt(w * w + x * x + y * y + z * z)
        local = pose(rotation(w / size, x / size, y / size, z / size), self.value(node, "translation", time, [0, 0, 0]))
        return self.pose(self.parents[node], time) @ local

    def named(self, name: str) -> int:
        # Shapes of a part can have its name; the part is nearest the base.
        found = [k for k, node in enumerate(self.document["nodes"]) if node.get("name") == name]
        return min(found)


def fitted(points: np.ndarray, to: np.ndarray) -> np.ndarray:
    """The rigid displacement of least squares from points to others."""
    middle, other = points.mean(axis=0), to.mean(axis=0)
    u, _, vt = np.linalg.svd((to - other).T @ (points - middle))
    turn = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return pose(turn, other - turn @ middle)


def links(arm: dict, row: dict[str, float], platform: np.ndarray) -> list[np.ndarray]:
    """The rigid links of an arm, and the wafer of each of its effectors."""
    frame = platform @ pose(np.eye(3), 1e-3 * np.array(arm["mount_mm"]))
    found, length = [], np.zeros(3)
    for joint in arm["joint"]:
        angle = joint.get("zero_deg", 0.0) + sum(
            ratio * row[f"{axis}_deg"] for axis, ratio in joint["drives"].items()
        )
        rise = np.array([0, 0, joint.get("rise_mm", 0.0)])
        frame = frame @ pose(np.eye(3), 1e-3 * (length + rise)) @ pose(about_z(np.radians(angle)), np.zeros(3))
        length = np.array([joint.get("length_mm", 0.0), joint.get("offset_mm", 0.0), 0.0])
        found.append(frame)
    return found


def check(folder: Path) -> None:
    """Compares the table of a folder with its scene."""
    with (folder / "example.csv").open(newline="", encoding="utf-8") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    scene = Scene((folder / "example.glb").read_bytes())
    gpr = tomllib.loads((ROBOTS / "gpr.toml").read_text(encoding="utf-8"))
    robot = tomllib.loads((ROBOTS / "dual-arm.toml").read_text(encoding="utf-8"))
    radii = [1e-3 * limb["socket_radius_mm"] for limb in gpr["limb"]]
    angles = [np.radians(limb["socket_angle_deg"]) for limb in gpr["limb"]]
    sockets = np.array([[r * np.cos(a), r * np.sin(a), 0] for r, a in zip(radii, angles)])
    rods = ["q1", "q2", "q3"]
    frames = [name[: -len("_qw")] for name in rows[0] if name.endswith("_qw")]
    nodes = {name: scene.named(name) for name in frames if name not in ("A", "B")}
    in_scene, by_chain, droop = 0.0, 0.0, 0.0
    for row in rows:
        for name, node in nodes.items():
            off = np.abs(scene.pose(node, row["time_s"]) - in_table(row, name)).max()
            in_scene = max(in_scene, float(off))
        tops = sockets + np.array([[0, 0, 1e-3 * row[f"{rod}_mm"]] for rod in rods])
        platform = fitted(sockets, tops)
        expected = {"platform": platform}
        expected |= {rod: pose(np.eye(3), top) for rod, top in zip(rods, tops)}
        sagged = {}
        for arm in robot["arm"]:
            *rigid, last = links(arm, row, platform)
            expected |= {f"{arm['name']} link {k + 1}": link for k, link in enumerate(rigid)}
            sagged[f"{arm['name']} link {len(rigid) + 1}"] = last
            for effector in arm["effector"]:
                center = 1e-3 * np.array(effector["wafer_center_mm"])
                sagged[effector["name"]] = last @ pose(about_z(np.radians(effector.get("heading_deg", 0.0))), center)
        if set(expected) | set(sagged) != set(frames):
            sys.exit(f"the table has poses of {frames}, expected {sorted(set(expected) | set(sagged))}")
        for name, at in expected.items():
            by_chain = max(by_chain, float(np.abs(in_table(row, name) - at).max()))
        for name, at in sagged.items():
            droop = max(droop, float(np.linalg.norm(in_table(row, name)[:3, 3] - at[:3, 3])))
        # The least sum of squares is that of the virtual joints.
        placed = sockets @ platform[:3, :3].T + platform[:3, 3]
        norm = 1e6 * np.linalg.norm(placed - tops)
        if abs(norm - row["virtual_displacement_um"]) > 1e-3:
            sys.exit(f"displacement of {row['virtual_displacement_um']} µm, expected {norm} µm")
    if not in_scene < SCENE:
        sys.exit(f"poses of the table and of the scene differ by {in_scene}")
    if not by_chain < EXACT:
        sys.exit(f"poses of the table and of the chain differ by {by_chain}")
    if not 1e-5 < droop < DROOP:
        sys.exit(f"the droop of the arms is {droop} m")
    print(
        f"poses of {len(frames)} frames in {len(rows)} rows: within {1e6 * in_scene:.2f} µm of the scene, "
        f"{1e9 * by_chain:.4f} nm of the chain, droop up to {1e6 * droop:.0f} µm"
    )


if __name__ == "__main__":
    check(Path(sys.argv[1]))
