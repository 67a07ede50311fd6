"""Notebooks: each tutorial can be downloaded, and its cells run."""

# pyright: reportMissingImports=false

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import pytest

import geomtorsion

nbformat = pytest.importorskip("nbformat")
notebooks = pytest.importorskip("notebooks")

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "examples" / "site" / "tutorials").glob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_tutorial_is_a_valid_notebook(page):
    """It has every cell of the page in order, its title first, and no link to a page."""
    text = page.read_text("utf-8")
    made = notebooks.notebook(text)
    nbformat.validate(json.loads(json.dumps(made)))
    assert made["nbformat"] == 4
    code = [cell["source"] for cell in made["cells"] if cell["cell_type"] == "code"]
    prose = [cell["source"] for cell in made["cells"] if cell["cell_type"] == "markdown"]
    assert len(code) == text.count("```{code-cell}") >= 2
    assert prose[0].startswith("# ")
    assert "kernelspec" not in prose[0]
    for source in prose:
        assert "{code-cell}" not in source
        assert not re.search(r"\]\([^)]*\.(md|rst)", source)
    for source in code:
        # Lines of IPython run commands of the shell.
        compile(re.sub(r"^!.*$", "pass", source, flags=re.MULTILINE), page.name, "exec")
        assert not source.startswith(":tags:")


@pytest.mark.parametrize(
    ("page", "kinds"),
    [
        ("", []),
        ("# Only text\n", ["markdown"]),
        ("```{code-cell}\n1\n```\n", ["code"]),
        ("```{code-cell}\n:tags: [hide-cell]\n```\n", ["code"]),
        ("```{code-cell} ipython3\n1\n```\n```{code-cell}\n2\n```\n", ["code", "code"]),
        ("```sh\nls\n```\n", ["markdown"]),
    ],
)
def test_small_pages(page, kinds):
    """Pages without text, without cells, and with other code."""
    made = notebooks.notebook(page)
    nbformat.validate(made)
    assert [cell["cell_type"] for cell in made["cells"]] == kinds


def test_answers_are_folded():
    """Cells that the page hides are folded in the notebook."""
    made = notebooks.notebook("```{code-cell}\n:tags: [hide-cell, wrap]\n1\n```\n")
    [cell] = made["cells"]
    assert cell["metadata"] == {
        "tags": ["hide-cell", "wrap"],
        "jupyter": {"source_hidden": True},
    }


def test_the_cells_of_a_notebook_run(tmp_path, monkeypatch):
    """A fresh kernel runs all cells in order, and the figures are figures."""
    client = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    pytest.importorskip("matplotlib")
    paths = [str(Path(geomtorsion.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, paths)))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    page = ROOT / "examples" / "site" / "tutorials" / "loops_that_do_not_close.md"
    made = nbformat.from_dict(notebooks.notebook(page.read_text("utf-8")))
    done = client.NotebookClient(made, timeout=300, kernel_name="python3").execute()
    outputs = [one for cell in done.cells for one in cell.get("outputs", [])]
    assert not [one for one in outputs if one["output_type"] == "error"]
    assert any("image/png" in one.get("data", {}) for one in outputs)


def test_pages_link_to_their_notebooks(built):
    """The built folder has each notebook beside its page."""
    for page in PAGES:
        file = built / "tutorials" / f"{page.stem}.ipynb"
        assert json.loads(file.read_text("utf-8")) == notebooks.notebook(page.read_text("utf-8"))
        assert f'href="{file.name}"' in file.with_suffix(".html").read_text("utf-8")
