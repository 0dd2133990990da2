"""The Python that documents show runs, block after block."""

from __future__ import annotations

import doctest
import importlib.util
import re

import pytest
from conftest import ROOT

import jointplay as jp


@pytest.mark.parametrize("name", ["README.md", "python/README.md", "docs/how-to/python.md"])
def test_code_of_documents_runs(name, monkeypatch, tmp_path):
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / name).read_text(encoding="utf-8"), re.M | re.S)
    assert blocks
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for block in blocks:
        exec(compile(block, name, "exec"), names)


@pytest.mark.once
@pytest.mark.filterwarnings("default")
def test_code_for_clusters_runs(monkeypatch, tmp_path):
    text = (ROOT / "docs" / "how-to" / "run-a-study-on-a-cluster.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    (saved,) = re.findall(r"^Save this as `(.*)`:\n\n```toml\n(.*?)^```", text, re.M | re.S)
    (tmp_path / saved[0]).write_text(saved[1])
    run = []
    for block in re.findall(r"^```python\n(.*?)^```", text, re.M | re.S):
        imported = re.findall(r"^(?:import|from) (\w+)", block, re.M)
        # Ray and Spark are large; they run where they are installed.
        if all(importlib.util.find_spec(name) for name in imported):
            exec(compile(block, "run-a-study-on-a-cluster.md", "exec"), {"__name__": "__main__"})
            run += imported
    assert {"distributed", "concurrent", "duckdb", "polars"} <= set(run)


@pytest.mark.parametrize("name", ["export-to-simulators.md", "show-motion-on-parts.md"])
def test_own_code_next_to_that_of_other_packages_runs(name, monkeypatch, tmp_path):
    text = (ROOT / "docs" / "how-to" / name).read_text(encoding="utf-8")
    blocks = [block for block in re.findall(r"^```python\n(.*?)^```", text, re.M | re.S) if "import jointplay" in block]
    assert blocks
    monkeypatch.chdir(tmp_path)
    for block in blocks:
        exec(compile(block, name, "exec"), {})


@pytest.mark.parametrize("documented", [jp, jp.Gpr])
def test_examples_of_docstrings_are_right(documented):
    found = [test for test in doctest.DocTestFinder().find(documented) if test.examples]
    assert found
    for test in found:
        assert doctest.DocTestRunner().run(test).failed == 0


def public_parts():
    for name in jp.__all__:
        thing = getattr(jp, name)
        if isinstance(thing, type):
            yield name, thing
            if issubclass(thing, BaseException):
                continue
            for attribute, value in vars(thing).items():
                if not attribute.startswith("_") and (callable(value) or hasattr(value, "__get__")):
                    yield f"{name}.{attribute}", value
        elif callable(thing):
            yield name, thing


@pytest.mark.parametrize(("name", "part"), list(public_parts()))
def test_everything_public_is_documented(name, part):
    if type(part).__name__ == "member_descriptor":  # a slot, whose annotation is documented in the source
        return
    assert (part.__doc__ or "").strip(), name
