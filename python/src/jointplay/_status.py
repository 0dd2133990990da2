"""Status of each of many poses."""

from enum import IntEnum


class Status(IntEnum):
    """Status of a pose in the array ``status`` of results: solved, or the reason of the failure."""

    SOLVED = 0
    """The pose has a solution."""
    NOT_FINITE = 1
    """An input is NaN or infinite."""
    TILT_TOO_LARGE = 2
    """The tilt angle is ±90° or beyond."""
    NOT_CONVERGED = 3
    """The iteration for the virtual joints, or for the loops of a mechanism, did not converge."""
    DEPENDENT_SIDES = 4
    """The virtual joints cannot change the three sides independently in this pose."""
    TURNED_OVER = 5
    """The solution for the virtual joints mirrors the platform."""
    BEYOND_LIMITS = 6
    """A rod, the tilt or a joint of a mechanism exceeds its limits."""
    BEYOND_CLEARANCE = 7
    """A virtual joint of a mechanism exceeds its clearance."""
