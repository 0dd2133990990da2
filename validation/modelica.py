"""Compare exported models in Modelica with jointplay, in a simulation by the compiler Rumoca.

Exports mechanisms with the `jointplay` command, simulates them over a drive, and compares the poses of all links and the
displacements of all virtual joints with those of `jointplay move`, at each step. Every mechanism of the catalogue
compiles and stays in its reference configuration.

Run by `exported.py`, in its environment.
"""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pymoca.parser
import rumoca

HERE = Path(__file__).resolve().parent

# Largest deviation of an origin, of an axis, and of a displacement of a virtual joint over a drive (m, 1, m).
TOLERANCE = 2e-9
# Largest deviation of a link from the reference configuration, whose loops jointplay closes within 1e-10 m.
STILL = 1e-8

CONFIG = {"solver": "bdf", "rtol": 1e-9, "atol": 1e-13}

# A table on a slide and a screw that tilt it, with a dial geared to the screw: the distance of both supports has to
# change with the tilt, and two virtual joints of unequal stiffness share it.
TABLE = """
kind = "mechanism"
name = "Tilting table"
units = { length = "mm", angle = "deg" }
base = "frame"

[[joint]]
name = "lift"
kind = "prismatic"
links = ["frame", "left leg"]
point = [-100, 0, 50]
axis = [0, 0, 1]
actuated = true

[[joint]]
name = "spindle"
kind = "helical"
links = ["frame", "right leg"]
point = [100, 0, 50]
axis = [0, 0, 1]
lead = 5
actuated = true

[[joint]]
name = "hinge"
kind = "revolute"
links = ["left leg", "table"]
point = [-100, 0, 80]
axis = [0, 1, 0]

[[joint]]
name = "ball"
kind = "spherical"
links = ["right leg", "table"]
point = [100, 0, 80]

[[joint]]
name = "dial"
kind = "revolute"
links = ["frame", "dial"]
point = [0, 200, 50]
axis = [0, 0, 1]

[[coupling]]
name = "gear"
coordinate = "dial"
terms = [{ coordinate = "spindle", ratio = -0.25 }]
offset = 10

[[virtual_joint]]
name = "left"
joint = "hinge"
on = "left leg"
slide = [1, 0, 0]
stiffness = 2e5

[[virtual_joint]]
name = "right"
joint = "ball"
on = "table"
slide = [1, 0, 0]
stiffness = 5e4

[[frame]]
name = "probe"
link = "table"
point = [0, 30, 100]
"""

# Mechanisms with their drives: first and last value, in the units of the file.
DRIVES: dict[str, dict[str, tuple[float, float]]] = {
    "gpr-mechanism": {"rod 1": (0, 3.1), "rod 2": (0, -1.55), "rod 3": (0, -1.55)},
    "four-bar": {"A": (20, 200)},
    "bennett": {"J1": (60, 150)},
    "sarrus": {"A1": (-20, 30)},
    "hexapod": {"P1": (0, 0.02), "P2": (0, -0.02)},
    "table.toml": {"lift": (0, 6), "spindle": (0, -720)},
}
STEPS = 12

# An input of a model: its name, start, unit and description.
INPUT = re.compile(r'RealInput (\w+)\(start = ([^,)]+).*unit = "(\w+)"\) "(.*)";')


def identifier(name: str) -> str:
    return re.sub("[^A-Za-z0-9]", "_", name)


def jointplay(command: str, *arguments: str, cwd: Path | None = None) -> dict:
    """The JSON answer of a command."""
    words = [command, *arguments, "--format", "json"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=cwd)
    if done.returncode != 0:
        sys.exit(f"jointplay {' '.join(arguments)}: {done.stderr}")
    return json.loads(done.stdout)


def package(command: str, name: str, folder: Path, *flags: str) -> tuple[str, str]:
    """Text and name of an exported package."""
    out = folder / f"modelica-{Path(name).stem}"
    answer = jointplay(command, "export", name, "--to", "modelica", "--out", str(out), "--force", *flags, cwd=folder)
    (export,) = answer["exports"]
    (path,) = map(Path, export["files"])
    return path.read_text(encoding="utf-8"), path.stem


def simulate(text: str, model: str, steps: int) -> rumoca.Result:
    """The result of a model from 0 s to 1 s."""
    try:
        compiled = rumoca.Session().loads(text, model=model)
        return compiled.simulate(t=(0, 1), dt=1 / steps, config=rumoca.SimConfig(**CONFIG))
    except rumoca.RumocaError as error:
        sys.exit(f"Rumoca refuses {model}: {error}")


def series(result: rumoca.Result, name: str, steps: int) -> np.ndarray:
    """A variable at even times from 0 s to 1 s."""
    found = np.interp(np.linspace(0, 1, steps + 1), np.array(result.time), np.array(result[name]))
    return found


def matrix(result: rumoca.Result, name: str, shape: tuple[int, ...], steps: int) -> np.ndarray:
    """An array at even times, shape (steps + 1, …)."""
    columns = [
        series(result, f"{name}[{','.join(str(k + 1) for k in at)}]", steps) for at in np.ndindex(*shape)
    ]
    return np.stack(columns, axis=-1).reshape(steps + 1, *shape)


