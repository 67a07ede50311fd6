"""The algebras behind the spaces: Bianchi's structure constants and the octonions."""

import random
from itertools import product as pairs

import pytest
import sympy as sp

from geomtorsion.geometry import contract
from geomtorsion.spaces import load
from geomtorsion.spaces.bianchi import TYPES, structure_constants
from geomtorsion.spaces.s7 import UNITS, product
from geomtorsion.spaces.s7 import structure_constants as octonion_constants


@pytest.mark.parametrize("name", TYPES)
def test_structure_constants_satisfy_jacobi(name: str) -> None:
    """Structure constants are antisymmetric and satisfy Jacobi's identity."""
    kind = TYPES[name]
    c = structure_constants(kind.n, kind.a)
    for i, j, k in pairs(range(3), repeat=3):
        assert c[i][j][k] == -c[j][i][k]
        for m in range(3):
            cyclic = sum(
                c[i][j][s] * c[s][k][m] + c[j][k][s] * c[s][i][m] + c[k][i][s] * c[s][j][m]
                for s in range(3)
            )
            assert sp.expand(cyclic) == 0


def test_classes_a_and_b() -> None:
    """The trace C_ij^j vanishes for class A and is 2 a along the first leg for class B."""
    for kind in TYPES.values():
        c = structure_constants(kind.n, kind.a)
        assert [sum(c[i][j][j] for j in range(3)) for i in range(3)] == [2 * kind.a, 0, 0]


def test_octonions_have_a_norm_and_do_not_associate() -> None:
    """|p q| = |p| |q| for random octonions; (e1 e2) e3 = - e1 (e2 e3)."""
    source = random.Random(7)
    for _ in range(20):
        p, q = ([sp.Integer(source.randint(-9, 9)) for _ in range(8)] for _ in range(2))
        norms = [sum(x**2 for x in octonion) for octonion in (p, q, product(p, q))]
        assert norms[0] * norms[1] == norms[2]
    e = [[sp.Integer(i == k) for i in range(8)] for k in range(8)]
    left = product(product(e[1], e[2]), e[3])
    right = product(e[1], product(e[2], e[3]))
    assert left == [-x for x in right]
    assert any(left)
    assert len(octonion_constants()) == 42


def test_coframe_of_s7_is_the_octonionic_one() -> None:
    """conj(p) dp at p = (1 + x)^2 / (1 + x.x): no real part, the coframe as imaginary part."""
    frame = load("s7").frame
    x = frame.coordinates
    square = sum(component**2 for component in x)
    p = [(1 - square) / (1 + square), *(2 * component / (1 + square) for component in x)]
    point = {component: sp.Rational(k - 4, 5) for k, component in enumerate(x)}
    conjugate = [p[0], *(-component for component in p[1:])]
    here = [entry.subs(point) for entry in conjugate]
    for m in UNITS:
        change = [entry.diff(x[m - 1]).subs(point) for entry in p]
        form = product(here, change)
        assert form[0] == 0
        assert form[1:] == [frame.coframe[i - 1, m - 1].subs(point) for i in UNITS]


def test_square_of_the_torsion_of_s7() -> None:
    """T_acd T_b^cd = 24 g_ab: four times the Ricci tensor of the unit sphere, 168 in all."""
    frame = load("s7").frame
    whole = frame.quantity("torsion_T").in_frame().lowered(2)
    square = contract("acd,bcd->ab", whole, whole.raised(1).raised(2))
    assert square.nonzero() == {(k, k): 24 for k in range(7)}
