"""Jets: elements that are linear in unknown functions, taken apart."""

from __future__ import annotations

from collections.abc import Collection

from sympy.core.function import AppliedUndef

from geomtorsion.errors import ExpressionError
from geomtorsion.exact.element import Element

# An unknown function and the order of its derivative by each of its arguments.
Jet = tuple[AppliedUndef, tuple[int, ...]]


def linear_parts(element: Element, functions: Collection[AppliedUndef]) -> dict[Jet, Element]:
    """Coefficients of unknown functions and their derivatives in an element linear in them.

    Raises
    ------
    ExpressionError
        The element is not linear in the functions.

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> x = sympy.Symbol("x")
    >>> f = sympy.Function("f")(x)
    >>> linear_parts(Field([x]).read(x**2 * f.diff(x)), [f])
    {(f(x), (1,)): Element(x**2)}
    """
    field = element.field
    whole = field.whole(element)
    jets = {}
    for generator in field.generators_of(whole):
        if generator.kind == "jet":
            function, orders, places = generator.argument
            applied = function(*(place.sympy for place in places))
            if applied in functions:
                jets[generator] = applied, orders
    if not jets:
        if whole.is_zero:
            return {}
        raise ExpressionError(f"expected an expression linear in {_listed(functions)}, got {whole}")
    bottom, top = field.denominator(whole), field.lift(whole)
    parts, rest = {}, field.polynomial(top)
    for generator, jet in jets.items():
        slope = field.polynomial(top.derivative(field.generators.index(generator)))
        rest = rest - slope * field.generator_element(generator)
        parts[jet] = slope / bottom
    mixed = any(g in jets for x in (*parts.values(), bottom) for g in field.generators_of(x))
    if mixed or rest.is_zero is not True:
        raise ExpressionError(f"expected an expression linear in {_listed(functions)}, got {whole}")
    return parts


def _listed(functions: Collection[AppliedUndef]) -> str:
    return ", ".join(str(one) for one in functions)
