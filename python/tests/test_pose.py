"""One pose: numbers, what is taken, what is refused."""

from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import jointplay as jp

VIRTUALIZATIONS = ("radial", "polar", "offset", "planar")
SOLVERS = ("newton", "least-norm", "closed-form")


@pytest.mark.parametrize("virtualization", VIRTUALIZATIONS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_the_command_says_the_same(gpr, ask, virtualization, solver):
    arguments = ["--q-mm", "500,501,502", "--virtualization", virtualization, "--solver", solver]
    report = ask("forward", *arguments)
    pose = gpr.forward((0.5, 0.501, 0.502), virtualization, solver=solver)
    platform = report["platform"]
    assert pose.azimuth_rad == pytest.approx(math.radians(platform["azimuth_deg"]), rel=1e-14)
    assert pose.tilt_rad == pytest.approx(math.radians(platform["tilt_deg"]), rel=1e-14)
    assert pose.torsion_rad == pytest.approx(math.radians(platform["torsion_deg"]), rel=1e-13, abs=1e-18)
    assert pose.axis_height_m * 1e3 == pytest.approx(platform["axis_height_mm"], rel=1e-14)
    np.testing.assert_allclose(pose.origin_m * 1e3, platform["origin_mm"], rtol=1e-14)
    np.testing.assert_allclose(pose.normal, platform["normal"], rtol=1e-15)
    np.testing.assert_allclose(pose.base_from_platform[:3, :3], platform["rotation"], rtol=1e-15)
    np.testing.assert_allclose(pose.sides_m * 1e3, report["sides_mm"], rtol=1e-15)
    joints = [value for values in report["virtual_joints"].values() for value in values]
    units = [1e3 if name.endswith("_m") else 180 / math.pi for name in pose.virtual_joint_names]
    np.testing.assert_allclose(pose.virtual_joints * units, joints, rtol=1e-13, atol=1e-15)
    assert (pose.solver, pose.iterations) == (report["solver"], report["iterations"])
    assert pose.characteristic_length_m == pytest.approx(report["characteristic_length_mm"] / 1e3)


def test_metrics_are_those_of_the_command(gpr, ask):
    for metric, report in ((0.05, "50"), ("radius", "radius"), ("paper", "paper")):
        arguments = ["--q-mm", "500,501,502", "--virtualization", "polar", "--metric", report]
        origin = ask("forward", *arguments)["platform"]["origin_mm"]
        pose = gpr.forward([0.5, 0.501, 0.502], "polar", metric=metric)
        np.testing.assert_allclose(pose.origin_m * 1e3, origin, rtol=1e-14)


@given(
    azimuth=st.floats(-math.pi, math.pi),
    tilt=st.floats(1e-6, 0.05),
    height=st.floats(0.3, 0.7),
    virtualization=st.sampled_from(VIRTUALIZATIONS),
)
def test_forward_undoes_inverse(azimuth, tilt, height, virtualization):
    gpr = jp.Gpr.paper().without_limit_checks()
    rods = gpr.inverse(azimuth, tilt, height)
    pose = gpr.forward(rods.rods_m, virtualization, solver="newton")
    assert pose.tilt_rad == pytest.approx(tilt, rel=1e-8)
    assert math.cos(pose.azimuth_rad - azimuth) == pytest.approx(1, abs=1e-12)
    assert pose.axis_height_m == pytest.approx(height, rel=1e-12)
    assert gpr.plane_tilt(rods.rods_m) == pytest.approx((pose.azimuth_rad, pose.tilt_rad), rel=1e-9)


@pytest.mark.parametrize(
    "rods",
    [
        (0.5, 0.501, 0.502),
        [0.5, 0.501, 0.502],
        np.array([0.5, 0.501, 0.502]),
        np.array([0.5, 9, 0.501, 9, 0.502])[::2],
        np.array([0.502, 0.501, 0.5])[::-1],
        np.array([0.5, 0.501, 0.502], dtype=">f8"),
        [np.float64(0.5), np.float64(0.501), np.float64(0.502)],
    ],
    ids=["tuple", "list", "array", "stride", "backwards", "byte order", "scalars"],
)
def test_three_numbers_of_any_kind_are_one_pose(gpr, rods):
    assert gpr.forward(rods) == gpr.forward((0.5, 0.501, 0.502))


def test_whole_numbers_are_taken():
    gpr = jp.Gpr(socket_radius_m=2, rod_limits_m=(1, 9), tilt_limit_rad=0.1, working_height_m=5)
    assert gpr.forward([5, 5, 5]).axis_height_m == 5
    assert gpr.forward(np.array([5, 5, 5], dtype=np.int32)) == gpr.forward((5.0, 5.0, 5.0))


def test_scalars_of_numpy_and_arrays_without_axes_are_one_tilt(gpr):
    expected = gpr.inverse(0.3, 0.02, 0.5)
    assert isinstance(expected, jp.Inverse)
    assert gpr.inverse(np.float32(0), np.float64(0.02), 0.5).rods_m[0] == gpr.inverse(0, 0.02).rods_m[0]
    assert gpr.inverse(np.array(0.3), 0.02) == expected


def test_center_height_and_approximate(gpr):
    pose = gpr.inverse_for_center(0.3, 0.02, 0.5, "polar")
    assert pose.origin_m[2] == pytest.approx(0.5, abs=1e-15)
    rough = gpr.approximate(0.3, 0.02)
    np.testing.assert_array_equal(rough.rods_m, gpr.inverse(0.3, 0.02).rods_m)
    np.testing.assert_array_equal(rough.base_from_platform[:2, 3], 0)
    assert rough.gaps_m.shape == (3, 3) and 1e-6 < np.abs(rough.gaps_m).max() < 1e-4


def test_limits(gpr):
    assert gpr.broken_limits((0.5, 0.501, 0.502)) == []
    rod, tilt = gpr.broken_limits((0.5, 0.5, 0.8))
    assert (rod.limit, rod.found, rod.max, rod.unit) == ("rod 3", 0.8, 0.754, "m")
    assert (tilt.limit, tilt.unit) == ("tilt", "rad") and tilt.found > tilt.max
    assert gpr.broken_limits((0.5, 0.5, 0.5), tilt_rad=0.5)[0].limit == "tilt"
    rows = np.array([[(0.5, 0.501, 0.502), (0.5, 0.5, 0.8)], [(0.1, 0.1, 0.1), (0.5, np.nan, 0.5)]])
    many = gpr.broken_limits(rows)
    assert many.rods.tolist() == [[[False] * 3, [False, False, True]], [[True] * 3, [False, True, False]]]
    assert many.tilt.tolist() == [[False, True], [False, True]] and many.any.sum() == 3
    assert gpr.broken_limits(rows, tilt_rad=0.01).tilt.sum() == 0
    assert gpr.broken_limits(rows, tilt_rad=[0.01, 0.1]).tilt.tolist() == [[False, True]] * 2
    with pytest.raises(jp.ArrayError):
        gpr.broken_limits(rows, tilt_rad=np.zeros(5))


def test_poses_beyond_the_limits_are_refused(gpr):
    with pytest.raises(jp.RobotLimitsError, match="lengths are in m and angles in rad") as caught:
        gpr.inverse(30, 1.5)
    error = caught.value
    assert isinstance(error, jp.NoAnswerError)
    assert [limit.limit for limit in error.limits_broken] == ["rod 2", "rod 3", "tilt"]
    assert error.limits_broken[-1].found == 1.5 and error.limits_broken[-1].max == gpr.tilt_limit_rad
    assert pickle.loads(pickle.dumps(error)).limits_broken == error.limits_broken
    # Millimetres for metres.
    with pytest.raises(jp.RobotLimitsError):
        gpr.forward([120, 121, 122])
    for call in (
        lambda: gpr.inverse_for_center(0, 0.1, 0.5),
        lambda: gpr.approximate(0, 0.1),
        lambda: gpr.tilt_play(0, 0.1),
        lambda: gpr.compare([0.01, 0.1]),
        lambda: gpr.mobility([0.1, 0.1, 0.1]),
        lambda: gpr.sensitivity([0.1, 0.1, 0.1]),
    ):
        with pytest.raises(jp.RobotLimitsError):
            call()
    many = gpr.inverse([0, 30, 0], [0.01, 1.5, np.nan])
    assert many.status.tolist() == [jp.Status.SOLVED, jp.Status.BEYOND_LIMITS, jp.Status.NOT_FINITE]
    assert np.isnan(many.rods_m[1]).all() and "1 beyond the limits" in many.failures()
    poses = gpr.forward([[0.5, 0.501, 0.502], [120, 121, 122]])
    assert poses.status.tolist() == [0, jp.Status.BEYOND_LIMITS] and np.isnan(poses.origin_m[1]).all()

    free = gpr.without_limit_checks()
    assert gpr.checks_limits and not free.checks_limits and free != gpr and "check_limits=False" in repr(free)
    assert pickle.loads(pickle.dumps(free)) == free and free.tilt_limit_rad == gpr.tilt_limit_rad
    assert free.inverse(0, 0.1).rods_m[0] == pytest.approx(0.5 - math.tan(0.1) * gpr.socket_radius_m[0])
    assert free.inverse([0.0, 1.0], 0.1).failed == 0


def test_no_answer_is_raised_with_its_facts(gpr):
    gpr = gpr.without_limit_checks()
    with pytest.raises(jp.NotConvergedError) as caught:
        gpr.forward((0.2, 0.5, 0.9), "offset", solver="newton")
    error = caught.value
    assert isinstance(error, jp.NoAnswerError) and isinstance(error, jp.JointplayError)
    assert not isinstance(error, ValueError)
    assert error.solver == "newton" and error.residual_m > error.threshold_m > 0
    assert len(error.best_virtual_joints) == 6 and error.iterations > 0
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.residual_m) == (str(error), error.residual_m)

    with pytest.raises(jp.TurnedOverError) as caught:
        gpr.forward((0.2, 0.5, 0.9), "polar", solver="newton")
    assert len(caught.value.virtual_joints) == 6

    with pytest.raises(jp.TiltTooLargeError) as caught:
        gpr.inverse(0, 2)
    assert caught.value.tilt_rad == 2 and isinstance(caught.value, ValueError)
    with pytest.raises(jp.NotFiniteError) as caught:
        gpr.forward((0.5, math.nan, 0.5))
    assert math.isnan(caught.value.value)


