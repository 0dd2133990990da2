"""Results of planning a program in a work cell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._base import Floats, Table


@dataclass(frozen=True, eq=False, repr=False)
class Samples(Table):
    """Samples of the trajectory of a program at a constant rate; rods in metres, motors in metres or radians."""

    time_s: Floats
    """Time since the start of the trajectory, shape (n,) [s]."""
    step: NDArray[np.int64]
    """Index of the step of each sample, shape (n,)."""
    line: NDArray[np.int64]
    """Program line of each sample, shape (n,)."""
    positions: Floats
    """Position of each axis, shape (n, axes) [m or rad]."""
    velocities: Floats
    """Velocity of each axis, shape (n, axes) [m/s or rad/s]."""
    accelerations: Floats
    """Acceleration of each axis, shape (n, axes) [m/s² or rad/s²]."""
    axes: tuple[str, ...]
    """Names of the axes."""
    axis_units: tuple[str, ...]
    """Unit of the position of each axis, ``'m'`` or ``'rad'``."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """Columns of time, step and line, and for each axis of position, velocity and acceleration, such as ``T_rad``, ``T_rad_s``, ``T_rad_s2``."""
        found: dict[str, NDArray[Any]] = {
            "time_s": self.time_s,
            "step": self.step,
            "line": self.line,
        }
        suffixes = {"": self.positions, "_s": self.velocities, "_s2": self.accelerations}
        for suffix, values in suffixes.items():
            for k, (name, unit) in enumerate(zip(self.axes, self.axis_units, strict=True)):
                found[f"{name}_{unit}{suffix}"] = values[:, k]
        return found
