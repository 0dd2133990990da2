"""Base classes of results, and their conversion into tables."""

from __future__ import annotations

import html
import keyword
import os
import re
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from jointplay import _jointplay

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas

Floats = NDArray[np.float64]

ROWS_SHOWN = 20
"""Number of rows of a table that a notebook shows."""


def _equal(a: Any, b: Any) -> bool:
    """Whether two fields are equal, where NaN equals NaN, as for rows without a solution."""
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        kind = getattr(a, "dtype", None)
        floats = kind is not None and kind.kind == "f"
        return bool(np.array_equal(a, b, equal_nan=floats))
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(_equal(a[key], b[key]) for key in a)
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(map(_equal, a, b))
    return bool(a == b)


def _brief(value: Any) -> str:
    """Short text of a value; larger arrays show type and shape only."""
    if isinstance(value, np.ndarray) and value.size > 6:
        return f"<{value.dtype} {value.shape}>"
    if isinstance(value, np.ndarray):
        return np.array2string(value, separator=", ").replace("\n", "")
    if isinstance(value, tuple) and len(value) > 6:
        return f"<{len(value)} entries>"
    return repr(value)


def _cell(value: Any) -> str:
    """Text of a number in a table, with six digits."""
    return f"{value:.6g}" if isinstance(value, (float, np.floating)) else html.escape(str(value))


_LATEX_CHARACTERS = {
    "\\": r"\textbackslash{}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    **{character: "\\" + character for character in "&%$#_{}"},
}


def latex_text(text: str) -> str:
    """Text of a name within a LaTeX formula."""
    return rf"\text{{{''.join(_LATEX_CHARACTERS.get(character, character) for character in text)}}}"


def latex_number(value: float) -> str:
    """LaTeX of a number with five digits."""
    mantissa, _, exponent = f"{value + 0.0:.5g}".partition("e")
    return rf"{mantissa} \cdot 10^{{{int(exponent)}}}" if exponent else mantissa


def latex_array(alignment: str, rows: Sequence[Sequence[str]]) -> str:
    """LaTeX of rows of cells as a displayed formula."""
    body = " \\\\\n".join(" & ".join(row) for row in rows)
    return f"$$\\begin{{array}}{{{alignment}}}\n{body}\n\\end{{array}}$$"


def identifiers(names: Sequence[str]) -> list[str]:
    """Unique Python identifiers for names: ``ball 1[0]_rad`` becomes ``ball_1_0_rad``."""
    found: list[str] = []
    for name in names:
        word = name
        if not name.isidentifier():
            valid = "".join(letter if f"a{letter}".isidentifier() else "_" for letter in name)
            word = re.sub("_+", "_", valid).strip("_")
        if not word.isidentifier() or keyword.iskeyword(word):
            word = "_" + word
        base, number = word, 2
        while word in found:
            word, number = f"{base}_{number}", number + 1
        found.append(word)
    return found


class Result:
    """Base class of all results: equality by value, a short ``repr``, pickling."""

    __slots__ = ()
    __hash__ = None  # type: ignore[assignment]

    def _fields_shown(self) -> Iterator[tuple[str, Any]]:
        for field in fields(self):  # type: ignore[arg-type]
            yield field.name, getattr(self, field.name)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        mine, theirs = dict(self._fields_shown()), dict(other._fields_shown())
        return _equal(mine, theirs)

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{html.escape(name)}</th><td>{html.escape(_brief(value))}</td></tr>"
            for name, value in self._fields_shown()
        )
        return f"<table><caption>{type(self).__name__}</caption><tbody>{rows}</tbody></table>"

    def __str__(self) -> str:
        shown = list(self._fields_shown())
        width = max((len(name) for name, _ in shown), default=0)
        rows = (f"  {name:<{width}}  {_brief(value)}" for name, value in shown)
        return "\n".join([type(self).__name__, *rows])

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={_brief(value)}" for name, value in self._fields_shown())
        return f"{type(self).__name__}({shown})"