def test_names_that_are_not_known_meet_those_that_are(gpr):
    for call, near in (
        (lambda: gpr.forward((0.5, 0.5, 0.5), "plannar"), "planar"),
        (lambda: gpr.forward((0.5, 0.5, 0.5), solver="newtown"), "newton"),
        (lambda: gpr.forward((0.5, 0.5, 0.5), metric="radios"), "radius"),
        (lambda: gpr.forward([[0.5, 0.5, 0.5]], quantities=["azimuth_deg"]), "azimuth_rad"),
    ):
        with pytest.raises(jp.UnknownNameError, match=f"did you mean `{near}`") as caught:
            call()
        assert near in caught.value.known and caught.value.name not in caught.value.known


@pytest.mark.parametrize(
    ("rods", "kind", "message"),
    [
        ([0.5, 0.5], jp.ArrayError, r"\(2,\)"),
        (0.5, jp.ArrayError, r"\(\)"),
        (np.zeros((3, 2)), jp.ArrayError, r"\(3, 2\)"),
        ([0.5, 0.5j, 0.5], jp.ArrayTypeError, r"\(3,\) and dtype complex128"),
        (["a", "b", "c"], jp.ArrayTypeError, "dtype <U1"),
        ([0.5, None, 0.5], jp.ArrayTypeError, "dtype object"),
        ([True, True, False], jp.ArrayTypeError, "dtype bool"),
        ([[0.5, 0.5, 0.5], [0.5]], jp.ArrayTypeError, "list"),
        (np.array(["2020"] * 3, dtype="M8[Y]"), jp.ArrayTypeError, "datetime64"),
    ],
)
def test_rods_that_are_none(gpr, rods, kind, message):
    with pytest.raises(kind, match=message) as caught:
        gpr.forward(rods)
    assert "metres" in str(caught.value) and "(..., 3)" in str(caught.value)


