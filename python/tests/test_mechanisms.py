"""Any mechanism: the same numbers as the command's, in SI."""

from __future__ import annotations

import copy
import io
import json
import math
import pickle
import re
import sys
import zipfile
from pathlib import Path

import numpy as np
import pandas
import polars
import pytest
from conftest import ROOT
from test_analyses import same

import jointplay as jp

DEG = math.pi / 180


@pytest.fixture
def four_bar():
    return jp.Mechanism.from_catalogue("four-bar")


def test_the_catalogue():
    names = jp.catalogue()
    assert names["bennett"] == "Bennett's linkage" and "gpr" not in names and len(names) > 20
    with pytest.raises(jp.UnknownNameError, match="did you mean `bennett`"):
        jp.Mechanism.from_catalogue("benet")


DOOR = """
kind = "mechanism"
name = "door"
units = { length = "mm", angle = "deg" }
base = "wall"
[[joint]]
name = "hinge"
kind = "revolute"
links = ["wall", "leaf"]
point = [0, 0, 0]
axis = [0, 0, 1]
actuated = true
[[frame]]
name = "handle"
link = "leaf"
point = [900, 0, 1000]
"""


def test_poses_of_links_and_frames_are_homogeneous_transforms():
    door = jp.Mechanism.from_toml(DOOR)
    assert door.frames == ("handle",) and door.links == ("wall", "leaf")
    angles = np.linspace(0, 1.5, 1000)
    positions = door.positions({"hinge": angles})
    poses = positions.link_poses("handle")
    assert poses.shape == (1000, 4, 4)
    circle = np.stack([0.9 * np.cos(angles), 0.9 * np.sin(angles), np.ones(1000)], axis=1)
    assert np.allclose(poses[:, :3, 3], circle, atol=1e-15)
    assert np.allclose(poses[:, 0, 0], np.cos(angles)) and np.allclose(poses[:, 1, 0], np.sin(angles))
    assert np.array_equal(poses[:, 3], np.tile([0, 0, 0, 1], (1000, 1)))
    offset = np.eye(4)
    offset[:3, 3] = [0.9, 0, 1]
    assert np.allclose(positions.link_poses("leaf") @ offset, poses, atol=1e-15)
    # One configuration, a motion, and coordinates of one's own.
    here = door.assemble({"hinge": 1.5})
    assert np.allclose(here.link_poses("handle"), poses[-1], atol=1e-15)
    moved = door.drive({"hinge": (0, 1.5)}, steps=3)
    assert moved.link_poses("handle").shape == (4, 4, 4)
    assert np.array_equal(door.link_poses([1.5], "handle"), here.link_poses("handle"))
    with pytest.raises(jp.InputError, match="exaggeration"):
        door.link_poses([1.5], "leaf", exaggerate=math.nan)
    broken = door.positions({"hinge": [0.1, math.nan]}).link_poses("leaf")
    assert np.isfinite(broken[0]).all() and np.isnan(broken[1]).all()
    with pytest.raises(jp.UnknownNameError, match="did you mean `handle`"):
        door.link_poses([0.0], "handel")
    with pytest.raises(jp.InputError, match="shape"):
        door.link_poses([0.0, 1.0], "handle")
    assert pickle.loads(pickle.dumps(moved)) == moved


def test_poses_of_a_mechanism_without_coordinates():
    bracket = jp.Mechanism.from_toml(
        DOOR.replace('"revolute"', '"fixed"').replace("axis = [0, 0, 1]\nactuated = true\n", "")
    )
    offset = np.eye(4)
    offset[:3, 3] = [0.9, 0, 1]
    assert np.array_equal(bracket.assemble().link_poses("handle"), offset)
    assert np.array_equal(bracket.link_poses(np.zeros((3, 0)), "handle"), np.stack([offset] * 3))
    assert bracket.link_poses(np.zeros((0, 0)), "leaf").shape == (0, 4, 4)


def test_velocities_and_jacobians_are_derivatives_of_poses():
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    at = {"rod 1": 0.002, "rod 2": -0.001, "rod 3": 0.0}
    rates = {"rod 1": 0.3, "rod 2": -0.1, "rod 3": 0.2}
    found = mechanism.jacobian("platform", at, velocities=rates)
    assert found.commanded == ("rod 1", "rod 2", "rod 3") and found.commanded_units == ("m",) * 3
    time = np.linspace(-1e-4, 1e-4, 3)
    around = mechanism.positions({name: value + rates[name] * time for name, value in at.items()})
    poses = around.link_poses("platform")
    assert np.allclose(poses[1], found.pose, atol=1e-14)
    turn = (poses[2, :3, :3] - poses[0, :3, :3]) @ poses[1, :3, :3].T / 2e-4
    angular = np.array([turn[2, 1], turn[0, 2], turn[1, 0]])
    linear = (poses[2, :3, 3] - poses[0, :3, 3]) / 2e-4
    moving = mechanism.velocities(rates, at)
    velocity = np.concatenate([angular, linear])
    assert np.allclose(moving.frame_velocities["platform"], velocity, atol=1e-6)
    assert np.allclose(found.matrix @ list(rates.values()), velocity, atol=1e-6)
    joints = (around.coordinates[2] - around.coordinates[0]) / 2e-4
    assert np.allclose(moving.velocities[-3:], joints[-3:], atol=1e-6)
    assert np.allclose(found.coordinate_derivatives @ list(rates.values()), moving.velocities)
    # Without commanded accelerations only the Jacobian changes.
    still = mechanism.accelerations({}, rates, at)
    assert np.allclose(
        still.frame_accelerations["platform"], found.derivative @ list(rates.values()), atol=1e-12
    )
    assert still == moving and still.names[-1] == "l3" and still.units[0] == "m"
    assert found.condition_number == pytest.approx(found.singular_values[0] / found.singular_values[2])
    assert found.manipulability == pytest.approx(np.prod(found.singular_values))
    assert pickle.loads(pickle.dumps(found)) == found


