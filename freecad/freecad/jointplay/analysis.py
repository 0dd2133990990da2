"""Results in words, and motions of drives or tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

import jointplay as jp

from .linkage import Linkage

#: Display units and their numbers in SI.
UNITS = {"m": ("mm", 1e-3), "rad": ("°", np.pi / 180)}


class MotionError(ValueError):
    """A drive that gives no motion."""


def mobility_text(mechanism: jp.Mechanism) -> str:
    """Mobility and redundant constraints of a mechanism."""
    return str(mechanism.mobility())


def unit_of(mechanism: jp.Mechanism, coordinate: str) -> tuple[str, float]:
    """Display unit of a coordinate and its number in SI."""
    if coordinate not in mechanism.coordinate_names:
        known = ", ".join(mechanism.coordinate_names)
        raise MotionError(f"the coordinate {coordinate!r} is not known; known: {known}")
    return UNITS[mechanism.coordinate_units[mechanism.coordinate_names.index(coordinate)]]


def suggestions(mechanism: jp.Mechanism, commands: Mapping[str, float]) -> jp.Suggestions:
    """Sets of virtual joints that make a displacement of the drives possible (mm, degrees)."""
    start = mechanism.assemble()
    moved = {name: value * unit_of(mechanism, name)[1] for name, value in commands.items()}
    return mechanism.suggest([{name: start[name] + value for name, value in moved.items()}])


def drive(mechanism: jp.Mechanism, displacements: Mapping[str, float], steps: int = 50) -> np.ndarray:
    """Configurations while drives move from where they are by displacements (mm, degrees), shape (n, f + M) [m, rad].

    Virtual joints take their least displacements.
    """
    if not displacements:
        raise MotionError("no drive is given; give one as NAME=DISPLACEMENT")
    start = mechanism.assemble()
    share = np.linspace(0.0, 1.0, steps + 1)
    moved = {name: value * unit_of(mechanism, name)[1] for name, value in displacements.items()}
    paths = {name: start[name] + value * share for name, value in moved.items()}
    return positions(mechanism, paths)


def table(mechanism: jp.Mechanism, path: str) -> np.ndarray:
    """Configurations along the rows of a CSV file of drives, as ``jointplay move --table`` reads it, shape (n, f + M) [m, rad]."""
    return positions(mechanism, mechanism.read_drive_table(path))


def positions(mechanism: jp.Mechanism, paths: Mapping[str, np.ndarray]) -> np.ndarray:
    found = mechanism.positions(paths)
    if found.failed:
        first = int(np.flatnonzero(found.status)[0])
        reasons = ", ".join(f"{count} × {reason}" for reason, count in found.failure_counts.items())
        raise MotionError(f"step {first} of {len(found.status)} and {found.failed - 1} more have no position: {reasons}")
    return found.coordinates


def play(linkage: Linkage, configurations: np.ndarray, exaggerate: float = 1.0) -> Iterator[int]:
    """Places the parts in each configuration, one at a time, and returns its number."""
    for number, coordinates in enumerate(configurations):
        linkage.show(coordinates, exaggerate)
        yield number


def displacements(text: str) -> dict[str, float]:
    """Drives of a text such as ``rod 1=2.5, rod 2=-1``."""
    found = {}
    for part in filter(None, (one.strip() for one in text.split(","))):
        name, equals, value = part.rpartition("=")
        try:
            number = float(value)
        except ValueError:
            number = np.nan
        if not equals or not np.isfinite(number):
            raise MotionError(f"{part!r} has to be NAME=DISPLACEMENT, in mm or degrees")
        found[name.strip()] = number
    return found
