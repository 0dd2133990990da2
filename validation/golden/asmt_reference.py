"""Assemblies in FreeCAD's ASMT format, and the positions that its solver finds along their motions.

    pip install pyondsel==0.0.3
    python asmt_reference.py

writes models/slider-crank.asmt, models/flipped-four-bar.asmt, models/cardan.asmt, models/gear-train.asmt, models/rack-and-screw.asmt and asmt-poses.csv (m, rad).
"""

import csv
import math
from pathlib import Path

from pyondsel.asmt_solver import AsmtSolver
from pyondsel.model.asmt_model import AsmtModel
from pyondsel.model.joint import Joint
from pyondsel.model.marker import Marker
from pyondsel.model.motion import Motion
from pyondsel.model.part import Part
from pyondsel.model.simulation import Simulation

HERE = Path(__file__).parent
FLIP = ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
# Its z is along x.
ALONG_X = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def turned(angle):
    c, s = math.cos(angle), math.sin(angle)
    return ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))


def model(name):
    # A quarter of a turn in ten steps.
    return AsmtModel(name=name, simulation=Simulation(0.0, 1.0, 10, h_max=0.1))


def slider_crank():
    """Exactly constrained: the coupler has balls at both ends but no spin, by a cylindrical joint."""
    a = model("slider-crank")
    a.add_ground_marker(Marker("pivot"))
    a.add_ground_marker(Marker("guide", (0.0, 0.0, 0.0), ALONG_X))
    crank = a.add_part(Part("crank", rotation=turned(math.pi / 2)))
    crank.add_marker(Marker("hub"))
    crank.add_marker(Marker("tip", (0.1, 0.0, 0.0)))
    reach = math.sqrt(0.3**2 - 0.1**2)
    coupler = a.add_part(Part("coupler", (0.0, 0.1, 0.0), turned(-math.asin(0.1 / 0.3))))
    coupler.add_marker(Marker("near"))
    coupler.add_marker(Marker("far", (0.3, 0.0, 0.0)))
    slider = a.add_part(Part("slider", (reach, 0.0, 0.0)))
    slider.add_marker(Marker("pin"))
    slider.add_marker(Marker("guided", (0.0, 0.0, 0.0), ALONG_X))
    a.add_joint(Joint("drive", "revolute", a.ground_path("pivot"), a.part_path("crank", "hub")))
    a.add_joint(Joint("tip", "revolute", a.part_path("crank", "tip"), a.part_path("coupler", "near")))
    a.add_joint(Joint("pin", "spherical", a.part_path("coupler", "far"), a.part_path("slider", "pin")))
    a.add_joint(Joint("guide", "translational", a.ground_path("guide"), a.part_path("slider", "guided")))
    a.add_motion(Motion("turn", "drive", f"{math.pi / 2} + 0.5*time"))
    return a, math.pi / 2


def four_bar():
    """A parallelogram with one joint whose second axis points in the opposite direction."""
    a = model("flipped-four-bar")
    a.add_ground_marker(Marker("left"))
    a.add_ground_marker(Marker("right", (0.3, 0.0, 0.0)))
    for name, x in [("crank", 0.0), ("rocker", 0.3)]:
        part = a.add_part(Part(name, (x, 0.0, 0.0), turned(math.pi / 2)))
        part.add_marker(Marker("foot"))
        part.add_marker(Marker("head", (0.1, 0.0, 0.0)))
    coupler = a.add_part(Part("coupler", (0.0, 0.1, 0.0)))
    coupler.add_marker(Marker("near"))
    coupler.add_marker(Marker("far", (0.3, 0.0, 0.0), FLIP))
    a.add_joint(Joint("drive", "revolute", a.ground_path("left"), a.part_path("crank", "foot")))
    a.add_joint(Joint("B", "revolute", a.part_path("crank", "head"), a.part_path("coupler", "near")))
    a.add_joint(Joint("C", "revolute", a.part_path("rocker", "head"), a.part_path("coupler", "far")))
    a.add_joint(Joint("D", "revolute", a.ground_path("right"), a.part_path("rocker", "foot")))
    a.add_motion(Motion("turn", "drive", f"{math.pi / 2} + 0.5*time"))
    return a, math.pi / 2


def cardan():
    """Two shafts at an angle, connected by a universal joint; the second part is drawn off its axis."""
    a = model("cardan")
    c, s = math.cos(0.5), math.sin(0.5)
    inclined = ((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c))
    along_y = ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0))
    a.add_ground_marker(Marker("near"))
    a.add_ground_marker(Marker("far", (0.0, -0.2 * s, 0.2 * c), inclined))
    first = a.add_part(Part("input"))
    first.add_marker(Marker("hub"))
    first.add_marker(Marker("cross", (0.0, 0.0, 0.0), ALONG_X))
    second = a.add_part(Part("output", (0.1, -0.2 * s, 0.2 * c), inclined))
    second.add_marker(Marker("cross", (-0.1, 0.0, -0.2), along_y))
    second.add_marker(Marker("bearing", (-0.1, 0.0, 0.0)))
    a.add_joint(Joint("drive", "revolute", a.ground_path("near"), a.part_path("input", "hub")))
    a.add_joint(Joint("cross", "universal", a.part_path("input", "cross"), a.part_path("output", "cross")))
    a.add_joint(Joint("bearing", "revolute", a.ground_path("far"), a.part_path("output", "bearing")))
    a.add_motion(Motion("turn", "drive", "0.5*time"))
    return a, 0.0