def test_parameters_move_a_mechanism_as_other_files_do():
    at = {"A": 0.4}
    mechanism = jp.Mechanism.from_catalogue("four-bar")
    found = mechanism.parameter_derivatives(at=at)
    assert found.parameters == tuple(mechanism.parameters) and found.coordinates.shape == (4, len(found.parameters))
    for k, (name, value) in enumerate(mechanism.parameters.items()):
        step = 1e-4 * value
        changed = [
            jp.Mechanism.from_catalogue("four-bar", parameters={name: value + by}).assemble(at) for by in (-step, step)
        ]
        coordinates = (changed[1].coordinates - changed[0].coordinates) / (2 * step)
        assert np.allclose(found.coordinates[:, k], coordinates, atol=1e-5 * np.abs(coordinates).max())
        poses = [one.link_poses("coupler") for one in changed]
        origin = (poses[1][:3, 3] - poses[0][:3, 3]) / (2 * step)
        assert np.allclose(found.frames["coupler"][3:, k], origin, atol=1e-6)
    one = mechanism.parameter_derivatives(["coupler"], at)
    assert np.array_equal(one.coordinates[:, 0], found.coordinates[:, found.parameters.index("coupler")])
    with pytest.raises(jp.UnknownNameError):
        mechanism.parameter_derivatives(["couple"])
    # This linkage moves for the dimensions of Bennett only.
    with pytest.raises(jp.InputError, match="parameter `b`: changing this dimension opens the loops"):
        jp.Mechanism.from_catalogue("bennett").parameter_derivatives(["b"], {"J1": 0.9})


def test_undetermined_and_contradictory_commands_have_no_derivatives(four_bar):
    with pytest.raises(jp.UndeterminedError) as caught:
        jp.Mechanism.from_catalogue("gpr-mechanism").velocities({"rod 1": 1.0}, commanded=["rod 1", "rod 2"])
    assert caught.value.motions == 1 and min(caught.value.singular_values) < 1e-12
    with pytest.raises(jp.DependentCommandsError) as caught:
        four_bar.jacobian("coupler", commanded=["A", "D"])
    assert caught.value.share > caught.value.allowed
    with pytest.raises(jp.InputError, match="commanded are A"):
        four_bar.velocities({"B": 1.0})
    with pytest.raises(jp.InputError, match="twice"):
        four_bar.velocities({"A": 1.0}, commanded=["A", "A"])
    with pytest.raises(jp.InputError, match="no joint of this mechanism is actuated"):
        jp.Mechanism.from_catalogue("griffis-duffy").velocities({})


def test_the_platform_of_three_rods_has_the_same_pose_as_a_mechanism():
    rods = {"rod 1": 0.002, "rod 2": -0.001, "rod 3": 0.0}
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    found = mechanism.assemble(rods).link_poses("platform")
    expected = jp.Gpr.paper().forward([0.502, 0.499, 0.5], virtualization="radial")
    # The frame of the platform link is that of the base at rods of 500 mm.
    center = found @ [0, 0, 0.5, 1]
    assert np.allclose(center[:3], expected.origin_m, atol=1e-12)
    assert np.allclose(found[:3, 2], expected.normal, atol=1e-12)


def test_what_a_mechanism_says_of_itself(four_bar):
    assert four_bar.coordinate_names == ("A", "B", "C", "D") and four_bar.coordinate_units == ("rad",) * 4
    assert (four_bar.joint_freedoms, four_bar.loops, len(four_bar.links)) == (4, 1, 4)
    assert four_bar.actuated == ("A",) and four_bar.virtual_joint_names == ()
    longer = jp.Mechanism.from_catalogue("four-bar", parameters={"coupler": 0.25})
    assert longer.parameters["coupler"] == 0.25 and longer != four_bar
    for value in (four_bar, longer):
        assert pickle.loads(pickle.dumps(value)) == value == copy.deepcopy(value)
    assert len({four_bar, jp.Mechanism.from_catalogue("four-bar")}) == 1
    assert repr(four_bar) == 'Mechanism(name="Planar four-bar linkage", links=4, joints=4, loops=1)'


def test_files(tmp_path, four_bar):
    path = ROOT / "crates/jointplay-format/robots" / "four-bar.toml"
    assert jp.Mechanism.from_file(path) == jp.Mechanism.from_toml(path.read_text()) == four_bar
    with pytest.raises(jp.FileError, match="coupler") as caught:
        jp.Mechanism.from_toml(path.read_text(), parameters={"couplr": 1})
    assert caught.value.line >= 1
    with pytest.raises(jp.FileError, match="unknown key `joints`"):
        jp.Mechanism.from_toml('kind = "mechanism"\nname = "x"\n[[joints]]\nname = "a"\n')
    with pytest.raises(FileNotFoundError):
        jp.Mechanism.from_file(tmp_path / "none.toml")


def test_models_of_other_programs():
    models = ROOT / "validation" / "golden" / "models"
    read = 0
    for path in sorted(models.iterdir()):
        if path.suffix in (".xml", ".sdf", ".urdf"):
            mechanism = jp.Mechanism.from_file(path)
            assert mechanism.joint_freedoms > 0 and isinstance(mechanism.ignored, tuple)
            assert pickle.loads(pickle.dumps(mechanism)) == mechanism
            read += 1
    assert read > 0


