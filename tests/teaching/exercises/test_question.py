"""Questions: expected mistakes and permutations of components."""

import numpy as np
import sympy as sp

from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.question import (
    Mistake,
    Question,
    all_mistakes,
    normal,
    permuted,
    reordered,
    scaled,
)

x, y = sp.symbols("x y", real=True)


def test_mistakes_never_equal_the_solution():
    """A permuted symmetric tensor or a doubled zero equals the solution: it is not a mistake."""
    symmetric = Question(
        "q", "components", "?", lambda: [[1, 2], [2, 3]], Domain((x,)),
        lambda: [Mistake("inverse", [[1, 2], [2, 3]])], shape=(2, 2),
    )  # fmt: skip
    assert {m.code for m in all_mistakes(symmetric)} == {"sign", "factor"}
    zero = Question("q", "expression", "?", lambda: 0, Domain((x,)))
    assert all_mistakes(zero) == ()


def test_permutations():
    """All other orders of the indices, once each."""
    value = {(0, 1, 2): 5}
    assert len(list(permuted(value, (3, 3, 3)))) == 5
    assert list(permuted(value, (3, 3, 2))) == []
    assert reordered(value, (2, 0, 1)) == {(2, 0, 1): 5}
    assert scaled(value, -1) == {(0, 1, 2): -5}
    assert normal(sp.Matrix([[0, 1]])) == {(0, 1): 1}
    assert normal(np.array([0.0, 2.0])) == {(1,): 2.0}
