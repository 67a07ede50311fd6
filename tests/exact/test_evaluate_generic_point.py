"""Generic point: the point that decides signs, and the search for a positive radicand."""

from __future__ import annotations

import pytest
import sympy as sp

from geomtorsion.errors import ExpressionError
from geomtorsion.exact import Field

x = sp.Symbol("x", real=True)


@pytest.mark.parametrize(("beyond", "found"), [("50", True), ("97", False)])
def test_how_long_a_positive_radicand_is_looked_for(beyond: str, found: bool) -> None:
    """Among the points of the search some have x > 50, but none has x > 97."""
    field, root = Field([x]), sp.sqrt(x - sp.Rational(beyond))
    if found:
        assert field.sample.value(field.read(root)) > 0
    else:
        with pytest.raises(ExpressionError, match="negative at every point that was tried"):
            field.read(root)
