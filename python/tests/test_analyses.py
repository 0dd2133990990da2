"""What the three-rod robot is asked besides its poses: the same numbers as the command's."""

from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import pyarrow
import pytest
from test_virtualization import Raises
from typed import Slides

import jointplay as jp


@pytest.fixture
def gpr() -> jp.Gpr:
    """The paper's robot, which also answers beyond its limits, as the paper's study needs."""
    return jp.Gpr.paper().without_limit_checks()


def same(value):
    """A result is a value: it survives pickling and copying, and its repr names its type."""
    assert pickle.loads(pickle.dumps(value)) == value == copy.deepcopy(value)
    assert repr(value).startswith(type(value).__name__ + "(") and value != 0
    with pytest.raises(AttributeError):
        value.rank = 7
    return value


@pytest.mark.parametrize("arguments", [[], ["--q-mm", "500,501,502", "--virtualization", "polar"]])
def test_mobility(gpr, ask, arguments):
    report = ask("mobility", *arguments)
    found = same(gpr.mobility(*([(0.5, 0.501, 0.502), "polar"] if arguments else [])))
    for name in ("kutzbach_mobility", "instantaneous_mobility", "finite_mobility", "rank", "redundancy"):
        assert getattr(found, name) == report[name]
    assert list(found.finite_mobility_bounds) == report["finite_mobility_bounds"]
    np.testing.assert_allclose(found.singular_values, report["singular_values"], rtol=1e-14, atol=1e-15)
    np.testing.assert_allclose(found.null_space.T, report["null_space"], atol=1e-15)
    np.testing.assert_allclose(found.self_stress.T, report["self_stress"], atol=1e-15)
    assert found.null_space.shape == (12, found.instantaneous_mobility)
    if arguments:
        assert found.augmented.mobility == report["augmented_mobility"]
        np.testing.assert_allclose(
            found.augmented.singular_values, report["augmented_singular_values"], rtol=1e-13, atol=1e-15
        )
    else:
        assert found.augmented is None and found.finite_mobility < found.instantaneous_mobility


def test_tilt_play(gpr, ask):
    report = ask("sensitivity", "--tilt-deg", "1.5", "--virtualization", "polar", "--metric", "radius")
    play = same(gpr.tilt_play(0, math.radians(1.5), virtualization="polar", metric="radius"))
    assert play.displacement_m * 1e3 == pytest.approx(report["displacement_mm"], rel=1e-12)
    assert play.motion_m * 1e3 == pytest.approx(report["motion_mm"], rel=1e-13)
    for bounds, expected in zip((play.at_start, play.at_midpoint, play.at_end), report["bounds"], strict=True):
        assert bounds.held == expected["held"]
        for name in ("lower", "upper", "eigenvalue_lower", "eigenvalue_upper", "coarse_upper", "linear"):
            assert getattr(bounds, f"{name}_m") * 1e3 == pytest.approx(expected[f"{name}_mm"], rel=1e-9, abs=1e-12)
    np.testing.assert_allclose(play.limb_shares, report["rod_shares"], rtol=1e-9)
    np.testing.assert_allclose(play.side_shares, report["side_shares"], rtol=1e-9)
    there = same(gpr.sensitivity(play.end.rods_m, "polar", metric="radius"))
    assert there == play.at_end.sensitivity and there.rank == report["rank"]
    np.testing.assert_allclose(there.singular_values[:3], report["singular_values"][:3], rtol=1e-12)
    assert there.matrix.shape == (6, 12) and there.virtual_joint_names[3] == "phi_1_rad"
    by_svd = np.linalg.svd(there.matrix, compute_uv=False)
    np.testing.assert_allclose(there.singular_values, by_svd[: len(there.singular_values)], atol=1e-14)


