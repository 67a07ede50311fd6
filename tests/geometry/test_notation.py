"""Tables of components: listed components, index names, refusals."""

from __future__ import annotations

from itertools import product

import pytest
import sympy as sp

from geomtorsion import cartan, levi_civita, spaces
from geomtorsion.errors import ArgumentError, GeomtorsionError, TensorIndexError
from geomtorsion.geometry import Frame

r, phi = sp.symbols("r phi", positive=True)


@pytest.fixture(scope="module")
def polar() -> Frame:
    """Polar coordinates: legs along r and phi."""
    return Frame([r, phi], [[1, 0], [0, r]])


def test_every_component_that_does_not_vanish():
    """A table lists exactly the components that do not vanish, with their values (Kerr)."""
    bar = levi_civita(spaces.load("kerr").frame)
    table = bar.table(every=True)
    found = {row.index: row.value for row in table}
    every = {(a, b, c): bar[a, b, c] for a, b, c in product(range(4), repeat=3)}
    assert found == {index: value for index, value in every.items() if value != 0}
    assert len(table) == 32
    assert len(bar.table()) + int(bar.table().ending.split()[0]) == 32


def test_names_can_be_chosen(polar):
    """Each coordinate gets one name: letters or words of a text, or entries of a list."""
    torsion = cartan(polar).torsion.S
    assert [row.label for row in torsion.table()] == ["S_{r phi}^{phi}"]
    for names in ("rφ", "r φ", "r, φ", ["r", "φ"], ("r", "φ")):
        assert [row.label for row in torsion.table(names)] == ["S_{rφ}^{φ}"]
    assert [row.label for row in polar.anholonomy.table()] == ["C_{12}^{2}"]
    assert [row.label for row in polar.anholonomy.table("ab")] == ["C_{ab}^{b}"]


def test_an_index_can_be_chosen(polar):
    """An index is chosen by its number, its value by number or name."""
    bar = levi_civita(polar)
    wanted = {(0, 1, 1): 1 / r, (1, 0, 1): 1 / r}
    for value in (1, "phi"):
        assert {row.index: row.value for row in bar.table(where={2: value})} == wanted
    assert {row.index for row in bar.table("rφ", where={2: "φ", 0: "r"})} == {(0, 1, 1)}
    assert not bar.table(where={0: "r", 1: "r"}).rows


def test_texts(polar):
    """A table prints one component per line and counts the omitted ones."""
    assert str(polar.metric.table()).splitlines()[1:] == [
        "  g_{r r}      [0, 0]  1",
        "  g_{phi phi}  [1, 1]  r**2",
    ]
    assert repr(polar.determinant.table()) == "determinant e\n  e    r"
    assert str(levi_civita(polar).curvature.riemann.table()) == (
        "Riemann R_bar_{abc}^{d}: all components vanish"
    )
    assert str(cartan(polar).torsion.S.table()).endswith("\n  1 more follows by symmetry")


@pytest.mark.parametrize(
    ("names", "message"),
    [
        ("r", "2 different names, one for each of r, phi"),
        ("rr", "2 different names"),
        ("a b c", "2 different names"),
        (["r", ""], "2 different names"),
        (["r", 3], "2 different names"),
        (7, "2 different names"),
        ({"r": 1, "phi": 2}, "2 different names"),
    ],
)
def test_invalid_names_are_refused(polar, names, message):
    """The error for bad names states how many different names are expected."""
    with pytest.raises(TensorIndexError, match=message):
        polar.metric.table(names)


@pytest.mark.parametrize(
    ("where", "message"),
    [
        ({2: 0}, "expected an index of g_{ab} from 0 to 1, got 2"),
        ({-1: 0}, "from 0 to 1, got -1"),
        ({True: 0}, "from 0 to 1, got True"),
        ({"r": 0}, "from 0 to 1, got 'r'"),
        ({0: 2}, "a whole number from 0 to 1, or one of r, phi"),
        ({0: "theta"}, "expected a whole number .* got 'theta'"),
        ({0: 1.5}, "expected a whole number"),
        ([1], "where"),
    ],
)
def test_invalid_indices_are_refused(polar, where, message):
    """An index or a value that does not exist is named in the error."""
    with pytest.raises(GeomtorsionError, match=message):
        polar.metric.table(where=where)
    with pytest.raises(ArgumentError, match="every"):
        polar.metric.table(every="yes")


def test_how_many_components_are_shown() -> None:
    """Text shows twelve components and LaTeX sixty; the others are counted."""
    q = sp.symbols("q1:7", real=True)
    frame = Frame(q, (sp.exp(sum(q)) * sp.eye(6)).tolist())
    symbols = levi_civita(frame).coefficients
    count = len(symbols.components.independent)
    assert count > 60
    assert str(symbols).count(" = ") == 12
    assert f"and {count - 12} more independent components" in str(symbols)
    assert symbols._repr_latex_().count("&=") == 60


def test_sympy_prints_tensors(polar):
    """sympy prints our tensors as text and LaTeX, although its own class has the same name."""
    metric = polar.metric
    assert metric._repr_latex_() == rf"$\displaystyle {sp.latex(metric)}$"
    assert sp.sstr(metric) == repr(metric)
    assert [line.rstrip() for line in sp.pretty(metric).splitlines()] == repr(metric).splitlines()
    assert sp.latex([metric]).count("pmatrix") == 2
