"""Virtualizations written in Python."""

from __future__ import annotations

import numpy as np
import pytest
from typed import Slides, tilt_angle, tilt_angles, refused

import jointplay as jp


@pytest.fixture
def gpr() -> jp.Gpr:
    """The paper's robot, which also answers beyond its limits, as the paper's study needs."""
    return jp.Gpr.paper().without_limit_checks()


def test_the_typed_program_runs(gpr):
    assert tilt_angle(gpr) == pytest.approx(0.02)
    np.testing.assert_allclose(tilt_angles(gpr), 0.02)
    assert refused() == "1:1"


@pytest.mark.parametrize("solver", ["newton", "least-norm"])
def test_the_radial_slides_written_anew(gpr, rods, solver):
    mine = gpr.forward(rods[0], Slides(), solver=solver)
    theirs = gpr.forward(rods[0], "radial", solver=solver)
    assert mine.virtualization == "slides" and mine.virtual_joint_names == theirs.virtual_joint_names
    np.testing.assert_allclose(mine.virtual_joints, theirs.virtual_joints, rtol=1e-13)
    np.testing.assert_allclose(mine.base_from_platform, theirs.base_from_platform, atol=1e-15)
    many, others = gpr.forward(rods, Slides(), solver=solver), gpr.forward(rods, "radial", solver=solver)
    # Those of the library are interpolated, without iterations.
    assert not others.iterations.any() and many.iterations.all()
    for name in set(others.quantities) - {"iterations"}:
        np.testing.assert_allclose(getattr(many, name), getattr(others, name), rtol=1e-11, atol=1e-14)


def test_any_object_with_the_methods_will_do(gpr):
    class Duck:
        name = "duck"
        joints = tuple(jp.VirtualJoint("l", limb) for limb in range(3))
        nominal, sockets, socket_velocities = Slides.nominal, Slides.sockets, Slides.socket_velocities

    one = gpr.forward((0.5, 0.501, 0.502), Duck())
    np.testing.assert_array_equal(one.origin_m, gpr.forward((0.5, 0.501, 0.502), Slides()).origin_m)


def test_a_closed_form_is_asked_first(gpr):
    class Exact(Slides):
        def closed_form(self, platform, sides):
            assert sides.shape == (3,)
            return gpr.forward((0.5, 0.501, 0.502), "radial", solver="newton").virtual_joints

    pose = gpr.forward((0.5, 0.501, 0.502), Exact())
    assert (pose.solver, pose.iterations) == ("closed-form", 0)
    assert gpr.forward((0.5, 0.501, 0.502), Slides()).solver == "least-norm"


class Raises(Slides):
    def __init__(self, after):
        self.left = after

    def sockets(self, platform, x):
        self.left -= 1
        if self.left < 0:
            raise KeyError("mine")
        return super().sockets(platform, x)


@pytest.mark.parametrize("after", [0, 1, 4])
def test_what_it_raises_comes_out_as_it_is(gpr, rods, after):
    for call in (lambda model: gpr.forward(rods[0], model), lambda model: gpr.forward(rods, model)):
        with pytest.raises(KeyError, match="mine"):
            call(Raises(after))


@pytest.mark.parametrize(
    ("change", "kind", "message"),
    [
        ({"sockets": lambda self, platform, x: np.zeros((2, 3))}, jp.ArrayError, r"sockets .*\(3, 2\), not \(2, 3\)"),
        ({"nominal": lambda self, platform: None}, TypeError, "nominal .*returned None"),
        ({"nominal": lambda self, platform: ["a"] * 3}, jp.ArrayTypeError, "<U1"),
        ({"socket_velocities": lambda self, platform, x: x}, jp.ArrayError, r"\(3, 3, 2\)"),
        ({"joints": []}, jp.InputError, "0 virtual joints, but needs 3 to 12"),
        ({"joints": [jp.VirtualJoint("l", 3)] * 3}, jp.InputError, "limbs are counted 0, 1, 2"),
        ({"joints": [jp.VirtualJoint("l", 0, "lineal")] * 3}, jp.UnknownNameError, "did you mean `linear`"),
        ({"joints": 3}, TypeError, "iterable"),
    ],
)
def test_what_is_no_virtualization(gpr, change, kind, message):
    with pytest.raises(kind, match=message):
        gpr.forward((0.5, 0.501, 0.502), type("Invalid", (Slides,), change)())


def test_objects_that_lack_something_are_told_what(gpr):
    with pytest.raises(TypeError, match="name, joints, nominal, sockets, socket_velocities.*int has no name"):
        gpr.forward((0.5, 0.501, 0.502), 3)
