"""Questions: tolerances, and the mistakes that are expected."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.teaching.exercises.domain import Domain
from geomtorsion.teaching.exercises.question import (
    Mistake,
    Question,
    all_mistakes,
    deviation,
    normal,
    permuted,
    reordered,
    scaled,
)

x, y = sp.symbols("x y", real=True)


def question(kind="expression", **more) -> Question:
    """A question whose answer is x."""
    return Question("q", kind, "?", lambda: more.pop("right", x), Domain((x, y)), **more)


def test_deviation_counts_tolerances():
    """One tolerance away is one, relative to the largest component."""
    asked = question("number", tolerance=1e-2)
    assert deviation(asked, {(): 101.0}, {(): 100.0}) == pytest.approx(1)
    assert deviation(asked, {(0,): 100.0, (1,): 2.0}, {(0,): 100.0}) == pytest.approx(2)
    assert deviation(asked, {(): 0.01}, {}) == pytest.approx(1)


def test_mistakes_never_equal_the_solution():
    """A permuted symmetric tensor, a doubled zero: these are no mistakes."""
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
