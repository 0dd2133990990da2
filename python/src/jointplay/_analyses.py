"""Results of what the three-rod robot is asked besides its poses."""

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
    """Mobility with the virtual joints free."""

    virtualization: str
    """Name of the virtualization."""
    mobility: int
    """Instantaneous mobility."""
    rank: int
    """Independent constraints."""
    singular_values: Floats
    """Of the scaled Jacobian [∂Φ/∂P ∂Φ/∂X], the largest first."""


@dataclass(frozen=True, eq=False, repr=False)
class Freedoms(Result):
    """Kutzbach, instantaneous and finite mobility."""

    kutzbach_mobility: int
    """Freedoms by the Kutzbach–Grübler count."""
    instantaneous_mobility: int
    """Instantaneous mobility h."""
    finite_mobility: int | None
    """Finite mobility; ``None`` if undecided."""
    finite_mobility_bounds: tuple[int, int]
    """Bounds between which the finite mobility lies."""
    rank: int
    """Independent constraints."""
    redundancy: int
    """Number of redundant constraints r."""
    threshold: float
    """Singular values at or below it count as zero."""
    characteristic_length_m: float
    """Length in which the Jacobian is scaled [m]."""

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
    """What of the three-rod robot can move.

    Coordinates are q_1, q_2, q_3, P_1, P_2, P_3; constraints three of each rod, then the sides 12, 23, 31.
    """

    singular_values: Floats
    """Of the scaled constraint Jacobian, the largest first."""
    null_space: Floats
    """Basis of the instantaneous motions, shape (n, h), one per column, in radians and characteristic lengths."""
    self_stress: Floats
    """Orthonormal self-stresses, shape (c, r), a column each."""
    augmented: AugmentedMobility | None
    """With the virtual joints free, if a virtualization was given."""


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivity(Result):
    """∂X/∂P in the metric, angles multiplied by the characteristic length."""

    matrix: Floats
    """∂X/∂P, shape (M, 12); columns are q_1, q_2, q_3, P_1, P_2, P_3."""
    rank: int
    """Number of non-zero singular values, r."""
    singular_values: Floats
    """The largest first."""
    right_vectors: Floats
    """Right singular vectors of the non-zero singular values, shape (12, r)."""
    characteristic_length_m: float
    """Length by which angles are multiplied [m]."""
    virtualization: str
    """Name of the virtualization."""
    virtual_joint_names: tuple[str, ...]
    """What the rows are."""


@dataclass(frozen=True, eq=False, repr=False)
class Bounds(Result):
    """First-order bounds of the virtual displacement."""

    lower_m: float
    """σ_min ‖V₃ᵀΔP‖ [m]."""
    upper_m: float
    """σ_max ‖V₃ᵀΔP‖ [m]."""
    eigenvalue_lower_m: float
    """The lower bound by eigenvalues [m]."""
    eigenvalue_upper_m: float
    """The upper bound by eigenvalues [m]."""
    coarse_upper_m: float
    """σ_max ‖ΔP‖ [m]."""
    linear_m: float
    """‖∂X/∂P ΔP‖ [m]."""
    held: bool
    """Whether the true displacement lies between ``lower_m`` and ``upper_m``."""
    sensitivity: Sensitivity
    """∂X/∂P where the bounds were taken."""


@dataclass(frozen=True, eq=False, repr=False)
class TiltPlay(Result):
    """Displacement of the virtual joints from level to a tilt, with first-order bounds."""

    start: Forward
    """The level pose."""
    end: Forward
    """The tilted pose."""
    displacement_m: float
    """‖ΔX‖ in the metric, nothing neglected [m]."""
    motion_m: float
    """‖ΔP‖ [m]."""
    at_start: Bounds
    """With derivatives at the level start, where the bounds are zero."""
    at_midpoint: Bounds
    """Bounds with the Jacobian at the midpoint of the motion."""
    at_end: Bounds
    """With derivatives at the tilted end."""
    limb_shares: Floats | None
    """Share of each limb in the displacement, shape (3,); ``None`` where nothing moves."""
    side_shares: Floats | None
    """Share of each side 12, 23, 31 in the displacement, shape (3,); ``None`` where nothing moves."""


