"""Results of the analyses and studies of the three-rod robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._base import AXES, Floats, Result, Table, latex_array, latex_text, spread

if TYPE_CHECKING:
    from ._jointplay import Forward


@dataclass(frozen=True, eq=False, repr=False)
class AugmentedMobility(Result):
    """Mobility of the three-rod robot with its virtual joints free."""

    virtualization: str
    """Name of the virtualization."""
    mobility: int
    """Instantaneous mobility with the virtual joints free."""
    rank: int
    """Number of independent constraints."""
    singular_values: Floats
    """Singular values of the scaled Jacobian [∂Φ/∂P ∂Φ/∂X], in descending order."""


@dataclass(frozen=True, eq=False, repr=False)
class Freedoms(Result):
    """Kutzbach, instantaneous and finite mobility."""

    kutzbach_mobility: int
    """Kutzbach mobility, from the numbers of freedoms and constraints."""
    instantaneous_mobility: int
    """Instantaneous mobility h."""
    finite_mobility: int | None
    """Finite mobility; ``None`` if undecided."""
    finite_mobility_bounds: tuple[int, int]
    """Bounds between which the finite mobility lies."""
    rank: int
    """Number of independent constraints."""
    redundancy: int
    """Number of redundant constraints r."""
    threshold: float
    """Threshold at or below which singular values count as zero."""
    characteristic_length_m: float
    """Characteristic length, which scales the Jacobian [m]."""

    def _repr_latex_(self) -> str:
        low, high = self.finite_mobility_bounds
        finite = rf"{low} \text{{ to }} {high}" if self.finite_mobility is None else str(self.finite_mobility)
        rows = (
            ("Kutzbach mobility", str(self.kutzbach_mobility)),
            ("instantaneous mobility", str(self.instantaneous_mobility)),
            ("finite mobility", finite),
            ("rank", str(self.rank)),
            ("redundant constraints", str(self.redundancy)),
        )
        return latex_array("lr", [(latex_text(name), value) for name, value in rows])


@dataclass(frozen=True, eq=False, repr=False)
class Mobility(Freedoms):
    """Mobility of the three-rod robot.

    The coordinates are q_1, q_2, q_3, P_1, P_2, P_3; the constraints are three for each rod, then the sides 12, 23, 31.
    """

    singular_values: Floats
    """Singular values of the scaled constraint Jacobian, in descending order."""
    null_space: Floats
    """Basis of the instantaneous motions as columns, shape (n, h), in radians and characteristic lengths."""
    self_stress: Floats
    """Orthonormal self-stresses as columns, shape (c, r)."""
    augmented: AugmentedMobility | None
    """Mobility with the virtual joints free; ``None`` if no virtualization was given."""


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivity(Result):
    """Sensitivity ∂X/∂P in the metric, angles multiplied by the characteristic length."""

    matrix: Floats
    """Matrix ∂X/∂P, shape (M, 12), with columns for q_1, q_2, q_3, P_1, P_2, P_3."""
    rank: int
    """Number of non-zero singular values, r."""
    singular_values: Floats
    """Singular values of ∂X/∂P, in descending order."""
    right_vectors: Floats
    """Right singular vectors of the non-zero singular values, shape (12, r)."""
    characteristic_length_m: float
    """Characteristic length, by which angles are multiplied [m]."""
    virtualization: str
    """Name of the virtualization."""
    virtual_joint_names: tuple[str, ...]
    """Names of the virtual joints, one for each row."""


@dataclass(frozen=True, eq=False, repr=False)
class Bounds(Result):
    """First-order bounds of the virtual displacement."""

    lower_m: float
    """Lower bound σ_min ‖V₃ᵀΔP‖ [m]."""
    upper_m: float
    """Upper bound σ_max ‖V₃ᵀΔP‖ [m]."""
    eigenvalue_lower_m: float
    """Lower bound by eigenvalues [m]."""
    eigenvalue_upper_m: float
    """Upper bound by eigenvalues [m]."""
    coarse_upper_m: float
    """Coarse upper bound σ_max ‖ΔP‖ [m]."""
    linear_m: float
    """Linear estimate ‖∂X/∂P ΔP‖ [m]."""
    held: bool
    """Whether the exact displacement is between ``lower_m`` and ``upper_m``."""
    sensitivity: Sensitivity
    """Sensitivity ∂X/∂P from which the bounds are computed."""


@dataclass(frozen=True, eq=False, repr=False)
class TiltPlay(Result):
    """Displacement of the virtual joints from the level pose to a tilt, with first-order bounds."""

    start: Forward
    """Level pose, at the start of the motion."""
    end: Forward
    """Tilted pose, at the end of the motion."""
    displacement_m: float
    """Exact displacement of the virtual joints ‖ΔX‖, in the metric [m]."""
    motion_m: float
    """Displacement of the links ‖ΔP‖ [m]."""
    at_start: Bounds
    """Bounds with the Jacobian at the level pose, where they are zero."""
    at_midpoint: Bounds
    """Bounds with the Jacobian at the midpoint of the motion."""
    at_end: Bounds
    """Bounds with the Jacobian at the tilted pose."""
    limb_shares: Floats | None
    """Share of each limb in the displacement, shape (3,); ``None`` without a displacement."""
    side_shares: Floats | None
    """Share of each side 12, 23, 31 in the displacement, shape (3,); ``None`` without a displacement."""


@dataclass(frozen=True, eq=False, repr=False)
class ModelCurve(Result):
    """Results of one virtualization over a range of tilts."""

    name: str
    """Name of the virtualization."""
    center_shift_m: Floats
    """Offset of the platform's origin from the base axis, shape (n, 2) [m]."""
    largest_displacement_m: Floats
    """Largest displacement of a socket from its nominal position in the platform, shape (n,) [m]."""
    failure: str | None
    """Reason for which the numbers are NaN from some tilt angle on; ``None`` if all are finite."""


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Table):
    """Comparison of virtualizations over the same tilts."""

    azimuth_rad: float
    """Azimuth of all tilts [rad]."""
    height_m: float
    """Axis height of all tilts [m]."""
    tilt_rad: Floats
    """Tilt angles, shape (n,) [rad]."""
    approximate_gap_m: Floats
    """Largest distance of a socket from its ball in the approximate model, shape (n,) [m]."""
    models: Mapping[str, ModelCurve]
    """Results of the virtualizations, by name."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """Columns of the tilt angle, the gap of the approximate model, and three columns of each virtualization, such as ``planar_center_shift_x_m``."""
        columns: dict[str, NDArray[Any]] = {
            "tilt_rad": self.tilt_rad,
            "approximate_gap_m": self.approximate_gap_m,
        }
        for name, model in self.models.items():
            columns[f"{name}_center_shift_x_m"] = model.center_shift_m[:, 0]
            columns[f"{name}_center_shift_y_m"] = model.center_shift_m[:, 1]
            columns[f"{name}_largest_displacement_m"] = model.largest_displacement_m
        return columns


@dataclass(frozen=True, eq=False, repr=False)
class SeriesSummary(Result):
    """Summary of one series of a study, in metres or radians."""

    name: str
    """Name of the series: symbol and limb or side, such as ``'q1'``, ``'L12'``, ``'phi3'``."""
    min: float
    """Smallest value of the series."""
    max: float
    """Largest value of the series."""
    pass_min: float | None
    """Smallest value at a level pose; ``None`` without level poses."""
    pass_max: float | None
    """Largest value at a level pose; ``None`` without level poses."""
    minimum_at: int
    """Number of level poses with the smallest value of their row."""
    maximum_at: int
    """Number of level poses with the largest value of their row."""
    constant_at: int
    """Number of level poses in rows along which the series is constant."""


@dataclass(frozen=True, eq=False, repr=False)
class StudySummary(Result):
    """Summary of a study."""

    samples: int
    """Number of poses."""
    singular_passes: int
    """Number of level poses."""
    largest_center_shift_m: float
    """Largest distance of the platform's origin from the base axis [m]."""
    largest_torsion_rad: float
    """Largest magnitude of the torsion about the platform normal [rad]."""
    largest_residual_m: float
    """Largest residual of the sides [m]."""
    iterations: tuple[int, ...]
    """Histogram of iterations: ``iterations[n]`` is the number of poses with n iterations."""
    beyond_tilt: int
    """Number of poses that exceed the tilt limit of the robot."""
    beyond_stroke: int
    """Number of poses with a rod beyond the limits of the robot."""
    series: Mapping[str, SeriesSummary]
    """Summaries of rods, sides and virtual joints, by name."""


