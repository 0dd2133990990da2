"""Tests of the workbench in FreeCAD without a window.

    apt-get install freecad-python3
    python3 -m venv env && env/bin/pip install jointplay
    freecadcmd -P $(echo env/lib/python3*/site-packages) freecad/workbench_tests.py

The exit code is 0 if all passed. Assemblies are made here: of the Assembly workbench of FreeCAD 1.0 and later, or as that workbench has them, for FreeCAD 0.20 of Debian 12.
"""

import importlib.util
import math
import os
import sys
import tempfile
import time
import traceback
import zipfile
from unittest.mock import MagicMock

import FreeCAD as App
import freecad
import numpy as np
import Part
from FreeCAD import Placement, Rotation, Vector

HERE = os.path.dirname(os.path.abspath(__file__)) if "__file__" in globals() else os.path.abspath("freecad")
freecad.__path__.append(os.path.join(HERE, "freecad"))

import jointplay as jp
from freecad.jointplay import analysis, linkage as linkages

#: Whether FreeCAD has the Assembly workbench.
HAS_ASSEMBLIES = importlib.util.find_spec("AssemblyApp") is not None
if HAS_ASSEMBLIES:
    importlib.import_module("AssemblyApp")
#: Agreement of the CAD kernel with jointplay (mm): 1 nm.
NANOMETRE = 1e-6
#: Radii of the pins of the platform and of the sockets of the rods (mm).
PIN, SOCKET = 1.0, 4.0


def centres():
    """Centres of the balls of the level robot (mm)."""
    angles = np.arange(3) * 2 * math.pi / 3
    return np.array([[93.218 * math.cos(a), 93.218 * math.sin(a), 500.0] for a in angles])


def robot():
    """A document with a base, three rods with sockets and a platform with three pins, drawn level, not at the origin."""
    document = App.newDocument("robot")
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    # Parts are drawn in frames of their own, which are not those of the links.
    own = Placement(Vector(7, -3, 11), Rotation(Vector(1, 2, 3), 40))
    balls = [Vector(*centre) for centre in centres().tolist()]

    def add(label, shapes):
        part = document.addObject("Part::Feature", "Body")
        part.Label = label
        moved = [shape.copy() for shape in shapes]
        for shape in moved:
            shape.Placement = own.inverse() * shape.Placement
        part.Shape = Part.makeCompound(moved)
        part.Placement = own

    def sphere(radius, centre):
        made = Part.makeSphere(radius)
        made.Placement = Placement(centre, Rotation())
        return made.Shells[0]

    add("base", [Part.makeBox(200, 200, 10, Vector(-100, -100, -10))])
    add("platform", [sphere(PIN, centre) for centre in balls])
    for number, centre in enumerate(balls, 1):
        add(f"rod {number}", [sphere(SOCKET, centre)])
    document.recompute()
    return document, mechanism


def chain(parts):
    """A document with an assembly of a chain of links that closes in a loop of parallel axes, as FreeCAD 1.x has it."""
    document = App.newDocument("chain")
    if HAS_ASSEMBLIES:
        assembly = document.addObject("Assembly::AssemblyObject", "Assembly")
        joints = assembly.newObject("Assembly::JointGroup", "Joints")
    else:
        assembly = document.addObject("App::Part", "Assembly")
        joints = document.addObject("App::DocumentObjectGroup", "Joints")
        assembly.addObject(joints)
    box = document.addObject("Part::Box", "Box")
    corners = [Vector(100 * math.cos(a), 100 * math.sin(a), 0) for a in np.arange(parts) * 2 * math.pi / parts]
    links = []
    for number, corner in enumerate(corners):
        link = document.addObject("App::Link", "Link")
        link.LinkedObject, link.Label = box, f"bar {number}"
        assembly.addObject(link)
        link.Placement = Placement(corner, Rotation(Vector(0, 0, 1), 360 * number / parts))
        links.append(link)
    ground = document.addObject("App::FeaturePython", "Ground")
    ground.addProperty("App::PropertyLink", "ObjectToGround")
    ground.ObjectToGround = links[0]
    joints.addObject(ground)
    for number in range(parts):
        joint = document.addObject("App::FeaturePython", "Joint")
        joint.Label = f"hinge {number}"
        joint.addProperty("App::PropertyEnumeration", "JointType")
        joint.JointType = ["Fixed", "Revolute"]
        joint.JointType = "Revolute"
        at = Placement(corners[number], Rotation())
        for end, link in enumerate([links[number - 1], links[number]], 1):
            # A hidden reference of a joint to its own assembly is no cycle.
            hidden = "Hidden" if HAS_ASSEMBLIES else ""
            joint.addProperty(f"App::PropertyXLinkSub{hidden}", f"Reference{end}")
            setattr(joint, f"Reference{end}", (assembly, [f"{link.Name}.Face1"]))
            joint.addProperty("App::PropertyPlacement", f"Placement{end}")
            setattr(joint, f"Placement{end}", link.Placement.inverse() * at)
        joints.addObject(joint)
    document.recompute()
    return document