def test_dimensions_that_make_no_robot():
    fine = dict(socket_radius_m=0.1, rod_limits_m=(0.2, 0.8), tilt_limit_rad=0.03, working_height_m=0.5)
    with pytest.raises(jp.GeometryError, match="has to be positive"):
        jp.Gpr(**{**fine, "socket_radius_m": -1})
    with pytest.raises(jp.OutOfRangeError) as caught:
        jp.Gpr(**{**fine, "working_height_m": 0.9})
    assert (caught.value.value, caught.value.min, caught.value.max, caught.value.unit) == (0.9, 0.2, 0.8, "m")
    with pytest.raises(jp.ArrayError, match=r"socket_angle_rad has to be an array of shape \(3,\)"):
        jp.Gpr(**fine, socket_angle_rad=[0, 1])
    with pytest.raises(TypeError):
        jp.Gpr(0.1)


def test_files(tmp_path, gpr):
    from conftest import ROOT

    path = ROOT / "crates/jointplay-format/robots" / "gpr.toml"
    assert jp.Gpr.from_file(path) == jp.Gpr.from_file(str(path)) == jp.Gpr.from_toml(path.read_text()) == gpr
    with pytest.raises(FileNotFoundError) as missing:
        jp.Gpr.from_file(tmp_path / "none.toml")
    # A text, as of `open`, and not the representation of a path object.
    assert missing.value.filename == str(tmp_path / "none.toml")
    invalid = tmp_path / "invalid.toml"
    invalid.write_text(path.read_text().replace("tilt_deg = 1.5", "tilt_deg = nan"))
    with pytest.raises(jp.FileError, match="invalid.toml:28:12: `tilt_deg` is not a number") as caught:
        jp.Gpr.from_file(invalid)
    assert (caught.value.line, caught.value.column) == (28, 12)
    (tmp_path / "binary").write_bytes(b"\xff\xfe")
    with pytest.raises(jp.InputError, match="UTF-8"):
        jp.Gpr.from_file(tmp_path / "binary")