@dataclass(frozen=True, eq=False, repr=False)
class Study(Table):
    """Poses of a raster of n tilts with one virtualization, azimuth by azimuth."""

    virtualization: str
    """Name of the virtualization."""
    virtual_joint_names: tuple[str, ...]
    """Names of the virtual joints with symbol, limb and unit, such as ``'phi_1_rad'``."""
    solver: str
    """Name of the solver of the virtual joints."""
    characteristic_length_m: float
    """Characteristic length, by which angles are multiplied in the metric [m]."""
    samples_per_row: int
    """Number of tilt angles for each azimuth."""
    azimuth_rad: Floats
    """Azimuth of each tilt, shape (n,) [rad]."""
    tilt_rad: Floats
    """Commanded tilt angle, of either sign, shape (n,) [rad]."""
    rods_m: Floats
    """Rod lengths, shape (n, 3) [m]."""
    sides_m: Floats
    """Sides L_12, L_23, L_31, shape (n, 3) [m]."""
    virtual_joints: Floats
    """Displacements of the virtual joints, shape (n, M) [m, rad]."""
    origin_m: Floats
    """Platform origin in the base frame, shape (n, 3) [m]."""
    torsion_rad: Floats
    """Torsion about the platform normal, shape (n,) [rad]."""
    iterations: NDArray[np.int64]
    """Number of iterations of the solver, shape (n,)."""
    residual_m: Floats
    """Largest difference between a side and its virtual length, shape (n,) [m]."""
    summary: StudySummary
    """Summary with extrema, values at level poses, and counts."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """Columns of all numbers of all poses, by name, each of shape (n,)."""
        columns: dict[str, NDArray[Any]] = {}
        for name in ("azimuth_rad", "tilt_rad", "rods_m", "sides_m", "virtual_joints", "origin_m",
                     "torsion_rad", "iterations", "residual_m"):  # fmt: skip
            axes = self.virtual_joint_names if name == "virtual_joints" else AXES.get(name, ())
            columns.update(spread(name, getattr(self, name), axes))
        return columns


@dataclass(frozen=True, eq=False, repr=False)
class BoundsCheck(Result):
    """Number of poses of a raster whose exact virtual displacement satisfies the first-order bounds."""

    poses: int
    """Number of checked poses, which are all tilted ones."""
    held_at_start: int
    """Number of poses that satisfy the bounds with the Jacobian at the level pose, where the bounds are zero."""
    held_at_midpoint: int
    """Number of poses that satisfy the bounds with the Jacobian at the midpoint."""
    held_at_end: int
    """Number of poses that satisfy the bounds with the Jacobian at the tilted pose."""