def test_loops_beside_a_model(tmp_path):
    joint = (
        '<joint name="{0}" type="continuous"><parent link="base"/><child link="{1}"/><axis xyz="0 0 1"/></joint>'
    ).format
    chain = tmp_path / "pair.urdf"
    chain.write_text(
        '<robot name="pair"><link name="base"/><link name="left"/><link name="right"/>'
        f'{joint("a", "left")}{joint("b", "right")}</robot>'
    )
    loops = tmp_path / "loops.toml"
    text = 'kind = "loops"\nunits = { length = "mm", angle = "deg" }\n[[joint]]\nname = "tips"\n'
    text += 'kind = "spherical"\nlinks = ["left", "right"]\nin = "left"\npoint = [0, 100, 0]\n'
    loops.write_text(text)
    closed = jp.Mechanism.from_file(chain, loops=loops)
    assert (jp.Mechanism.from_file(chain).loops, closed.loops) == (0, 1)
    assert pickle.loads(pickle.dumps(closed)) == closed
    assert closed.drive({"a": 0.2}, steps=2)["b"][-1] == pytest.approx(0.2)
    pairs = tmp_path / "robot.yaml"
    pairs.write_text("closed_loop: [[left, right]]\ntype: ['3d']\nname_mot: [a]\n")
    in_yaml = jp.Mechanism.from_file(chain, loops=pairs)
    assert (in_yaml.loops, pickle.loads(pickle.dumps(in_yaml))) == (1, in_yaml)
    pairs.write_text("closed_loop: [[left, absent]]\n")
    with pytest.raises(jp.FileError, match="robot.yaml:1"):
        jp.Mechanism.from_file(chain, loops=pairs)
    loops.write_text(text.replace('"right"]', '"absent"]'))
    with pytest.raises(jp.FileError, match="loops.toml:6"):
        jp.Mechanism.from_file(chain, loops=loops)
    with pytest.raises(jp.InputError, match="loops are for models"):
        jp.Mechanism.from_file(loops, loops=loops)


def test_assemblies_of_freecad_need_a_unit(tmp_path):
    model = ROOT / "validation/golden/models/slider-crank.asmt"
    with pytest.raises(jp.FileError, match="does not state its unit"):
        jp.Mechanism.from_file(model)
    with pytest.raises(jp.InputError, match="units must be one of m, mm, um, in"):
        jp.Mechanism.from_file(model, units="ft")
    read = {unit: jp.Mechanism.from_file(model, units=unit) for unit in ("m", "mm")}
    assert pickle.loads(pickle.dumps(read["mm"])) == read["mm"] != read["m"]
    assert read["mm"].mobility().instantaneous_mobility == read["m"].mobility().instantaneous_mobility
    other = tmp_path / "door.toml"
    other.write_text(DOOR)
    with pytest.raises(jp.InputError, match="units are for assemblies"):
        jp.Mechanism.from_file(other, units="m")


def test_assemble(four_bar, ask):
    report = ask("assemble", "four-bar", "--at", "A=30")
    found = same(four_bar.assemble({"A": 30 * DEG}))
    for name, degrees in report["coordinates"].items():
        assert found[name] == pytest.approx(degrees * DEG, abs=1e-13)
    assert list(found) == list(report["coordinates"]) and len(found) == 4 and "E" not in found
    branches = four_bar.branches({"A": 30 * DEG}, starts=30)
    assert len(branches) == 2 and branches[0] == found
    assert branches[1]["B"] != pytest.approx(found["B"]) and branches[1].residual < 1e-12
    # Corrections from the guess do not close it: the nearest closed configuration is found.
    far = four_bar.assemble({"D": 2.5})
    assert far["D"] == 2.5 and far.residual < 1e-12
    with pytest.raises(jp.NotAssembledError) as caught:
        four_bar.assemble({"A": 0.5, "C": 0.1})
    assert len(caught.value.branches) == 0
    assert isinstance(caught.value, jp.NoAnswerError)
    with pytest.raises(jp.UnknownNameError, match="joint `a` is not known"):
        four_bar.assemble({"a": 0})


@pytest.mark.parametrize("name", ["bennett", "sarrus", "four-bar", "hexapod", "gpr-mechanism"])
def test_mobility(ask, name):
    report = ask("mobility", name)
    found = same(jp.Mechanism.from_catalogue(name).mobility())
    for field in ("kutzbach_mobility", "instantaneous_mobility", "finite_mobility", "rank", "redundancy"):
        assert getattr(found, field) == report[field]
    np.testing.assert_allclose(found.singular_values, report["singular_values"], rtol=1e-9, atol=1e-14)
    assert len(found.redundant_constraints) == len(report["redundant_constraints"])
    for one, reported in zip(found.redundant_constraints, report["redundant_constraints"]):
        assert [one.what, list(one.joints)] == [reported["what"], reported["joints"]]
        assert list(one.couplings) == reported["couplings"]
        assert [one.group, one.independent] == [reported["group"], reported["independent"]]
        for load, in_mm in zip(one.remove_any_one_of, reported["remove_any_one_of"]):
            assert load.joint == in_mm["joint"]
            np.testing.assert_allclose(load.force_n, in_mm["force_n"])
            np.testing.assert_allclose(load.moment_nm * 1e3, in_mm["moment_nmm"])
    basis = report["redundant_constraint_basis"]
    assert found.redundant_constraints_sparsest == basis["sparsest"]
    assert list(found.joints_in_all_self_stresses) == basis["joints_in_all"]
    assert list(found.couplings_in_all_self_stresses) == basis["couplings_in_all"]
    assert found.couplings == report.get("couplings", 0)
    for link, motion in report["link_motions"].items():
        mine = found.link_motions[link]
        assert (mine.dimension, mine.translations) == (motion["dimension"], motion["translations"])
        assert mine.twists.shape == (6, mine.dimension)
        if "axis_point_mm" in motion:
            np.testing.assert_allclose(mine.axis_point_m * 1e3, motion["axis_point_mm"], atol=1e-6)
    for coordinate, value in report["coordinates"].items():
        unit = dict(zip(found.configuration.names, found.configuration.units, strict=True))[coordinate]
        factor = DEG if unit == "rad" else {"m": 1, "mm": 1e-3}[report["units"]["length"]]
        assert found.configuration[coordinate] == pytest.approx(value * factor, abs=1e-12)