def test_robots_and_poses_are_values(gpr):
    other = jp.Gpr(
        socket_radius_m=[0.1, 0.11, 0.12],
        socket_angle_rad=[0, 2, 4],
        base_points_m=[[0.1, 0], [-0.05, 0.1], [-0.05, -0.1]],
        rod_limits_m=(0.2, 0.8),
        tilt_limit_rad=0.03,
        working_height_m=0.5,
        name="mine",
    )
    pose = other.forward((0.5, 0.501, 0.502), "planar")
    for value in (gpr, other, pose, gpr.inverse(0.1, 0.02), gpr.approximate(0.1, 0.02), gpr.platform):
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
            assert pickle.loads(pickle.dumps(value, protocol)) == value
        assert copy.copy(value) == copy.deepcopy(value) == value
        assert value != 3 and "(" in repr(value)
    assert gpr != other and len({gpr, jp.Gpr.paper(), other}) == 2
    assert pose != other.forward((0.5, 0.501, 0.502), "polar")
    with pytest.raises(AttributeError):
        gpr.name = "other"
    with pytest.raises(AttributeError):
        pose.azimuth_rad = 1


def test_derivatives_of_the_robot_are_those_of_its_poses_and_of_its_mechanism():
    gpr = jp.Gpr.paper()
    rods = np.array([0.502, 0.499, 0.5])
    found = gpr.platform_derivatives(rods, "radial")
    assert found.pose == gpr.forward(rods, "radial")
    for k, step in enumerate(1e-4 * np.eye(3)):
        less, more = (gpr.platform_derivatives(rods + by, "radial") for by in (-step, step))
        origin = (more.pose.origin_m - less.pose.origin_m) / 2e-4
        assert np.allclose(found.jacobian[3:, k], origin, atol=1e-7)
        joints = (more.pose.virtual_joints - less.pose.virtual_joints) / 2e-4
        assert np.allclose(found.virtual_joints[:, k], joints, atol=1e-7)
        assert np.allclose(found.jacobian_derivatives[k], (more.jacobian - less.jacobian) / 2e-4, atol=1e-5)
        second = (more.virtual_joints - less.virtual_joints) / 2e-4
        assert np.allclose(found.virtual_joints_second[:, :, k], second, atol=1e-5)
    mechanism = jp.Mechanism.from_catalogue("gpr-mechanism")
    expected = mechanism.jacobian("platform", {"rod 1": 0.002, "rod 2": -0.001, "rod 3": 0.0})
    # The frame of the platform link is that of the base at rods of 500 mm.
    arm = found.pose.origin_m - expected.pose[:3, 3]
    linear = expected.matrix[3:] + np.cross(expected.matrix[:3].T, arm).T
    assert np.allclose(found.jacobian, np.vstack([expected.matrix[:3], linear]), atol=1e-9)

    tilt = gpr.rod_derivatives(0.3, 0.01)
    assert np.array_equal(tilt.rods_m, gpr.inverse(0.3, 0.01).rods_m)
    # A higher plane needs longer rods, all alike; tilting is what the platform does for the rods.
    assert np.array_equal(tilt.jacobian[:, 2], np.ones(3)) and tilt.second.shape == (3, 3, 3)
    turning = gpr.platform_derivatives(gpr.rod_derivatives(0.0, 0.0).rods_m).jacobian[:3]
    assert np.allclose(turning @ gpr.rod_derivatives(0.0, 0.0).jacobian, np.eye(3) * [1, 1, 0], atol=1e-12)
    assert pickle.loads(pickle.dumps(found)) == found

    with pytest.raises(jp.InputError, match="follow from no equation"):
        gpr.platform_derivatives(rods, "polar", solver="newton")


