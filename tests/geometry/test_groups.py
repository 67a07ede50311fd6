"""Groups: invariant frames from structure constants."""

from itertools import product

import pytest
import sympy as sp

from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.geometry.groups import exponential

h = sp.Symbol("h", positive=True)
x = sp.Symbol("x", real=True)


def constants(n: int, **given: object) -> list:
    """C[i][j][k] = C_ij^k from names such as _01_2, completed antisymmetrically."""
    table = [[[sp.Integer(0)] * n for _ in range(n)] for _ in range(n)]
    for name, value in given.items():
        _, lower, upper = name.split("_")
        i, j, k = int(lower[0]), int(lower[1]), int(upper)
        table[i][j][k] = sp.sympify(value)
        table[j][i][k] = -sp.sympify(value)
    return table


ALGEBRAS = {
    "abelian": constants(3),
    "Heisenberg": constants(3, _01_2=1),
    "rotations": constants(3, _01_2=-1, _12_0=-1, _20_1=-1),
    "sl2": constants(3, _01_2=1, _12_0=-1, _20_1=-1),
    "Bianchi IV": constants(3, _01_1=1, _02_2=1, _02_1=1),
    "Bianchi V": constants(3, _01_1=1, _02_2=1),
    "Bianchi VI_h": constants(3, _01_1=h, _01_2=1, _02_2=h, _02_1=1),
    "Bianchi VII_h": constants(3, _01_1=h, _01_2=1, _02_2=h, _02_1=-1),
    "golden": constants(3, _01_2=1, _02_1=1, _02_2=1),
    "euclidean": constants(3, _20_1=1, _21_0=-1),
    "oscillator": constants(4, _12_3=1, _01_2=1, _02_1=-1),
    "turned": constants(3, _20_1=1, _21_0=-4),
}


@pytest.mark.parametrize("name", ALGEBRAS)
def test_anholonomy_equals_the_structure_constants(name: str) -> None:
    """The anholonomy is -C_ij^k exactly, also with parameters and irrational or complex roots."""
    table = ALGEBRAS[name]
    frame = Frame.from_structure_constants(table)
    for i, j, k in product(range(len(table)), repeat=3):
        assert frame.anholonomy[i, j, k] == -table[i][j][k], (i, j, k)
    assert cartan(frame).is_flat


def test_rotations_are_the_sphere_of_radius_two() -> None:
    """C = -epsilon is the frame of the paper: R = 3/2."""
    frame = Frame.from_structure_constants(ALGEBRAS["rotations"], "alpha beta gamma")
    assert [symbol.name for symbol in frame.coordinates] == ["alpha", "beta", "gamma"]
    assert levi_civita(frame).curvature.scalar[()] == sp.Rational(3, 2)


def test_order_matters_where_later_exponentials_come_first() -> None:
    """A nilpotent algebra of class three, ordered such that no exponential is trivial."""
    table = constants(4, _32_1=1, _31_0=1)
    frame = Frame.from_structure_constants(table)
    for i, j, k in product(range(4), repeat=3):
        assert frame.anholonomy[i, j, k] == -table[i][j][k]


@pytest.mark.parametrize(
    "matrix",
    [
        [[0, 1], [0, 0]],
        [[2, 1], [0, 2]],
        [[0, 1], [-1, 0]],
        [[1, 2], [-2, 1]],
        [[0, 2], [1, 0]],
        [[1, 1, 0, 0], [0, 1, 1, 0], [0, 0, 1, 0], [1, 0, 0, 2]],
        [[0, 1, 1, 0], [-1, 0, 0, 1], [0, 0, 0, 1], [0, 0, -1, 0]],
    ],
    ids=str,
)
def test_exponential_solves_its_equation(matrix: list) -> None:
    """d/dx exp(x A) = A exp(x A) and exp(0) = 1, defective and complex cases included."""
    constant = sp.Matrix(matrix)
    flow = exponential(constant, x)
    assert flow.subs(x, 0) == sp.eye(constant.rows)
    residue = (flow.diff(x) - constant * flow).applyfunc(sp.simplify)
    assert residue.is_zero_matrix
