"""Errors with their details as attributes; ``jointplay`` exports all of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._poses import BrokenLimit


class JointplayError(Exception):
    """Base class of all errors of this package.

    The details of an error are its attributes, in SI units.
    """

    def __init__(self, message: str, /, **facts: Any) -> None:
        super().__init__(message)
        self._facts = facts
        for name, value in facts.items():
            setattr(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), str(self), self._facts)


def _again(cls: type[JointplayError], message: str, facts: dict[str, Any]) -> JointplayError:
    return cls(message, **facts)


class InputError(JointplayError, ValueError):
    """An argument is invalid."""


class ArrayError(InputError):
    """An array has an invalid shape or layout, is read-only, or overlaps another."""

    shape: tuple[int, ...] | None
    """Shape of the array."""
    dtype: Any
    """Data type of the array."""


class ArgumentTypeError(JointplayError, TypeError):
    """An argument has an invalid type."""


class ArrayTypeError(ArgumentTypeError):
    """An array does not contain real numbers, or its data type cannot be written in place."""

    shape: tuple[int, ...] | None
    """Shape of the array."""
    dtype: Any
    """Data type of the array."""


class UnknownNameError(InputError):
    """A name is unknown."""

    what: str
    """Kind of the named object."""
    name: str
    """The unknown name."""
    known: list[str]
    """Known names of this kind."""


class FileError(InputError):
    """A file is invalid; the message lists all errors, the attributes give the position of the first."""

    file: str
    """Name of the file."""
    line: int
    """Line, counted from 1."""
    column: int
    """Column, counted from 1."""


class PartsError(InputError):
    """A folder contains the parts of another study, or its files have changed."""


class NotFiniteError(InputError):
    """A number is NaN or infinite."""

    what: str
    """Name of the number."""
    value: float
    """Value of the number."""


class OutOfRangeError(InputError):
    """A number is out of range."""

    what: str
    """Name of the number."""
    value: float
    """Value of the number, in ``unit``."""
    min: float
    """Smallest allowed value, in ``unit``."""
    max: float
    """Largest allowed value, in ``unit``."""
    unit: str
    """Unit of the number: ``'m'``, ``'rad'``, or ``'1'`` for a plain number."""


class TiltTooLargeError(InputError):
    """At this tilt the rods do not intersect the platform plane."""

    tilt_rad: float
    """Commanded tilt angle [rad]."""


class GeometryError(InputError):
    """The dimensions do not define a robot."""


class TooLargeError(InputError):
    """A mechanism is too large for the requested analysis."""

    what: str
    """Name of the quantity that is too large."""
    found: int
    """Value of the quantity."""
    allowed: int
    """Largest allowed value of the quantity."""


class NoAnswerError(JointplayError):
    """A valid request has no solution, or none was found."""


class MissingPartsError(NoAnswerError):
    """Parts of a study are missing."""

    missing: int
    """Number of missing parts."""
    parts: int
    """Number of all parts."""
    first: int
    """Number of the first missing part."""


class BeyondLimitsError(NoAnswerError):
    """A pose of a robot or a configuration of a mechanism exceeds its limits."""

    limits_broken: tuple[BrokenLimit, ...] | list[str]
    """Limits that are exceeded."""


class RobotLimitsError(BeyondLimitsError):
    """A pose exceeds the limits of the robot for rod lengths and tilt."""

    limits_broken: tuple[BrokenLimit, ...]
    """Limits that are exceeded, rods first."""


class NotConvergedError(NoAnswerError):
    """The iteration for the virtual joints did not converge."""

    solver: str
    """Name of the solver."""
    best_virtual_joints: list[float]
    """Virtual joints with the smallest residual found [m, rad]."""
    residual_m: float
    """Largest difference between a side and its virtual length at ``best_virtual_joints`` [m]."""
    threshold_m: float
    """Requested residual [m]."""
    iterations: int
    """Number of iterations."""


class DependentSidesError(NoAnswerError):
    """The virtual joints cannot change the three sides independently."""

    characteristic_length_m: float
    """Characteristic length, by which angles are multiplied [m]."""
    iterations: int
    """Number of iterations."""


class TurnedOverError(NoAnswerError):
    """The solution for the virtual joints mirrors the platform."""

    virtual_joints: list[float]
    """Virtual joints of the mirrored solution [m, rad]."""


class NotClosedError(NoAnswerError):
    """A configuration does not satisfy the constraints of the mechanism."""

    residual: float
    """Largest constraint residual, in radians and characteristic lengths."""
    allowed: float
    """Largest residual of closed loops, in radians and characteristic lengths."""


class NotAssembledError(NoAnswerError):
    """The loops of a mechanism cannot be closed as commanded."""

    branches: list[list[float]]
    """Closed configurations found from other starts [m, rad]."""


class NotReachedError(NoAnswerError):
    """The loops did not close from the initial guess."""

    residual: float
    """Largest remaining residual, in radians and characteristic lengths."""
    allowed: float
    """Largest residual of closed loops, in radians and characteristic lengths."""
    iterations: int
    """Number of iterations."""


class NotRelievedError(NoAnswerError):
    """The virtual joints do not make the commanded motion possible."""

    residual: float
    """Largest remaining residual, in radians and characteristic lengths."""
    allowed: float
    """Largest residual of closed loops, in radians and characteristic lengths."""
    couplings: list[str]
    """Names of the couplings that the commanded values contradict, the most violated first; play of joints does not relieve them."""


class UndeterminedError(NoAnswerError):
    """The commanded coordinates do not determine the motion."""

    motions: int
    """Number of independent motions with the commanded coordinates fixed."""
    singular_values: list[float]
    """Singular values of the loop closure, one for each coordinate that is not commanded, in radians and characteristic lengths, in descending order."""


class DependentCommandsError(NoAnswerError):
    """The loops do not allow the combination of rates of the commanded coordinates."""

    share: float
    """Fraction of the commanded rates that opens the loops."""
    allowed: float
    """Largest fraction that counts as round-off."""


class JointLimitsError(BeyondLimitsError):
    """A joint exceeds its limits, or a virtual joint its clearance."""

    limits_broken: list[str]
    """Names of the coordinates that exceed their limits."""
    result: Any
    """Result of the computation in spite of the limits."""


class PlanningError(NoAnswerError):
    """A program has no trajectory: a target is out of reach, a limit is exceeded, or the arm cannot follow a line."""

    file: str
    """Name of the program."""
    reasons: tuple[tuple[int, int, str], ...]
    """Line, column and message of each reason."""


class StoppedError(NoAnswerError):
    """A mechanism stopped before the start of its path."""

    motion: Any
    """Motion up to the stop, a ``Motion``."""