def test_mobility_within_a_tolerance(ask):
    report = ask("mobility", "bennett", "--set", "b=0.1101", "--tolerance", "1e-3")
    found = jp.Mechanism.from_catalogue("bennett", parameters={"b": 0.1101}).mobility(tolerance=1e-3)
    assert found.near.mobility == report["near_mobility"] == 1
    assert found.near.needed == pytest.approx(report["near_tolerance_needed"], rel=1e-9)
    with pytest.raises(jp.OutOfRangeError):
        jp.Mechanism.from_catalogue("bennett").mobility(tolerance=1)
    for tolerance in (10, 0, -1, float("nan")):
        with pytest.raises(jp.OutOfRangeError):
            jp.Mechanism.from_catalogue("four-bar").assemble(tolerance=tolerance)


def test_drive(four_bar, ask):
    report = ask("move", "four-bar", "--drive", "A=0:90:30")
    path = same(four_bar.drive({"A": (0, 90 * DEG)}, steps=3))
    assert path.driven == ("A",) and path.held == () and path.stopped is None and path.message is None
    for name, values in report["series"].items():
        np.testing.assert_allclose(path.columns()[name.replace("_deg", "_rad")], np.radians(values), atol=1e-12)
    np.testing.assert_allclose(path["A"], np.radians([0, 30, 60, 90]))
    assert isinstance(path.to_dataframe(), pandas.DataFrame) and polars.DataFrame(path).shape == (4, 4)
    with pytest.raises(KeyError):
        path["E"]
    here = four_bar.assemble()["A"]
    assert four_bar.drive({"A": here + 0.1}, steps=1)["A"] == pytest.approx([here, here + 0.1])
    for drives, steps in (({}, 3), ({"A": 1}, 0)):
        with pytest.raises(jp.InputError):
            four_bar.drive(drives, steps=steps)


def test_drive_along_a_curve(four_bar):
    angles = 0.3 * np.sin(np.linspace(0, 2 * np.pi, 25))
    path = four_bar.drive({"A": angles})
    np.testing.assert_allclose(path["A"], angles, atol=1e-15)
    assert path.stopped is None and (path.residual < 1e-12).all()
    finer = four_bar.drive({"A": angles}, steps=48)
    np.testing.assert_allclose(finer["B"][::2], path["B"], atol=1e-9)
    for curve in ([0.1], np.zeros((2, 3)), [0.1, 0.2, math.nan]):
        with pytest.raises(jp.JointplayError):
            four_bar.drive({"A": curve})
    with pytest.raises(jp.InputError, match="is not held"):
        four_bar.drive({"A": 0.1}, free=["A"])


def test_a_table_of_drives_is_that_of_the_command(four_bar, tmp_path):
    table = tmp_path / "drives.csv"
    table.write_text("# by hand\ntime,A_deg\n0,10\n1,20\n2,25\n", encoding="utf-8")
    drives = four_bar.read_drive_table(table)
    assert list(drives) == ["A"]
    np.testing.assert_allclose(drives["A"], np.radians([10, 20, 25]), rtol=1e-15)
    assert four_bar.drive(drives)["A"] == pytest.approx(drives["A"])
    for text, part in (("A,B_um\n1,1\n2,2\n", "column 2: joint `B_um` is not known"), ("A\n1\n", "1 rows of numbers")):
        table.write_text(text, encoding="utf-8")
        with pytest.raises(jp.InputError, match=part):
            four_bar.read_drive_table(table)
    with pytest.raises(OSError):
        four_bar.read_drive_table(tmp_path / "none.csv")


def test_a_dead_point_stops_the_way(ask):
    crossed = jp.Mechanism.from_catalogue("four-bar").drive({"D": (0, 2.5)})
    assert crossed.stopped == "locked" and "dead point" in crossed.message
    assert len(crossed.singular) == 1 and crossed.singular[0].instantaneous_mobility >= 1
    assert crossed.share[-1] < 1 and (crossed.residual < 1e-12).all()
    with pytest.raises(jp.StoppedError, match="before the start of the path") as caught:
        jp.Mechanism.from_catalogue("four-bar").drive({"D": (2.5, 0)})
    assert caught.value.motion.stopped == "locked"


def test_suggest(ask):
    report = ask("suggest", "gpr-mechanism", "--command", "rod 1=5,rod 2=0,rod 3=0")
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    found = same(mechanism.suggest([{"rod 1": 0.005, "rod 2": 0, "rod 3": 0}]))
    assert found.needed and found.candidates == report["candidates"] and len(found.sets) == len(report["sets"])
    for mine, theirs in zip(found.sets, report["sets"], strict=True):
        assert mine.size_m * 1e3 == pytest.approx(theirs["size_mm"], rel=1e-9)
        assert [joint.name for joint in mine.virtual_joints] == [joint["name"] for joint in theirs["virtual_joints"]]
        assert [joint.on for joint in mine.virtual_joints] == [joint["on"] for joint in theirs["virtual_joints"]]
    one = mechanism.suggest([{"rod 1": 0.005, "rod 2": 0, "rod 3": 0}], joints=3, limit=10, symmetric=True, rank="largest")
    assert one.sets and all(len(found.virtual_joints) <= 3 for found in one.sets)
    with pytest.raises(jp.UnknownNameError, match="rank"):
        mechanism.suggest([{"rod 1": 0.005, "rod 2": 0, "rod 3": 0}], rank="least")
    with pytest.raises(jp.InputError, match="the same joints"):
        mechanism.suggest([{"rod 1": 0.005}, {"rod 2": 0.005}])


def test_suggestions_by_elastic_energy():
    rods = jp.Mechanism.from_catalogue("gpr-mechanism")
    tilt = {"rod 1": 0.002, "rod 2": 0.0, "rod 3": 0.0}
    with pytest.raises(jp.InputError, match="has no linear stiffness"):
        rods.suggest([tilt], rank="stiffness")
    with pytest.raises(jp.InputError, match="needs rank="):
        rods.suggest([tilt], linear_stiffness=1e6)
    with pytest.raises(jp.InputError, match="must be a positive finite number"):
        rods.suggest([tilt], rank="stiffness", linear_stiffness=-1.0)
    found = rods.suggest([tilt], rank="stiffness", linear_stiffness=2e7, angular_stiffness=5e3)
    best = found.sets[0]
    assert best.energy_j >= found.least_energy_j * (1 - 1e-6)
    assert best.energy_j == pytest.approx(sum(one.stiffness * one.largest**2 for one in best.virtual_joints) / 2)
    # The new mechanism has the stiffness, and with it the same displacement.
    relief = rods.with_virtual_joints(best).relieve(tilt)
    assert relief.size_unit == "sqrt(J)" and relief.size**2 / 2 == pytest.approx(best.energy_j, rel=1e-7)
    assert rods.suggest([tilt]).sets[0].energy_j is None


