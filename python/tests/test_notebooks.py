"""The notebooks run from top to bottom, and documents name them by their titles."""

from __future__ import annotations

import re

import nbclient
import nbformat
import pytest
from conftest import ROOT

NOTEBOOKS = sorted((ROOT / "python" / "notebooks").glob("*.ipynb"))


@pytest.mark.once
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.setenv("MPLCONFIGDIR", str(tmp_path))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs for cell in code), "outputs are stripped from notebooks that are kept"
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    assert all(cell.execution_count for cell in code)


def test_there_are_notebooks():
    assert len(NOTEBOOKS) == 5


@pytest.mark.parametrize("document", ["docs/how-to/python.md", "python/README.md"])
def test_documents_link_notebooks_by_their_titles(document):
    text = (ROOT / document).read_text(encoding="utf-8")
    links = re.findall(r"\[([^]]*)\]\([^)]*/([\w-]+)\.ipynb\)", text)
    assert links
    for link, stem in links:
        first = nbformat.read(ROOT / "python" / "notebooks" / f"{stem}.ipynb", as_version=4).cells[0]
        assert first.source.splitlines()[0] == f"# {link}"
