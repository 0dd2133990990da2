"""Results of forward and inverse kinematics: immutable, with units in their names."""

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
"""Quantities that ``Gpr.forward`` computes for many poses."""


class ForwardMany(Many):
    """Poses of the platform for many sets of rods.

    The shape (...) of the poses is the shape of the rods without its last axis.
    The result contains the requested quantities only; a pose without a solution is NaN in all of them.
    Each column of an array is contiguous in memory, so the last axis has the largest stride.
    """

    __slots__ = ("_arrays", "failed", "failure_counts", "status", "virtual_joint_names", "virtualization")

    _arrays: dict[str, Floats]
    virtualization: str
    """Name of the virtualization."""
    virtual_joint_names: tuple[str, ...]
    """Names of the virtual joints with symbol, limb and unit, such as ``'u_1_m'``."""
    status: NDArray[np.uint8]
    """Status of each pose, shape (...): 0 for a solution, otherwise the reason as a ``Status``."""
    failed: int
    """Number of poses without a solution."""
    failure_counts: Mapping[str, int]
    """Number of failed poses by reason."""

    if TYPE_CHECKING:
        azimuth_rad: Floats
        """Tilt direction: azimuth of the platform normal, from -π to π, shape (...) [rad]."""
        tilt_rad: Floats
        """Tilt angle, from 0 to π, shape (...) [rad]."""
        torsion_rad: Floats
        """Torsion: rotation about the platform normal beyond the shortest rotation from the horizontal, shape (...) [rad]."""
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
        """Norm of the displacement of the virtual joints from nominal, in the metric, shape (...) [m]."""
        ball_displacement_m: Floats
        """Distance of each ball from the centre of its nominal socket, shape (..., 3) [m]."""
        sensitivity: Floats
        """Singular values of ∂X/∂P in the metric, in descending order, shape (..., 3)."""
        residual_m: Floats
        """Largest difference between a side and its virtual length, shape (...) [m]."""
        iterations: Floats
        """Number of iterations of the solver, 0 for a closed form and for interpolated poses, shape (...)."""

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
        """Names of the quantities that the result contains."""
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
        """Columns of all numbers of all poses, by name, each of shape (n,); poses with several axes in C order."""
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
    """Rods for many tilts.

    (...) is the broadcast shape of the tilts.
    """

    rods_m: Floats
    """Rod lengths, shape (..., 3), NaN without a solution [m]; each column is contiguous in memory."""
    status: NDArray[np.uint8]
    """Status of each tilt, shape (...): 0 for a solution, otherwise the reason as a ``Status``."""
    failed: int
    """Number of tilts without a solution."""
    failure_counts: Mapping[str, int]
    """Number of failed poses by reason."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """Columns of all numbers of all poses, by name, each of shape (n,); poses with several axes in C order."""
        return {**spread("rods_m", self.rods_m, AXES["rods_m"]), "status": self.status.reshape(-1)}

    def __repr__(self) -> str:
        return f"InverseMany(<{self.failures()}; shape {self.status.shape}>)"


@dataclass(frozen=True, eq=False, repr=False)
class Platform(Result):
    """Platform of the three-rod robot: nominal sockets in the platform frame."""

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
    """Pose of the rigid-platform approximation, with the gaps between its sockets and the balls."""

    rods_m: Floats
    """Rods of the exact inverse kinematics for the same plane, shape (3,) [m]."""
    base_from_platform: Floats
    """Homogeneous transform with the origin on the base axis, shape (4, 4) [m]."""
    gaps_m: Floats
    """Vector from each ball to its socket in the base frame, shape (3, 3), one row for each limb [m]."""


@dataclass(frozen=True, eq=False, repr=False)
class BallClearance(Result):
    """Clearance of the balls in their sockets that a pose requires, for rigid parts."""

    displacements_m: Floats
    """Displacement of each ball from the centre of its socket, by the virtualization, shape (3,) [m]."""
    lower_bound_m: float
    """Lower bound of the required radial clearance, for any position of the platform [m]."""
    upper_bound_m: float
    """Radial clearance that is sufficient for the pose: the largest displacement [m]."""
    available_m: float | None
    """Radial clearance of the robot [m]; ``None`` if it is unknown."""
    is_sufficient: bool | None
    """Whether the available clearance is sufficient; ``None`` if it is unknown, or between the bounds."""


@dataclass(frozen=True, eq=False, repr=False)
class RodDerivatives(Result):
    """Rods of a tilt, with derivatives by (θ_x, θ_y, z): the tilt as a rotation vector in the base plane, and the axis height."""

    rods_m: Floats
    """Rod lengths, shape (3,) [m]."""
    jacobian: Floats
    """First derivatives ∂q_k/∂(θ_x, θ_y, z), shape (3, 3), one row for each rod [m/rad, m/rad, 1]."""
    second: Floats
    """Second derivatives ∂²q_k/∂(θ_x, θ_y, z)², shape (3, 3, 3), one symmetric matrix for each rod [m/rad²]."""


@dataclass(frozen=True, eq=False, repr=False)
class PlatformDerivatives(Result):
    """Derivatives of a pose of the platform by the rods."""

    pose: Forward
    """Pose at which the derivatives are evaluated."""
    jacobian: Floats
    """Angular velocity, then velocity of the origin, in the base frame, for unit velocities of the rods, shape (6, 3) [rad/m, 1]."""
    jacobian_derivatives: Floats
    """Derivative of the Jacobian by each rod, shape (3, 6, 3) [rad/m², 1/m]."""
    virtual_joints: Floats
    """Derivatives of the M virtual joints by the rods, shape (M, 3) [1, rad/m]."""
    virtual_joints_second: Floats
    """Second derivatives of the M virtual joints by the rods, shape (M, 3, 3) [1/m, rad/m²]."""


@dataclass(frozen=True, eq=False, repr=False)
class BrokenLimits(Result):
    """Limits that many poses exceed.

    The shape (...) of the poses is the shape of the rods without its last axis.
    """

    rods: NDArray[np.bool_]
    """Whether each rod exceeds its limits, shape (..., 3)."""
    tilt: NDArray[np.bool_]
    """Whether the tilt exceeds its limit, shape (...)."""

    @property
    def any(self) -> NDArray[np.bool_]:
        """Whether each pose exceeds any limit, shape (...)."""
        return np.asarray(self.rods.any(axis=-1) | self.tilt)


@dataclass(frozen=True)
class BrokenLimit:
    """Limit that a pose exceeds."""

    limit: str
    """Name of the limit: ``'rod 1'``, ``'rod 2'``, ``'rod 3'`` or ``'tilt'``."""
    found: float
    """Value that exceeds the limit, in ``unit``."""
    min: float
    """Smallest allowed value, in ``unit``."""
    max: float
    """Largest allowed value, in ``unit``."""
    unit: str
    """Unit of the values, ``'m'`` or ``'rad'``."""
