"""Assemblies that FreeCAD 1.0 or later makes, solves, saves and exports: fixtures of the importer.

    freecadcmd validation/golden/freecad_assemblies.py FOLDER

writes `freecad-crank.FCStd`, `freecad-crank.asmt`, `freecad-crank-poses.csv` and `freecad-constraints.asmt`.
The poses are those of FreeCAD's own solver, with the crank held at some angles.
"""

import math
import os
import sys

import FreeCAD as App
from FreeCAD import Placement, Rotation, Vector

sys.path.append(os.path.join(App.getHomePath(), "Mod", "Assembly"))
for folder in ("/usr/share/freecad/Mod/Assembly",):
    if os.path.isdir(folder):
        sys.path.append(folder)

import JointObject

X, Y, Z = Vector(1, 0, 0), Vector(0, 1, 0), Vector(0, 0, 1)


def at(x=0.0, y=0.0, z=0.0, axis=Z, degrees=0.0):
    return Placement(Vector(x, y, z), Rotation(axis, degrees))


class Drawing:
    """A document with one assembly."""

    def __init__(self, name):
        self.document = App.newDocument(name.replace("-", "_"))
        self.assembly = self.document.addObject("Assembly::AssemblyObject", "Assembly")
        self.assembly.Type, self.assembly.Label = "Assembly", name
        self.joints = self.assembly.newObject("Assembly::JointGroup", "Joints")

    def part(self, label, placement=Placement()):
        part = self.assembly.newObject("Part::Box", "Box")
        part.Label, part.Placement = label, placement
        return part

    def ground(self, part):
        joint = self.joints.newObject("App::FeaturePython", "GroundedJoint")
        JointObject.GroundedJoint(joint, part)
        return joint

    def joint(self, kind, label, one, other, element="Face1", **properties):
        """A joint between places of two parts: the frames are given, and not computed from the shapes."""
        joint = self.joints.newObject("App::FeaturePython", "Joint")
        JointObject.Joint(joint, JointObject.JointTypes.index(kind))
        joint.Label = label
        elements = element.split() if " " in element else [element, element]
        for number, ((part, placement), name) in enumerate(zip((one, other), elements), 1):
            setattr(joint, f"Detach{number}", True)
            setattr(joint, f"Reference{number}", [self.assembly, [f"{part.Name}.{name}", f"{part.Name}.Vertex1"]])
            setattr(joint, f"Placement{number}", placement)
        for name, value in properties.items():
            setattr(joint, name, value)
        return joint

    def solve(self):
        self.document.recompute()
        code = self.assembly.solve()
        if code != 0:
            raise RuntimeError(f"FreeCAD's solver returns {code}")

    def save(self, folder, export_only=False):
        path = os.path.join(folder, self.assembly.Label)
        if not export_only:
            self.document.saveAs(path + ".FCStd")
        self.assembly.exportAsASMT(path + ".asmt")
        App.closeDocument(self.document.Name)


