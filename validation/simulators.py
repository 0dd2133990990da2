"""Compare exported mechanisms with the simulators and viewers that they are for.

Exports mechanisms with the `jointplay` command and loads them with MuJoCo: the virtual joints settle where jointplay
has them, and rigid closures do not; every mechanism of the catalogue loads and holds its reference configuration.
Makes parts of mechanisms as GLB, and one of STEP by cascadio, animates them, compares the poses of the nodes with
the poses of the links, and validates the files with the glTF validator.

Run by `exported.py`, in its environment.
"""

from __future__ import annotations

import json
import math
import re
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import couplings
import modelica
import mujoco
import numpy as np

HERE = Path(__file__).resolve().parent

# Commands of the rods of the three-rod robot (mm), and the tolerance for MuJoCo's displacements (m).
RODS = [(3.1, -1.55, -1.55), (1.0, 0.5, -2.0), (-2.0, 4.0, 1.5)]
SETTLED = 1e-8

# Mechanisms whose links are few and whose motion is a full turn or a long travel, with a drive.
ANIMATED = {
    "gpr-mechanism": ["rod 1=0:3"],
    "four-bar": ["A=0:360"],
    "hexapod": ["P1=0:0.02", "P2=0:-0.02"],
}


def jointplay(command: str, *arguments: str) -> dict:
    """The JSON answer of a command."""
    done = subprocess.run(
        [command, *arguments, "--format", "json"], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        sys.exit(f"jointplay {' '.join(arguments)}: {done.stderr}")
    return json.loads(done.stdout)


def settled(model: mujoco.MjModel, commands: dict[str, float], steps: int) -> mujoco.MjData:
    """The model after its actuators have moved to commands."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    start = data.ctrl.copy()
    for step in range(steps):
        share = min(1.0, 2.0 * step / steps)
        for name, value in commands.items():
            at = model.actuator(name).id
            data.ctrl[at] = start[at] + share * (value - start[at])
        mujoco.mj_step(model, data)
    return data


def check_play(command: str, folder: Path) -> None:
    """MuJoCo settles at the virtual displacements of jointplay; without virtual joints it does not have them."""
    for flag, name in ((None, "play"), ("--rigid", "rigid")):
        extra = [flag] if flag else []
        jointplay(command, "export", "gpr-mechanism", "--to", "mjcf", "--out", str(folder / name), *extra)
    model = mujoco.MjModel.from_xml_path(str(folder / "play" / "gpr-mechanism.xml"))
    rigid = mujoco.MjModel.from_xml_path(str(folder / "rigid" / "gpr-mechanism.xml"))
    worst, least = 0.0, math.inf
    for rods in RODS:
        commands = {f"rod {k + 1}": 1e-3 * rod for k, rod in enumerate(rods)}
        at = ",".join(f"rod {k + 1}={rod}" for k, rod in enumerate(rods))
        answer = jointplay(command, "assemble", "gpr-mechanism", "--at", at)
        expected = virtual_displacements(answer)
        data = settled(model, commands, 12_000)
        found = {name: data.joint(name).qpos[0] for name in expected}
        off = max(abs(found[name] - expected[name]) for name in expected)
        worst = max(worst, off)
        if off > SETTLED:
            sys.exit(f"MuJoCo settles at {found} m, jointplay has {expected} m: {off} m apart")
        # Rigid closures pull the platform back: its shift is lost.
        shift = data.body("platform").xpos[:2]
        level = settled(model, {name: 0.0 for name in commands}, 1_000).body("platform").xpos[:2]
        other = settled(rigid, commands, 12_000).body("platform").xpos[:2]
        least = min(least, float(np.linalg.norm((shift - level) - (other - level))))
    if least < 1e-6:
        sys.exit(f"a model without play has the same shift within {least} m: this comparison shows nothing")
    print(
        f"MuJoCo {mujoco.__version__}: play of {len(RODS)} poses within {1e6 * worst:.4f} µm of jointplay; "
        f"without play the platform is at least {1e6 * least:.2f} µm elsewhere"
    )


def check_hinges(command: str, folder: Path) -> None:
    """Loops that a hinge closes yield no more than those of balls do, in mechanisms of any size."""
    worst = 0.0
    for unit, size in (("mm", 0.001), ("mm", 0.1), ("m", 1.0)):
        point = lambda *parts: [part * size * (1000.0 if unit == "mm" else 1.0) for part in parts]
        text = f"""kind = "mechanism"
name = "four-bar with a bent hinge"
units = {{ length = "{unit}", angle = "deg" }}
base = "ground"
joint = [
  {{ name = "A", kind = "revolute", links = ["ground", "crank"], point = {point(0, 0, 0)}, axis = [0, 0, 1], actuated = true }},
  {{ name = "B", kind = "revolute", links = ["coupler", "crank"], point = {point(0.3, 0, 0)}, axis = [0, 0.2955, 0.9553] }},
  {{ name = "C", kind = "revolute", links = ["coupler", "rocker"], point = {point(0.3, 0.8, 0)}, axis = [0, 0, 1] }},
  {{ name = "D", kind = "revolute", links = ["ground", "rocker"], point = {point(1, 0, 0)}, axis = [0, 0, 1] }},
]
virtual_joint = [
  {{ name = "lift", joint = "C", slide = [0, 0, 1] }},
  {{ name = "roll", joint = "C", on = "coupler", turn = [1, 0, 0] }},
  {{ name = "pitch", joint = "C", on = "rocker", turn = [0, 1, 0], about = {point(0.3, 0.75, 0.03)} }},
]
"""
        file = folder / "hinges.toml"
        file.write_text(text, encoding="utf-8")
        jointplay(command, "export", str(file), "--to", "mjcf", "--out", str(folder / "hinges"), "--force")
        model = mujoco.MjModel.from_xml_path(str(folder / "hinges" / "hinges.xml"))
        answer = jointplay(command, "assemble", str(file), "--at", "A=40")
        found = settled(model, {"A": math.radians(40.0)}, 12_000).joint("lift").qpos[0]
        expected = virtual_displacements(answer)["lift"]
        worst = max(worst, abs(found / expected - 1.0))
    if not worst < 1e-4:
        sys.exit(f"a loop that a hinge closes: displacements in MuJoCo differ by a share of {worst}")
    print(f"loops closed by hinges: displacements within a share of {worst:.1e} of jointplay, from 1 mm to 1 m")


def check_page(command: str, folder: Path) -> None:
    """The code of the page on simulators prints the displacements of jointplay."""
    page = (HERE.parent / "docs" / "how-to" / "export-to-simulators.md").read_text(encoding="utf-8")
    (block,) = [part[len("python\n") :] for part in page.split("```") if part.startswith("python\nimport mujoco")]
    jointplay(command, "export", "gpr-mechanism", "--to", "mjcf", "--out", str(folder / "page" / "models"))
    done = subprocess.run(
        [sys.executable, "-c", block], cwd=folder / "page", capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        sys.exit(f"the code of the page on simulators fails: {done.stderr}")
    answer = jointplay(command, "assemble", "gpr-mechanism", "--at", "rod 1=3.1,rod 2=-1.55,rod 3=-1.55")
    expected = [1e6 * value for value in virtual_displacements(answer).values()]
    found = [float(word) for word in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", done.stdout)]
    if not np.allclose(found, expected, rtol=0, atol=1e6 * SETTLED):
        sys.exit(f"the code of the page on simulators prints {done.stdout}, expected {expected} µm")


def virtual_displacements(answer: dict) -> dict[str, float]:
    """Displacements of the virtual joints of an assembly (m)."""
    scale = {"mm": 1e-3, "m": 1.0}[answer["units"]["length"]]
    return {name: scale * value for name, value in answer["virtual_joints"].items()}


def check_catalogue(command: str, folder: Path) -> None:
    """MuJoCo loads every mechanism of the catalogue, and holds its reference configuration."""
    names = [
        entry["name"]
        for entry in jointplay(command, "catalogue")["entries"]
        if entry["kind"] == "mechanism"
    ]
    worst = 0.0
    for name in names:
        jointplay(command, "export", name, "--to", "mjcf", "--out", str(folder / "catalogue"), "--force")
        model = mujoco.MjModel.from_xml_path(str(folder / "catalogue" / f"{name}.xml"))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        mujoco.mj_forward(model, data)
        start = data.xpos.copy()
        if data.nefc and np.abs(data.efc_pos).max() > 1e-9:
            closed = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
            off = np.abs(data.efc_pos[closed]).max() if closed.any() else 0.0
            if off > 1e-9:
                sys.exit(f"{name}: the loops are open by {off} in MuJoCo")
        for _ in range(200):
            mujoco.mj_step(model, data)
        moved = float(np.abs(data.xpos - start).max())
        worst = max(worst, moved)
        if not moved < 1e-6:
            sys.exit(f"{name} moves by {moved} m from its reference configuration in MuJoCo")
    print(f"{len(names)} mechanisms load, and stay within {1e9 * worst:.3f} nm of their reference")


class Glb:
    """A binary glTF file with one animation, evaluated from its bytes."""

    def __init__(self, data: bytes) -> None:
        length = int.from_bytes(data[12:16], "little")
        self.document = json.loads(data[20 : 20 + length])
        self.bytes = data[28 + length :]
        self.nodes = self.document["nodes"]
        self.parents = {child: k for k, node in enumerate(self.nodes) for child in node.get("children", [])}
        self.known: dict[int, np.ndarray] = {}
        animation = self.document["animations"][-1]
        self.channels = {
            (channel["target"]["node"], channel["target"]["path"]): animation["samplers"][channel["sampler"]]
            for channel in animation["channels"]
        }

    def numbers(self, accessor: int) -> np.ndarray:
        if accessor not in self.known:
            self.known[accessor] = self.read(accessor)
        return self.known[accessor]

    def read(self, accessor: int) -> np.ndarray:
        entry = self.document["accessors"][accessor]
        view = self.document["bufferViews"][entry["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[entry["type"]]
        start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
        flat = np.frombuffer(self.bytes, "<f4", entry["count"] * width, start)
        return flat.reshape(-1, width).astype(float)

    def value(self, node: int, path: str, time: float, rest: list[float]) -> np.ndarray:
        sampler = self.channels.get((node, path))
        if sampler is None:
            return np.array(self.nodes[node].get(path, rest), dtype=float)
        times, values = self.numbers(sampler["input"])[:, 0], self.numbers(sampler["output"])
        at = int(np.clip(np.searchsorted(times, time, "right"), 1, len(times) - 1))
        share = float(np.clip((time - times[at - 1]) / (times[at] - times[at - 1]), 0, 1))
        a, b = values[at - 1], values[at]
        if path == "translation":
            return a + share * (b - a)
        angle = math.acos(min(1.0, abs(float(a @ b)) / float(np.linalg.norm(a) * np.linalg.norm(b))))
        b = b if a @ b > 0 else -b
        if angle < 1e-6:
            return a + share * (b - a)
        return (math.sin((1 - share) * angle) * a + math.sin(share * angle) * b) / math.sin(angle)

    def matrix(self, node: int, time: float) -> np.ndarray:
        """The pose of a node in the scene."""
        local = np.eye(4)
        if "matrix" in self.nodes[node]:
            local = np.array(self.nodes[node]["matrix"], dtype=float).reshape(4, 4).T
        else:
            local[:3, :3] = rotation(self.value(node, "rotation", time, [0, 0, 0, 1]))
            local[:3, :3] *= np.array(self.nodes[node].get("scale", [1, 1, 1]), dtype=float)
            local[:3, 3] = self.value(node, "translation", time, [0, 0, 0])
        above = self.parents.get(node)
        return local if above is None else self.matrix(above, time) @ local

    def named(self, name: str) -> int:
        (found,) = [k for k, node in enumerate(self.nodes) if node.get("name") == name]
        return found


def rotation(quaternion: np.ndarray) -> np.ndarray:
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


def box(document: dict, data: bytearray, size: tuple[float, float, float]) -> int:
    """Adds the mesh of a box, and returns its index."""
    corners = [[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    corners = [[c * s for c, s in zip(corner, size)] for corner in corners]
    faces = [0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3]
    start = len(data)
    data += struct.pack("<24f", *[c for corner in corners for c in corner])
    views = document["bufferViews"]
    views.append({"buffer": 0, "byteOffset": start, "byteLength": 96, "target": 34962})
    start = len(data)
    data += struct.pack("<36H", *faces)
    views.append({"buffer": 0, "byteOffset": start, "byteLength": 72, "target": 34963})
    low, high = [-0.5 * s for s in size], [0.5 * s for s in size]
    accessors = document["accessors"]
    accessors.append({"bufferView": len(views) - 2, "componentType": 5126, "count": 8, "type": "VEC3", "min": low, "max": high})
    accessors.append({"bufferView": len(views) - 1, "componentType": 5123, "count": 36, "type": "SCALAR"})
    primitive = {"attributes": {"POSITION": len(accessors) - 2}, "indices": len(accessors) - 1}
    document["meshes"].append({"primitives": [primitive]})
    return len(document["meshes"]) - 1


def parts(names: list[str]) -> bytes:
    """A file of parts: a box for each name, some in a group that is displaced, turned and scaled."""
    data = bytearray()
    document: dict = {
        "asset": {"version": "2.0", "generator": "boxes"},
        "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "assembly", "children": [1]}, {"name": "group", "scale": [0.5, 0.5, 0.5], "translation": [0.1, -0.2, 0.3], "rotation": [0.5, 0.5, 0.5, 0.5], "children": []}],
        "meshes": [], "accessors": [], "bufferViews": [],
    }
    for k, name in enumerate(names):
        mesh = box(document, data, (0.02, 0.03 + 0.01 * k, 0.05))
        document["nodes"].append({"name": name, "mesh": mesh, "translation": [0.05 * k, 0.02, -0.01 * k]})
        document["nodes"][k % 2]["children"].append(len(document["nodes"]) - 1)
    document["buffers"] = [{"byteLength": len(data)}]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    header = b"glTF" + struct.pack("<II", 2, 12 + 8 + len(text) + 8 + len(data))
    return header + struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", len(data)) + b"BIN\0" + bytes(data)


def poses(answer: dict, link: str, per_meter: float) -> list[np.ndarray]:
    """The poses of a link during a motion, as `jointplay move --poses` has them."""
    found = []
    series = answer["poses"][link]
    for place, (w, x, y, z) in zip(series[next(key for key in series if key.startswith("position"))], series["quaternion"]):
        pose = np.eye(4)
        pose[:3, :3] = rotation(np.array([x, y, z, w]))
        pose[:3, 3] = np.array(place) / per_meter
        found.append(pose)
    return found


def check_parts(command: str, folder: Path, validate: Callable[[Path], dict]) -> None:
    """Parts move as the links do, whatever their places in the file; the files are valid."""
    for name, drives in ANIMATED.items():
        flags = [*(word for drive in drives for word in ("--drive", drive)), "--steps", "24"]
        answer = jointplay(command, "move", name, *flags, "--poses")
        per_meter = {"mm": 1e3, "m": 1.0}[answer["units"]["length"]]
        links = [link for link in answer["poses"]]
        file = folder / f"{name}-parts.glb"
        # One part has a name of its own, which a table gives to its link.
        file.write_bytes(parts([*links[:-1], "a part"]))
        step = folder / f"{name}-parts"
        jointplay(
            command, "move", name, *flags, "--to", "gltf", "--parts", str(file), "--part", f"a part={links[-1]}",
            "--out", str(step),
        )
        bars = folder / f"{name}-bars"
        jointplay(command, "move", name, *flags, "--to", "gltf", "--out", str(bars))
        before, after = still_glb(file), Glb((step / f"{name}-motion.glb").read_bytes())
        drawn = Glb((bars / f"{name}-motion.glb").read_bytes())
        for path in (step, bars):
            report = validate(path / f"{name}-motion.glb")
            if report["issues"]["messages"]:
                sys.exit(f"{name}: {json.dumps(report['issues']['messages'], indent=2)}")
        up = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=float)
        reference = jointplay(command, "move", name, *still(drives), "--steps", "1", "--poses")
        worst = 0.0
        for number, link in enumerate(links):
            node = "a part" if number + 1 == len(links) else link
            home = poses(reference, link, per_meter)[0]
            all_poses = poses(answer, link, per_meter)
            start = before.matrix(before.named(node), 0.0)
            for k, pose in enumerate(all_poses):
                time = 4.0 * k / (len(all_poses) - 1)
                expected = up @ pose @ np.linalg.inv(home) @ np.linalg.inv(up) @ start
                worst = max(worst, np.abs(after.matrix(after.named(node), time) - expected)[:3, 3].max())
                shown = drawn.matrix(drawn.named(link), time)
                worst = max(worst, np.abs(shown - up @ pose)[:3, 3].max())
        if worst > 1.2e-6:
            sys.exit(f"{name}: parts are off by {worst} m")
        print(f"glTF of {name}: {len(links)} parts within {1e6 * worst:.2f} µm of the poses of the links")


def check_step(command: str, folder: Path, validate: Callable[[Path], dict]) -> None:
    """Parts of a STEP assembly, converted by cascadio, move as the links do; z is up in them."""
    import cascadio

    file = folder / "step.glb"
    cascadio.step_to_glb(str(HERE / "golden" / "models" / "four-bar.step"), str(file), 0.1, 0.5)
    flags = ["--drive", "A=0:360"]
    out = folder / "step"
    jointplay(command, "move", "four-bar", *flags, "--to", "gltf", "--parts", str(file), "--out", str(out))
    report = validate(out / "four-bar-motion.glb")
    if report["issues"]["messages"]:
        sys.exit(f"parts of STEP: {json.dumps(report['issues']['messages'], indent=2)}")
    answer = jointplay(command, "move", "four-bar", *flags, "--poses")
    reference = jointplay(command, "move", "four-bar", *still(["A"]), "--steps", "1", "--poses")
    per_meter = {"mm": 1e3, "m": 1.0}[answer["units"]["length"]]
    before, after = still_glb(file), Glb((out / "four-bar-motion.glb").read_bytes())
    worst = 0.0
    for link in answer["poses"]:
        home = np.linalg.inv(poses(reference, link, per_meter)[0])
        start = before.matrix(before.named(link), 0.0)
        moved = poses(answer, link, per_meter)
        for k, pose in enumerate(moved):
            shown = after.matrix(after.named(link), 4.0 * k / (len(moved) - 1))
            worst = max(worst, np.abs(shown - pose @ home @ start)[:3, 3].max())
    if worst > 1.2e-6:
        sys.exit(f"parts of STEP are off by {worst} m")
    print(f"glTF of STEP parts: within {1e6 * worst:.2f} µm of the poses of the links")


def still(drives: list[str]) -> list[str]:
    """A drive that stays where the loops of these mechanisms close, at zero."""
    return ["--drive", f"{drives[0].split('=')[0]}=0:1e-9"]


def still_glb(path: Path) -> Glb:
    """A file without animations."""
    data = path.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    glb = Glb.__new__(Glb)
    glb.known = {}
    glb.document = json.loads(data[20 : 20 + length])
    glb.bytes, glb.channels, glb.nodes = data[28 + length :], {}, glb.document["nodes"]
    glb.parents = {child: k for k, node in enumerate(glb.nodes) for child in node.get("children", [])}
    return glb


def check(command: str, validate: Callable[[Path], dict]) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        check_play(command, folder)
        check_hinges(command, folder)
        check_page(command, folder)
        check_catalogue(command, folder)
        couplings.check(command, folder)
        modelica.check(command, folder)
        check_parts(command, folder, validate)
        check_step(command, folder, validate)
