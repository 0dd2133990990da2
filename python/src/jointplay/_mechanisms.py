"""Results of the analyses and motions of mechanisms."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._analyses import Freedoms
from ._base import Floats, Many, Result, Table, latex_array, latex_number, latex_text, write_whole

if TYPE_CHECKING:
    from ._jointplay import Mechanism


@dataclass(frozen=True, eq=False, repr=False)
class Configuration(Result, Mapping[str, float]):
    """Closed configuration of a mechanism: a mapping from names of coordinates to values [m, rad]."""

    mechanism: Mechanism
    """The mechanism."""
    names: tuple[str, ...]
    """Names of the coordinates: joints, then virtual joints."""
    units: tuple[str, ...]
    """Unit of each coordinate, ``'m'`` or ``'rad'``."""
    coordinates: Floats
    """Values of the coordinates, shape (f + M,) [m, rad]."""
    residual: float
    """Largest closure residual of a loop, in radians and characteristic lengths."""
    iterations: int
    """Number of iterations of the solver."""

    __hash__ = None  # type: ignore[assignment]
    __eq__ = Result.__eq__

    def __getitem__(self, name: str) -> float:
        if name not in self.names:
            raise KeyError(name)
        return float(self.coordinates[self.names.index(name)])

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def link_poses(self, name: str) -> Floats:
        """Pose of a link or an attached frame in the base frame, ``base_from_frame``, shape (4, 4) [m]."""
        return self.mechanism.link_poses(self.coordinates, name)


@dataclass(frozen=True, eq=False, repr=False)
class Coupling(Result):
    """Linear relation between joint coordinates, such as that of gears, belts and screws: coordinate = offset + Σ ratio · term."""

    name: str
    """Name of the coupling."""
    coordinate: str
    """Name of the dependent coordinate."""
    terms: tuple[tuple[str, float], ...]
    """Names of the independent coordinates, each with its ratio [m/m, m/rad, rad/m or rad/rad]."""
    offset: float
    """Value of the dependent coordinate if the independent ones are zero [m, rad]."""


@dataclass(frozen=True, eq=False, repr=False)
class JointLoad(Result):
    """Load that a joint exerts on its second link in a self-stress."""

    joint: str
    """Name of the joint."""
    place_m: Floats
    """Position of the joint in the base frame, shape (3,) [m]."""
    force_n: Floats
    """Force in the base frame, shape (3,) [N]; the largest force of the self-stress is 1 N, unless all are zero."""
    moment_nm: Floats
    """Moment about the position of the joint in the base frame, shape (3,) [N m]."""


@dataclass(frozen=True, eq=False, repr=False)
class RedundantConstraint(Result):
    """Redundant constraint as a self-stress: joint loads in equilibrium without an external load."""

    what: str
    """Description of the constraint, such as ``'moment about x, transmitted by A, B, C, D'``."""
    joints: tuple[str, ...]
    """Names of the joints that transmit the self-stress."""
    couplings: tuple[str, ...]
    """Names of the couplings that transmit the self-stress; removing any one of them removes the self-stress."""
    group: int
    """Number of the group of the constraint, from 1; symmetries of the mechanism map the members of a group onto each other."""
    independent: bool
    """Whether the constraint is a member of the basis; the others depend on the basis."""
    remove_any_one_of: tuple[JointLoad, ...]
    """Loads of the joints; releasing any one of these joints along its force or about its moment removes the self-stress."""


@dataclass(frozen=True, eq=False, repr=False)
class LinkMotion(Result):
    """Instantaneous motions of a link."""

    dimension: int
    """Number of independent motions of the link."""
    translations: int
    """Number of independent translations of the link."""
    twists: Floats
    """Independent twists of the link as columns, angular, then linear, shape (6, dimension)."""
    pitch_m_per_rad: float | None
    """Pitch of the screw motion [m/rad]; ``None`` for a translation or several motions."""
    axis_point_m: Floats | None
    """Point of the screw axis in the base frame, shape (3,) [m]; ``None`` for a translation or several motions."""


@dataclass(frozen=True, eq=False, repr=False)
class NearMobility(Result):
    """Mobility within a closure tolerance, in radians and characteristic lengths."""

    tolerance: float
    """Closure tolerance of the analysis."""
    mobility: int
    """Number of motions whose closure residual is within the tolerance."""
    needed: float
    """Tolerance that these motions together require."""
    next: float | None
    """Approximate tolerance that one further motion requires; ``None`` if no candidate is close to possible."""


@dataclass(frozen=True, eq=False, repr=False)
class MechanismMobility(Freedoms):
    """Mobility of a mechanism, with redundant constraints and the motions of its links.

    Coordinates are the joint coordinates, in the order of the file.
    """

    name: str
    """Name of the mechanism."""
    configuration: Configuration
    """Configuration of the analysis."""
    singular_values: Floats | None
    """Singular values of the scaled constraint Jacobian, in descending order; ``None`` with sparse algebra."""
    null_space: Floats | None
    """Basis of the instantaneous motions as columns, shape (n, h), in radians and characteristic lengths; ``None`` if it has more than a million entries."""
    self_stress: Floats | None
    """Orthonormal self-stresses as columns, shape (c, r), with three moments and three forces for each loop; ``None`` with sparse algebra."""
    classification: str
    """Class of the mechanism by its mobilities, in words."""
    branch_dimensions: tuple[int, ...] | None
    """Dimensions of the branches that meet in the configuration; ``None`` if every instantaneous motion is finite."""
    redundant_constraints: tuple[RedundantConstraint, ...]
    """Redundant constraints: a sparsest basis of the self-stresses, and the symmetric images of its members."""
    redundant_constraints_sparsest: bool | None
    """Whether no basis of self-stresses has fewer joints in total; ``None`` with sparse algebra, which finds no basis."""
    joints_in_all_self_stresses: tuple[str, ...]
    """Joints that take part in all self-stresses."""
    couplings_in_all_self_stresses: tuple[str, ...]
    """Couplings that take part in all self-stresses."""
    couplings: int
    """Number of couplings, each of which is one constraint."""
    link_motions: Mapping[str, LinkMotion]
    """Instantaneous motion of each link except the base, by name."""
    near: NearMobility | None
    """Mobility within a closure tolerance; ``None`` if none was given."""


@dataclass(frozen=True, eq=False, repr=False)
class SimulatorModel(Result):
    """Mechanism in the format of a simulator."""

    text: str
    """Text of the model."""
    loops: str | None
    """Text of the file of joints that close loops, for URDF, which describes trees only; ``None`` for other formats."""
    lost: tuple[str, ...]
    """Properties of the mechanism that the format cannot represent."""


@dataclass(frozen=True, eq=False, repr=False)
class SingularConfiguration(Result):
    """Singular configuration on the path of a motion."""

    share: float
    """Path parameter, 0 to 1."""
    coordinates: Floats
    """All coordinates in the singular configuration, shape (f + M,) [m, rad]."""
    instantaneous_mobility: int
    """Instantaneous mobility with the drives free."""
    least_singular_value: float
    """Smallest singular value in the singular configuration, as a fraction of the largest."""
    branches: int | None
    """Number of branches of the motion that meet; ``None`` if the second-order analysis does not determine it."""
    drives_reverse: bool | None
    """Whether the driven coordinates reverse on the only branch, as at a dead point, or continue; ``None`` if several branches meet, or it is undecided."""


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Table):
    """Motion of a mechanism as n configurations, beginning with the start."""

    mechanism: Mechanism
    """The mechanism."""
    name: str
    """Name of the mechanism."""
    names: tuple[str, ...]
    """Names of the coordinates: joints, then virtual joints."""
    units: tuple[str, ...]
    """Unit of each coordinate, ``'m'`` or ``'rad'``."""
    driven: tuple[str, ...]
    """Names of the driven coordinates."""
    held: tuple[str, ...]
    """Names of the actuated coordinates that were not driven and kept their values."""
    coordinates: Floats
    """All coordinates along the path, shape (n, f + M) [m, rad]."""
    share: Floats
    """Path parameter, 0 to 1, shape (n,)."""
    residual: Floats
    """Largest closure residual of a loop, in radians and characteristic lengths, shape (n,)."""
    least_singular_value: Floats
    """Smallest singular value as a fraction of the largest, shape (n,); zero at a singular configuration."""
    free_mobility: NDArray[np.int64]
    """Instantaneous mobility with the drives held, shape (n,)."""
    singular: tuple[SingularConfiguration, ...]
    """Singular configurations along the path."""
    limits_broken: tuple[str, ...]
    """Names of the coordinates that exceed their limits or clearances."""
    within_limits: NDArray[np.bool_]
    """Whether all coordinates are within their joint limits and clearances, shape (n,)."""
    stopped: Literal["locked", "singular_start", "incompatible", "beyond_limits"] | None
    """Reason for which the motion stopped before the end of the path; ``None`` if it is complete."""
    message: str | None
    """Description of the stop and its position, in the units of the file; ``None`` if the motion is complete."""

    def __getitem__(self, name: str) -> Floats:
        """Values of one coordinate along the path, shape (n,) [m or rad]."""
        if name not in self.names:
            raise KeyError(name)
        return self.coordinates[:, self.names.index(name)]

    def link_poses(self, name: str, *, exaggerate: float = 1.0) -> Floats:
        """Poses of a link or an attached frame in the base frame, ``base_from_frame``, shape (n, 4, 4) [m].

        Displacements of virtual joints are multiplied by ``exaggerate``, for pictures.
        """
        return self.mechanism.link_poses(self.coordinates, name, exaggerate=exaggerate)

    def to_gltf(
        self,
        path: str | os.PathLike[str],
        *,
        parts: str | os.PathLike[str] | None = None,
        table: Mapping[str, str] | str | os.PathLike[str] | None = None,
        parts_up: Literal["y", "z"] | None = None,
        exaggerate: float = 1.0,
        times_s: ArrayLike | None = None,
        duration_s: float = 4.0,
        tolerance_um: float = 1.0,
    ) -> tuple[str, ...]:
        """Writes the motion as an animated 3D scene into a binary glTF file, and returns the links without a part.

        Parameters
        ----------
        path : str or path-like
            The file to write, such as ``motion.glb``; an existing file is replaced.
        parts : str or path-like
            Binary glTF file whose nodes move with the links of the same names; by default links are drawn as bars.
        table : mapping of str to str, or path-like
            Link of each node, by name of the node, or the path of a table of parts.
        parts_up : str
            Axis of the file of parts that is z of the base frame; by default the axis in the table of parts, otherwise
            ``'z'`` for files of Open CASCADE, such as those of cascadio, and ``'y'`` for others.
        exaggerate : float
            Factor by which displacements of virtual joints are multiplied.
        times_s : array_like
            Time of each configuration [s]; by default they are at equal intervals.
        duration_s : float
            Duration of the motion [s], where no times are given.
        tolerance_um : float
            Largest deviation of the interpolated motion from the configurations [µm].
        """
        pairs: list[tuple[str, str]] = []
        file: tuple[str, str] | None = None
        if isinstance(table, (str, os.PathLike)):
            file = (os.fspath(table), Path(table).read_text(encoding="utf-8"))
        elif table is not None:
            pairs = list(table.items())
        contents, missing = self.mechanism._gltf(
            self.coordinates,
            times_s,
            duration_s,
            exaggerate,
            tolerance_um,
            None if parts is None else Path(parts).read_bytes(),
            pairs,
            file,
            parts_up,
        )
        write_whole(Path(path), contents)
        return tuple(missing)

    def columns(self) -> dict[str, NDArray[Any]]:
        """Columns of all coordinates along the path, by name and unit, such as ``crank_rad``."""
        return _by_name_and_unit(self.names, self.units, self.coordinates)


@dataclass(frozen=True, eq=False, repr=False)
class Positions(Many):
    """Configurations of a mechanism for n commands; rows without a solution within limits and clearances are NaN."""

    mechanism: Mechanism
    """The mechanism."""
    names: tuple[str, ...]
    """Names of the coordinates: joints, then virtual joints."""
    units: tuple[str, ...]
    """Unit of each coordinate, ``'m'`` or ``'rad'``."""
    coordinates: Floats
    """Values of the coordinates, shape (n, f + M) [m, rad]."""
    residual: Floats
    """Largest closure residual of a loop, in radians and characteristic lengths, shape (n,)."""
    status: NDArray[np.uint8]
    """Status of each row, shape (n,): 0 for a solution, otherwise the reason as a ``Status``."""
    failed: int
    """Number of rows without a solution."""
    failure_counts: Mapping[str, int]
    """Number of failed rows by reason."""

    def __getitem__(self, name: str) -> Floats:
        """Values of one coordinate for all commands, shape (n,) [m or rad]."""
        if name not in self.names:
            raise KeyError(name)
        return self.coordinates[:, self.names.index(name)]

    def link_poses(self, name: str) -> Floats:
        """Poses of a link or an attached frame in the base frame, ``base_from_frame``, shape (n, 4, 4) [m]; NaN for rows without a solution."""
        return self.mechanism.link_poses(self.coordinates, name)

    def columns(self) -> dict[str, NDArray[Any]]:
        """Columns of all coordinates, by name and unit, such as ``crank_rad``."""
        return _by_name_and_unit(self.names, self.units, self.coordinates)


def _by_name_and_unit(
    names: tuple[str, ...], units: tuple[str, ...], coordinates: Floats
) -> dict[str, NDArray[Any]]:
    return {
        f"{name}_{unit}": coordinates[:, k]
        for k, (name, unit) in enumerate(zip(names, units, strict=True))
    }


@dataclass(frozen=True, eq=False, repr=False)
class Jacobian(Result):
    """Geometric Jacobian of a link or an attached frame, with loops closed.

    For ball joints, derivatives are angular velocities in the rotated frame of the joint.
    """

    name: str
    """Name of the link or frame."""
    configuration: Configuration
    """Configuration at which the Jacobian is evaluated."""
    commanded: tuple[str, ...]
    """Names of the commanded coordinates, one for each column."""
    commanded_units: tuple[str, ...]
    """Unit of each commanded coordinate, ``'m'`` or ``'rad'``."""
    pose: Floats
    """Pose of the frame in the base frame, shape (4, 4) [m]."""
    matrix: Floats
    """Angular velocity, then velocity of the origin, in the base frame, per unit velocity of each commanded coordinate, shape (6, n) [rad, m]."""
    derivative: Floats | None
    """Rate of change of the Jacobian, shape (6, n) [rad/s, m/s]; ``None`` if no velocities were given."""
    coordinate_derivatives: Floats
    """Derivatives of all coordinates with respect to the commanded ones, joints, then virtual joints, shape (f + M, n)."""
    singular_values: Floats
    """Singular values of the Jacobian in radians and characteristic lengths, in descending order, shape (min(6, n),)."""
    condition_number: float | None
    """Ratio of the largest to the smallest singular value of the Jacobian; ``None`` if the smallest is zero."""
    manipulability: float
    """Product of the singular values of the Jacobian."""
    loop_singular_values: Floats
    """Singular values of the loop closure with the commanded coordinates fixed, one for each other coordinate, in radians and characteristic lengths, in descending order; zeros are freedoms that the minimum-norm displacement determines."""
    characteristic_length_m: float
    """Characteristic length, by which angles are multiplied [m]."""

    def _repr_latex_(self) -> str:
        head = ("", *(latex_text(name) for name in self.commanded))
        axes = [rf"{quantity}_{axis}" for quantity in (r"\omega", "v") for axis in "xyz"]
        rows = [(axis, *map(latex_number, row)) for axis, row in zip(axes, self.matrix, strict=True)]
        return latex_array("c|" + "r" * len(self.commanded), [head, *rows])


@dataclass(frozen=True, eq=False, repr=False)
class Rates(Result):
    """Velocities and accelerations of all coordinates, links and attached frames of a mechanism.

    For ball joints, velocities are the components of the angular velocity in the rotated frame of the joint, and accelerations their derivatives.
    """

    configuration: Configuration
    """Configuration at which the velocities are evaluated."""
    names: tuple[str, ...]
    """Names of the coordinates: joints, then virtual joints."""
    units: tuple[str, ...]
    """Unit of each coordinate, ``'m'`` or ``'rad'``."""
    velocities: Floats
    """Velocities of all coordinates, shape (f + M,) [m/s, rad/s]."""
    accelerations: Floats
    """Accelerations of all coordinates, shape (f + M,) [m/s², rad/s²]."""
    frame_velocities: Mapping[str, Floats]
    """Angular velocity, then velocity of the origin, in the base frame, by name of the link or frame, each of shape (6,) [rad/s, m/s]."""
    frame_accelerations: Mapping[str, Floats]
    """Angular acceleration, then acceleration of the origin, in the base frame, by name of the link or frame, each of shape (6,) [rad/s², m/s²]."""


@dataclass(frozen=True, eq=False, repr=False)
class ParameterDerivatives(Result):
    """Derivatives with respect to n parameters of a mechanism file, with commanded coordinates fixed and loops closed.

    Derivatives are per unit of the parameter in the file.
    For ball joints, they are rotations in the rotated frame of the joint.
    """

    configuration: Configuration
    """Configuration at which the derivatives are evaluated."""
    parameters: tuple[str, ...]
    """Names of the parameters, one for each column."""
    names: tuple[str, ...]
    """Names of the coordinates: joints, then virtual joints."""
    units: tuple[str, ...]
    """Unit of each coordinate, ``'m'`` or ``'rad'``."""
    coordinates: Floats
    """Derivatives of all coordinates with respect to the parameters, shape (f + M, n) [m, rad]."""
    frames: Mapping[str, Floats]
    """Rotation, then displacement of the origin, in the base frame, by name of the link or frame, each of shape (6, n) [rad, m]."""


@dataclass(frozen=True, eq=False, repr=False)
class SuggestedJoint(Result):
    """Virtual joint of a suggestion."""

    name: str
    """Description of the virtual joint."""
    joint: str
    """Name of the joint at which the virtual joint is suggested."""
    on: str
    """Name of the link that carries the virtual joint."""
    motion: Literal["slide", "turn"]
    """Motion of the virtual joint: ``'slide'`` is a translation, ``'turn'`` a rotation."""
    direction: Floats
    """Direction of the translation or axis of the rotation, in the frame of the link that carries the virtual joint, shape (3,)."""
    about: Floats | None
    """Point of the axis of the rotation, in the frame of the link that carries the virtual joint, shape (3,) [m]; ``None`` for a translation."""
    clearance: float | None
    """Clearance of the joint in the direction of the virtual joint, in ``unit``; ``None`` if the file has none."""
    stiffness: float | None
    """Stiffness of the virtual joint [N/m, N m/rad]; ``None`` unless ranked by stiffness."""
    largest: float
    """Largest displacement of the virtual joint over the commands, in ``unit``."""
    unit: str
    """Unit of the displacement, ``'m'`` or ``'rad'``."""
    alternatives: tuple[SuggestedJoint, ...]
    """Other virtual joints of the same leg that relieve the same instantaneous motion."""


@dataclass(frozen=True, eq=False, repr=False)
class Suggestion(Result):
    """Set of virtual joints with which the commands are possible."""

    size_m: float
    """Largest norm of the displacements over the commands, rotations multiplied by the characteristic length [m]."""
    energy_j: float | None
    """Largest elastic energy over the commands, with the displacements that minimize it [J]; ``None`` unless ranked by stiffness."""
    symmetric: bool
    """Whether every symmetry of the mechanism maps the set onto itself; ``False`` where it has none."""
    symmetric_for_commands: bool
    """Whether every symmetry of the mechanism that maps the commands onto each other maps the set onto itself; ``False`` where it has none."""
    within_clearances: bool
    """Whether no virtual joint exceeds the clearance of its joint, as far as clearances are known."""
    coordinates: Floats
    """Joint coordinates for each command, shape (commands, f) [m, rad]."""
    limits_broken: tuple[str, ...]
    """Names of the joint coordinates that exceed their limits for one of the commands."""
    virtual_joints: tuple[SuggestedJoint, ...]
    """Virtual joints of the set."""


@dataclass(frozen=True, eq=False, repr=False)
class Suggestions(Result):
    """Sets of virtual joints with which commanded motions of a mechanism are possible."""

    needed: bool
    """Whether the commands require play."""
    home_residual: float
    """Largest mismatch of the rigid links where the search starts, in radians and characteristic lengths; where they do not close, every set closes them too."""
    without_play: Floats
    """Joint coordinates without play for each command, shape (commands, f) [m, rad]; empty if the commands require play."""
    limits_broken: tuple[str, ...]
    """Names of the joint coordinates that exceed their limits in ``without_play``."""
    sets: tuple[Suggestion, ...]
    """Sets of virtual joints, those within joint limits and clearances first, then by rank; no set contains a smaller sufficient set."""
    candidates: int
    """Number of candidate positions and directions of virtual joints."""
    in_class: float
    """Number of sets in the searched class, including those that were not compared."""
    lower_bound_m: float
    """Lower bound of the displacement of any set of candidates [m]."""
    least_energy_j: float | None
    """Lower bound of the elastic energy of any set of candidates [J]; ``None`` unless ranked by stiffness."""
    compared: int
    """Number of sets that were compared."""
    cut_short: bool
    """Whether the search stopped at its limit."""
    untried: int
    """Number of sets that were estimated as possible but not tried; with these, or after ``cut_short``, a smaller displacement may exist."""


@dataclass(frozen=True, eq=False, repr=False)
class Relief(Result):
    """Displacement of the virtual joints of a mechanism for a command."""

    configuration: Configuration
    """The closed configuration."""
    virtual_joint_names: tuple[str, ...]
    """Names of the virtual joints."""
    virtual_joint_units: tuple[str, ...]
    """Unit of each virtual joint, ``'m'`` or ``'rad'``."""
    virtual_joints: Floats
    """Displacements of the virtual joints, shape (M,) [m, rad]."""
    clearances: Floats
    """Clearance of each virtual joint to either side, shape (M,) [m, rad]; NaN if unknown."""
    size: float
    """Norm of the displacement, in ``size_unit``."""
    size_unit: str
    """Unit of the norm: ``'m'``, with rotations multiplied by the characteristic length, or ``'sqrt(J)'`` if every virtual joint has a stiffness."""
    singular_values: Floats
    """Singular values of the derivative of the displacement with respect to the commanded coordinates, in descending order."""
    characteristic_length_m: float
    """Characteristic length, by which rotations are multiplied [m]."""
