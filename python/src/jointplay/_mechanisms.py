"""Results of what any mechanism is asked."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ._analyses import Freedoms
from ._base import Floats, Many, Result, Table, latex_array, latex_number, latex_text, write_whole

if TYPE_CHECKING:
    from ._jointplay import Mechanism


@dataclass(frozen=True, eq=False, repr=False)
class Configuration(Result, Mapping[str, float]):
    """A closed configuration: a mapping from names of coordinates to their values [m, rad]."""

    mechanism: Mechanism
    """The mechanism."""
    names: tuple[str, ...]
    """Names of the coordinates: joints, then virtual joints."""
    units: tuple[str, ...]
    """Unit of each, ``'m'`` or ``'rad'``."""
    coordinates: Floats
    """Their values, shape (f + M,) [m, rad]."""
    residual: float
    """Largest mismatch of a loop, in radians and characteristic lengths."""
    iterations: int
    """Corrections done."""

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
    """A linear relation between joint coordinates: coordinate = offset + Σ ratio · term, such as that of gears, belts and screws."""

    name: str
    """Name of the coupling."""
    coordinate: str
    """The coordinate that follows the others."""
    terms: tuple[tuple[str, float], ...]
    """The other coordinates, each with its ratio [m/m, m/rad, rad/m or rad/rad]."""
    offset: float
    """Value of the coordinate with the others at zero [m, rad]."""


@dataclass(frozen=True, eq=False, repr=False)
class JointLoad(Result):
    """Load of a joint in a self-stress, on the second link of the joint."""

    joint: str
    """Name of the joint."""
    place_m: Floats
    """Place of the joint in the base frame (m)."""
    force_n: Floats
    """Force in the base frame; the largest of the self-stress has 1 N."""
    moment_nm: Floats
    """Moment about the place in the base frame (N m)."""


@dataclass(frozen=True, eq=False, repr=False)
class RedundantConstraint(Result):
    """A redundant constraint as a self-stress: loads of joints in equilibrium without an external load."""

    what: str
    """In words, such as ``'moment about x, in A, B, C, D'``."""
    joints: tuple[str, ...]
    """The joints that transmit it."""
    couplings: tuple[str, ...]
    """The couplings that transmit it; removing any one of them removes it, too."""
    group: int
    """Number of its group, from 1; symmetries of the mechanism map the members of a group onto each other."""
    independent: bool
    """Whether it is a member of the basis; the others depend on the basis."""
    remove_any_one_of: tuple[JointLoad, ...]
    """Releasing any one of these joints along its force or about its moment removes the self-stress."""


@dataclass(frozen=True, eq=False, repr=False)
class LinkMotion(Result):
    """Instantaneous motion of a link."""

    dimension: int
    """Number of independent motions."""
    translations: int
    """How many of them are translations."""
    twists: Floats
    """Its independent twists as columns, angular, then linear, shape (6, dimension)."""
    pitch_m_per_rad: float | None
    """Pitch of a single motion that is not a translation [m/rad]."""
    axis_point_m: Floats | None
    """And a point of its axis in the base frame, shape (3,) [m]."""


@dataclass(frozen=True, eq=False, repr=False)
class NearMobility(Result):
    """What moves if dimensions are true only to a tolerance, in radians and characteristic lengths."""

    tolerance: float
    """Tolerance that was given."""
    mobility: int
    """Freedoms within it."""
    needed: float
    """The tolerance that they need."""
    next: float | None
    """About the tolerance for one more; ``None`` where none is near."""


@dataclass(frozen=True, eq=False, repr=False)
class MechanismMobility(Freedoms):
    """What of a mechanism can move.

    Coordinates are those of its joints, in the order of the file.
    """

    name: str
    """Name of the mechanism."""
    configuration: Configuration
    """Where it was looked at."""
    singular_values: Floats | None
    """Of the scaled constraint Jacobian, the largest first; ``None`` where sparse algebra had to do."""
    null_space: Floats | None
    """Basis of the instantaneous motions, shape (n, h), one per column, in radians and characteristic lengths; ``None`` beyond a million numbers."""
    self_stress: Floats | None
    """Orthonormal self-stresses, shape (c, r), for each loop three moments and three forces; ``None`` as above."""
    classification: str
    """What class of mechanism this makes it, in words."""
    branch_dimensions: tuple[int, ...] | None
    """Dimensions of the branches that meet, if not every instantaneous motion is finite."""
    redundant_constraints: tuple[RedundantConstraint, ...]
    """Redundant constraints: a sparsest basis of the self-stresses, and the symmetric images of its members."""
    redundant_constraints_sparsest: bool | None
    """Whether no basis of self-stresses has fewer joints in total; ``None`` with sparse algebra, which finds no basis."""
    joints_in_all_self_stresses: tuple[str, ...]
    """Joints that take part in all self-stresses."""
    couplings_in_all_self_stresses: tuple[str, ...]
    """Couplings that take part in all self-stresses."""
    couplings: int
    """Number of couplings, a constraint each."""
    link_motions: Mapping[str, LinkMotion]
    """Instantaneous motion of each link but the base."""
    near: NearMobility | None
    """What moves within a tolerance, if one was given."""


@dataclass(frozen=True, eq=False, repr=False)
class SimulatorModel(Result):
    """A mechanism as a model of a simulator."""

    text: str
    """The model."""
    loops: str | None
    """The file of joints that close loops, for URDF, which describes trees only."""
    lost: tuple[str, ...]
    """What the format does not keep."""


@dataclass(frozen=True, eq=False, repr=False)
class SingularConfiguration(Result):
    """A singular configuration along the path."""

    share: float
    """Path parameter, 0 to 1."""
    coordinates: Floats
    """All coordinates there, shape (f + M,) [m, rad]."""
    instantaneous_mobility: int
    """Instantaneous mobility with the drives free."""
    least_singular_value: float
    """The least singular value found there, as a share of the largest."""
    branches: int | None
    """Number of branches of the motion that meet; ``None`` if second order does not decide."""


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Table):
    """A motion of a mechanism: n configurations, the start first."""

    mechanism: Mechanism
    """The mechanism."""
    name: str
    """Name of the mechanism."""
    names: tuple[str, ...]
    """Names of the coordinates: joints, then virtual joints."""
    units: tuple[str, ...]
    """Unit of each, ``'m'`` or ``'rad'``."""
    driven: tuple[str, ...]
    """Coordinates that were driven."""
    held: tuple[str, ...]
    """Coordinates of other motors, which held still."""
    coordinates: Floats
    """All coordinates along the path, shape (n, f + M) [m, rad]."""
    share: Floats
    """Path parameter, 0 to 1, shape (n,)."""
    residual: Floats
    """Largest mismatch of a loop, in radians and characteristic lengths, shape (n,)."""
    least_singular_value: Floats
    """As a share of the largest, shape (n,): zero at a singular configuration."""
    free_mobility: NDArray[np.int64]
    """Instantaneous mobility with the drives held, shape (n,)."""
    singular: tuple[SingularConfiguration, ...]
    """Singular configurations along the path."""
    limits_broken: tuple[str, ...]
    """Coordinates beyond their limits or clearance."""
    within_limits: NDArray[np.bool_]
    """Whether all joint limits and clearances hold, shape (n,)."""
    stopped: Literal["locked", "singular_start", "incompatible", "beyond_limits"] | None
    """Why it stopped before the end; ``None`` if it did not."""
    message: str | None
    """The same in words, and where, in the units of the file."""

    def __getitem__(self, name: str) -> Floats:
        """One coordinate along the path, shape (n,) [m or rad]."""
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
        duration_s: float = 4.0,
        tolerance_um: float = 1.0,
    ) -> tuple[str, ...]:
        """Writes the motion as an animated 3D scene, one binary glTF file; returns the links without a part.

        Parameters
        ----------
        path : str or path-like
            The file to write, such as ``motion.glb``; one that exists is replaced.
        parts : str or path-like
            A binary glTF file whose nodes move with the links of the same names; by default links are drawn as bars.
        table : mapping of str to str, or path-like
            Names of nodes, and the links that they move with; or the path of a table of parts.
        parts_up : str
            The axis of the file of parts that is z of the base frame; by default that of the table of parts, else
            ``'z'`` for files of Open CASCADE, such as those of cascadio, and ``'y'`` for others.
        exaggerate : float
            Factor of the displacements of virtual joints.
        duration_s : float
            Duration of the motion.
        tolerance_um : float
            Largest deviation from the configurations, between which the motion is interpolated.
        """
        pairs: list[tuple[str, str]] = []
        file: tuple[str, str] | None = None
        if isinstance(table, (str, os.PathLike)):
            file = (os.fspath(table), Path(table).read_text(encoding="utf-8"))
        elif table is not None:
            pairs = list(table.items())
        contents, missing = self.mechanism._gltf(
            self.coordinates,
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
        """Every coordinate along the path by name and unit, such as ``crank_rad``."""
        return _by_name_and_unit(self.names, self.units, self.coordinates)


@dataclass(frozen=True, eq=False, repr=False)
class Positions(Many):
    """All joints for n commands; a row that cannot be closed, or is beyond limits or clearances, is NaN."""

    mechanism: Mechanism
    """The mechanism."""
    names: tuple[str, ...]
    """Names of the coordinates: joints, then virtual joints."""
    units: tuple[str, ...]
    """Unit of each, ``'m'`` or ``'rad'``."""
    coordinates: Floats
    """Their values, shape (n, f + M) [m, rad]."""
    residual: Floats
    """Largest mismatch of a loop, in radians and characteristic lengths, shape (n,)."""
    status: NDArray[np.uint8]
    """What became of each row, shape (n,): 0 where it has an answer, else a ``Status``."""
    failed: int
    """How many rows have no answer."""
    failure_counts: Mapping[str, int]
    """How many have none for which reason."""

    def __getitem__(self, name: str) -> Floats:
        """One coordinate for all commands, shape (n,) [m or rad]."""
        if name not in self.names:
            raise KeyError(name)
        return self.coordinates[:, self.names.index(name)]

    def link_poses(self, name: str) -> Floats:
        """Poses of a link or an attached frame in the base frame, ``base_from_frame``, shape (n, 4, 4) [m]; NaN where a row is."""
        return self.mechanism.link_poses(self.coordinates, name)

    def columns(self) -> dict[str, NDArray[Any]]:
        """Every coordinate by name and unit, such as ``crank_rad``."""
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

    Of balls, derivatives are angular velocities in the turned frame.
    """

    name: str
    """The link or frame."""
    configuration: Configuration
    """Where it was computed."""
    commanded: tuple[str, ...]
    """Names of the commanded coordinates: the columns."""
    commanded_units: tuple[str, ...]
    """Unit of each, ``'m'`` or ``'rad'``."""
    pose: Floats
    """Pose of the frame in the base frame, shape (4, 4) [m]."""
    matrix: Floats
    """Angular velocity, then velocity of the origin, in the base frame, shape (6, n) [rad, m]."""
    derivative: Floats | None
    """Its rate of change, if velocities were given, shape (6, n) [rad/s, m/s]."""
    coordinate_derivatives: Floats
    """Derivatives of all coordinates, joints, then virtual joints, shape (f + M, n)."""
    singular_values: Floats
    """Of the matrix in radians and characteristic lengths, the largest first, shape (min(6, n),)."""
    condition_number: float | None
    """Largest over smallest singular value; ``None`` where the smallest is zero."""
    manipulability: float
    """Product of the singular values."""
    loop_singular_values: Floats
    """Of the loops with the commanded coordinates held, one for each other coordinate, in radians and characteristic lengths, the largest first; zeros are freedoms that the least displacement determines."""
    characteristic_length_m: float
    """The characteristic length [m]."""

    def _repr_latex_(self) -> str:
        head = ("", *(latex_text(name) for name in self.commanded))
        axes = [rf"{quantity}_{axis}" for quantity in (r"\omega", "v") for axis in "xyz"]
        rows = [(axis, *map(latex_number, row)) for axis, row in zip(axes, self.matrix, strict=True)]
        return latex_array("c|" + "r" * len(self.commanded), [head, *rows])


