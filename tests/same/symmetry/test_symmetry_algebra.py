"""Algebras of symmetries: names of known spaces, and brackets of vectors in closed form."""

from itertools import combinations

import pytest
import sympy as sp

import geomtorsion as gt

t, x, y, z, r, theta, phi = sp.symbols("t x y z r theta phi", positive=True)
a = sp.Function("a")(t)

# Space: name, signature of the Killing form, derived series.
SHIPPED = {
    "flat_polar": ("e(2)", (0, 1, 2), (3, 2, 0)),
    "s2": ("so(3)", (0, 3, 0), (3,)),
    "so3": ("so(4)", (0, 6, 0), (6,)),
    "s3": ("so(4)", (0, 6, 0), (6,)),
    "heisenberg": ("oscillator algebra", (0, 1, 3), (4, 3, 1, 0)),
    "sol": ("e(1, 1)", (1, 0, 2), (3, 2, 0)),
    "bianchi_v": ("so(3, 1)", (3, 3, 0), (6,)),
    "bianchi_iv": ("Bianchi IV", (1, 0, 2), (3, 2, 0)),
    "goedel": ("sl(2, R) + R^2", (2, 1, 2), (5, 3)),
    "schwarzschild": ("so(3) + R", (0, 3, 1), (4, 3)),
    "kerr": ("R^2", (0, 0, 2), (2, 0)),
    "taub_nut": ("so(3) + R", (0, 3, 1), (4, 3)),
    "de_sitter": ("so(4, 1)", (4, 6, 0), (10,)),
    "ads3": ("so(2, 2)", (4, 2, 0), (6,)),
    "frw_closed": ("so(4)", (0, 6, 0), (6,)),
    "kerr_kinnersley": ("R^2", (0, 0, 2), (2, 0)),
}


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_spaces(name: str) -> None:
    """Name, Killing form and derived series of the symmetries of shipped spaces."""
    algebra = gt.symmetries(name).algebra
    assert (algebra.name, algebra.signature, algebra.derived_series) == SHIPPED[name]


FRAMES = {
    "Minkowski": (sp.diag(1, 1, 1, 1), "metric", "iso(3, 1)"),
    "FLRW": (sp.diag(1, a, a, a), "metric", "e(3)"),
    "FLRW, legs": (sp.diag(1, a, a, a), "teleparallel", "e(3)"),
    "Kasner": (sp.diag(1, t**2, t**3, t**5), "metric", "R^3"),
    "none": (sp.diag(1, 1 + x * y * t**2, 1 + x**3 + y, 1 + z * t), "metric", "trivial"),
}


@pytest.mark.parametrize("name", FRAMES)
def test_frames(name: str) -> None:
    """Names with unknown functions, for parallel legs, and for a frame without symmetry."""
    coframe, keep, expected = FRAMES[name]
    frame = gt.Frame([t, x, y, z], coframe, signature=(-1, 1, 1, 1))
    assert gt.symmetries(frame, keep).algebra.name == expected


@pytest.mark.parametrize("name", ["s2", "flat_polar", "de_sitter", "taub_nut", "goedel", "frw"])
def test_brackets_of_vectors(name: str) -> None:
    """[xi_i, xi_j] = C_ij^k xi_k holds exactly, everywhere, for the vectors in closed form."""
    found = gt.symmetries(name)
    vectors, algebra = found.vectors, found.algebra
    assert len(vectors) == algebra.dimension
    for i, j in combinations(range(len(vectors)), 2):
        total = gt.lie_bracket(found.frame, vectors[i], vectors[j])
        for (a, b, k), value in algebra.brackets().items():
            if (a, b) == (i, j):
                total = total - vectors[k] * value
        assert total.is_zero


def test_the_sign_of_a_parameter_decides() -> None:
    """Open and closed universes: k < 0 has so(3, 1), k = 0 has e(3), k > 0 has so(4)."""
    frame = gt.spaces.load("frw").frame
    names = [gt.symmetries(frame.subs({"k": value})).algebra.name for value in (-1, 0, 1)]
    assert names == ["so(3, 1)", "e(3)", "so(4)"]
    # Without a value the region has k > 0, and the heading gives the value that was used.
    algebra = gt.symmetries(frame).algebra
    assert algebra.name == "so(4)"
    assert "signs at k = " in algebra.heading