def test_compare(gpr, ask):
    report = ask("compare")
    found = same(gpr.compare(np.radians(report["tilt_deg"]), math.radians(report["azimuth_deg"])))
    assert list(found.models) == [model["virtualization"] for model in report["models"]]
    for model in report["models"]:
        curve = found.models[model["virtualization"]]
        np.testing.assert_allclose(curve.center_shift_m[:, 0] * 1e6, model["center_shift_x_um"], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(
            curve.largest_displacement_m * 1e6, model["largest_displacement_um"], rtol=1e-9, atol=1e-9
        )
    assert pyarrow.table(found).column_names[:3] == ["tilt_rad", "approximate_gap_m", "radial_center_shift_x_m"]
    some = gpr.compare([0.01, 0.02], virtualizations=["radial", Slides()])
    radial, mine = some.models["radial"], some.models["slides"]
    np.testing.assert_allclose(mine.center_shift_m, radial.center_shift_m, atol=1e-14)
    with pytest.raises(jp.InputError, match='two virtualizations are named "slides": give each another name'):
        gpr.compare([0.01], virtualizations=[Slides(), "polar", Slides()])
    far = gpr.compare([0.01, 1.3], virtualizations=["offset"], solver="least-norm").models["offset"]
    assert "did not converge" in far.failure
    assert np.isfinite(far.center_shift_m[0]).all() and np.isnan(far.center_shift_m[1]).all()


def test_the_paper_s_study(gpr):
    study = same(jp.study.simulate())
    assert study.virtualization == "polar" and study.azimuth_rad.shape == (777,) and study.samples_per_row == 21
    rows = gpr.inverse(study.azimuth_rad, study.tilt_rad, 0.5)
    np.testing.assert_allclose(study.rods_m, rows.rods_m, rtol=1e-14)
    poses = gpr.forward(study.rods_m, "polar", solver="newton")
    single = [gpr.forward(rods, "polar", solver="newton").virtual_joints for rods in study.rods_m]
    np.testing.assert_allclose(study.virtual_joints, single, rtol=1e-12, atol=1e-15)
    # Arrays are interpolated to 1e-13 of the longest side: lengths, and angles at the mean radius.
    away = np.abs(study.virtual_joints - poses.virtual_joints)
    radius, longest = gpr.socket_radius_m.mean(), poses.sides_m.max()
    assert (away < 1e-13 * longest / np.array([1, 1, 1, radius, radius, radius])).all()
    np.testing.assert_allclose(study.origin_m, poses.origin_m, atol=1e-14)
    summary = study.summary
    assert summary.samples == 777 and summary.singular_passes == 37
    assert summary.largest_center_shift_m == pytest.approx(np.hypot(*study.origin_m[:, :2].T).max())
    assert sum(summary.iterations) == 777 and summary.series["q1"].max == study.rods_m[:, 0].max()
    assert summary.beyond_tilt == np.sum(np.abs(study.tilt_rad) > gpr.tilt_limit_rad * (1 + 1e-9))
    frame = study.to_dataframe()
    assert len(frame) == 777 and frame.phi_2_rad[5] == study.virtual_joints[5, 4]
    bounds = same(jp.study.check_bounds(azimuth_rad=[0.1], tilt_rad=[0, 0.01, 0.02]))
    assert (bounds.poses, bounds.held_at_start, bounds.held_at_midpoint) == (2, 0, 2)


def test_rasters_of_one_s_own(gpr):
    there = jp.study.simulate(gpr, Slides(), azimuth_rad=[0, 1], tilt_rad=[0.01, 0.02], order="serpentine")
    assert there.tilt_rad.tolist() == [0.01, 0.02, 0.02, 0.01] and there.azimuth_rad.tolist() == [0, 0, 1, 1]
    with pytest.raises(jp.InputError, match="no poses"):
        jp.study.simulate(gpr, azimuth_rad=[])
    with pytest.raises(jp.UnknownNameError, match="known: raster, serpentine"):
        jp.study.simulate(gpr, order="spiral")
    with pytest.raises(jp.TiltTooLargeError, match="sample 1") as caught:
        jp.study.simulate(gpr, azimuth_rad=[0.5], tilt_rad=[0, 2])
    assert (caught.value.sample, caught.value.azimuth_rad, caught.value.tilt_rad) == (1, 0.5, 2)
    with pytest.raises(jp.ArrayError, match=r"tilt_rad .* \(n,\), not \(1, 1\)"):
        jp.study.simulate(gpr, tilt_rad=[[0.1]])
    with pytest.raises(jp.InputError, match="at most 5000000"):
        jp.study.simulate(gpr, azimuth_rad=np.zeros(3000), tilt_rad=np.zeros(3000))


@pytest.mark.parametrize(
    "ask_it",
    [
        lambda gpr, model: gpr.mobility((0.5, 0.501, 0.502), model),
        lambda gpr, model: gpr.sensitivity((0.5, 0.501, 0.502), model),
        lambda gpr, model: gpr.tilt_play(0, 0.01, virtualization=model),
        lambda gpr, model: gpr.compare([0.01], virtualizations=[model]),
        lambda gpr, model: gpr.inverse_for_center(0, 0.01, 0.5, model),
        lambda gpr, model: jp.study.simulate(gpr, model),
        lambda gpr, model: jp.study.check_bounds(gpr, model),
    ],
)
def test_virtualizations_of_one_s_own_are_taken_everywhere(gpr, ask_it):
    ask_it(gpr, Slides())
    with pytest.raises(KeyError, match="mine"):
        ask_it(gpr, Raises(3))
