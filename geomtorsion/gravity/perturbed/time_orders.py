"""Time orders: the highest time derivatives in the equations of a cosmos."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sympy.core.function import AppliedUndef

from geomtorsion.exact import Element, Field, Truncated
from geomtorsion.geometry import Tensor, determinant
from geomtorsion.gravity.theory.field_equations import FieldEquations
from geomtorsion.gravity.theory.matter import ScalarField


@dataclass(frozen=True)
class TimeOrders:
    """The highest time derivatives in the equations of the scale factor and of scalar fields.

    orders: by the name of the function, a for the scale factor.
    is_degenerate: whether the coefficients of the highest derivatives have no inverse, so that the
        equations have fewer free starting values than their orders suggest.
    """

    orders: Mapping[str, int]
    is_degenerate: bool

    @property
    def is_higher(self) -> bool:
        """Whether an equation is of higher order than two."""
        return any(order > 2 for order in self.orders.values())

    @property
    def meaning(self) -> str:
        """What higher derivatives mean for the modes of a theory; empty for second order."""
        if not self.is_higher:
            return ""
        modes = "the theory has further modes; count them"
        if self.is_degenerate:
            modes = "constraints remove some of the further modes; count the rest"
        return f"higher time derivatives: {self}; {modes} with perturbed.degrees_of_freedom"

    def __str__(self) -> str:
        if not self.is_higher:
            return "second order"
        parts = [f"{name} to order {order}" for name, order in self.orders.items() if order > 2]
        kind = "degenerate" if self.is_degenerate else "not degenerate"
        return f"{', '.join(parts)}, {kind}"


def orders_of_cosmos(equations: FieldEquations, tensor: Tensor, scale: AppliedUndef) -> TimeOrders:
    """Orders of the equations of the scale factor and of the scalar fields of a cosmos.

    tensor: the equation of the coframe or of the metric, last index up. scale: log of a(t).
    """
    volume, field = equations.frame.determinant.element(), equations.frame.field
    space = field.sum([(1, volume, tensor.element(i, i)) for i in (1, 2, 3)])
    rows = {scale: _base(space)}
    for one in equations.matter:
        if isinstance(one, ScalarField):
            row = volume * equations.matter_equations[one.symbol].element()
            assert isinstance(one.phi, AppliedUndef)
            rows[one.phi] = _base(row)
    return time_orders(rows, tensor.order(0).frame.field)


def _base(element: Element) -> Element:
    """An element of an expanded frame at order zero."""
    assert isinstance(element, Truncated)
    return element.parts[0]


def time_orders(rows: Mapping[AppliedUndef, Element], field: Field) -> TimeOrders:
    """Orders of the equations of functions of the time, one equation for each function.

    The equations follow from an action, in which function j has derivatives up to order a_j. The
    coefficient of the derivative of j of order a_i + a_j in equation i is the second derivative of
    the Lagrangian by the highest derivatives of i and j.
    """
    slopes = {name: _slopes(row, list(rows)) for name, row in rows.items()}
    # The orders that the own equations demand; equations of other functions may demand more.
    own = {x: -(-max(slopes[x].get(x, {0: None})) // 2) for x in rows}
    for x in rows:
        mixed = [max(one[x]) - own[y] for y, one in slopes.items() if x in one and y != x]
        own[x] = max(own[x], *mixed, 0)
    names = list(rows)
    entries = {}
    for i, x in enumerate(names):
        for j, y in enumerate(names):
            slope = slopes[x].get(y, {}).get(own[x] + own[y])
            if slope is not None:
                entries[i, j] = slope
    orders = {
        x: max((max(one[x]) for one in slopes.values() if x in one), default=0) for x in names
    }
    whole = determinant(field, entries, len(names))
    return TimeOrders({_name(x): k for x, k in orders.items()}, bool(whole.is_zero))


def _name(function: AppliedUndef) -> str:
    """The name of a function; N is the logarithm of the scale factor a."""
    name = function.func.__name__
    return "a" if name == "N" else name


def _slopes(row: Element, functions: list[AppliedUndef]) -> dict[AppliedUndef, dict[int, Element]]:
    """Function -> order of its derivative in the element -> derivative of the element by it."""
    field = row.field
    whole = field.whole(row)
    bottom, top = field.denominator(whole), field.lift(whole)
    result: dict[AppliedUndef, dict[int, Element]] = {}
    for generator in field.generators_of(whole):
        if generator.kind != "jet":
            continue
        function, orders, places = generator.argument
        applied = function(*(place.sympy for place in places))
        if applied in functions:
            slope = field.polynomial(top.derivative(field.generators.index(generator))) / bottom
            result.setdefault(applied, {})[sum(orders)] = slope
    return result