class Table(Result):
    """Base class of results that are tables, which pandas, Polars and PyArrow accept directly."""

    __slots__ = ()

    def columns(self) -> dict[str, NDArray[Any]]:
        """Columns of all numbers of all rows, by name, each of shape (n,); arrays with several axes in C order."""
        raise NotImplementedError

    def to_dataframe(self) -> pandas.DataFrame:
        """The columns as a pandas ``DataFrame``.

        Names are converted to identifiers, for attributes and ``query``: the column ``ball 1[0]_rad`` becomes ``ball_1_0_rad``.
        Needs pandas, which ``pip install jointplay[dataframe]`` includes.
        """
        try:
            import pandas
        except ModuleNotFoundError as error:
            raise ModuleNotFoundError(
                "to_dataframe needs pandas: pip install 'jointplay[dataframe]'", name="pandas"
            ) from error
        columns = self.columns()
        return pandas.DataFrame(dict(zip(identifiers(list(columns)), columns.values(), strict=True)))

    def plot(self, *names: str, x: str | None = None, ax: matplotlib.axes.Axes | None = None) -> matplotlib.axes.Axes:
        """Draws columns as lines with matplotlib, and returns the axes.

        Without names, it draws all columns except ``x``; without ``x``, it draws them over the row number.
        Names are those of ``columns()`` or of ``to_dataframe()``.
        Lines are drawn into ``ax``, or into a new figure.
        """
        if ax is None:
            try:
                import matplotlib.pyplot as plt
            except ModuleNotFoundError as error:
                raise ModuleNotFoundError("plot needs matplotlib: pip install matplotlib", name="matplotlib") from error
            ax = plt.subplots()[1]
        columns = self.columns()
        known = dict(zip(identifiers(list(columns)), columns, strict=True))
        names = tuple(known.get(name, name) for name in names)
        x = x if x is None else known.get(x, x)
        for name in (*names, *([x] if x is not None else [])):
            if name not in columns:
                raise KeyError(f"{name!r} is not a column: columns are {', '.join(columns)}")
        over = np.arange(len(next(iter(columns.values())))) if x is None else columns[x]
        for name in names or [name for name in columns if name != x]:
            ax.plot(over, columns[name], label=name)
        ax.set_xlabel("row" if x is None else x)
        if len(names) == 1:
            ax.set_ylabel(names[0])
        else:
            ax.legend()
        return ax

    def _repr_html_(self) -> str:
        columns = self.columns()
        rows = len(next(iter(columns.values()), ()))
        shown: list[int | None] = list(range(rows))
        if rows > ROWS_SHOWN:
            half = ROWS_SHOWN // 2
            shown = [*range(half), None, *range(rows - half, rows)]
        head = "".join(f"<th>{html.escape(name)}</th>" for name in columns)
        body = []
        for row in shown:
            cells = "".join(f"<td>{'…' if row is None else _cell(values[row])}</td>" for values in columns.values())
            body.append(f"<tr><th>{'…' if row is None else row}</th>{cells}</tr>")
        title = f"{type(self).__name__}, {rows} row{'' if rows == 1 else 's'}"
        table = f"<thead><tr><th></th>{head}</tr></thead><tbody>{''.join(body)}</tbody>"
        return f"<table><caption>{title}</caption>{table}</table>"

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The columns as an Arrow stream, through the Arrow PyCapsule interface; they are copied."""
        columns = [(name, np.ascontiguousarray(values)) for name, values in self.columns().items()]
        return _jointplay.arrow_stream(columns)


class Many(Table):
    """Base class of results of many poses, each with a status."""

    __slots__ = ()

    status: NDArray[np.uint8]
    failed: int
    failure_counts: Mapping[str, int]

    def failures(self) -> str:
        """Number of poses without a solution, with reasons, in one line."""
        poses = self.status.size
        if self.failed == 0:
            return f"all {poses} poses have an answer"
        why = ", ".join(f"{count} {reason}" for reason, count in self.failure_counts.items())
        return f"{self.failed} of {poses} poses have no answer: {why}"


def spread(name: str, values: NDArray[Any], axes: tuple[str, ...]) -> dict[str, NDArray[Any]]:
    """Columns of an array: one for each name of its last axis, or one for the whole array without names."""
    if not axes:
        return {name: values.reshape(-1)}
    return {axis: values[..., k].reshape(-1) for k, axis in enumerate(axes)}


AXES: dict[str, tuple[str, ...]] = {
    "origin_m": ("origin_x_m", "origin_y_m", "origin_z_m"),
    "normal": ("normal_x", "normal_y", "normal_z"),
    "sides_m": ("side_12_m", "side_23_m", "side_31_m"),
    "ball_displacement_m": ("ball_displacement_1_m", "ball_displacement_2_m", "ball_displacement_3_m"),
    "sensitivity": ("sensitivity_1", "sensitivity_2", "sensitivity_3"),
    "rods_m": ("rod_1_m", "rod_2_m", "rod_3_m"),
}
"""Column names of arrays with a last axis, by name of the array."""


@contextmanager
def writing(path: Path) -> Iterator[BinaryIO]:
    """Opens a temporary file that replaces ``path`` when it is complete, and is removed on failure."""
    partial = path.with_name(f".jointplay-partial-{uuid.uuid4().hex}")
    try:
        with open(partial, "xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, path)
    except BaseException as error:
        # The name of the temporary file means nothing to the caller.
        if isinstance(error, OSError) and error.filename is not None and str(error.filename) == str(partial):
            error.filename, error.filename2 = str(path), None
        with suppress(OSError):
            partial.unlink()
        raise


def write_whole(path: Path, content: bytes) -> None:
    """Writes a file completely or not at all."""
    with writing(path) as file:
        file.write(content)
