"""Docstrings as pages show them: prose without markup, formulas, lists, links."""

import pytest

pytest.importorskip("myst_nb", reason="the extra docs is not installed")
docstrings = pytest.importorskip("docstrings")

TEXT = """Force of *torsion* per |mass|.

Equation
--------
f^c = 2 S_a^c_b q'^a q'^b      [FizievKleinert1994], below eq. (6)
At the start omega_ai^j = 0, where nothing turns.

Parameters
----------
velocity
    Shape (n,), see `Frame`.

Raises
------
ShapeError
    It has another shape.

Examples
--------
>>> 1 + 1
2
"""


def test_a_docstring_becomes_a_page():
    """Each section is converted in its own way."""
    found = "\n".join(docstrings.converted(TEXT.split("\n")))
    assert r"\*torsion\* per \|mass\|" in found
    assert "    f^{c} = 2\\,S_{a}{}^{c}{}_{b}\\,q'^{a}\\,q'^{b}" in found
    assert "[FizievKleinert1994], below eq. (6)" in found
    assert r"At the start \ :math:`ω_{a i}{}^{j} = 0`\ , where nothing turns." in found
    assert "``velocity``\n    Shape (n,), see \\ :py:obj:`Frame <geomtorsion.Frame>`\\ ." in found
    assert ":py:exc:`~geomtorsion.errors.ShapeError`" in found
    assert ">>> 1 + 1\n2" in found


def test_fields_of_a_class_become_a_list():
    """A line with a name and a colon starts a field; other lines continue it."""
    found = docstrings.converted(
        ["A thing.", "", "size: of it, in m;", "in all.", "kind: its own."]
    )
    assert found[2:] == [
        "``size``",
        "    of it, in m;",
        "    in all.",
        "``kind``",
        "    its own.",
        "",
    ]
