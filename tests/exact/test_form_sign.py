"""Form: shorter elements with the same sign as longer ones."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion.codegen import numpy_function
from geomtorsion.exact import Field
from geomtorsion.exact.form import form, of_same_sign

R, THETA, M, A = sp.symbols("r theta M a")
EDGES = [
    (R**2 - 2 * M * R + A**2) * sp.sin(THETA) / R**2,
    -(sp.cos(THETA) ** 3) / R,
    R**2 * sp.sin(THETA),
    (R - M) ** 3 * (R + M) ** 2 / (THETA**5 * (R - A)),
    sp.exp(R) * (R - 3) / 7,
    -1 / R**2,
    sp.sqrt(1 + R**2) * (M - R**2) / (1 + R**2) ** 2,
    sp.sin(5 * THETA) ** 3 / R**3,
    sp.Integer(-3),
    sp.Integer(0),
]


@pytest.mark.parametrize("expression", EDGES)
def test_signs_and_zeros(expression):
    """The shorter element has the same sign around each zero and pole, and has no denominator."""
    names = (R, THETA, M, A)
    element = Field(names).read(expression)
    shorter = of_same_sign(element)
    values = np.random.default_rng(5).uniform(-4, 4, (4, 3000))
    both = numpy_function([element, shorter], names, check=False)(*values)
    signs = np.broadcast_to(np.sign(both), (2, 3000))
    assert np.array_equal(signs[0], signs[1])
    assert all(exponent > 0 for _, exponent in form(shorter).powers)
    assert of_same_sign(shorter).sympy == shorter.sympy


def test_positive_factors_are_omitted():
    """Positive factors are omitted, and powers are reduced to lower powers of the same sign."""
    field = Field((R, THETA, M, A))
    found = of_same_sign(field.read(EDGES[0])).sympy
    assert sp.expand(found - (R**2 - 2 * M * R + A**2) * sp.sin(THETA)) == 0
    assert of_same_sign(field.read(EDGES[4])).sympy == R - 3
    assert of_same_sign(field.read(EDGES[5])).sympy == -1
    # r**2 stays, because the element vanishes at r = 0.
    assert sp.expand(of_same_sign(field.read(EDGES[2])).sympy - EDGES[2]) == 0
