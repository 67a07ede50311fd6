"""Lie algebras: names, Bianchi types, series and signatures against matrices and tables."""

import copy
import pickle
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError

k = sp.Symbol("k", positive=True)


def of_matrices(matrices: list[sp.Matrix]) -> gt.LieAlgebra:
    """The algebra that a list of independent matrices spans over the reals."""
    n = len(matrices)
    numbers = [np.array(one.tolist(), dtype=complex) for one in matrices]

    def entries(one: np.ndarray) -> np.ndarray:
        return np.concatenate([np.real(one).ravel(), np.imag(one).ravel()])

    columns = np.array([entries(one) for one in numbers]).T
    constants = {}
    for (i, a), (j, b) in combinations(enumerate(numbers), 2):
        change, *_ = np.linalg.lstsq(columns, entries(a @ b - b @ a), rcond=None)
        assert np.allclose(columns @ change, entries(a @ b - b @ a)), "the matrices do not close"
        values = {m: Fraction(w).limit_denominator(1000) for m, w in enumerate(change.tolist())}
        constants |= {(i, j, m): sp.Rational(value) for m, value in values.items() if value}
    return gt.LieAlgebra(
        {(i, j, m): 0 for i in range(n) for j in (n - 1,) for m in (0,)} | constants
    )


def unit(n: int, i: int, j: int, value: sp.Expr | int = 1) -> sp.Matrix:
    """A matrix with one entry."""
    matrix = sp.zeros(n, n)
    matrix[i, j] = value
    return matrix


def rotations(p: int, q: int) -> list[sp.Matrix]:
    """so(p, q)."""
    eta = [1] * p + [-1] * q
    n = p + q
    return [unit(n, i, j) - unit(n, j, i, eta[i] * eta[j]) for i, j in combinations(range(n), 2)]


def with_translations(p: int, q: int) -> list[sp.Matrix]:
    """so(p, q) with the translations."""
    n = p + q
    turns = [sp.diag(one, sp.zeros(1, 1)) for one in rotations(p, q)]
    return turns + [unit(n + 1, i, n) for i in range(n)]


def traceless(n: int) -> list[sp.Matrix]:
    """sl(n, R)."""
    mixed = [unit(n, i, j) for i in range(n) for j in range(n) if i != j]
    return mixed + [unit(n, i, i) - unit(n, i + 1, i + 1) for i in range(n - 1)]


def unitary(p: int, q: int) -> list[sp.Matrix]:
    """su(p, q)."""
    n, eta = p + q, [1] * p + [-1] * q
    basis = [sp.I * (unit(n, i, i) - unit(n, i + 1, i + 1)) for i in range(n - 1)]
    for i, j in combinations(range(n), 2):
        sign = eta[i] * eta[j]
        basis += [unit(n, i, j) - unit(n, j, i, sign), sp.I * (unit(n, i, j) + unit(n, j, i, sign))]
    return basis


def sums(*parts: list[sp.Matrix]) -> list[sp.Matrix]:
    """Matrices in blocks: the direct sum."""
    sizes = [part[0].rows for part in parts]
    return [
        sp.diag(*(one if m == k else sp.zeros(size, size) for m, size in enumerate(sizes)))
        for k, part in enumerate(parts)
        for one in part
    ]


NAMED = {
    "so(3)": rotations(3, 0),
    "sl(2, R)": traceless(2),
    "so(4)": rotations(4, 0),
    "so(3, 1)": rotations(3, 1),
    "so(2, 2)": rotations(2, 2),
    "so(3) + sl(2, R)": sums(traceless(2), rotations(3, 0)),
    "so(4, 1)": rotations(4, 1),
    "so(3, 2)": rotations(3, 2),
    "su(3)": unitary(3, 0),
    "su(2, 1)": unitary(2, 1),
    "sl(3, R)": traceless(3),
    "sl(3, C)": traceless(3) + [sp.I * one for one in traceless(3)],
    "e(2)": with_translations(2, 0),
    "e(1, 1)": with_translations(1, 1),
    "e(3)": with_translations(3, 0),
    "iso(3, 1)": with_translations(3, 1),
    "iso(2, 1)": with_translations(2, 1),
    "so(3) + R": sums(rotations(3, 0), [sp.ones(1, 1)]),
    "e(3) + R^2": sums(with_translations(3, 0), [sp.ones(1, 1)], [sp.ones(1, 1)]),
    "sl(2, R) acting on R^2": [sp.diag(x, sp.zeros(1, 1)) for x in traceless(2)]
    + [unit(3, 0, 2), unit(3, 1, 2)],
    "aff(R)": [unit(2, 0, 0), unit(2, 0, 1)],
    "Heisenberg algebra": [unit(3, 0, 1), unit(3, 1, 2), unit(3, 0, 2)],
    "Heisenberg algebra of dimension 5": [
        *(unit(4, 0, i) for i in (1, 2)),
        *(unit(4, i, 3) for i in (1, 2)),
        unit(4, 0, 3),
    ],
    "Heisenberg algebra + R": sums([unit(3, 0, 1), unit(3, 1, 2), unit(3, 0, 2)], [sp.ones(1, 1)]),
    "nilpotent algebra of dimension 6, lower central series 6, 3, 1, 0": [
        unit(4, i, j) for i, j in combinations(range(4), 2)
    ],
    "solvable algebra of dimension 5, derived series 5, 3, 1, 0": [
        *(unit(3, i, j) for i, j in combinations(range(3), 2)),
        sp.diag(1, -1, 0),
        sp.diag(0, 1, -1),
    ],
}


