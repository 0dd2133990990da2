"""Results of poses: frozen, with their units in their names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._base import AXES, Floats, Many, Result, spread

if TYPE_CHECKING:
    from ._jointplay import Forward


QUANTITIES = (
    "azimuth_rad",
    "tilt_rad",
    "torsion_rad",
    "axis_height_m",
    "origin_m",
    "normal",
    "sides_m",
    "virtual_joints",
    "displacement_m",
    "ball_displacement_m",
    "sensitivity",
    "residual_m",
    "iterations",
)
"""What can be asked of many poses."""


class ForwardMany(Many):
    """Where the platform is for each of many rods.

    With (...) for the shape of the poses, that of the rods without their last axis.
    Only the quantities that were asked for are there; a pose without an answer is NaN in all of them.
    The columns of an array lie in one piece each, so that its last axis is not the fastest.
    """

    __slots__ = ("_arrays", "failed", "failure_counts", "status", "virtual_joint_names", "virtualization")

    _arrays: dict[str, Floats]
    virtualization: str
    """Name of the virtualization."""
    virtual_joint_names: tuple[str, ...]
    """Symbol, limb and unit of each virtual joint, such as ``'u_1_m'``."""
    status: NDArray[np.uint8]
    """What became of each pose, shape (...): 0 where it has an answer, else a ``Status``."""
    failed: int
    """How many poses have no answer."""
    failure_counts: Mapping[str, int]
    """How many have none for which reason."""

    if TYPE_CHECKING:
        azimuth_rad: Floats
        """Tilt direction: azimuth of the platform normal, from -π to π, shape (...) [rad]."""
        tilt_rad: Floats
        """Tilt angle, from 0 to π, shape (...) [rad]."""
        torsion_rad: Floats
        """Turn about the platform normal beyond the shortest rotation to it, shape (...) [rad]."""
        axis_height_m: Floats
        """Height at which the platform plane crosses the base axis, shape (...) [m]."""
        origin_m: Floats
        """Platform origin in the base frame, shape (..., 3) [m]."""
        normal: Floats
        """Platform normal in the base frame, shape (..., 3)."""
        sides_m: Floats
        """Sides L_12, L_23, L_31 between the ball centres, shape (..., 3) [m]."""
        virtual_joints: Floats
        """Displacements of the virtual joints, shape (..., M) [m, rad]."""
        displacement_m: Floats
        """How far the virtual joints are from nominal, in the metric, shape (...) [m]."""
        ball_displacement_m: Floats
        """Distance of each ball from the centre of its nominal socket, shape (..., 3) [m]."""
        sensitivity: Floats
        """Singular values of ∂X/∂P in the metric, the largest first, shape (..., 3)."""
        residual_m: Floats
        """Largest difference between a side and its virtual length, shape (...) [m]."""
        iterations: Floats
        """Iterations of the solver, 0 for a closed form, shape (...)."""

    def __init__(
        self,
        *,
        virtualization: str,
        virtual_joint_names: tuple[str, ...],
        arrays: dict[str, Floats],
        status: NDArray[np.uint8],
        failed: int,
        failure_counts: Mapping[str, int],
    ) -> None:
        keep = object.__setattr__
        keep(self, "virtualization", virtualization)
        keep(self, "virtual_joint_names", virtual_joint_names)
        keep(self, "_arrays", arrays)
        keep(self, "status", status)
        keep(self, "failed", failed)
        keep(self, "failure_counts", MappingProxyType(dict(failure_counts)))

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of the arrays that are here."""
        return tuple(self._arrays)

    def __getattr__(self, name: str) -> Floats:
        if not name.startswith("_") and name in self._arrays:
            return self._arrays[name]
        if name in QUANTITIES:
            raise AttributeError(
                f"{name} was not asked for: quantities are {', '.join(self._arrays)}", name=name, obj=self
            )
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}", name=name, obj=self)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"results do not change: {name} cannot be set")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"results do not change: {name} cannot be deleted")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._arrays]

    def _fields_shown(self) -> Iterator[tuple[str, Any]]:
        yield "virtualization", self.virtualization
        yield from self._arrays.items()
        yield "status", self.status

    def __repr__(self) -> str:
        return (
            f"ForwardMany(<{self.failures()}; virtualization {self.virtualization!r}, "
            f"shape {self.status.shape}: {', '.join(self._arrays)}>)"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        state = {
            "virtualization": self.virtualization,
            "virtual_joint_names": self.virtual_joint_names,
            "arrays": self._arrays,
            "status": self.status,
            "failed": self.failed,
            "failure_counts": dict(self.failure_counts),
        }
        return _again, (ForwardMany, state)

    def columns(self) -> dict[str, NDArray[Any]]:
        """Every number of every pose by name, each of shape (n,); poses of several axes in C order."""
        columns: dict[str, NDArray[Any]] = {}
        for name, values in self._arrays.items():
            axes = self.virtual_joint_names if name == "virtual_joints" else AXES.get(name, ())
            columns.update(spread(name, values, axes))
        columns["status"] = self.status.reshape(-1)
        return columns


def _again(cls: type[Any], state: dict[str, Any]) -> Any:
    return cls(**state)


@dataclass(frozen=True, eq=False, repr=False)
class InverseMany(Many):
    """The rods of many tilts.

    With (...) for the shape that the tilts have together.
    """

    rods_m: Floats
    """Rod lengths, shape (..., 3), NaN where there are none [m]; each column lies in one piece."""
    status: NDArray[np.uint8]
    """What became of each pose, shape (...): 0 where it has rods, else a ``Status``."""
    failed: int
    """How many poses have no rods."""
    failure_counts: Mapping[str, int]
    """How many have none for which reason."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """Every number of every pose by name, each of shape (n,); poses of several axes in C order."""
        return {**spread("rods_m", self.rods_m, AXES["rods_m"]), "status": self.status.reshape(-1)}

    def __repr__(self) -> str:
        return f"InverseMany(<{self.failures()}; shape {self.status.shape}>)"


@dataclass(frozen=True, eq=False, repr=False)
class Platform(Result):
    """The platform as built: nominal sockets in the platform frame."""

    radii_m: Floats
    """Socket radii r_k, shape (3,) [m]."""
    angles_rad: Floats
    """Socket angles β_k, shape (3,) [rad]."""
    directions: Floats
    """Unit vectors from the origin toward the sockets, shape (3, 2)."""
    sockets_m: Floats
    """Nominal sockets, shape (3, 2) [m]."""
    mean_radius_m: float
    """Mean of the socket radii [m]."""


@dataclass(frozen=True, eq=False, repr=False)
class Approximate(Result):
    """The pose of the approximate model, and how far it tears the sockets off the balls."""

    rods_m: Floats
    """Rods of the exact inverse kinematics for the same plane, shape (3,) [m]."""
    base_from_platform: Floats
    """Homogeneous transform with the origin on the base axis, shape (4, 4) [m]."""
    gaps_m: Floats
    """From each ball to its socket, in the base frame, shape (3, 3), a row for each limb [m]."""


@dataclass(frozen=True, eq=False, repr=False)
class BallClearance(Result):
    """Clearance of the balls in their sockets that a pose needs, for rigid parts."""

    displacements_m: Floats
    """Displacement of each ball from the centre of its socket, under the virtualization, shape (3,) [m]."""
    lower_bound_m: float
    """Radial clearance that is needed wherever the platform settles, at least [m]."""
    upper_bound_m: float
    """Radial clearance at which the pose is possible: the largest displacement [m]."""
    available_m: float | None
    """Radial clearance of the robot; None where it is not known [m]."""
    is_sufficient: bool | None
    """Whether the available clearance is sufficient; None where it is unknown, or between the bounds."""


@dataclass(frozen=True, eq=False, repr=False)
class RodDerivatives(Result):
    """Rods of a tilt with their derivatives by (θ_x, θ_y, z): the tilt as a rotation vector in the base plane, and the axis height."""

    rods_m: Floats
    """Rod lengths, shape (3,) [m]."""
    jacobian: Floats
    """∂q_k/∂(θ_x, θ_y, z), shape (3, 3), a row for each rod [m/rad, m/rad, 1]."""
    second: Floats
    """∂²q_k/∂(θ_x, θ_y, z)², shape (3, 3, 3), a symmetric matrix for each rod [m/rad²]."""


@dataclass(frozen=True, eq=False, repr=False)
class PlatformDerivatives(Result):
    """Derivatives of a pose of the platform by the rods."""

    pose: Forward
    """The pose."""
    jacobian: Floats
    """Angular velocity, then velocity of the origin, in the base frame, for unit velocities of the rods, shape (6, 3) [rad/m, 1]."""
    jacobian_derivatives: Floats
    """Derivative of the Jacobian by each rod, shape (3, 6, 3) [rad/m², 1/m]."""
    virtual_joints: Floats
    """Derivatives of the M virtual joints by the rods, shape (M, 3) [1, rad/m]."""
    virtual_joints_second: Floats
    """Their second derivatives, shape (M, 3, 3) [1/m, rad/m²]."""


@dataclass(frozen=True, eq=False, repr=False)
class BrokenLimits(Result):
    """The limits that many poses break.

    With (...) for the shape of the poses, that of the rods without their last axis.
    """

    rods: NDArray[np.bool_]
    """Whether each rod is beyond its limits, shape (..., 3)."""
    tilt: NDArray[np.bool_]
    """Whether the tilt is beyond its limit, shape (...)."""

    @property
    def any(self) -> NDArray[np.bool_]:
        """Whether a pose breaks any limit, shape (...)."""
        return np.asarray(self.rods.any(axis=-1) | self.tilt)


@dataclass(frozen=True)
class BrokenLimit:
    """A limit that a pose breaks."""

    limit: str
    """``'rod 1'``, ``'rod 2'``, ``'rod 3'`` or ``'tilt'``."""
    found: float
    """What was found, in ``unit``."""
    min: float
    """Least that is allowed, in ``unit``."""
    max: float
    """Greatest that is allowed, in ``unit``."""
    unit: str
    """``'m'`` or ``'rad'``."""
