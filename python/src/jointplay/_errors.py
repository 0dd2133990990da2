"""Errors with their facts as attributes; all are re-exported by ``jointplay``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._poses import BrokenLimit


class JointplayError(Exception):
    """Base class of all errors of this package.

    The facts of an error are its attributes, in SI units.
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
    """Shape that was found."""
    dtype: Any
    """Type of numbers that was found."""


class ArgumentTypeError(JointplayError, TypeError):
    """An argument has an invalid type."""


class ArrayTypeError(ArgumentTypeError):
    """An array does not hold real numbers, or not those that can be written in place."""

    shape: tuple[int, ...] | None
    """Shape that was found."""
    dtype: Any
    """Type of numbers that was found."""


class UnknownNameError(InputError):
    """A name is unknown."""

    what: str
    """Kind of the named object."""
    name: str
    """The name that was given."""
    known: list[str]
    """The known names."""


class FileError(InputError):
    """A file is invalid; the message lists all errors, the attributes give the position of the first."""

    file: str
    """Name of the file."""
    line: int
    """Line, counted from 1."""
    column: int
    """Column, counted from 1."""


class PartsError(InputError):
    """A folder has the parts of another study, or its files have changed."""


class NotFiniteError(InputError):
    """A number is NaN or infinite."""

    what: str
    """Name of the number."""
    value: float
    """The value."""


class OutOfRangeError(InputError):
    """A number is out of range."""

    what: str
    """Name of the number."""
    value: float
    """The value, in ``unit``."""
    min: float
    """Smallest allowed value, in ``unit``."""
    max: float
    """Largest allowed value, in ``unit``."""
    unit: str
    """``'m'``, ``'rad'``, or ``'1'`` for a plain number."""


class TiltTooLargeError(InputError):
    """A tilt at which the rods no longer meet the platform plane."""

    tilt_rad: float
    """Commanded tilt angle [rad]."""


class GeometryError(InputError):
    """Dimensions that do not define a robot."""


class TooLargeError(InputError):
    """A mechanism is too large for the requested analysis."""

    what: str
    """The quantity that is too large."""
    found: int
    """The number found."""
    allowed: int
    """The largest allowed number."""


class NoAnswerError(JointplayError):
    """A valid request has no solution, or none was found."""


class MissingPartsError(NoAnswerError):
    """Parts of a study are missing."""

    missing: int
    """How many are missing."""
    parts: int
    """How many there are."""
    first: int
    """Number of the first missing part."""


class BeyondLimitsError(NoAnswerError):
    """A pose of a robot or a configuration of a mechanism is beyond its limits."""

    limits_broken: tuple[BrokenLimit, ...] | list[str]
    """The limits that are exceeded."""


class RobotLimitsError(BeyondLimitsError):
    """A pose is beyond the robot's limits of rod lengths and tilt."""

    limits_broken: tuple[BrokenLimit, ...]
    """The limits that are exceeded, rods first."""


class NotConvergedError(NoAnswerError):
    """The iteration for the virtual joints did not converge."""

    solver: str
    """The solver."""
    best_virtual_joints: list[float]
    """Virtual joints with the least residual found [m, rad]."""
    residual_m: float
    """Largest difference between a side and its virtual length there [m]."""
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
    """The virtual joints found mirror the platform."""

    virtual_joints: list[float]
    """The virtual joints found [m, rad]."""


class NotClosedError(NoAnswerError):
    """A configuration breaks the constraints that it should satisfy."""

    residual: float
    """Largest mismatch, in radians and characteristic lengths."""
    allowed: float
    """Largest mismatch of closed loops."""


class NotAssembledError(NoAnswerError):
    """The loops of a mechanism cannot be closed as commanded."""

    branches: list[list[float]]
    """Closed configurations found from other starts [m, rad]."""


class NotReachedError(NoAnswerError):
    """The loops did not close from the initial guess."""

    residual: float
    """Largest residual mismatch, in radians and characteristic lengths."""
    allowed: float
    """Largest mismatch of closed loops."""
    iterations: int
    """Number of steps."""


class NotRelievedError(NoAnswerError):
    """The virtual joints do not make the commanded motion possible."""

    residual: float
    """Largest residual mismatch, in radians and characteristic lengths."""
    allowed: float
    """Largest mismatch of closed loops."""
    couplings: list[str]
    """Couplings that the commanded values contradict, the most violated first; play at joints does not relieve them."""


class UndeterminedError(NoAnswerError):
    """The commanded coordinates do not determine the motion."""

    motions: int
    """Number of independent motions with the commanded coordinates held."""
    singular_values: list[float]
    """Of the equations of the loops, one for each other coordinate, in radians and characteristic lengths, the largest first."""


class DependentCommandsError(NoAnswerError):
    """The loops do not allow these rates of the commanded coordinates together."""

    share: float
    """Share of the commanded rates that opens the loops."""
    allowed: float
    """Largest share that counts as round-off."""


class JointLimitsError(BeyondLimitsError):
    """A joint is beyond its limits, or a virtual joint beyond its clearance."""

    limits_broken: list[str]
    """Names of the coordinates beyond their limits."""
    result: Any
    """The result computed at the configuration."""


class PlanningError(NoAnswerError):
    """A program has no trajectory: targets out of reach, limits, or lines that the arm cannot follow."""

    file: str
    """Name of the program."""
    reasons: tuple[tuple[int, int, str], ...]
    """Line, column and message of each reason."""


class StoppedError(NoAnswerError):
    """A mechanism stopped before the start of its path."""

    motion: Any
    """The ``Motion`` up to the stop."""