def test_needed_clearance_of_the_balls():
    tilt = np.radians(1.5)
    gpr = jp.Gpr.paper()
    rods = gpr.inverse(np.radians(30.0), tilt).rods_m
    found = gpr.needed_clearance(rods, "radial")
    # Along a side only this side changes, by 1/cos of the tilt.
    side = np.sqrt(3.0) * 93.218e-3 * (1.0 / np.cos(tilt) - 1.0)
    assert found.lower_bound_m == pytest.approx(side / 2.0, rel=1e-9)
    assert found.upper_bound_m == max(found.displacements_m) >= found.lower_bound_m
    assert (found.available_m, found.is_sufficient, gpr.ball_clearance_m) == (None, None, None)
    many = gpr.forward(np.array([rods, rods]), "radial")
    np.testing.assert_allclose(many.ball_displacement_m, [found.displacements_m] * 2, rtol=0.0, atol=1e-15)

    text = """
kind = "gpr"
limb = [
  { socket_radius_mm = 93.218, socket_angle_deg = 0 },
  { socket_radius_mm = 93.218, socket_angle_deg = 120 },
  { socket_radius_mm = 93.218, socket_angle_deg = 240 },
]
limits = { rod_mm = [246, 754], tilt_deg = 1.5 }
working = { height_mm = 500 }
ball = { clearance_radius_um = 20 }
"""
    small = jp.Gpr.from_toml(text)
    assert small.ball_clearance_m == 20e-6
    assert small.needed_clearance(rods, "radial").is_sufficient is False
    assert pickle.loads(pickle.dumps(small)) == small != jp.Gpr.from_toml(text.replace("= 20 }", "= 21 }"))
    with pytest.raises(jp.FileError, match="clearance_radius_um"):
        jp.Gpr.from_toml(text.replace("= 20 }", "= -20 }"))