@dataclass(frozen=True, eq=False, repr=False)
class Rates(Result):
    """Velocities and accelerations of all coordinates, links and attached frames.

    Of balls, angular velocity in the turned frame, and the derivative of its components.
    """

    configuration: Configuration
    """Where they were computed."""
    names: tuple[str, ...]
    """Names of the coordinates: joints, then virtual joints."""
    units: tuple[str, ...]
    """Unit of each coordinate, ``'m'`` or ``'rad'``."""
    velocities: Floats
    """Velocities of all coordinates, shape (f + M,) [m/s, rad/s]."""
    accelerations: Floats
    """Accelerations of all coordinates, shape (f + M,) [m/s², rad/s²]."""
    frame_velocities: Mapping[str, Floats]
    """Angular velocity, then velocity of the origin, in the base frame, by link or frame, each of shape (6,)."""
    frame_accelerations: Mapping[str, Floats]
    """Angular acceleration, then acceleration of the origin, in the base frame, each of shape (6,)."""


@dataclass(frozen=True, eq=False, repr=False)
class ParameterDerivatives(Result):
    """Derivatives by n parameters of the file, per unit of the parameter there, with commanded coordinates held and loops closed.

    Of balls, derivatives are rotations in the turned frame.
    """

    configuration: Configuration
    """Where they were computed."""
    parameters: tuple[str, ...]
    """Names of the parameters: the columns."""
    names: tuple[str, ...]
    """Names of the coordinates: joints, then virtual joints."""
    units: tuple[str, ...]
    """Unit of each coordinate, ``'m'`` or ``'rad'``."""
    coordinates: Floats
    """Derivatives of all coordinates, shape (f + M, n) [m, rad]."""
    frames: Mapping[str, Floats]
    """Rotation, then displacement of the origin, in the base frame, by link or frame, each of shape (6, n) [rad, m]."""


