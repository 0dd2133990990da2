"""Hold exported motions of cells to what other programs read of them.

Exports the example cell's motion with the `jointplay` command, and reads it back by the glTF validator, the MCAP
reader with its decoder for ROS 2, and Arrow's reader of Parquet; what they read is compared with the CSV.
In the same environment it runs `cell_poses.py`, which compares poses in tables with the scene and a
chain, `distances.py`, which compares the collision check with another library, and
`simulators.py`, which compares exported mechanisms with MuJoCo and with a compiler of Modelica, and animated parts with
the poses of their links.
Everything that it makes and downloads is in `target/cell`.

Run by `cargo xtask cell`; with `--prepare` it only fetches those readers.
"""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
HOME = ROOT / "target" / "cell"
PACKAGES = [
    "cascadio==0.1.1",
    "coal==3.0.3",
    "mcap==1.6.0",
    "mcap-ros2-support==0.6.0",
    "mujoco==4.0.0",
    "numpy==2.2.6",
    "pyarrow==26.0.1",
    "pymoca==0.12.0",
    "rumoca==0.10.2",
]
VALIDATOR = "gltf-validator@2.0.0-dev.3.10"
RATE = 50

# A program of one wafer for the example cell, by both arms.
PROGRAM = """HOME
TRANSFER LP1 SLOT 1 TO PM1 WITH A
TRANSFER PM1 TO LP2 SLOT 25 WITH B
HOME
"""

# Report of the glTF validator on a file, as JSON.
VALIDATE = """
const validator = require('gltf-validator');
const bytes = new Uint8Array(require('fs').readFileSync(process.argv[1]));
validator.validateBytes(bytes, { maxIssues: 100 }).then((report) => console.log(JSON.stringify(report)));
"""


def run(command: list[str | Path], **options: object) -> str:
    """The standard output of a command; if it fails, so does this program."""
    words = [str(part) for part in command]
    done = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=False, **options)  # type: ignore[call-overload]
    if done.returncode != 0:
        sys.exit(f"failed with exit code {done.returncode}: {' '.join(words)}\n{done.stdout}")
    return done.stdout


def environment() -> Path:
    """A Python of our own with the readers; made once."""
    folder = HOME / "python"
    binaries = folder / ("Scripts" if os.name == "nt" else "bin")
    mark, wanted = folder / "packages.txt", "\n".join(PACKAGES)
    if not mark.exists() or mark.read_text() != wanted:
        venv.create(folder, with_pip=True, clear=True)
        run([binaries / "python", "-m", "pip", "install", "--quiet", "--no-compile", *PACKAGES])
        mark.write_text(wanted)
    return binaries / "python"


def validator() -> Path:
    """The folder with the glTF validator; installed once."""
    folder = HOME / "node"
    mark = folder / "package.txt"
    if not mark.exists() or mark.read_text() != VALIDATOR:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "package.json").write_text('{ "private": true }\n')
        npm = "npm.cmd" if os.name == "nt" else "npm"
        run([npm, "install", "--no-progress", "--no-audit", "--no-fund", "--silent", VALIDATOR], cwd=folder)
        mark.write_text(VALIDATOR)
    return folder


def same(what: str, found: float, expected: float, threshold: float) -> None:
    if not abs(found - expected) <= threshold:
        sys.exit(f"{what}: {found!r}, expected {expected!r} within {threshold!r}")


def validate(path: Path) -> dict:
    """The report of the glTF validator."""
    return json.loads(run(["node", "--eval", VALIDATE, path.resolve()], cwd=validator()))


def check_gltf(path: Path, duration: float) -> str:
    """The validator finds nothing at all, and the animation lasts as long as the motion."""
    report = validate(path)
    issues = report["issues"]
    if issues["messages"]:
        sys.exit(f"report of the glTF validator on {path.name}:\n{json.dumps(issues['messages'], indent=2)}")
    data = path.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    document = json.loads(data[20 : 20 + length])
    (animation,) = document["animations"]
    accessors = document["accessors"]
    ends = {accessors[sampler["input"]]["max"][0] for sampler in animation["samplers"]}
    for end in ends:
        same("the end of the glTF animation", end, duration, 1e-6 * duration)
    if document["asset"]["extras"]["duration_s"] != duration:
        sys.exit("glTF does not state the duration of the motion")
    info = report["info"]
    return f"{info['animationCount']} animation, {info['totalTriangleCount']} triangles"


