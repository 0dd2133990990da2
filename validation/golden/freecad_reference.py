"""An assembly as FreeCAD 1.x saves it (FCStd) and exports it (ASMT), with all places computed by FreeCAD.

    apt-get install freecad-python3
    freecadcmd freecad_reference.py

writes models/crank-press.FCStd and models/crank-press.asmt.

Debian 12 has FreeCAD 0.20.2, which writes the same properties but has no Assembly workbench:
the types of the objects of that workbench are written into the saved file.
"""

import math
import os
import zipfile

import FreeCAD as App
from FreeCAD import Placement, Rotation, Vector

try:
    HERE = os.path.dirname(os.path.abspath(__file__))
except NameError:  # freecadcmd does not define it in every version
    HERE = os.path.join(os.getcwd(), "validation", "golden")
FLIP = Placement(Vector(), Rotation(Vector(1, 0, 0), 180))
# Everything is drawn in an inclined plane, so that no number is 0 by accident.
PLANE = Placement(Vector(40, -25, 10), Rotation(Vector(1, 2, 3), 50))
JOINT_TYPES = ["Fixed", "Revolute", "Cylindrical", "Slider", "Ball", "Distance", "Parallel",
               "Perpendicular", "Angle", "RackPinion", "Screw", "Gears", "Belt"]


def place(x, y, angle=0.0, z=0.0):
    return PLANE * Placement(Vector(x, y, z), Rotation(Vector(0, 0, 1), math.degrees(angle)))


def property_of(thing, kind, name, value):
    thing.addProperty("App::Property" + kind, name, "Joint", "")
    setattr(thing, name, value)


