"""Functions: the trigonometric and hyperbolic functions by their names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from geomtorsion.exact.element import Element


def _circular(form: Callable[[Element, Element], Element]) -> Any:
    """A function of cos and sin of its argument."""
    return lambda reader, argument: form(*reader.cos_sin(argument))


def _hyperbolic(form: Callable[[Element, Element], Element]) -> Any:
    """A function of cosh and sinh of its argument."""
    return lambda reader, argument: form(*reader.cosh_sinh(argument))


CIRCULAR: dict[str, Any] = {
    "cos": _circular(lambda c, s: c),
    "sin": _circular(lambda c, s: s),
    "tan": _circular(lambda c, s: s / c),
    "cot": _circular(lambda c, s: c / s),
    "sec": _circular(lambda c, s: 1 / c),
    "csc": _circular(lambda c, s: 1 / s),
}
HYPERBOLIC: dict[str, Any] = {
    "cosh": _hyperbolic(lambda c, s: c),
    "sinh": _hyperbolic(lambda c, s: s),
    "tanh": _hyperbolic(lambda c, s: s / c),
    "coth": _hyperbolic(lambda c, s: c / s),
    "sech": _hyperbolic(lambda c, s: 1 / c),
    "csch": _hyperbolic(lambda c, s: 1 / s),
}
FUNCTIONS: dict[str, Any] = {
    **CIRCULAR,
    **HYPERBOLIC,
    "exp": lambda reader, argument: reader.exp(argument),
}
