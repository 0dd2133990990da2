"""Pictures of mechanisms, for notebooks and files."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from jointplay import _jointplay

from ._base import write_whole
from ._errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True, repr=False)
class Picture:
    """Vector picture that notebooks display."""

    svg: str
    """The picture as SVG."""
    own_texts: Sequence[str] = ()
    """Title and labels from the caller; in LaTeX, they may contain formulas."""

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"Picture(<SVG, {len(self.svg)} characters>)"

    def png(self, width_px: int = 1800) -> bytes:
        """The picture as PNG with a width of ``width_px``."""
        return _jointplay.picture_as_png(self.svg, width_px)

    def pdf(self) -> bytes:
        """The picture as PDF: vectors, and text in embedded fonts."""
        return _jointplay.picture_as_pdf(self.svg)

    def latex(self, pdf_name: str) -> tuple[str, bytes]:
        """The picture for LaTeX: source with all text, for ``\\input``, and the graphics as PDF without text.

        The source refers to the PDF as ``pdf_name`` and needs ``\\usepackage{graphicx}``.
        The given title and labels may contain formulas between two ``$``.
        """
        return _jointplay.picture_as_latex(self.svg, pdf_name, list(self.own_texts))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the picture into a file: SVG, PNG, PDF or LaTeX, by its extension.

        With ``.tex``, the graphics are written into a PDF of the same name in the same folder; see `latex`.
        The file is written completely or not at all; an existing file is replaced.
        """
        path = Path(path)
        match path.suffix.lower():
            case ".svg":
                content = self.svg.encode()
            case ".png":
                content = self.png()
            case ".pdf":
                content = self.pdf()
            case ".tex":
                graphics = path.with_suffix(".pdf")
                source, pdf = self.latex(graphics.name)
                write_whole(graphics, pdf)
                content = source.encode()
            case _:
                raise InputError(f"{path}: the name of a picture must end in .svg, .png, .pdf or .tex")
        write_whole(path, content)
