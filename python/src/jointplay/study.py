"""Studies: rasters of tilts as in the paper, and plans of any number of samples in chunks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from numpy.typing import ArrayLike

from ._jointplay import Chunk, Gpr, Plan, Schema
from ._parts import Parts

if TYPE_CHECKING:
    from ._analyses import BoundsCheck, Study
    from ._virtualization import Virtualization

__all__ = ["Chunk", "Parts", "Plan", "Schema", "check_bounds", "simulate"]

Parts.__module__ = __name__


def simulate(
    gpr: Gpr | None = None,
    virtualization: Literal["planar", "radial", "polar", "offset"] | Virtualization = "polar",
    *,
    azimuth_rad: ArrayLike | None = None,
    tilt_rad: ArrayLike | None = None,
    height_m: float | None = None,
    order: Literal["raster", "serpentine"] = "raster",
    solver: Literal["closed-form", "least-norm", "newton"] = "newton",
    metric: Literal["paper", "radius"] | float = "paper",
) -> Study:
    """Computes all poses of a raster of tilts, each from the nominal virtual joints.

    The defaults are those of the paper: its robot, and tilt angles from -2° to 2° in steps of 0.2° for each azimuth from 0° to 360° in steps of 10°.

    Parameters
    ----------
    gpr
        The robot; by default that of the paper.
    virtualization
        The virtual joints that model the play.
    azimuth_rad, tilt_rad
        Arrays of shape (n,), the slow and the fast axis of the raster [rad].
    height_m
        Axis height [m]; by default the working height of the robot.
    order
        ``'raster'``: each azimuth from the first tilt angle to the last; ``'serpentine'``: every second azimuth in reverse.
    solver, metric
        Solver and metric as in ``Gpr.forward``; by default the iteration of the paper.
    """
    if order not in ("raster", "serpentine"):
        from ._errors import UnknownNameError

        known = ["raster", "serpentine"]
        message = f"order `{order}` is not known; known: {', '.join(known)}"
        raise UnknownNameError(message, what="order", name=order, known=known)
    robot = Gpr.paper() if gpr is None else gpr
    return robot._simulate(
        virtualization, azimuth_rad, tilt_rad, height_m, order == "serpentine", solver, metric
    )


def check_bounds(
    gpr: Gpr | None = None,
    virtualization: Literal["planar", "radial", "polar", "offset"] | Virtualization = "polar",
    *,
    azimuth_rad: ArrayLike | None = None,
    tilt_rad: ArrayLike | None = None,
    height_m: float | None = None,
    solver: Literal["closed-form", "least-norm", "newton"] = "newton",
    metric: Literal["paper", "radius"] | float = "paper",
) -> BoundsCheck:
    """Compares the exact displacement of each tilted pose, from the level pose at the same height, with the first-order bounds of the paper.

    The parameters are those of ``simulate``.
    """
    robot = Gpr.paper() if gpr is None else gpr
    return robot._check_bounds(virtualization, azimuth_rad, tilt_rad, height_m, solver, metric)