@dataclass(frozen=True, eq=False, repr=False)
class ModelCurve(Result):
    """One model over a range of tilts."""

    name: str
    """Name of the virtualization."""
    center_shift_m: Floats
    """Offset of the platform's origin from the base axis, shape (n, 2) [m]."""
    largest_displacement_m: Floats
    """The farthest that a socket is moved from its nominal place in the platform, shape (n,) [m]."""
    failure: str | None
    """Why the numbers are NaN from some tilt angle on, if they are."""


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Table):
    """All models over the same tilts."""

    azimuth_rad: float
    """Azimuth of all tilts [rad]."""
    height_m: float
    """Axis height of all tilts [m]."""
    tilt_rad: Floats
    """The tilt angles, shape (n,) [rad]."""
    approximate_gap_m: Floats
    """The farthest that a socket of the approximate model is off its ball, shape (n,) [m]."""
    models: Mapping[str, ModelCurve]
    """The models by name."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """Tilt angle, the approximate model's gap, and three columns of each model, such as ``planar_center_shift_x_m``."""
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
    """One series of a study summed up, in metres or radians."""

    name: str
    """Symbol and limb or side, such as ``'q1'``, ``'L12'``, ``'phi3'``."""
    min: float
    """Least value."""
    max: float
    """Greatest value."""
    pass_min: float | None
    """Least value at a level pose; ``None`` without such poses."""
    pass_max: float | None
    """Greatest value at a level pose; ``None`` without such poses."""
    minimum_at: int
    """Level poses at which the series is least of its row."""
    maximum_at: int
    """Level poses at which it is greatest of its row."""
    constant_at: int
    """Level poses in a row along which it is constant."""


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
    """``iterations[n]``: how many poses took n iterations."""
    beyond_tilt: int
    """Poses that tilt beyond the robot's limit."""
    beyond_stroke: int
    """Poses with a rod beyond the robot's limits."""
    series: Mapping[str, SeriesSummary]
    """Rods, sides and virtual joints by name."""


@dataclass(frozen=True, eq=False, repr=False)
class Study(Table):
    """All n poses of a raster under one virtualization, azimuth by azimuth."""

    virtualization: str
    """Name of the virtualization."""
    virtual_joint_names: tuple[str, ...]
    """Symbol, limb and unit of each virtual joint, such as ``'phi_1_rad'``."""
    solver: str
    """What found the virtual joints."""
    characteristic_length_m: float
    """Length by which angles were multiplied to weigh them against lengths [m]."""
    samples_per_row: int
    """Number of tilt angles for each azimuth."""
    azimuth_rad: Floats
    """Azimuth, shape (n,) [rad]."""
    tilt_rad: Floats
    """Tilt angle as commanded, either sign, shape (n,) [rad]."""
    rods_m: Floats
    """Rod lengths, shape (n, 3) [m]."""
    sides_m: Floats
    """Sides L_12, L_23, L_31, shape (n, 3) [m]."""
    virtual_joints: Floats
    """Displacements of the virtual joints, shape (n, M) [m, rad]."""
    origin_m: Floats
    """Platform origin in the base frame, shape (n, 3) [m]."""
    torsion_rad: Floats
    """Turn about the platform normal, shape (n,) [rad]."""
    iterations: NDArray[np.int64]
    """Iterations of the solver, shape (n,)."""
    residual_m: Floats
    """Largest difference between a side and its virtual length, shape (n,) [m]."""
    summary: StudySummary
    """Extrema, values at level poses, and counts."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """Every number of every pose by name, each of shape (n,)."""
        columns: dict[str, NDArray[Any]] = {}
        for name in ("azimuth_rad", "tilt_rad", "rods_m", "sides_m", "virtual_joints", "origin_m",
                     "torsion_rad", "iterations", "residual_m"):  # fmt: skip
            axes = self.virtual_joint_names if name == "virtual_joints" else AXES.get(name, ())
            columns.update(spread(name, getattr(self, name), axes))
        return columns


@dataclass(frozen=True, eq=False, repr=False)
class BoundsCheck(Result):
    """In how many poses of a raster the true virtual displacement keeps the first-order bounds."""

    poses: int
    """Poses checked: all that tilt."""
    held_at_start: int
    """Held with derivatives at the level start, where the bounds are zero."""
    held_at_midpoint: int
    """Number of poses that satisfy the bounds with the Jacobian at the midpoint."""
    held_at_end: int
    """Held with derivatives at the tilted end."""