class SavedAsAssembly:
    """A document that is saved with the object types of the Assembly workbench."""

    def __init__(self, document):
        self.document = document

    def __getattr__(self, name):
        return getattr(self.document, name)

    def saveCopy(self, path):
        if HAS_ASSEMBLIES:
            self.document.saveCopy(path)
            return
        plain = path.replace("copy", "plain")
        self.document.saveCopy(plain)
        with zipfile.ZipFile(plain) as old, zipfile.ZipFile(path, "w") as new:
            text = old.read("Document.xml").decode()
            text = text.replace('type="App::Part" name="Assembly"', 'type="Assembly::AssemblyObject" name="Assembly"')
            new.writestr("Document.xml", text)


def is_same(first, second):
    """Whether two placements agree to round-off (mm)."""
    return np.abs(np.array(first.toMatrix().A) - np.array(second.toMatrix().A)).max() < 1e-9


def gaps(linkage):
    """Distances between pins and their sockets, as the CAD kernel measures them, each a displacement (mm)."""
    pins = linkage.parts["platform"].Shape.Shells
    found = []
    for number, pin in enumerate(pins, 1):
        socket = linkage.parts[f"rod {number}"].Shape.Shells[0]
        found.append(SOCKET - PIN - pin.distToShape(socket)[0])
    return np.array(found)


def test_the_gap_that_the_kernel_sees_is_the_play():
    document, mechanism = robot()
    linkage = linkages.linkage(document, mechanism)
    assert linkage.unmatched == [], linkage.unmatched
    assert np.abs(gaps(linkage)).max() < NANOMETRE
    configurations = analysis.drive(mechanism, {"rod 1": 3.1, "rod 2": -1.55, "rod 3": -1.55}, steps=10)
    # Virtual joints follow the joints.
    virtual = slice(len(mechanism.coordinate_names), None)
    largest = 0.0
    for number in analysis.play(linkage, configurations):
        play = np.abs(1000 * configurations[number, virtual])
        seen = gaps(linkage)
        assert np.abs(seen - play).max() < NANOMETRE, (number, seen - play)
        largest = max(largest, np.abs(seen - play).max())
    assert play.max() > 0.01, play
    print(f"    largest play {1000 * play.max():.3f} µm, kernel and jointplay differ by {1e6 * largest:.4f} nm")
    # Ten times the play: the kernel sees what the exaggerated poses of jointplay are.
    linkage.show(configurations[-1], 10.0)
    expected = []
    for number, centre in enumerate(centres(), 1):
        at = [linkage.mechanism.link_poses(configurations[-1], link, exaggerate=10.0)
              @ np.linalg.inv(linkage.reference[link]) @ np.array([*centre / 1000, 1.0])
              for link in ["platform", f"rod {number}"]]
        expected.append(1000 * np.linalg.norm(at[0] - at[1]))
    assert np.abs(gaps(linkage) - expected).max() < NANOMETRE, (gaps(linkage), expected)
    assert max(expected) > 3 * play.max()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "moved.FCStd")
        linkage.show(configurations[-1])
        document.saveCopy(path)
        again = App.openDocument(path)
        (platform,) = again.getObjectsByLabel("platform")
        assert is_same(platform.Placement, linkage.parts["platform"].Placement)
        App.closeDocument(again.Name)
    linkage.restore()
    assert np.abs(gaps(linkage)).max() < NANOMETRE


def test_an_assembly_of_twenty_parts_is_read_and_answered_in_less_than_a_second():
    document = chain(20)
    start = time.perf_counter()
    mechanism = linkages.mechanism_of(SavedAsAssembly(document))
    text = analysis.mobility_text(mechanism)
    spent = time.perf_counter() - start
    print(f"    mobility of 20 parts after {spent:.3f} s")
    assert spent < 1.0, spent
    # A planar loop of n hinges has mobility n − 3, and the plane is redundant three times.
    found = mechanism.mobility()
    assert (len(mechanism.links), found.finite_mobility, found.redundancy) == (21, 17, 3), text
    linkage = linkages.linkage(SavedAsAssembly(document))
    assert linkage.unmatched == []
    # Parts are where the mechanism has them before anything moves.
    for link, placed in linkage.placements(mechanism.assemble().coordinates).items():
        assert is_same(placed, linkage.drawn[link]), link