def inside(folder: Path) -> None:
    """Read by programs that are not ours; runs in the environment of its own."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory
    from pyarrow import parquet

    with (folder / "example.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    table = parquet.read_table(folder / "example.parquet")
    names = list(rows[0])
    if table.column_names != names or table.num_rows != len(rows):
        sys.exit(f"Parquet has {table.num_rows} rows of {table.column_names}, CSV {len(rows)} of {names}")
    for name in names:
        if [float(row[name]) for row in rows] != [float(value) for value in table[name].to_pylist()]:
            sys.exit(f"column {name} is not the same in Parquet and in CSV")

    degrees = 3.141592653589793 / 180
    state, points, ends, frames = 0, 0, 0.0, set()
    with (folder / "example.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _schema, channel, message, decoded in reader.iter_decoded_messages():
            if channel.topic == "/joint_states":
                row = rows[state]
                stamp = decoded.header.stamp.sec + 1e-9 * decoded.header.stamp.nanosec
                same("the time of a joint state", stamp, float(row["time_s"]), 1e-9)
                same("the time of its message", 1e-9 * message.log_time, stamp, 1e-9)
                for name, position, speed in zip(decoded.name, decoded.position, decoded.velocity):
                    turns = f"{name}_deg" in row
                    unit, scale = ("deg", degrees) if turns else ("mm", 1e-3)
                    same(f"the position of {name}", position, scale * float(row[f"{name}_{unit}"]), 1e-12)
                    same(f"the speed of {name}", speed, scale * float(row[f"{name}_{unit}_per_s"]), 1e-12)
                state += 1
            elif channel.topic == "/joint_trajectory":
                last = decoded.points[-1].time_from_start
                ends += last.sec + 1e-9 * last.nanosec
                points += len(decoded.points)
            elif channel.topic == "/tf":
                frames.update(transform.child_frame_id for transform in decoded.transforms)
    if state != len(rows):
        sys.exit(f"MCAP has {state} joint states, CSV {len(rows)} rows")
    duration = float(rows[-1]["time_s"])
    same("the durations of all trajectories together", ends, duration, 1e-6)
    if not {"platform", "q1"} <= frames:
        sys.exit(f"frames are missing among {sorted(frames)}")
    print(f"{len(rows)} rows of {len(names)} columns, {points} points of trajectories, {len(frames)} frames")


def prepare() -> Path:
    """The Python with the readers; all that is fetched is there."""
    HOME.mkdir(parents=True, exist_ok=True)
    validator()
    return environment()


def main() -> None:
    command = Path(sys.argv[1]).resolve()
    python = prepare()
    with tempfile.TemporaryDirectory() as temporary:
        program, folder = Path(temporary) / "one.program", Path(temporary) / "out"
        program.write_text(PROGRAM)
        kinds = "csv,parquet,gltf,mcap,solidworks,text"
        line: list[str | Path] = [command, "cell", "export", "example", program, "--to", kinds]
        line += ["--rate", str(RATE), "--out", folder]
        report = json.loads(run([*line, "--format", "json"]))
        print(run([python, __file__, "--inside", folder]), end="")
        poses = Path(temporary) / "poses"
        line = [command, "cell", "export", "example", program, "--to", "csv,gltf", "--rate", "32", "--out", poses]
        run([*line, "--poses"])
        print(run([python, Path(__file__).with_name("cell_poses.py"), poses]), end="")
        duration = report["duration_s"]
        with (folder / "example.csv").open() as file:
            same("the last row of the CSV", float(file.readlines()[-1].split(",")[0]), duration, 0.0)
        for motor in folder.glob("motor-*.csv"):
            last = motor.read_text().splitlines()[-1]
            same(f"the last line of {motor.name}", float(last.split(",")[0]), duration, 0.0)
        end = (folder / "example-neutral.txt").read_text().splitlines()[-1]
        same("the end of the controller text", float(end.split()[1]), duration, 5e-7)
        print(check_gltf(folder / "example.glb", duration))
    print(f"all of them last {duration} s")
    print(run([python, Path(__file__).with_name("distances.py"), command]), end="")
    print(run([python, __file__, "--simulators", command]), end="")


if __name__ == "__main__":
    if sys.argv[1] == "--inside":
        inside(Path(sys.argv[2]))
    elif sys.argv[1] == "--simulators":
        import simulators

        simulators.check(sys.argv[2], validate)
    elif sys.argv[1] == "--prepare":
        prepare()
    else:
        main()
