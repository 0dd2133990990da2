"""Virtualizations written in Python."""

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
    """One virtual joint of a virtualization."""

    symbol: str
    """The symbol that joints of this kind share, such as ``'phi'``."""
    limb: int
    """The limb it belongs to, counted from 0."""
    motion: Literal["linear", "angular"] = "linear"
    """Whether its coordinate is a length [m] or an angle [rad]."""


class Virtualization(ABC):
    """A model of the socket displacements in the platform plane: a map X → sockets.

    Use an object of a subclass wherever the name of a virtualization is taken.
    Any object with these attributes will do; being a subclass only helps to get them right.
    All vectors are in the platform frame.
    Python is called several times for each pose, so this is slow compared with the built-in ones.
    """

    name: str
    """The name, in lower case."""
    joints: Sequence[VirtualJoint]
    """The virtual joints, in the order of X, from 3 to 12 of them."""

    @abstractmethod
    def nominal(self, platform: Platform) -> ArrayLike:
        """The X at which every socket is at its nominal place, shape (M,) [m, rad]."""

    @abstractmethod
    def sockets(self, platform: Platform, x: NDArray[np.float64]) -> ArrayLike:
        """The three sockets p_k(X), shape (3, 2) [m]."""

    @abstractmethod
    def socket_velocities(self, platform: Platform, x: NDArray[np.float64]) -> ArrayLike:
        """∂p/∂X, shape (M, 3, 2): for each virtual joint the velocities of the three sockets [m/m, m/rad]."""

    def closed_form(self, platform: Platform, sides: NDArray[np.float64]) -> ArrayLike | None:
        """The exact X of least displacement for sides L_12, L_23, L_31, shape (M,), or ``None`` without a closed form."""
        return None