def gear_train():
    """A gear, a second one whose axis points in the opposite direction, a bevel gear on it, and a belt; parts are drawn off their axes."""
    a = model("gear-train")
    wheels = [("driver", (0.0, 0.0, 0.0), turned(0.3)), ("flipped", (0.3, 0.05, 0.0), FLIP)]
    wheels += [("bevel", (0.4, 0.05, 0.1), ALONG_X), ("pulley", (-0.5, 0.2, 0.1), turned(-1.0))]
    for name, place, rotation in wheels:
        a.add_ground_marker(Marker(f"{name} bearing", place, rotation))
        part = a.add_part(Part(name, place, rotation))
        part.add_marker(Marker("hub", (0.07, 0.02, 0.0)))
    for part, (_, place, rotation) in zip(a.parts, wheels):
        # The part lies such that its hub is in the bearing.
        hub = [sum(row[k] * (0.07, 0.02, 0.0)[k] for k in range(3)) for row in rotation]
        part.position = tuple(p - h for p, h in zip(place, hub))
    for name, _, _ in wheels:
        joint = "drive" if name == "driver" else f"{name} axle"
        a.add_joint(Joint(joint, "revolute", a.ground_path(f"{name} bearing"), a.part_path(name, "hub")))
    pairs = [("driver", "flipped", 0.1, 0.2), ("bevel", "flipped", 0.06, 0.15), ("driver", "pulley", 0.1, -0.08)]
    for first, second, i, j in pairs:
        ends = a.part_path(first, "hub"), a.part_path(second, "hub")
        a.add_joint(Joint(f"{first} and {second}", "gear", *ends, radius_i=i, radius_j=j))
    a.add_motion(Motion("turn", "drive", "0.5*time"))
    return a, 0.0


def rack_and_screw():
    """A pinion that moves a rack, and whose thread moves a nut; a lead screw in one cylindrical joint, driven by a gear."""
    a = model("rack-and-screw")
    a.add_ground_marker(Marker("bearing"))
    a.add_ground_marker(Marker("bed", (0.0, -0.05, 0.0), ALONG_X))
    a.add_ground_marker(Marker("post", (0.2, 0.0, 0.0)))
    a.add_ground_marker(Marker("beam", (0.0, 0.4, 0.0)))
    pinion = a.add_part(Part("pinion", (-0.05, 0.0, 0.0)))
    pinion.add_marker(Marker("hub", (0.05, 0.0, 0.0)))
    rack = a.add_part(Part("rack", (0.3, -0.05, 0.0)))
    rack.add_marker(Marker("guided", (-0.3, 0.0, 0.0), ALONG_X))
    # x is along the rack, against its slide.
    rack.add_marker(Marker("teeth", (-0.3, 0.0, 0.0), ((-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0))))
    nut = a.add_part(Part("nut", (0.2, 0.0, 0.1)))
    nut.add_marker(Marker("guided"))
    nut.add_marker(Marker("thread", (0.0, 0.0, 0.0), FLIP))
    screw = a.add_part(Part("screw", (0.02, 0.4, 0.0)))
    screw.add_marker(Marker("shaft", (-0.02, 0.0, 0.0)))
    a.add_joint(Joint("drive", "revolute", a.ground_path("bearing"), a.part_path("pinion", "hub")))
    a.add_joint(Joint("slide", "translational", a.ground_path("bed"), a.part_path("rack", "guided")))
    a.add_joint(Joint("lift", "translational", a.ground_path("post"), a.part_path("nut", "guided")))
    a.add_joint(Joint("spindle", "cylindrical", a.ground_path("beam"), a.part_path("screw", "shaft")))
    teeth, hub = a.part_path("rack", "teeth"), a.part_path("pinion", "hub")
    a.add_joint(Joint("teeth", "rack_pinion", teeth, hub, pitch_radius=0.05))
    a.add_joint(Joint("thread", "screw", a.part_path("nut", "thread"), hub, pitch=0.4))
    a.add_joint(Joint("pair", "gear", hub, a.part_path("screw", "shaft"), radius_i=0.01, radius_j=0.04))
    a.add_joint(Joint("lead", "screw", a.ground_path("beam"), a.part_path("screw", "shaft"), pitch=-0.3))
    a.add_motion(Motion("turn", "drive", "0.5*time"))
    return a, 0.0


def main():
    rows = []
    for assembly, start in [slider_crank(), four_bar(), cardan(), gear_train(), rack_and_screw()]:
        text = assembly.to_asmt()
        # The solver looks for lower case.
        for label in ["RadiusI", "RadiusJ", "PitchRadius", "Pitch"]:
            text = text.replace(f"\t{label}\n", f"\t{label[0].lower()}{label[1:]}\n")
        (HERE / "models" / f"{assembly.name}.asmt").write_text(text)
        found = AsmtSolver().solve(text)
        for path, part in found.parts.items():
            name = path.rsplit("/", 1)[-1]
            for k in (2, 5, len(found.times) - 1):
                rows.append([assembly.name, repr(0.5 * found.times[k]), name, *map(repr, part.positions[k])])
    with open(HERE / "asmt-poses.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["model", "turned_rad", "part", "x_m", "y_m", "z_m"])
        writer.writerows(rows)


main()
