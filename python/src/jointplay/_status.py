"""What became of each of many poses."""

from enum import IntEnum


class Status(IntEnum):
    """Whether a pose has an answer, and if not, why: the numbers in the ``status`` of results."""

    SOLVED = 0
    """It has."""
    NOT_FINITE = 1
    """A number given is NaN or infinite."""
    TILT_TOO_LARGE = 2
    """The tilt angle is ±90° or beyond."""
    NOT_CONVERGED = 3
    """The iteration for the virtual joints, or that closes the loops of a mechanism, did not converge."""
    DEPENDENT_SIDES = 4
    """The virtual joints cannot change the three sides independently there."""
    TURNED_OVER = 5
    """The virtual joints found mirror the platform."""
    BEYOND_LIMITS = 6
    """A rod or the tilt, or a joint of a mechanism, is beyond its limits."""
    BEYOND_CLEARANCE = 7
    """A virtual joint of a mechanism is beyond its clearance."""
