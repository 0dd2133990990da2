"""The page of the documentation that lists every function and result of the package, with its documentation.

`INSTA_UPDATE=always pytest -k reference` writes it.
"""

from __future__ import annotations

import dataclasses
import inspect
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jointplay as jp

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "python-types.md"

HEAD = """# Python functions and types

For Python programmers: this page lists every class, function and result of the package `jointplay` with its documentation, as `help` prints it.
[Python interface](python.md) is the overview, and [Use jointplay from Python](../how-to/python.md) has examples.
"""


def documentation(of: Any) -> Iterator[str]:
    """The documentation as a block of text."""
    text = inspect.getdoc(of)
    # What Python writes where a class or a dataclass has none.
    if text and not re.match(r"\w+\([^)]*\)$", text, re.DOTALL):
        yield f"```text,wrap\n{text.strip()}\n```\n"


def signature(name: str, of: Any) -> str:
    try:
        text = str(inspect.signature(of))
    except (TypeError, ValueError):
        text = "(…)"
    # The object itself is not given, and addresses of defaults change.
    text = re.sub(r"\((self|cls|/|type)(, /)?(, )?", "(", text, count=1)
    return f"{name}{re.sub(r' at 0x[0-9a-f]+', '', text)}"


def members(of: type) -> Iterator[str]:
    """Fields, properties and methods of a class of its own."""
    if dataclasses.is_dataclass(of):
        rows = [f"| `{field.name}` | `{str(field.type).replace('|', 'or')}` |" for field in dataclasses.fields(of)]
        yield "\n".join(["| field | type |", "| --- | --- |", *rows]) + "\n"
    fields = {field.name for field in dataclasses.fields(of)} if dataclasses.is_dataclass(of) else set()
    for name, member in sorted(vars(of).items()):
        if name.startswith("_") or name in fields:
            continue
        value = getattr(of, name)
        if callable(value):
            yield f"### {of.__name__}.{name}\n"
            yield f"```python\n{signature(name, value)}\n```\n"
            yield from documentation(value)
        elif isinstance(member, property) or type(member).__name__ == "getset_descriptor":
            yield f"### {of.__name__}.{name}\n"
            yield from documentation(member)


def public(module: Any, prefix: str) -> Iterator[str]:
    for name in sorted(module.__all__):
        found = getattr(module, name)
        if isinstance(found, type):
            yield f"## {prefix}{name}\n"
            bases = ", ".join(base.__name__ for base in found.__bases__ if base.__module__.startswith("jointplay"))
            if bases:
                yield f"A subclass of {bases}.\n"
            yield from documentation(found)
            yield from members(found)
        elif callable(found):
            yield f"## {prefix}{name}\n"
            yield f"```python\n{signature(name, found)}\n```\n"
            yield from documentation(found)


def without_signatures(text: str) -> list[str]:
    """The lines without signatures, which each version of Python writes differently."""
    return re.sub(r"```python\n.*?\n```\n", "", text, flags=re.DOTALL).splitlines()


def test_the_reference_lists_every_public_name():
    text = "\n".join([HEAD, *public(jp, "jp."), *public(jp.study, "jp.study.")])
    if os.environ.get("INSTA_UPDATE") == "always":
        PAGE.write_text(text, "utf-8")
    there = PAGE.read_text("utf-8")
    assert without_signatures(text) == without_signatures(there), "run INSTA_UPDATE=always pytest -k reference"