def rotations(quaternions: list[list[float]]) -> np.ndarray:
    """Rotation matrices of unit quaternions w, x, y, z."""
    w, x, y, z = np.array(quaternions).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(rows).transpose(2, 0, 1)


def check_drive(command: str, name: str, drives: dict[str, tuple[float, float]], folder: Path) -> None:
    """Poses of links and displacements of virtual joints over a drive are those of jointplay."""
    at = ",".join(f"{drive}={first}" for drive, (first, _) in drives.items())
    text, class_name = package(command, name, folder, "--at", at)
    words = [word for drive, (a, b) in drives.items() for word in ("--drive", f"{drive}={a}:{b}")]
    answer = jointplay(command, "move", name, *words, "--steps", str(STEPS), "--poses", cwd=folder)
    per_meter = {"mm": 1e3, "m": 1.0}[answer["units"]["length"]]
    per_radian = {"deg": 180 / math.pi, "rad": 1.0}[answer["units"]["angle"]]
    inputs = []
    for name_of_input, start, unit, drive in INPUT.findall(text):
        scale = {"m": per_meter, "rad": per_radian}[unit]
        a, b = (value / scale for value in drives[drive]) if drive in drives else (float(start),) * 2
        inputs.append(f"{name_of_input} = {a!r} + ({b - a!r})*time")
    model = f"{text}model Drive\n  {class_name}.Mechanism m({', '.join(inputs)});\nend Drive;\n"
    result = simulate(model, "Drive", STEPS)
    worst = 0.0
    for link, of_link in answer["poses"].items():
        kind = "frame" if f'Link frame_{identifier(link)} ' in text else "link"
        frame = f"m.{kind}_{identifier(link)}.frame"
        origin = next(value for key, value in of_link.items() if key.startswith("position"))
        off = matrix(result, f"{frame}.r", (3,), STEPS) - np.array(origin) / per_meter
        worst = max(worst, float(np.abs(off).max()))
        off = matrix(result, f"{frame}.axes.R", (3, 3), STEPS) - rotations(of_link["quaternion"])
        worst = max(worst, float(np.abs(off).max()))
    displacement = 0.0
    for joint in answer.get("largest_displacements", {}):
        (expected,) = (
            np.array(value) / per_meter for key, value in answer["series"].items() if key.startswith(f"{joint}_")
        )
        found = series(result, f"m.joint_{identifier(joint)}.q", STEPS)
        worst = max(worst, float(np.abs(found - expected).max()))
        displacement = max(displacement, float(np.abs(expected).max()))
    if not worst < TOLERANCE:
        sys.exit(f"{name}: Rumoca is off by {worst} over the drive")
    print(
        f"Modelica, {name}: {len(answer['poses'])} links and frames, displacements up to {1e6 * displacement:.1f} µm, "
        f"within {1e9 * worst:.3f} nm and nrad over the drive"
    )


def check_page(command: str, folder: Path) -> None:
    """The code of the page on simulators prints the displacements of jointplay."""
    page = (HERE.parent / "docs" / "how-to" / "export-to-simulators.md").read_text(encoding="utf-8")
    (block,) = [part[len("python\n") :] for part in page.split("```") if part.startswith("python\nimport rumoca")]
    out = folder / "page" / "modelica"
    jointplay(command, "export", "gpr-mechanism", "--to", "modelica", "--out", str(out))
    done = subprocess.run(
        [sys.executable, "-c", block], cwd=folder / "page", capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        sys.exit(f"the code of the page on Modelica fails: {done.stderr}")
    answer = jointplay(command, "assemble", "gpr-mechanism", "--at", "rod 1=3.1,rod 2=-1.55,rod 3=-1.55")
    expected = [1e3 * value for value in answer["virtual_joints"].values()]
    found = [float(word) for word in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", done.stdout)]
    if not np.allclose(found, expected, rtol=0, atol=1e6 * TOLERANCE):
        sys.exit(f"the code of the page on Modelica prints {done.stdout}, expected {expected} µm")


def check_catalogue(command: str, folder: Path) -> None:
    """Every mechanism compiles, and stays in its reference configuration; another parser reads its file."""
    entries = jointplay(command, "catalogue")["entries"]
    names = [entry["name"] for entry in entries if entry["kind"] == "mechanism"]
    worst = 0.0
    for name in names:
        text, class_name = package(command, name, folder)
        if pymoca.parser.parse(text) is None:
            sys.exit(f"{name}: pymoca does not parse the package")
        result = simulate(text, f"{class_name}.Reference", 2)
        for link in re.findall(r"^    Link (link_\w+) ", text, re.MULTILINE):
            for part, shape in (("r", (3,)), ("axes.R", (3, 3))):
                found = matrix(result, f"mechanism.{link}.frame.{part}", shape, 2)
                worst = max(worst, float(np.abs(found - found[0]).max()))
        if not worst < STILL:
            sys.exit(f"{name} moves by {worst} m from its reference configuration in Modelica")
    print(f"{len(names)} mechanisms compile, and stay within {1e9 * worst:.3f} nm of their reference")


def check(command: str, folder: Path) -> None:
    (folder / "table.toml").write_text(TABLE, encoding="utf-8")
    print(f"Rumoca {rumoca.version()}:")
    for name, drives in DRIVES.items():
        check_drive(command, name, drives, folder)
    check_page(command, folder)
    check_catalogue(command, folder)
