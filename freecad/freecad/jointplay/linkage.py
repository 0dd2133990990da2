"""The mechanism of a document, and the parts that move with its links.

FreeCAD measures in mm and degrees, jointplay in m and rad.
"""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass

import FreeCAD as App
import numpy as np

import jointplay as jp

#: Millimetres of a metre.
MM = 1000.0


class LinkageError(ValueError):
    """A document whose parts and links do not match."""


@dataclass
class Linkage:
    """A mechanism with the parts of a document that move with its links."""

    mechanism: jp.Mechanism
    #: Objects by the names of their links.
    parts: dict[str, App.DocumentObject]
    #: Placements of the parts in the reference configuration.
    drawn: dict[str, App.Placement]
    #: Poses of the links in the reference configuration, base_from_link, shape (4, 4) [m].
    reference: dict[str, np.ndarray]

    @property
    def unmatched(self) -> list[str]:
        """Links without a part."""
        return [link for link in self.mechanism.links if link not in self.parts]

    def placements(self, coordinates, exaggerate: float = 1.0) -> dict[str, App.Placement]:
        """Placements of the parts in a configuration (m, rad).

        A part keeps its place relative to its link: ``base_from_link · reference⁻¹ · drawn``.
        """
        found = {}
        for link, drawn in self.drawn.items():
            pose = self.mechanism.link_poses(coordinates, link, exaggerate=exaggerate)
            moved = pose @ np.linalg.inv(self.reference[link])
            found[link] = placement(moved) * drawn
        return found

    def show(self, coordinates, exaggerate: float = 1.0) -> None:
        """Places the parts in a configuration (m, rad)."""
        for link, moved in self.placements(coordinates, exaggerate).items():
            self.parts[link].Placement = moved

    def restore(self) -> None:
        """Places the parts as drawn."""
        for link, drawn in self.drawn.items():
            self.parts[link].Placement = drawn


def placement(pose: np.ndarray) -> App.Placement:
    """A placement (mm) of a homogeneous transform (m)."""
    rows = np.array(pose, dtype=float)
    rows[:3, 3] *= MM
    return App.Placement(App.Matrix(*rows.ravel()))


def mechanism_of(document: App.Document) -> jp.Mechanism:
    """The mechanism of the assembly in a document, as it is now, saved or not."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "copy.FCStd")
        document.saveCopy(path)
        return jp.Mechanism.from_file(path)


def linkage(document: App.Document, mechanism: jp.Mechanism | None = None) -> Linkage:
    """Matches the links of a mechanism to the objects of a document that have their names as labels.

    Without a mechanism, that of the assembly in the document is read.
    The parts are drawn in the reference configuration of the mechanism, which closes the guess of its file.
    """
    mechanism = mechanism or mechanism_of(document)
    objects: dict[str, list[App.DocumentObject]] = {}
    for one in document.Objects:
        if hasattr(one, "Placement") and one.TypeId != "App::FeaturePython":
            objects.setdefault(one.Label, []).append(one)
    parts = {}
    for link in mechanism.links:
        named = objects.get(link, [])
        if len(named) > 1:
            names = ", ".join(one.Name for one in named)
            raise LinkageError(f"the label {link!r} of a link is that of {len(named)} objects: {names}")
        if named:
            parts[link] = named[0]
    if not parts:
        links = ", ".join(mechanism.links)
        raise LinkageError(f"no object of the document has the label of a link; links: {links}")
    start = mechanism.assemble().coordinates
    return Linkage(
        mechanism,
        parts,
        {link: App.Placement(part.Placement) for link, part in parts.items()},
        {link: mechanism.link_poses(start, link) for link in parts},
    )


class OpenLinkages:
    """Linkages of open documents, each read when it is first used."""

    def __init__(self):
        self._by_name: dict[str, tuple[App.Document, Linkage]] = {}

    def linkage(self, document: App.Document) -> Linkage:
        """The linkage of a document: the one that was set, or that of its assembly."""
        known, found = self._by_name.get(document.Name, (None, None))
        return found if known is document else self.set(document, None)

    def set(self, document: App.Document, mechanism: jp.Mechanism | None) -> Linkage:
        """Matches a mechanism to the parts of a document as drawn, in place of an earlier one."""
        known, earlier = self._by_name.get(document.Name, (None, None))
        if known is document:
            earlier.restore()
        found = linkage(document, mechanism)
        self._by_name[document.Name] = (document, found)
        return found

    def restore(self) -> None:
        """Places the parts of all documents that are still open as drawn."""
        for name, (document, found) in self._by_name.items():
            if App.listDocuments().get(name) is document:
                found.restore()