def test_a_suggestion_makes_a_new_mechanism():
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    tilt = {"rod 1": 0.002, "rod 2": 0, "rod 3": -0.001}
    for found in mechanism.suggest([tilt]).sets[:4]:
        made = mechanism.with_virtual_joints(found)
        assert made.relieve(tilt).size == pytest.approx(found.size_m, rel=1e-7)
        assert made.virtual_joint_names == tuple(joint.name for joint in found.virtual_joints)
        assert pickle.loads(pickle.dumps(made)) == made and mechanism.virtual_joint_names == ("l1", "l2", "l3")
        swapped = [next(iter(joint.alternatives), joint) for joint in found.virtual_joints]
        assert len(mechanism.with_virtual_joints(swapped).virtual_joint_names) == len(found.virtual_joints)
    with pytest.raises(jp.UnknownNameError, match="joint"):
        jp.Mechanism.from_catalogue("four-bar").with_virtual_joints(found)


def test_relieve(ask):
    report = ask("sensitivity", "gpr-mechanism", "--command", "S1[1]=0.1")
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    found = same(mechanism.relieve({"S1[1]": 0.1 * DEG}))
    assert found.size * 1e6 == pytest.approx(report["size"], rel=1e-9) and found.size_unit == "m"
    displacements = [joint["displacement"] for joint in report["virtual_joints"]]
    np.testing.assert_allclose(found.virtual_joints * 1e6, displacements, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found.singular_values, report["singular_values"], rtol=1e-9)
    assert found.configuration["S1[1]"] == 0.1 * DEG and np.isnan(found.clearances).all()
    with pytest.raises(jp.InputError, match="no virtual joints"):
        jp.Mechanism.from_catalogue("four-bar").relieve({"A": 1})
    with pytest.raises(jp.InputError, match="freedoms: choose one of"):
        mechanism.relieve({"S1": 0})


def test_positions(four_bar):
    angles = np.linspace(0.2, 1.4, 200)
    found = same(four_bar.positions({"A": angles}))
    np.testing.assert_array_equal(found["A"], angles)
    assert (found.residual < 1e-12).all() and found.to_dataframe().shape == (200, 4)
    path = four_bar.drive({"A": (0.2, 1.4)}, steps=199)
    np.testing.assert_allclose(found.coordinates, path.coordinates, atol=1e-11)
    gap = four_bar.positions({"A": [0.2, np.nan, 0.3]})
    assert np.isnan(gap.coordinates[1]).all() and np.isfinite(gap.coordinates[[0, 2]]).all()
    assert gap.status.tolist() == [jp.Status.SOLVED, jp.Status.NOT_FINITE, jp.Status.SOLVED]
    late = four_bar.positions({"A": [np.inf, 0.2]})
    assert late.status.tolist() == [jp.Status.NOT_FINITE, jp.Status.SOLVED] and late.failed == 1
    assert four_bar.positions({"A": []}).coordinates.shape == (0, 4)
    with pytest.raises(jp.UnknownNameError):
        four_bar.positions({"A": [0.2]}, solver="best")


def test_independent_positions():
    """In any order, from the first row, the positions that a path leads to; the same bits for any number of threads."""
    hexapod = jp.Mechanism.from_catalogue("hexapod")
    legs = list(hexapod.actuated)
    home = hexapod.assemble()
    lengths = np.random.default_rng(3).uniform(-0.004, 0.004, (5000, len(legs)))
    lengths[0] = 0
    lengths[17, 2] = np.nan
    commands = {name: home[name] + lengths[:, k] for k, name in enumerate(legs)}
    found = same(hexapod.positions(commands, independent=True, threads=2))
    assert found.failure_counts == {"not a finite number": 1} and np.isnan(found.coordinates[17]).all()
    assert np.nanmax(found.residual) < 1e-11
    alone = hexapod.positions(commands, independent=True, threads=1)
    np.testing.assert_array_equal(found.coordinates, alone.coordinates)
    back = {name: values[::-1] for name, values in commands.items()}
    back = {name: np.concatenate([values[-1:], values]) for name, values in back.items()}
    np.testing.assert_array_equal(
        hexapod.positions(back, independent=True).coordinates[1:], found.coordinates[::-1]
    )
    few = {name: values[:10] for name, values in commands.items()}
    one_by_one = hexapod.positions(few).coordinates
    np.testing.assert_allclose(found.coordinates[:10], one_by_one, atol=1e-10)
    with pytest.raises(jp.InputError, match="threads"):
        hexapod.positions(few, independent=True, threads=0)


def test_positions_have_a_status():
    """Rows beyond joint limits and clearances, and what allows them."""
    rods = {f"rod {k + 1}": [0.0, 0.001 * k, 0.3] for k in range(3)}
    robot = jp.Mechanism.from_catalogue("gpr-mechanism")
    beyond = robot.positions(rods)
    assert beyond.status.tolist() == [0, 0, jp.Status.BEYOND_LIMITS]
    assert np.isnan(beyond.coordinates[2]).all() and beyond.failure_counts == {"beyond the limits": 1}
    free = robot.positions(rods, check_limits=False)
    assert free.failed == 0 and free["rod 1"][2] == 0.3
    text = (ROOT / "crates/jointplay-format/robots" / "gpr-mechanism.toml").read_text(encoding="utf-8")
    tight = jp.Mechanism.from_toml(re.sub(r"(\[\[virtual_joint\]\])", r"\1\nclearance = 0.000001", text))
    found = tight.positions({"rod 1": [0.0, 0.002], "rod 2": 0.0, "rod 3": 0.0})
    assert found.status.tolist() == [0, jp.Status.BEYOND_CLEARANCE]