def crank(folder):
    """A crank with a rod, a slide on a guide, a second slide at a distance, and two parts at angles to the crank."""
    drawing = Drawing("freecad-crank")
    start, along_x = 40.0, Rotation(Y, 90)
    frame = drawing.part("frame", at(3, -2, 1, Vector(1, 2, 2), 20))
    # Everything is drawn relative to the frame, which is not at the origin.
    base = frame.Placement
    pin = Vector(30 * math.cos(math.radians(start)), 30 * math.sin(math.radians(start)), 5)
    arm = drawing.part("crank", base * at(0, 0, 5, Z, start))
    rod = drawing.part("rod", base * Placement(pin, Rotation(Z, -12)))
    slide = drawing.part("slide", base * at(110, 0, 5))
    second = drawing.part("second slide", base * at(60, -10, 3))
    flap = drawing.part("flap", base * at(0, 50, 0, X, 50))
    vane = drawing.part("vane", base * at(0, 70, 0, X, 10))
    drawing.ground(frame)
    axis_x = lambda x, y, z: Placement(Vector(x, y, z), along_x)
    drive = drawing.joint("Revolute", "drive", (frame, at(0, 0, 5)), (arm, at()), EnableAngleMin=True, AngleMin=-170.0)
    drawing.joint("Ball", "pin", (arm, at(30)), (rod, at()))
    drawing.joint("Cylindrical", "eye", (rod, at(90)), (slide, at()))
    drawing.joint("Slider", "guide", (frame, axis_x(0, 0, 5)), (slide, axis_x(0, 0, 0)), EnableLengthMax=True, LengthMax=150.0)
    drawing.joint("Slider", "second guide", (frame, axis_x(0, -10, 3)), (second, axis_x(0, 0, 0)))
    drawing.joint("Distance", "wire", (arm, at(20)), (second, at()), "Vertex1", Distance=45.0)
    drawing.joint("Revolute", "flap hinge", (frame, axis_x(0, 50, 0)), (flap, axis_x(0, 0, 0)))
    drawing.joint("Perpendicular", "square", (arm, at(0, 0, 0, Y, 45)), (flap, at()))
    drawing.joint("Revolute", "vane hinge", (frame, axis_x(0, 70, 0)), (vane, axis_x(0, 0, 0)))
    drawing.joint("Angle", "tilt", (arm, at(0, 0, 0, Y, 45)), (vane, at()), Distance=60.0)
    drawing.solve()

    parts = (arm, rod, slide, second, flap, vane)
    drawn = [part.Placement for part in parts]
    first = (base.inverse() * arm.Placement).Rotation.toEuler()[0]
    rows = ["angle_rad,part,x_mm,y_mm,z_mm,q1,q2,q3,q4"]
    drive.Activated = False
    for degrees in (0, 6, 12, 18, 24, 30):
        arm.Placement = base * at(0, 0, 5, Z, first + degrees)
        held = drawing.ground(arm)
        drawing.solve()
        for part in parts:
            place, turn = part.Placement.Base, part.Placement.Rotation.Q
            numbers = ",".join(f"{value:.12g}" for value in (*place, *turn))
            rows.append(f"{math.radians(degrees):.15g},{part.Label},{numbers}")
        drawing.document.removeObject(held.Name)
    drive.Activated = True
    for part, placement in zip(parts, drawn):
        part.Placement = placement
    drawing.solve()
    with open(os.path.join(folder, "freecad-crank-poses.csv"), "w", encoding="utf-8") as file:
        file.write("\n".join(rows) + "\n")
    drawing.save(folder)


def constraints(folder):
    """A grounded part and one other for each constraint that is no joint by itself."""
    drawing = Drawing("freecad-constraints")
    ground = drawing.part("ground")
    drawing.ground(ground)
    one, other = at(1, 2, 3, Vector(1, 1, 0), 30), at(4, 5, 6, Vector(0, 1, 1), 50)
    for kind, name, element, distance in [
        ("Distance", "point in plane", "Face1 Vertex1", 3.0),
        ("Distance", "point near line", "Edge1 Vertex1", 3.0),
        ("Distance", "parallel lines", "Edge1 Edge1", 3.0),
        ("Distance", "line in plane", "Face1 Edge1", 3.0),
        ("Distance", "parallel planes", "Face1 Face1", 3.0),
        ("Parallel", "parallel axes", "Face1", 0.0),
        ("Perpendicular", "perpendicular axes", "Face1", 0.0),
        ("Angle", "axes at an angle", "Face1", 35.0),
    ]:
        part = drawing.part(name, at(7, 8, 9, Vector(1, 2, 3), 25))
        drawing.document.recompute()
        drawing.joint(kind, name, (ground, one), (part, other), element, Distance=distance)
    drawing.solve()
    drawing.save(folder, export_only=True)


def main():
    folder = os.path.abspath(os.environ.get("ASSEMBLIES", sys.argv[-1]))
    crank(folder)
    constraints(folder)
    print(f"written to {folder}")


main()
