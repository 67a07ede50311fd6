"""Functions: the trigonometric and hyperbolic functions by their names, and roots of squares."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

import sympy

if TYPE_CHECKING:
    from geomtorsion.exact.element import Element


class RootOfSquare(sympy.Function):
    """The root of a square, which a field reads with the sign that it has in the domain.

    sympy makes Abs of it as soon as the symbols in it are real, and no field reads that.
    """

    nargs = 1


def with_roots(expression: sympy.Basic) -> sympy.Basic:
    """An expression in which sympy has made Abs of roots, ready to be read.

    Examples
    --------
    >>> x = sympy.Symbol("x", real=True)
    >>> with_roots(1 + sympy.sqrt(x**2))
    RootOfSquare(x) + 1
    """
    return expression.replace(sympy.Abs, RootOfSquare)


class Waves(Protocol):
    """What all these functions are made of; the reader of a field has it."""

    def cos_sin(self, angle: Element) -> tuple[Element, Element]:
        """(cos, sin) of an element."""
        ...

    def cosh_sinh(self, argument: Element) -> tuple[Element, Element]:
        """(cosh, sinh) of an element."""
        ...

    def exp(self, exponent: Element) -> Element:
        """exp of an element."""
        ...


# The value of a function from what reads its argument, and the argument.
Rule = Callable[[Waves, "Element"], "Element"]


def _circular(form: Callable[[Element, Element], Element]) -> Rule:
    """A function of cos and sin of its argument."""
    return lambda waves, argument: form(*waves.cos_sin(argument))


def _hyperbolic(form: Callable[[Element, Element], Element]) -> Rule:
    """A function of cosh and sinh of its argument."""
    return lambda waves, argument: form(*waves.cosh_sinh(argument))


CIRCULAR: dict[str, Rule] = {
    "cos": _circular(lambda c, s: c),
    "sin": _circular(lambda c, s: s),
    "tan": _circular(lambda c, s: s / c),
    "cot": _circular(lambda c, s: c / s),
    "sec": _circular(lambda c, s: 1 / c),
    "csc": _circular(lambda c, s: 1 / s),
}
HYPERBOLIC: dict[str, Rule] = {
    "cosh": _hyperbolic(lambda c, s: c),
    "sinh": _hyperbolic(lambda c, s: s),
    "tanh": _hyperbolic(lambda c, s: s / c),
    "coth": _hyperbolic(lambda c, s: c / s),
    "sech": _hyperbolic(lambda c, s: 1 / c),
    "csch": _hyperbolic(lambda c, s: 1 / s),
}
FUNCTIONS: dict[str, Rule] = {
    **CIRCULAR,
    **HYPERBOLIC,
    "exp": lambda waves, argument: waves.exp(argument),
}