def test_positions_with_play_are_those_of_the_robot(gpr):
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    rods = np.random.default_rng(2).uniform(-0.001, 0.001, (20, 3))
    found = mechanism.positions({f"rod {k + 1}": rods[:, k] for k in range(3)})
    assert (found.residual < 1e-12).all()
    radial = gpr.forward(rods + 0.5, "radial")
    slides = np.stack([found[name] for name in mechanism.virtual_joint_names], axis=1)
    np.testing.assert_allclose(slides, radial.virtual_joints - gpr.socket_radius_m, atol=1e-9)



def test_a_tilt_commanded_by_a_ball_joint_stays_near_home():
    """The heave that the command leaves free moves least: every door once put the rods metres away."""
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    rods = ["rod 1", "rod 2", "rod 3"]
    reach = 1.01 * 0.093218 * np.sin(1 * DEG)
    tilt = {"S1[0]": 0.0, "S1[1]": 1 * DEG}
    there = mechanism.relieve(tilt).configuration
    assert sum(there[rod] for rod in rods) == pytest.approx(0, abs=1e-9)
    assert max(abs(there[rod]) for rod in rods) < reach
    path = mechanism.drive({"S1[1]": (0, 1 * DEG)}, steps=5)
    assert all(np.abs(path[rod]).max() < reach for rod in rods) and path.within_limits.all()
    turns = np.linspace(-1, 1, 5) * DEG
    many = mechanism.positions({"S1[0]": 0.0, "S1[1]": turns, "S1[2]": 0.0})
    assert all(np.abs(many[rod]).max() < reach for rod in rods)
    assert many.status.tolist() == [jp.Status.SOLVED] * 5
    best = mechanism.suggest([tilt]).sets[0]
    assert best.size_m == pytest.approx(1.5 * 0.093218 * (1 - np.cos(1 * DEG)), rel=0.01)
    assert np.abs(best.coordinates[0, :3]).max() < 2 * reach and best.limits_broken == ()


def test_joint_limits_are_an_answer():
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    beyond = {"rod 1": 0.3, "rod 2": 0.3, "rod 3": 0.3}
    for ask in (mechanism.assemble, mechanism.mobility, mechanism.relieve):
        with pytest.raises(jp.JointLimitsError, match="rod 1 is at 300.000000 mm, its limits are -254 to 254 mm") as caught:
            ask(beyond)
        assert caught.value.limits_broken[:3] == ["rod 1", "rod 2", "rod 3"] and caught.value.result is not None


def test_limits_of_robots_and_mechanisms_have_one_base_class():
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    for ask in (lambda: jp.Gpr.paper().inverse(30, 1.5), lambda: mechanism.assemble({"rod 1": 0.3, "rod 2": 0.3, "rod 3": 0.3})):
        with pytest.raises(jp.BeyondLimitsError) as caught:
            ask()
        assert caught.value.limits_broken
    assert issubclass(jp.BeyondLimitsError, jp.NoAnswerError)


def test_positions_beyond_joint_limits_have_their_status():
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    found = mechanism.positions({"rod 1": [0, 0.3], "rod 2": [0, 0.3], "rod 3": [0, 0.3]})
    assert found.status.tolist() == [jp.Status.SOLVED, jp.Status.BEYOND_LIMITS]
    with pytest.raises(jp.InputError, match=r"joint `S1` is a ball: command all of S1"):
        mechanism.positions({"S1[0]": [0.0], "S1[1]": [0.01]})


@pytest.mark.once
def test_many_loops_by_sparse_algebra():
    """Seventy parallelograms side by side: too many for dense algebra, and easy to count."""
    points = {"a": (0, 0), "b": (1, 0), "c": (1, 2), "d": (0, 2)}
    text = 'kind = "mechanism"\nname = "parallelograms"\nunits = { length = "m", angle = "rad" }\nbase = "base"\n'
    for i in range(70):
        links = {"a": ("base", "left"), "b": ("base", "right"), "c": ("right", "top"), "d": ("left", "top")}
        for joint, ends in links.items():
            ends = [link if link == "base" else f"{link} {i}" for link in ends]
            x, y = points[joint]
            text += f'[[joint]]\nname = "{joint}{i}"\nkind = "revolute"\nlinks = {ends}\n'
            text += f"point = [{x + 3 * i}, {y}, 0]\naxis = [0, 0, 1]\n"
    many = jp.Mechanism.from_toml(text)
    found = same(many.mobility())
    assert (found.kutzbach_mobility, found.instantaneous_mobility, found.redundancy) == (-140, 70, 210)
    assert found.singular_values is None and found.null_space.shape == (280, 70)
    path = many.drive({"a3": 0.3}, steps=3)
    assert path.stopped is None and path["b3"][-1] == pytest.approx(0.3, abs=1e-9)
    with pytest.raises(jp.TooLargeError) as caught:
        many.positions({"a3": [0.1]})
    assert caught.value.found > caught.value.allowed