def test_an_assembly_that_freecad_saved_is_the_mechanism_of_the_open_document():
    if not HAS_ASSEMBLIES:
        print("    not run: this FreeCAD has no Assembly workbench")
        return
    path = os.path.join(HERE, "..", "validation", "golden", "models", "freecad-crank.FCStd")
    document = App.openDocument(path)
    mechanism = linkages.mechanism_of(document)
    found = mechanism.mobility()
    assert (found.finite_mobility, found.redundancy) == (1, 0), analysis.mobility_text(mechanism)
    linkage = linkages.linkage(document, mechanism)
    drawn = dict(linkage.drawn)
    for link, placed in linkage.placements(mechanism.assemble().coordinates).items():
        # The solver of FreeCAD stops at residuals of this size (mm).
        difference = np.array(placed.toMatrix().A) - np.array(drawn[link].toMatrix().A)
        assert np.abs(difference).max() < 1e-5, (link, difference)
    App.closeDocument(document.Name)


def test_tables_and_texts_give_motions_or_reasons():
    mechanism = jp.Mechanism.from_catalogue("four-bar")
    name = mechanism.actuated[0]
    start = math.degrees(mechanism.assemble()[name])
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "drive.csv")

        def write(text):
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)

        write(f"# motor\nt,{name}_deg\n0,{start}\n1,{start + 5}\n2,{start + 10}\n")
        by_table = analysis.table(mechanism, path)
        assert np.allclose(by_table, analysis.drive(mechanism, {name: 10.0}, steps=2), atol=1e-12)
        for text, part in [
            ("a_deg\n1\n2\n", "no column"),
            (f"{name}_mm\n1\n2\n", "is not known"),
            (f"{name}_deg\n1\nx\n", "expected a finite number"),
            (f"{name}_deg\n", "0 rows"),
        ]:
            write(text)
            refused(lambda: analysis.table(mechanism, path), part)
    assert analysis.displacements(f"{name}=1.5, b =-2") == {name: 1.5, "b": -2.0}
    refused(lambda: analysis.displacements("a"), "NAME=DISPLACEMENT")
    refused(lambda: analysis.displacements("a=nan"), "NAME=DISPLACEMENT")
    refused(lambda: analysis.drive(mechanism, {}), "no drive is given")
    refused(lambda: analysis.drive(mechanism, {"x": 1.0}), "is not known")
    document, robot_mechanism = robot()
    refused(lambda: linkages.linkage(document, mechanism), "no object of the document")
    document.addObject("Part::Box", "Box").Label = "rod 1"
    twice = len(document.getObjectsByLabel("rod 1")) > 1
    if twice:
        refused(lambda: linkages.linkage(document, robot_mechanism), "is that of 2 objects")


def test_the_panel_follows_the_active_document():
    # The windows of the panel are stubs.
    sys.modules.update({name: MagicMock() for name in ["FreeCADGui", "PySide"]})
    from freecad.jointplay.panel import Panel

    panel = Panel()
    documents = [robot()[0] for _ in range(2)]
    path = os.path.join(HERE, "..", "crates", "jointplay-format", "robots", "gpr-mechanism.toml")
    sys.modules["PySide"].QtGui.QFileDialog.getOpenFileName.return_value = (path, "")
    for document in documents:
        App.setActiveDocument(document.Name)
        panel.open_mechanism()
    configuration = analysis.drive(panel.linked().mechanism, {"rod 1": 1.0, "rod 2": 1.0, "rod 3": 1.0}, steps=1)[-1]
    for active, other in [documents, documents[::-1]]:
        App.setActiveDocument(active.Name)
        linked = panel.linked()
        assert linked.parts["platform"].Document is active
        linked.show(configuration)
        assert not is_same(linked.parts["platform"].Placement, linked.drawn["platform"])
        (still,) = other.getObjectsByLabel("platform")
        assert is_same(still.Placement, linked.drawn["platform"])
        panel.restore()
        assert is_same(linked.parts["platform"].Placement, linked.drawn["platform"])
    # A closed document has no parts to put back.
    App.closeDocument(documents[0].Name)
    panel.restore()


def test_suggestions_are_those_of_the_library():
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    commands = {"rod 1": 2.0, "rod 2": -1.0, "rod 3": -1.0}
    expected = mechanism.suggest([{name: value / 1000 for name, value in commands.items()}])
    assert str(analysis.suggestions(mechanism, commands)) == str(expected)


def refused(action, part):
    try:
        action()
    except ValueError as error:
        assert part in str(error), error
    else:
        raise AssertionError(f"not refused: {part}")


def main():
    failed = 0
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            try:
                test()
                print(f"{name} ... ok")
            except Exception:
                failed += 1
                print(f"{name} ... FAILED")
                traceback.print_exc(file=sys.stdout)
    print(f"{failed} failed")
    sys.stdout.flush()
    # FreeCAD's own exit does not return the code of a script.
    os._exit(1 if failed else 0)


main()