@dataclass(frozen=True, eq=False, repr=False)
class SuggestedJoint(Result):
    """One virtual joint of a suggestion."""

    name: str
    """What it is, in words."""
    joint: str
    """The joint that would have it."""
    on: str
    """The link that carries it."""
    motion: Literal["slide", "turn"]
    """Whether it slides or turns."""
    direction: Floats
    """Along or about what, in the frame of the link that carries it, shape (3,)."""
    about: Floats | None
    """For a turn, a point of its axis in the same frame, shape (3,) [m]."""
    clearance: float | None
    """Clearance of the joint in this direction, in ``unit``; ``None`` if the file has none."""
    stiffness: float | None
    """Stiffness [N/m, N m/rad]; ``None`` unless ranked by stiffness."""
    largest: float
    """Largest displacement over the commands, in ``unit``."""
    unit: str
    """``'m'`` or ``'rad'``."""
    alternatives: tuple[SuggestedJoint, ...]
    """Other virtual joints of the same leg that relieve the same instantaneous motion."""


@dataclass(frozen=True, eq=False, repr=False)
class Suggestion(Result):
    """A set of virtual joints that makes the commands possible."""

    size_m: float
    """Largest displacement over the commands, turns weighed by the characteristic length [m]."""
    energy_j: float | None
    """Largest elastic energy over the commands, which the displacement makes least [J]; ``None`` unless ranked by stiffness."""
    symmetric: bool
    """Whether every symmetry of the mechanism maps the set onto itself; ``False`` where it has none."""
    symmetric_for_commands: bool
    """Whether every symmetry of the mechanism that maps the commands onto each other maps the set onto itself; ``False`` where it has none."""
    within_clearances: bool
    """Whether no virtual joint exceeds the clearance of its joint, as far as clearances are known."""
    coordinates: Floats
    """Joint coordinates for each command, shape (commands, f) [m, rad]."""
    limits_broken: tuple[str, ...]
    """Joint coordinates that are beyond their limits for one of the commands."""
    virtual_joints: tuple[SuggestedJoint, ...]
    """Its virtual joints."""


