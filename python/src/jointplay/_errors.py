"""What can go wrong, each with its facts as attributes; all are re-exported by ``jointplay``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._poses import BrokenLimit


class JointplayError(Exception):
    """Base class of all errors of this package.

    The facts that an error knows are attributes of it, in SI units.
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
    """What was given cannot be computed with."""


class ArrayError(InputError):
    """An array has the wrong shape or layout, is read-only, or overlaps another."""

    shape: tuple[int, ...] | None
    """Shape that was found."""
    dtype: Any
    """Type of numbers that was found."""


class ArgumentTypeError(JointplayError, TypeError):
    """An argument has a type that cannot be taken."""


class ArrayTypeError(ArgumentTypeError):
    """An array does not hold real numbers, or not those that can be written in place."""

    shape: tuple[int, ...] | None
    """Shape that was found."""
    dtype: Any
    """Type of numbers that was found."""


class UnknownNameError(InputError):
    """A name is none of the known ones."""

    what: str
    """What it should be the name of."""
    name: str
    """The name that was given."""
    known: list[str]
    """All names that there are."""


class FileError(InputError):
    """A file is refused, at a place in it."""

    file: str
    """What the file is called."""
    line: int
    """Line, counted from 1."""
    column: int
    """Column, counted from 1."""


class NotFiniteError(InputError):
    """A number is NaN or infinite."""

    what: str
    """Which number."""
    value: float
    """What was found."""


class OutOfRangeError(InputError):
    """A number lies outside the range that it has to be in."""

    what: str
    """Which number."""
    value: float
    """What was found, in ``unit``."""
    min: float
    """Least that is allowed, in ``unit``."""
    max: float
    """Greatest that is allowed, in ``unit``."""
    unit: str
    """``'m'``, ``'rad'``, or ``'1'`` for a plain number."""


class PitchTooLargeError(InputError):
    """A tilt at which the rods no longer meet the platform plane."""

    pitch_rad: float
    """Pitch that was asked for [rad]."""


class GeometryError(InputError):
    """Dimensions that make no robot."""


class TooLargeError(InputError):
    """A mechanism that the algebra asked for would work on for hours."""

    what: str
    """What there is too much of."""
    found: int
    """How many there are."""
    allowed: int
    """How many there may be."""


class NoAnswerError(JointplayError):
    """The question is in order, but has no answer, or none was found."""


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
    """Which iteration."""
    best_virtual_joints: list[float]
    """Virtual joints with the least residual found [m, rad]."""
    residual_m: float
    """Largest difference between a side and its virtual length there [m]."""
    threshold_m: float
    """Residual that was asked for [m]."""
    iterations: int
    """Iterations done."""


class DependentSidesError(NoAnswerError):
    """The virtual joints cannot change the three sides independently."""

    characteristic_length_m: float
    """Length by which angles are weighed [m]."""
    iterations: int
    """Iterations done."""


class TurnedOverError(NoAnswerError):
    """The virtual joints found mirror the platform."""

    virtual_joints: list[float]
    """The virtual joints found [m, rad]."""


class NotClosedError(NoAnswerError):
    """A configuration breaks the constraints that it should satisfy."""

    residual: float
    """Largest mismatch, in radians and characteristic lengths."""
    allowed: float
    """Largest that counts as closed."""


class NotAssembledError(NoAnswerError):
    """The loops of a mechanism could not be closed as asked."""

    branches: list[list[float]]
    """Configurations that were found instead [m, rad]."""


class NotReachedError(NoAnswerError):
    """The loops did not close from where the search began."""

    residual: float
    """Largest mismatch that is left, in radians and characteristic lengths."""
    allowed: float
    """Largest that counts as closed."""
    iterations: int
    """Steps done."""


class NotRelievedError(NoAnswerError):
    """The virtual joints do not make the commanded motion possible."""

    residual: float
    """Largest mismatch that is left, in radians and characteristic lengths."""
    allowed: float
    """Largest that counts as closed."""


class JointLimitsError(BeyondLimitsError):
    """A joint is beyond its limits, or a virtual joint beyond its clearance."""

    limits_broken: list[str]
    """Names of the coordinates beyond their limits."""
    result: Any
    """The result computed at the configuration."""


class StoppedError(NoAnswerError):
    """A mechanism stopped on the way to where its motion was to begin."""

    motion: Any
    """The ``Motion`` up to there."""
