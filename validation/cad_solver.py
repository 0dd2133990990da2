"""Compare positions along a drive with OndselSolver, the assembly solver of FreeCAD.

Two models are made and driven: a slider-crank, which is exactly constrained, and three vertical rods under a platform
with ball joints, which is overconstrained. The solver answers "solved" for both. For the first, the positions of all
parts are compared with those of `jointplay move`; for the second, the distance of each ball from its socket in the
solution is listed next to the displacements that `jointplay assemble` needs there, with virtual joints that move the
sockets radially, and in the plane.

    python -m pip install pyondsel==0.0.3
    python validation/cad_solver.py --jointplay target/release/jointplay

prints the tables of docs/explanation/cad-solvers.md.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import tempfile
from pathlib import Path

from pyondsel.model.asmt_model import AsmtModel
from pyondsel.model.joint import Joint
from pyondsel.model.marker import Marker
from pyondsel.model.motion import Motion
from pyondsel.model.part import Part
from pyondsel.model.simulation import Simulation
from pyondsel.trajectory import Trajectory

Vector = tuple[float, float, float]

# The robot of the catalogue: radius of the balls and height of the platform (m).
RADIUS, HEIGHT = 0.093218, 0.5
# Displacements of the rods at the end of the drive (m).
STROKES = (3.1e-3, -0.5e-3, -2.6e-3)
STEPS = 5
# Virtual joints of jointplay.
MODELS = ("radial", "planar")
# Its z is along x.
ALONG_X = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def slider_crank() -> AsmtModel:
    """A crank of 0.1 m, a coupler of 0.3 m with a ball at the slider; all joints are needed."""
    a = AsmtModel(name="slider-crank", simulation=Simulation(0.0, 1.0, STEPS, h_max=0.1))
    a.add_ground_marker(Marker("pivot"))
    a.add_ground_marker(Marker("guide", (0.0, 0.0, 0.0), ALONG_X))
    crank = a.add_part(Part("crank"))
    crank.add_marker(Marker("hub"))
    crank.add_marker(Marker("tip", (0.1, 0.0, 0.0)))
    coupler = a.add_part(Part("coupler", (0.1, 0.0, 0.0)))
    coupler.add_marker(Marker("near"))
    coupler.add_marker(Marker("far", (0.3, 0.0, 0.0)))
    slider = a.add_part(Part("slider", (0.4, 0.0, 0.0)))
    slider.add_marker(Marker("pin"))
    slider.add_marker(Marker("guided", (0.0, 0.0, 0.0), ALONG_X))
    a.add_joint(Joint("drive", "revolute", a.ground_path("pivot"), a.part_path("crank", "hub")))
    a.add_joint(Joint("tip", "revolute", a.part_path("crank", "tip"), a.part_path("coupler", "near")))
    a.add_joint(Joint("pin", "spherical", a.part_path("coupler", "far"), a.part_path("slider", "pin")))
    a.add_joint(Joint("guide", "translational", a.ground_path("guide"), a.part_path("slider", "guided")))
    a.add_motion(Motion("turn", "drive", "1.5*time"))
    return a


def socket(rod: int, height: float = HEIGHT, turned: float = 0.0) -> Vector:
    """Place of a socket, level, in an assembly turned about the vertical (m, rad)."""
    angle = rod * math.tau / 3 + turned
    return (RADIUS * math.cos(angle), RADIUS * math.sin(angle), height)


def three_rods(turned: float = 0.0) -> AsmtModel:
    """Three rods that slide along z, each with a ball joint under the platform."""
    a = AsmtModel(name="three-rods", simulation=Simulation(0.0, 1.0, STEPS, h_max=0.1))
    platform = a.add_part(Part("platform", (0.0, 0.0, HEIGHT)))
    for rod in range(3):
        a.add_ground_marker(Marker(f"guide{rod}", socket(rod, HEIGHT, turned)))
        part = a.add_part(Part(f"rod{rod}", socket(rod, HEIGHT, turned)))
        part.add_marker(Marker("end"))
        platform.add_marker(Marker(f"ball{rod}", socket(rod, 0.0, turned)))
        end = a.part_path(f"rod{rod}", "end")
        a.add_joint(Joint(f"slide{rod}", "translational", a.ground_path(f"guide{rod}"), end))
        a.add_joint(Joint(f"ball{rod}", "spherical", end, a.part_path("platform", f"ball{rod}")))
        a.add_motion(Motion(f"drive{rod}", f"slide{rod}", f"{STROKES[rod]}*time", kind="translational"))
    return a


def rotation(bryant: Vector) -> list[list[float]]:
    """Rotation by angles about x, then the turned y, then the turned z."""
    (sa, sb, sc), (ca, cb, cc) = ([f(angle) for angle in bryant] for f in (math.sin, math.cos))
    return [
        [cb * cc, -cb * sc, sb],
        [ca * sc + sa * sb * cc, ca * cc - sa * sb * sc, -sa * cb],
        [sa * sc - ca * sb * cc, sa * cc + ca * sb * sc, ca * cb],
    ]


def gaps(found: Trajectory, k: int, turned: float = 0.0) -> list[float]:
    """Distance of each ball from its socket in a frame of the solution (m)."""
    parts = {path.rsplit("/", 1)[-1]: part for path, part in found.parts.items()}
    turn, centre = rotation(parts["platform"].bryant_angles[k]), parts["platform"].positions[k]
    distances = []
    for rod in range(3):
        local = socket(rod, 0.0, turned)
        ball = [centre[i] + sum(turn[i][j] * local[j] for j in range(3)) for i in range(3)]
        distances.append(math.dist(ball, parts[f"rod{rod}"].positions[k]))
    return distances


def answer(command: str, *arguments: object) -> dict[str, object]:
    """The JSON of a jointplay command."""
    words = [command, "--quiet", *map(str, arguments), "--format", "json"]
    return json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)


def main() -> None:
    """Print both tables."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--jointplay", default="jointplay", help="the command")
    command = options.parse_args().jointplay

    model = slider_crank()
    found = model.solve()
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "slider-crank.asmt"
        file.write_text(model.to_asmt())
        imported = file.with_suffix(".toml")
        answer(command, "import", file, "--units", "m", "--out", imported)
        drive = f"drive=0:{1.5 * found.times[-1]!r}"
        moved = answer(command, "move", imported, "--drive", drive, "--steps", len(found.times) - 1, "--poses")
    differences = [
        abs(a - b)
        for path, part in found.parts.items()
        for ours, theirs in zip(moved["poses"][path.rsplit("/", 1)[-1]]["position"], part.positions, strict=True)
        for a, b in zip(ours, theirs, strict=True)
    ]
    print(f"slider-crank, {len(found.times)} frames: positions differ by at most {max(differences):.1e} m")
    print()

    found = three_rods().solve()
    balls = ["ball 1", "ball 2", "ball 3"]
    columns = [f"{source}: {ball}" if ball == balls[0] else ball for source in ("solver", *MODELS) for ball in balls]
    print("| drive | " + " | ".join(columns) + " |")
    print("| --- " * 10 + "|")
    with tempfile.TemporaryDirectory() as scratch:
        robots = {name: Path(scratch) / f"{name}.toml" for name in MODELS}
        for name, file in robots.items():
            answer(command, "import", "gpr", "--virtualization", name, "--out", file)
        for k, share in enumerate(found.times):
            row = gaps(found, k)
            at = ",".join(f"rod {rod + 1}={share * stroke!r}" for rod, stroke in enumerate(STROKES))
            for file in robots.values():
                # One number for each ball, or two.
                play = [*answer(command, "assemble", file, "--at", at).get("virtual_joints", {}).values()] or [0.0] * 3
                size = len(play) // 3
                row += [math.hypot(*play[size * rod : size * rod + size]) for rod in range(3)]
            print(f"| {100 * share:.0f} % | " + " | ".join(f"{1e6 * gap:.1f}" for gap in row) + " |")
    print()
    print("| assembly turned by | ball 1 | ball 2 | ball 3 |")
    print("| --- | --- | --- | --- |")
    for degrees in (0, 45, 120):
        turned = math.radians(degrees)
        row = gaps(three_rods(turned).solve(), -1, turned)
        print(f"| {degrees}° | " + " | ".join(f"{1e6 * gap:.1f}" for gap in row) + " |")


if __name__ == "__main__":
    main()