@dataclass(frozen=True, eq=False, repr=False)
class Suggestions(Result):
    """Where a mechanism would have to have play."""

    needed: bool
    """Whether any play is needed at all."""
    without_play: Floats
    """Joint coordinates for each command, shape (commands, f) [m, rad]; empty where play is needed."""
    limits_broken: tuple[str, ...]
    """Joint coordinates that are beyond their limits there."""
    sets: tuple[Suggestion, ...]
    """Sets of virtual joints, those within joint limits and clearances first, then by displacement; none holds another that is enough."""
    candidates: int
    """Places and directions that were considered."""
    in_class: float
    """Number of sets in the class that was searched, compared or not."""
    lower_bound_m: float
    """Displacement below which no set of the candidates lies (m)."""
    least_energy_j: float | None
    """Elastic energy below which no set of the candidates lies [J]; ``None`` unless ranked by stiffness."""
    compared: int
    """Sets that were compared."""
    cut_short: bool
    """Whether the search stopped at its limit."""
    untried: int
    """Sets taken for possible, but not tried: with these, or where cut short, a smaller displacement may exist."""


@dataclass(frozen=True, eq=False, repr=False)
class Relief(Result):
    """Displacement of the virtual joints for a command."""

    configuration: Configuration
    """The closed configuration."""
    virtual_joint_names: tuple[str, ...]
    """Names of the virtual joints."""
    virtual_joint_units: tuple[str, ...]
    """Unit of each, ``'m'`` or ``'rad'``."""
    virtual_joints: Floats
    """Their displacements, shape (M,) [m, rad]."""
    clearances: Floats
    """Clearance of each virtual joint, ± its displacement, shape (M,) [m, rad]; NaN if unknown."""
    size: float
    """Size of the displacement, in ``size_unit``."""
    size_unit: str
    """``'m'``, turns being multiplied by the characteristic length; ``'sqrt(J)'`` where every virtual joint has a stiffness."""
    singular_values: Floats
    """Of the displacement per displacement of the commanded coordinates, the largest first."""
    characteristic_length_m: float
    """Length by which turns are multiplied [m]."""
