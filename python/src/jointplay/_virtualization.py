"""Base class of virtualizations that are implemented in Python."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from ._poses import Platform


@dataclass(frozen=True)
class VirtualJoint:
    """Virtual joint of a virtualization."""

    symbol: str
    """Symbol of the virtual joint, common to all limbs, such as ``'phi'``."""
    limb: int
    """Index of the limb of the virtual joint, from 0."""
    motion: Literal["linear", "angular"] = "linear"
    """Kind of the coordinate: a length [m] for ``'linear'``, an angle [rad] for ``'angular'``."""


class Virtualization(ABC):
    """Model of the socket displacements in the platform plane: a map from virtual joints X to sockets.

    An object of a subclass replaces the name of a virtualization in all functions.
    Functions accept any object with these attributes; the base class only supports their implementation.
    All vectors are in the platform frame.
    Each pose calls Python several times, which is slow compared with the built-in virtualizations.
    """

    name: str
    """Name of the virtualization, in lower case."""
    joints: Sequence[VirtualJoint]
    """Virtual joints in the order of X; 3 to 12 are allowed."""

    @abstractmethod
    def nominal(self, platform: Platform) -> ArrayLike:
        """Virtual joints X at which every socket is at its nominal position, shape (M,) [m, rad]."""

    @abstractmethod
    def sockets(self, platform: Platform, x: NDArray[np.float64]) -> ArrayLike:
        """Positions p_k(X) of the three sockets, shape (3, 2) [m]."""

    @abstractmethod
    def socket_velocities(self, platform: Platform, x: NDArray[np.float64]) -> ArrayLike:
        """Derivatives ∂p/∂X of the three sockets by each virtual joint, shape (M, 3, 2) [m/m, m/rad]."""

    def closed_form(self, platform: Platform, sides: NDArray[np.float64]) -> ArrayLike | None:
        """Virtual joints X of minimum norm for the sides L_12, L_23, L_31, shape (M,) [m, rad]; ``None`` without a closed form."""
        return None