@pytest.mark.parametrize("virtualization", ["radial", "polar", "planar"])
def test_a_robot_is_a_mechanism_with_the_same_poses(virtualization):
    gpr = jp.Gpr(
        socket_radius_m=[0.1, 0.12, 0.09],
        socket_angle_rad=[0.1, 2.0, 4.4],
        rod_limits_m=(0.3, 0.7),
        tilt_limit_rad=0.05,
        working_height_m=0.5,
        ball_clearance_m=2e-5,
    )
    mechanism = jp.Mechanism.from_gpr(gpr, virtualization)
    back = mechanism.to_gpr(0.05)
    assert np.allclose(back.socket_radius_m, gpr.socket_radius_m, rtol=0, atol=1e-15)
    assert back.rod_limits_m == pytest.approx(gpr.rod_limits_m) and back.ball_clearance_m == 2e-5
    rods = gpr.inverse(0.7, [0.01, 0.02, 0.04]).rods_m
    commanded = {f"rod {k + 1}": rods[:, k] - gpr.working_height_m for k in range(3)}
    by_loops = mechanism.positions(commanded).link_poses("platform")
    by_formula = gpr.forward(rods, virtualization, metric="radius", solver="least-norm")
    assert np.allclose(by_loops[:, :3, 3], by_formula.origin_m, rtol=0, atol=1e-10)
    with pytest.raises(jp.InputError, match="is not a three-rod robot: .* 6 prismatic"):
        jp.Mechanism.from_catalogue("hexapod").to_gpr(0.05)
    with pytest.raises(jp.InputError):
        mechanism.to_gpr(float("nan"))
    with pytest.raises(jp.InputError, match="tilt"):
        mechanism.to_gpr(90.0)
    with pytest.raises(jp.InputError, match="radial, polar or planar"):
        jp.Mechanism.from_gpr(gpr, "offset")


def test_motions_and_models_are_exported(tmp_path, ask):
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    motion = mechanism.drive({"rod 1": (0, 0.003)}, steps=12)
    assert motion.to_gltf(tmp_path / "motion.glb", exaggerate=500) == ()
    contents = (tmp_path / "motion.glb").read_bytes()
    assert contents[:4] == b"glTF" and int.from_bytes(contents[8:12], "little") == len(contents)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["motion.glb"]
    # Its own scene serves as a file of parts, whose nodes have the names of the links.
    parts = tmp_path / "parts.glb"
    parts.write_bytes(contents)
    assert motion.to_gltf(tmp_path / "again.glb", parts=parts, table={"platform": "rod 1"}, parts_up="z") == ("platform",)
    named = (tmp_path / "again.glb").read_bytes()
    file = tmp_path / "parts.toml"
    file.write_text('kind = "parts"\nup = "z"\n[links]\n"rod 1" = "platform"\n')
    assert motion.to_gltf(tmp_path / "again.glb", parts=parts, table=file) == ("platform",)
    assert (tmp_path / "again.glb").read_bytes() == named
    file.write_text('kind = "parts"\n[links]\n"rod 1" = 7\n')
    with pytest.raises(jp.FileError, match="a list") as refused:
        motion.to_gltf(tmp_path / "no.glb", parts=parts, table=str(file))
    assert refused.value.line == 3
    with pytest.raises(jp.InputError, match="did you mean"):
        motion.to_gltf(tmp_path / "no.glb", parts=parts, table={"platfrom": "rod 1"})
    with pytest.raises(jp.InputError, match="duration"):
        motion.to_gltf(tmp_path / "no.glb", duration_s=0)
    times = np.geomspace(0.5, 4.0, 13)
    motion.to_gltf(tmp_path / "timed.glb", times_s=times, exaggerate=500)
    timed = (tmp_path / "timed.glb").read_bytes()
    document = json.loads(timed[20 : 20 + int.from_bytes(timed[12:16], "little")])
    inputs = [document["accessors"][sampler["input"]] for sampler in document["animations"][0]["samplers"]]
    assert all(one["min"] == [0.5] and one["max"] == [4.0] for one in inputs)
    with pytest.raises(jp.InputError, match="a time for each of 13 configurations, got 2"):
        motion.to_gltf(tmp_path / "no.glb", times_s=[0, 1])
    with pytest.raises(jp.ArrayTypeError, match="times_s"):
        motion.to_gltf(tmp_path / "no.glb", times_s=["a", "b"])
    with pytest.raises(jp.InputError, match="must grow"):
        motion.to_gltf(tmp_path / "no.glb", times_s=times[::-1])
    assert not (tmp_path / "no.glb").exists()
    model = mechanism.to_model("urdf", {"rod 1": 0.001})
    assert model.text.startswith("<?xml") and 'kind = "loops"' in model.loops and model.lost
    assert mechanism.to_model("mjcf").loops is None
    assert mechanism.to_model("modelica").text.startswith("package GPROfThePaperAsAMechanism ")
    written = ask("export", "gpr-mechanism", "--to", "sdf", "--out", str(tmp_path / "models"))
    (file,) = written["exports"][0]["files"]
    assert Path(file).read_text() == mechanism.to_model("sdf").text
    with pytest.raises(jp.UnknownNameError, match="urdf"):
        mechanism.to_model("udrf")


@pytest.fixture
def library(tmp_path):
    """The head of a library for C, as units recognise it: its platform, and the mark of the version."""
    head = bytearray(b"\x7fELF\x02\x01\x01".ljust(18, b"\0") + b"\x3e\0")
    mark = f"jointplay library of functional mock-up units\t{jp.__version__}\n"
    path = tmp_path / "libjointplay.so"
    path.write_bytes(bytes(head) + mark.encode())
    return path