@pytest.mark.parametrize("name", NAMED)
def test_algebras_of_matrices(name: str) -> None:
    """The name of each algebra of matrices, also in another basis."""
    matrices = NAMED[name]
    algebra = of_matrices(matrices)
    assert algebra.name == name
    assert algebra.dimension == len(matrices)
    if len(matrices) < 7:
        mixed = [sum((one * (j + 1) for one in matrices[:j]), x) for j, x in enumerate(matrices)]
        assert of_matrices(mixed[::-1]).name == name


def test_the_oscillator_algebra() -> None:
    """A rotation of a Heisenberg algebra, or a boost, has a central element that is a bracket."""
    turn = {(0, 1, 2): 1, (0, 2, 1): -1, (1, 2, 3): 1}
    assert gt.LieAlgebra(turn).name == "oscillator algebra"
    assert gt.LieAlgebra(turn | {(0, 2, 1): 1}).name == "split oscillator algebra"


BIANCHI = {
    "bianchi_i": ("I", "R^3"),
    "bianchi_ii": ("II", "Heisenberg algebra"),
    "bianchi_iii": ("III", "aff(R) + R"),
    "bianchi_iv": ("IV", "Bianchi IV"),
    "bianchi_v": ("V", "Bianchi V"),
    "bianchi_vi_0": ("VI_0", "e(1, 1)"),
    "bianchi_vi_h": ("VI_h, h = -a**2", "Bianchi VI_h, h = -a**2"),
    "bianchi_vii_0": ("VII_0", "e(2)"),
    "bianchi_vii_h": ("VII_h, h = a**2", "Bianchi VII_h, h = a**2"),
    "bianchi_viii": ("VIII", "sl(2, R)"),
    "bianchi_ix": ("IX", "so(3)"),
}


@pytest.mark.parametrize("name", BIANCHI)
def test_bianchi_types(name: str) -> None:
    """The legs of each shipped Bianchi space have its algebra, in this basis and in another."""
    frame = gt.spaces.load(name).frame
    constants = -frame.anholonomy.in_frame().to_sympy()
    assert isinstance(constants, sp.ImmutableDenseNDimArray)
    algebra = gt.LieAlgebra(constants.tolist())
    assert (algebra.bianchi, algebra.name) == BIANCHI[name]
    new = sp.Matrix([[1, 2, 0], [0, 1, -1], [3, 0, 1]])
    back = new.inv()
    turned = [
        [
            [
                sum(
                    new[i, a] * new[j, b] * constants[a, b, c] * back[c, m]
                    for a in range(3)
                    for b in range(3)
                    for c in range(3)
                )
                for m in range(3)
            ]
            for j in range(3)
        ]
        for i in range(3)
    ]
    other = gt.LieAlgebra(turned)
    assert (other.bianchi, other.name) == BIANCHI[name]


def test_numbers_of_an_algebra() -> None:
    """Killing form, series, centre and radical of the Euclidean and the Heisenberg algebra."""
    motions = of_matrices(with_translations(3, 0))
    assert motions.signature == (0, 3, 3)
    assert (motions.radical, motions.center, motions.derived_series) == (3, 0, (6,))
    assert motions.is_unimodular
    assert not motions.is_semisimple
    assert not motions.is_solvable
    nil = gt.LieAlgebra({(0, 1, 2): 1})
    assert (nil.radical, nil.center, nil.lower_central_series) == (3, 1, (3, 1, 0))
    assert nil.is_nilpotent
    assert nil.killing_form == sp.zeros(3, 3)
    assert not gt.LieAlgebra({(0, 1, 1): 1}).is_unimodular


def test_killing_form_of_rotations() -> None:
    """K(X, Y) = (n - 2) tr(X Y) on so(n)."""
    matrices = rotations(4, 0)
    algebra = of_matrices(matrices)
    expected = sp.Matrix(6, 6, lambda i, j: 2 * (matrices[i] * matrices[j]).trace())
    assert algebra.killing_form == expected


def test_brackets() -> None:
    """Brackets of vectors follow from the constants; the array is antisymmetric."""
    algebra = gt.LieAlgebra({(0, 1, 2): k, (1, 2, 0): 1, (2, 0, 1): 1})
    assert algebra.bracket([1, 0, 0], [0, 1, 2]) == (0, -2, k)
    assert algebra.structure_constants[1, 0, 2] == -k
    assert algebra.brackets() == {(0, 1, 2): k, (0, 2, 1): -1, (1, 2, 0): 1}
    assert "signs at k = " in str(algebra)


def test_as_an_object() -> None:
    """Equal by content; copies and pickles are equal; a notebook shows the brackets."""
    algebra = gt.LieAlgebra({(0, 1, 2): k})
    for other in (pickle.loads(pickle.dumps(algebra)), copy.deepcopy(algebra)):
        assert other == algebra
        assert hash(other) == hash(algebra)
        assert other.name == algebra.name
    assert algebra != gt.LieAlgebra({(0, 1, 2): 1})
    shown = algebra._repr_html_()
    assert "Heisenberg algebra" in shown
    assert "<math" in shown


REFUSALS = [
    (lambda: gt.LieAlgebra({(0, 1, 2): 1, (0, 2, 2): 1, (1, 2, 0): 1}), "Jacobi"),
    (lambda: gt.LieAlgebra([[[0, 0], [1, 0]], [[1, 0], [0, 0]]]), "antisymmetric"),
    (lambda: gt.LieAlgebra("so(3)"), "structure constants"),
    (
        lambda: gt.LieAlgebra({(0, 1, 1): 1}).bracket([1], [1, 0]),
        "one for each of 2 basis",
    ),
    (lambda: gt.LieAlgebra({(0, 1, 1): 1}).bracket(3, [1, 0]), "first"),  # pyright: ignore[reportArgumentType]
]


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_bad_input_is_refused(call, words):
    """Each bad argument is refused with its own message."""
    with pytest.raises(GeomtorsionError, match=words):
        call()
