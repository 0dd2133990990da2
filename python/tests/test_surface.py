"""No input gives a number that is none: a status, an error of the package, or finite numbers."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import jointplay as jp

NAN, INF = math.nan, math.inf

# What callers mean, what they mix up (mm for m, degrees for radians), and what no robot has.
ODD = (0.0, -0.0, 0.5, 0.02, 1.5, 2.0, 30.0, 120.0, 500.0, -0.1, -1.0, math.pi / 2, 1e-320, 1e-9, 1e16)
WILD = (1e50, 1e60, 1e154, 1e200, 1e308, -1e308, 1.7976931348623157e308, NAN, INF, -INF, 10**400, -(10**400), 2**63)
numbers = st.one_of(
    st.sampled_from(ODD + WILD), st.floats(), st.floats(0.49, 0.51), st.floats(-0.03, 0.03), st.integers()
)
triples = st.one_of(
    st.tuples(numbers, numbers, numbers),
    st.tuples(st.floats(0.49, 0.51), st.floats(0.49, 0.51), st.floats(0.49, 0.51)),
    numbers.map(lambda number: (number,) * 3),
)
counts = st.one_of(st.sampled_from([0, -1, 1, 2, 2**31, 2**63, 2**64, 10**30]), st.integers(-5, 5))
virtualizations = st.sampled_from(["planar", "radial", "polar", "offset"])
solvers = st.sampled_from(["newton", "least-norm", "closed-form"])
metrics = st.one_of(st.sampled_from(["paper", "radius"]), numbers)

PAPER = jp.Gpr.paper()
ROBOTS = st.sampled_from([PAPER, PAPER.without_limit_checks()])
FOUR_BAR = jp.Mechanism.from_catalogue("four-bar")
RODS = jp.Mechanism.from_catalogue("gpr-mechanism")

FORWARD = [
    *("rods_m", "sides_m", "azimuth_rad", "tilt_rad", "torsion_rad", "axis_height_m", "origin_m", "center_shift_m"),
    *("normal", "base_from_platform", "virtual_joints", "characteristic_length_m", "iterations", "residual_m"),
]
# Fields with NaN for unknown values.
UNKNOWN = {"clearances", "pitch_m_per_rad"}


def report(result: Any) -> Any:
    """Every number of a result that no status speaks of."""
    if isinstance(result, (jp.ForwardMany, jp.InverseMany, jp.Positions)):
        fine = (result.status == 0).reshape(-1)
        for name, column in result.columns().items():
            assert np.isfinite(column[fine]).all(), (name, column[fine])
            if name not in ("status", "residual"):
                assert np.isnan(column[~fine].astype(float)).all(), name
        assert result.failed == np.sum(~fine) == sum(result.failure_counts.values())
    elif isinstance(result, jp.Forward):
        yield from (getattr(result, name) for name in FORWARD)
    elif isinstance(result, jp.Inverse):
        yield result.rods_m
    elif isinstance(result, jp.ModelCurve):
        if result.failure is None:
            for field in dataclasses.fields(result):
                yield from report(getattr(result, field.name))
    elif dataclasses.is_dataclass(result):
        for field in dataclasses.fields(result):
            if field.name not in UNKNOWN:
                yield from report(getattr(result, field.name))
    elif isinstance(result, Mapping):
        for value in result.values():
            yield from report(value)
    elif isinstance(result, (list, tuple)):
        for value in result:
            yield from report(value)
    elif isinstance(result, (float, int, np.ndarray)):
        yield result


def check(call: Any) -> Any:
    """Whether a call keeps what the package promises; its result, or nothing where it raised."""
    try:
        result = call()
    except jp.JointplayError as error:
        assert str(error) and "argument" not in str(error)
        return None
    for value in report(result):
        kind = getattr(value, "dtype", np.dtype(float)).kind
        if not isinstance(value, str) and kind in "fiu":
            assert np.isfinite(np.asarray(value, dtype=float)).all(), (result, value)
    return result


def many(cases: int):
    return settings(
        max_examples=cases, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
    )


@many(600)
@given(ROBOTS, triples, virtualizations, solvers, metrics)
def test_forward(gpr, rods, virtualization, solver, metric):
    one = check(lambda: gpr.forward(rods, virtualization, solver=solver, metric=metric))
    if all(isinstance(rod, float) for rod in rods):
        rows = [rods, (0.5, 0.5, 0.5), rods]
        several = check(lambda: gpr.forward(rows, virtualization, solver=solver, metric=metric))
        if several is not None:
            assert (several.status[[0, 2]] == 0).all() == (one is not None)


@many(400)
@given(ROBOTS, numbers, numbers, st.one_of(st.none(), numbers))
def test_inverse(gpr, azimuth, tilt, height):
    one = check(lambda: gpr.inverse(azimuth, tilt, height))
    if isinstance(azimuth, float) and isinstance(tilt, float) and isinstance(height, float):
        several = check(lambda: gpr.inverse([azimuth, 0.0], tilt, height))
        assert several is not None and (several.status[0] == 0) == (one is not None)
    check(lambda: gpr.approximate(azimuth, tilt, height))


@many(300)
@given(ROBOTS, numbers, numbers, numbers, virtualizations, solvers, metrics)
def test_poses_for_a_tilt(gpr, azimuth, tilt, height, virtualization, solver, metric):
    how = {"solver": solver, "metric": metric}
    check(lambda: gpr.inverse_for_center(azimuth, tilt, height, virtualization, **how))
    check(lambda: gpr.tilt_play(azimuth, tilt, height, virtualization, **how))
    check(lambda: gpr.rod_derivatives(azimuth, tilt, height))
    check(lambda: gpr.compare([0.01, tilt], azimuth, height, **how))


@many(200)
@given(ROBOTS, triples, virtualizations, solvers, metrics, st.one_of(st.none(), numbers))
def test_analyses_of_rods(gpr, rods, virtualization, solver, metric, tilt):
    check(lambda: gpr.sensitivity(rods, virtualization, solver=solver, metric=metric))
    check(lambda: gpr.platform_derivatives(rods, virtualization, solver=solver, metric=metric))
    check(lambda: gpr.plane_tilt(rods))
    check(lambda: gpr.mobility(rods, virtualization))
    try:
        broken = gpr.broken_limits(rods, tilt)
    except jp.JointplayError:
        return
    if isinstance(broken, list):
        assert all(not limit.min <= limit.found <= limit.max for limit in broken)


@many(300)
@given(numbers, triples, st.tuples(numbers, numbers), numbers, numbers)
def test_dimensions(radius, angles, limits, tilt, height):
    what = {"rod_limits_m": limits, "tilt_limit_rad": tilt, "working_height_m": height}
    for angle in (None, angles):
        gpr = check(lambda angle=angle: jp.Gpr(socket_radius_m=radius, socket_angle_rad=angle, **what))
        if gpr is not None:
            for robot in (gpr, gpr.without_limit_checks()):
                check(lambda robot=robot: robot.inverse(0.3, 0.01))
                check(lambda robot=robot: robot.forward((0.5, 0.501, 0.502), "polar"))


@many(60)
@given(st.lists(numbers, max_size=3), st.lists(numbers, max_size=3), st.one_of(st.none(), numbers), metrics)
def test_studies(azimuths, tilts, height, metric):
    raster = {"azimuth_rad": azimuths, "tilt_rad": tilts, "height_m": height, "metric": metric}
    check(lambda: jp.study.simulate(PAPER, **raster))
    check(lambda: jp.study.check_bounds(PAPER, **raster))


@many(60)
@given(numbers, numbers, counts, st.one_of(st.none(), numbers))
def test_motions_of_a_mechanism(start, end, steps, tolerance):
    if isinstance(start, float) and isinstance(end, float) and not max(abs(start), abs(end)) > 7:
        check(lambda: FOUR_BAR.drive({"A": (start, end)}, steps=steps))
    elif abs(start) != 2**63:
        with pytest.raises(jp.JointplayError):
            FOUR_BAR.drive({"A": (NAN, end)}, steps=steps)
    with pytest.raises(jp.JointplayError):
        FOUR_BAR.drive({"A": 1}, steps=-abs(steps))
    with pytest.raises(jp.JointplayError):
        FOUR_BAR.branches({"A": 1}, starts=-abs(steps))
    check(lambda: FOUR_BAR.assemble({"A": start}, tolerance=tolerance))
    check(lambda: FOUR_BAR.mobility({"A": end}, tolerance=tolerance))


@many(60)
@given(st.lists(numbers, min_size=1, max_size=4), st.sampled_from(["least-norm", "newton"]))
def test_positions_of_a_mechanism(values, solver):
    if all(isinstance(value, float) for value in values):
        for mechanism, joint in ((FOUR_BAR, "A"), (RODS, "rod 1")):
            for check_limits in (True, False):
                check(lambda m=mechanism, j=joint, c=check_limits: m.positions({j: values}, solver=solver, check_limits=c))


@many(40)
@given(numbers, numbers)
def test_play_of_a_mechanism(first, second):
    check(lambda: RODS.relieve({"rod 1": first, "rod 2": second}))
    check(lambda: jp.Mechanism.from_catalogue("four-bar", parameters={"coupler": first}))


@many(60)
@given(counts)
def test_numbers_of_threads(threads):
    rods = np.full((3, 3), 0.5)
    check(lambda: PAPER.forward(rods, threads=threads))
    check(lambda: PAPER.inverse(np.zeros(3), 0.01, threads=threads))


def test_named_cases():
    free = PAPER.without_limit_checks()
    for call in (
        lambda: PAPER.forward([1e308] * 3, "planar"),
        lambda: free.forward([1e308] * 3, "planar"),
        lambda: FOUR_BAR.drive({"A": (0.2, 1.0)}, steps=-1),
        lambda: FOUR_BAR.drive({"A": (0.2, NAN)}),
        lambda: PAPER.inverse(30, 1.5),
        lambda: PAPER.inverse(0, math.radians(20)),
        lambda: PAPER.forward([120, 121, 122]),
        lambda: PAPER.forward([-0.1] * 3),
        lambda: PAPER.forward([0.1, 0.5, 0.1]),
    ):
        with pytest.raises(jp.JointplayError):
            call()
    assert np.isnan(free.forward(np.full((2, 3), 1e308)).origin_m).all()
    with pytest.raises(jp.NotFiniteError, match="A is nan|A is NaN"):
        FOUR_BAR.drive({"A": (0.2, NAN)})