def test_units_are_those_of_the_command(tmp_path, ask, library, gpr, monkeypatch):
    def of_command(name, *options):
        folder = tmp_path / "units"
        written = ask("export", name, "--to", "fmu", "--library", str(library), "--out", str(folder), "--force", *options)
        (file,) = written["exports"][0]["files"]
        return Path(file).read_bytes()

    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    unit = mechanism.to_fmu(name="gpr-mechanism", library=library)
    assert unit == of_command("gpr-mechanism")
    at = mechanism.to_fmu({"rod 1": 0.001}, fmi=3, name="gpr-mechanism", library=[library])
    assert at == of_command("gpr-mechanism", "--at", "rod 1=1", "--fmi", "3")
    # The text of the file differs in its comments; the numbers do not.
    contents = zipfile.ZipFile(io.BytesIO(gpr.to_fmu((0.5005, 0.5, 0.4995), virtualization="polar", library=library)))
    expected = zipfile.ZipFile(
        io.BytesIO(of_command("gpr", "--q-mm", "500.5,500,499.5", "--virtualization", "polar"))
    )
    assert contents.namelist()[:3] == expected.namelist()[:3] and len(contents.namelist()) == 4
    settings = contents.read("resources/settings.toml")
    assert settings == expected.read("resources/settings.toml")
    model = tmp_path / "again.toml"
    model.write_bytes(contents.read("resources/model.toml"))
    again = jp.Gpr.from_file(model)
    assert np.allclose(again.socket_radius_m, gpr.socket_radius_m, rtol=1e-15) and again.name == gpr.name
    assert np.allclose(again.base_points_m, gpr.base_points_m, atol=1e-15)
    with pytest.raises(jp.NoAnswerError, match="6 motions free.*universal joint"):
        jp.Mechanism.from_catalogue("delta").to_fmu(library=library)
    with pytest.raises(jp.InputError, match="no actuated joint"):
        jp.Mechanism.from_toml(DOOR.replace("actuated = true\n", "")).to_fmu(library=library)
    with pytest.raises(jp.InputError, match="2 or 3"):
        mechanism.to_fmu(fmi=1, library=library)
    with pytest.raises(jp.InputError, match="not a shared library"):
        mechanism.to_fmu(library=Path(__file__))
    with pytest.raises(jp.InputError, match="two libraries"):
        mechanism.to_fmu(library=[library, library])
    with pytest.raises(FileNotFoundError):
        mechanism.to_fmu(library=tmp_path / "none.so")
    with pytest.raises(jp.InputError, match="three rod lengths"):
        gpr.to_fmu([0.5, 0.5], library=library)
    with pytest.raises(jp.InputError, match="checks limits"):
        gpr.without_limit_checks().to_fmu(library=library)
    # Without a library, that of the command on the path.
    command = tmp_path / "bin" / "jointplay"
    command.parent.mkdir()
    command.write_text("")
    command.chmod(0o755)
    monkeypatch.setenv("PATH", str(command.parent))
    with pytest.raises(jp.InputError, match="c-library"):
        mechanism.to_fmu()
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "libjointplay.so").write_bytes(library.read_bytes())
    if sys.platform == "linux":
        assert mechanism.to_fmu(name="gpr-mechanism") == unit


GEARS = """
kind = "mechanism"
name = "gear ring"
units = { length = "mm", angle = "deg" }
base = "frame"
joint = [
  { name = "A", kind = "revolute", links = ["frame", "a"], point = [0, 0, 0], axis = [0, 0, 1], actuated = true },
  { name = "nut", kind = "cylindrical", links = ["frame", "b"], point = [30, 0, 0], axis = [0, 0, 1] },
]
coupling = [
  { name = "mesh", coordinate = "nut[1]", terms = [{ coordinate = "A", ratio = -2 }] },
  { name = "thread", coordinate = "nut[0]", terms = [{ coordinate = "nut[1]", ratio = "5 / 360" }], offset = 2 },
  { name = "feed", coordinate = "nut[0]", terms = [{ coordinate = "A", ratio = "-10 / 360" }], offset = 2 },
]
"""


def test_couplings(ask, tmp_path):
    path = tmp_path / "gears.toml"
    path.write_text(GEARS)
    gears = jp.Mechanism.from_file(path)
    mesh, thread, feed = gears.couplings
    assert (mesh.name, mesh.coordinate, mesh.terms, mesh.offset) == ("mesh", "nut[1]", (("A", -2.0),), 0.0)
    # 5 mm a turn, in metres and radians.
    assert thread.terms[0][0] == "nut[1]"
    assert thread.terms[0][1] == pytest.approx(0.005 / math.tau)
    assert thread.offset == pytest.approx(0.002)
    assert feed.name == "feed"
    assert jp.Mechanism.from_catalogue("four-bar").couplings == ()
    report = ask("mobility", path)
    found = same(gears.mobility())
    assert found.couplings == report["couplings"] == 3
    [redundant] = found.redundant_constraints
    assert redundant.joints == ()
    assert list(redundant.couplings) == report["redundant_constraints"][0]["couplings"]
    assert set(redundant.couplings) == {"mesh", "thread", "feed"}
    assert set(found.couplings_in_all_self_stresses) == {"mesh", "thread", "feed"}
    assert list(found.couplings_in_all_self_stresses) == report["redundant_constraint_basis"]["couplings_in_all"]


def test_positions_stay_on_their_branch():
    four_bar = jp.Mechanism.from_catalogue("four-bar")
    far = four_bar.positions({"A": [0, -0.5, -1.03, -0.23]})
    near = four_bar.positions({"A": np.linspace(0, -0.23, 24)})
    assert (far.status == 0).all()
    np.testing.assert_allclose(far.coordinates[-1], near.coordinates[-1], atol=1e-9)


def test_balls_reach_their_commands():
    toml = """
kind = "mechanism"
name = "ball"
units = { length = "mm", angle = "rad" }
base = "world"
joint = [{ name = "b", kind = "spherical", links = ["world", "arm"], point = [10, 0, 0] }]
"""
    ball = jp.Mechanism.from_toml(toml)
    for steps in (1, 7):
        moved = ball.drive({"b[0]": 0.4, "b[1]": -0.9, "b[2]": 4.0}, steps=steps)
        assert [moved[f"b[{k}]"][-1] for k in range(3)] == [0.4, -0.9, 4.0]


def test_errors_of_types_name_the_argument():
    mechanism = jp.Mechanism.from_catalogue("four-bar")
    with pytest.raises(jp.ArgumentTypeError, match=r"^A has to be a number, not str$"):
        mechanism.mobility({"A": "x"})
    with pytest.raises(jp.ArgumentTypeError, match=r"^A has to be a number, not NoneType$"):
        mechanism.assemble({"A": None})
    with pytest.raises(jp.ArgumentTypeError, match=r"^starts has to be a whole number, not float$"):
        mechanism.branches(starts=2.5)
    with pytest.raises(jp.ArgumentTypeError, match=r"^crank has to be a number, not list$"):
        jp.Mechanism.from_catalogue("four-bar", parameters={"crank": [1]})
    with pytest.raises(TypeError):
        mechanism.mobility({"A": "x"})
