"""What became of each of many poses."""

from enum import IntEnum


class Status(IntEnum):
    """Whether a pose has an answer, and if not, why: the numbers in the ``status`` of results."""

    SOLVED = 0
    """It has."""
    NOT_FINITE = 1
    """A number given is NaN or infinite."""
    PITCH_TOO_LARGE = 2
    """The pitch is ±90° or beyond."""
    NOT_CONVERGED = 3
    """The iteration for the virtual joints did not converge."""
    DEPENDENT_SIDES = 4
    """The virtual joints cannot change the three sides independently there."""
    TURNED_OVER = 5
    """The virtual joints found mirror the platform."""