class Press:
    """A crank, a rod and a carriage that slides on a frame."""

    def __init__(self):
        self.document = App.newDocument("press")
        self.assembly = self.document.addObject("App::Part", "Assembly")
        self.assembly.Label = "crank press"
        self.joints = self.document.addObject("App::DocumentObjectGroup", "Joints")
        self.assembly.addObject(self.joints)
        self.parts, self.rows = {}, []
        # Angles of crank and rod, as drawn.
        self.crank, self.rod = 0.7, -math.asin(30 * math.sin(0.7) / 90)
        self.reach = 30 * math.cos(self.crank) + 90 * math.cos(self.rod)

    def add(self, kind, name, label, placement, within=None):
        made = self.document.addObject(kind, name)
        made.Label = label
        (within or self.assembly).addObject(made)
        made.Placement = placement
        return made

    def add_parts(self):
        box = self.document.addObject("Part::Box", "Box")
        box.Length, box.Width, box.Height = 30, 6, 4
        column = self.document.addObject("App::Part", "Column")
        inside = self.add("Part::Box", "Beam", "Beam", Placement(Vector(1, 2, 3), Rotation(20, 30, 40)), column)
        # A part with a body in it, a link to a solid, a link to a part, and a sub-assembly.
        self.frame = self.add("App::Part", "Frame", "frame", place(-12, 5, 0.3, -6))
        self.add("Part::Cylinder", "Post", "Post", Placement(Vector(5, -3, 2), Rotation(10, 70, -20)), self.frame)
        self.crank_link = self.add("App::Link", "Crank", "crank ø6", place(0, 0, self.crank))
        self.crank_link.LinkedObject = box
        pin = place(30 * math.cos(self.crank), 30 * math.sin(self.crank), self.rod, 5)
        self.rod_link = self.add("App::Link", "Rod", "rod", pin)
        self.rod_link.LinkedObject = column
        self.carriage = self.add("App::Part", "Carriage", "carriage", place(self.reach, 0, 0.1, 2))
        property_of(self.carriage, "Bool", "Rigid", True)
        shoe = self.document.addObject("App::Link", "Shoe")
        shoe.LinkedObject = box
        self.carriage.addObject(shoe)
        shoe.Placement = Placement(Vector(0, 4, -1), Rotation(0, 15, 90))
        # Path of a place in the assembly, the moving part, and from it to the object of the place.
        self.places = {
            "frame": ("Frame.Post.Face1", self.frame, self.document.Post.Placement),
            "crank": ("Crank.Face3", self.crank_link, Placement()),
            "rod": ("Rod.Beam.Edge2", self.rod_link, inside.Placement),
            "carriage": ("Carriage.Shoe.Vertex1", self.carriage, shoe.Placement),
        }
        spare = self.add("Part::Box", "Spare", "spare", Placement())
        spare.Length = 2

    def ground(self, part, label):
        made = self.document.addObject("App::FeaturePython", "GroundedJoint")
        made.Label = label
        property_of(made, "Link", "ObjectToGround", part)
        property_of(made, "Placement", "Placement", part.Placement)
        self.joints.addObject(made)
        self.rows.append(("FixedJoint", label, [("", "ground", part.Placement), (part.Label, "fixing", Placement())]))

    def joint(self, label, kind, first, second, at, turned=Placement(), limits=None, suppressed=False):
        """A joint whose frames coincide at a place of the assembly, the second after a turn."""
        made = self.document.addObject("App::FeaturePython", "Joint")
        made.Label = label
        made.addProperty("App::PropertyEnumeration", "JointType", "Joint", "")
        made.JointType = JOINT_TYPES
        made.JointType = kind
        ends = []
        for number, (name, turn) in enumerate([(first, Placement()), (second, turned)], 1):
            path, part, within = self.places[name]
            property_of(made, "XLinkSub", f"Reference{number}", (self.assembly, [path, path]))
            in_object = (part.Placement * within).inverse() * at * turn
            property_of(made, "Placement", f"Placement{number}", in_object)
            # Part of the placement already.
            property_of(made, "Placement", f"Offset{number}", Placement(Vector(0, 0, 1), Rotation()))
            property_of(made, "Bool", f"Detach{number}", False)
            ends.append((part.Label, label, part.Placement.inverse() * at * turn))
        property_of(made, "Float", "Distance", 0.0)
        property_of(made, "Bool", "Activated", not suppressed)
        for name in ["LengthMin", "LengthMax", "AngleMin", "AngleMax"]:
            property_of(made, "Bool", "Enable" + name, name in (limits or {}))
            property_of(made, "Float", name, (limits or {}).get(name, 0.0))
        self.joints.addObject(made)
        if not suppressed:
            asmt = {"Revolute": "RevoluteJoint", "Cylindrical": "CylindricalJoint",
                    "Slider": "TranslationalJoint", "Ball": "SphericalJoint"}[kind]
            self.rows.append((asmt, label, ends, limits or {}))
        return made

    def motion(self, joint):
        simulation = self.document.addObject("App::FeaturePython", "Simulation")
        motion = self.document.addObject("App::FeaturePython", "Motion")
        motion.addProperty("App::PropertyEnumeration", "MotionType", "Motion", "")
        motion.MotionType = ["Angular", "Linear"]
        property_of(motion, "XLinkSub", "Joint", (joint, [""]))
        property_of(motion, "String", "Formula", "0.7 + 5*time")
        property_of(simulation, "LinkList", "Group", [motion])
        self.assembly.addObject(simulation)
        self.driven = joint.Label

    def save(self):
        self.document.recompute()
        plain = os.path.join(HERE, "models", "plain.FCStd")
        self.document.saveAs(plain)
        types = [
            ('type="App::Part" name="Assembly"', 'type="Assembly::AssemblyObject" name="Assembly"'),
            ('type="App::Part" name="Carriage"', 'type="Assembly::AssemblyLink" name="Carriage"'),
            ('type="App::DocumentObjectGroup" name="Joints"', 'type="Assembly::JointGroup" name="Joints"'),
            ('type="App::PropertyXLinkSub"', 'type="App::PropertyXLinkSubHidden"'),
        ]
        target = os.path.join(HERE, "models", "crank-press.FCStd")
        with zipfile.ZipFile(plain) as old, zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as new:
            for name in old.namelist():
                content = old.read(name)
                if name == "Document.xml":
                    text = content.decode()
                    for before, after in types:
                        assert before in text, before
                        text = text.replace(before, after)
                    content = text.encode()
                new.writestr(name, content)
        os.remove(plain)

    def export(self):
        """The text of FreeCAD's *Export ASMT*, with limits and a motion by the markers of their joints."""
        lines = []

        def add(level, *texts):
            lines.extend("\t" * level + text for text in texts)

        def pose(level, placement):
            add(level, "Position3D", "\t" + "\t".join(repr(x) for x in placement.Base) + "\t", "RotationMatrix")
            columns = [placement.Rotation.multVec(Vector(*axis)) for axis in [(1, 0, 0), (0, 1, 0), (0, 0, 1)]]
            for k in range(3):
                add(level, "\t" + "\t".join(repr(column[k]) for column in columns) + "\t")

        def points(level, part):
            add(level, "RefPoints")
            for _, _, ends, *_ in self.rows:
                for owner, name, placement in ends:
                    if owner == part:
                        add(level + 1, "RefPoint")
                        pose(level + 2, Placement())
                        add(level + 2, "Markers", "\tMarker", "\t\tName", "\t\t\t" + name)
                        pose(level + 4, placement)

        add(0, "OndselSolver", "Assembly")
        add(1, "Notes", "\t", "Name", "\tcrank press")
        pose(1, Placement())
        points(1, "")
        add(1, "Parts")
        for part in [self.frame, self.crank_link, self.rod_link, self.carriage]:
            add(2, "Part", "\tName", "\t\t" + part.Label)
            pose(3, part.Placement)
            points(3, part.Label)
        add(1, "KinematicIJs", "ConstraintSets", "\tJoints")

        def block(kind, name, ends, *more):
            add(3, kind, "\tName", "\t\t" + name)
            for label, (owner, marker, _) in zip(["MarkerI", "MarkerJ"], ends):
                path = "/".join(["", "crank press", *([owner] if owner else []), marker])
                add(4, label, "\t" + path)
            for label, value in more:
                add(4, label, "\t" + value)

        for kind, name, ends, *_ in self.rows:
            block(kind, name, ends)
        add(2, "Motions")
        for kind, name, ends, *_ in self.rows:
            if name == self.driven:
                block("RotationalMotion", name + "-AngularMotion", ends, ("MotionJoint", ""), ("RotationZ", "0.7 + 5*time"))
        add(2, "Limits")
        for _, name, ends, *limits in self.rows:
            for key, value in (limits[0] if limits else {}).items():
                kind = "TranslationLimit" if key.startswith("Length") else "RotationLimit"
                text = f"{value:f}" if key.startswith("Length") else f"{value:f}*pi/180.0"
                end = "=>" if key.endswith("Min") else "=<"
                block(kind, f"{name}-Limit{key}", ends, ("MotionJoint", ""), ("Limit", text), ("Type", end), ("Tol", "1.0e-9"))
        add(2, "GeneralConstraintSets")
        with open(os.path.join(HERE, "models", "crank-press.asmt"), "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")


def main():
    press = Press()
    press.add_parts()
    press.ground(press.frame, "grounded")
    pin = press.rod_link.Placement
    eye = place(press.reach, 0, press.rod, 5)
    along = place(press.reach, 0) * Placement(Vector(), Rotation(Vector(0, 1, 0), 90))
    drive = press.joint("drive", "Revolute", "frame", "crank", place(0, 0, 0.2),
                        Placement(Vector(), Rotation(Vector(0, 0, 1), math.degrees(0.5))),
                        {"AngleMin": -170.0, "AngleMax": 175.5})
    press.joint("pin", "Revolute", "crank", "rod", pin, FLIP, {"AngleMin": -20.0})
    press.joint("eye", "Cylindrical", "rod", "carriage", eye, Placement(Vector(0, 0, 1.25), Rotation()),
                {"LengthMin": -3.0, "LengthMax": 4.5, "AngleMin": -60.0, "AngleMax": 60.0})
    press.joint("slide", "Slider", "frame", "carriage", along, limits={"LengthMin": -40.0, "LengthMax": 25.25})
    press.joint("old guide", "Ball", "frame", "carriage", eye, suppressed=True)
    press.motion(drive)
    press.save()
    press.export()
    print("written")


main()
