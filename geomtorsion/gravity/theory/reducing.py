"""Reducing: from field equations to first-order equations of functions of one variable."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError, LimitError
from geomtorsion.exact import Element, unknown_functions
from geomtorsion.gravity.reduced.branches import Branch, Search
from geomtorsion.gravity.reduced.elimination import Eliminated, Elimination, Residual
from geomtorsion.gravity.reduced.jets import Jets
from geomtorsion.gravity.reduced.reduction import Reduction
from geomtorsion.gravity.theory.residuals import Sources, conditions_of, names_of_inner
from geomtorsion.support import checks


def reduced(sources: Sources, variable: object, conditions: object) -> Reduction:
    """First-order equations and constraints of field equations; see `FieldEquations.reduce`."""
    frame = sources.frame
    coordinates = {one.name: one for one in frame.coordinates}
    order = (sources.connection, sources.fluid, sources.field, sources.coframe)
    more = conditions_of(conditions)
    residuals = list(sources.residuals(more))
    elements = [element for element, _ in residuals]
    functions = unknown_functions(elements)
    if variable is None:
        used = [x for x in frame.coordinates if any(x in one.args for one in functions)]
        variable = (used or frame.coordinates)[0].name
    name = checks.known_name(variable, coordinates, "variable", GravityError)
    symbol = coordinates[name]
    _check_functions(functions, symbol)
    rank = {function: k for k, part in enumerate(order) for function in part}
    functions.sort(key=lambda one: (rank.get(one, -1), str(one)))
    if not functions:
        raise GravityError(
            f"reduce: expected an unknown function of {symbol}, got equations without one. Give "
            f"the ansatz a function such as a({symbol})."
        )
    others = [one for one in frame.field.symbols if one != symbol]
    jets = Jets(symbol, functions, others, _highest(elements))
    pool = [
        Residual(part, own)
        for element, own in residuals
        for part in _parts(jets, element, frame.coordinates)
    ]
    # A function of the coframe or the connection may drop out of all equations.
    kinds = sources.nonzero, sources.algebraic, sources.vanishing
    sorts = [x.intersection(functions) for x in kinds]
    below = [jets.read(_denominator(element)) for element in elements]
    search = Search(partial(Elimination, jets, functions, *sorts, below), tuple(pool))
    names = () if more else names_of_inner(sources.inner, symbol.name)
    first = _first(search, names)
    _check_determined(sources, jets, functions, first.eliminated)
    return Reduction(jets, first, search, frame, names)


def _first(search: Search, names: Sequence[str]) -> Branch:
    """The first branch of a search; names: of arguments that a condition could name."""
    try:
        return search.first()
    except LimitError as limit:
        advice = f"Name the argument of a function: conditions={list(names)}. " if names else ""
        raise LimitError(
            f"reduce: the elimination of derivatives is too large ({checks.cut(str(limit))}). "
            f"{advice}Give numbers for constants, use fewer unknown functions, or write the theory "
            "with a scalar field."
        ) from None
    except RecursionError:
        raise GravityError(
            "reduce: expected equations that give one highest derivative after another, got ones "
            "that refer to each other in a circle. Omit a condition, or add one."
        ) from None


def _check_functions(functions: Sequence[AppliedUndef], variable: sp.Symbol) -> None:
    """Refuse functions of anything else than the variable."""
    for one in functions:
        if one.args != (variable,):
            raise GravityError(
                f"reduce: expected functions of {variable}, got {one}. Choose this function, or "
                "make it depend on this variable only."
            )


def _highest(elements: Iterable[Element]) -> int:
    """The largest order that elimination needs: Jacobi's bound on the order of a system."""
    orders: dict[sp.Basic, int] = {}
    for element in elements:
        for one in element.sympy.atoms(sp.Derivative):
            function, order = one.expr, sum(int(n) for _, n in one.variable_count)
            orders[function] = max(order, orders.get(function, 0))
    return sum(orders.values()) + max(orders.values(), default=0) + 1


def _denominator(element: Element) -> sp.Expr:
    """The denominator of an element, without factors that cancel."""
    whole = element.field.whole(element) if element.is_kept else element
    return sp.fraction(whole.sympy)[1]


def _parts(jets: Jets, element: Element, coordinates: Sequence[sp.Symbol]) -> list[Element]:
    """Elements without other coordinates that vanish where one does for all of their values."""
    parts = [jets.read(sp.fraction(element.sympy)[0])]
    for coordinate in coordinates:
        if coordinate != jets.variable:
            parts = [x for part in parts for x in _coefficients(jets, part, coordinate)]
    return parts


def _coefficients(jets: Jets, element: Element, coordinate: sp.Symbol) -> list[Element]:
    """Derivatives by a coordinate at one place, which vanish all if the element does."""
    if coordinate not in element.symbols:
        return [element]
    waves = [sp.sin(coordinate), sp.cos(coordinate)]
    numerator = sp.fraction(element.sympy)[0]
    place, parts = sp.S.Zero, list[Element]()
    if numerator.has(*waves):
        place = sp.pi / 2
        if not numerator.is_polynomial(*waves):
            raise GravityError(
                f"reduce: expected equations in which {coordinate} drops out or occurs as a power, "
                f"sine or cosine, got {checks.cut(str(numerator))}. Choose other coordinates."
            )
    count = 2 * sp.Poly(numerator, *waves).total_degree() + 1
    while not element.is_zero and (len(parts) < count or place == 0):
        parts.append(jets.replaced(element, {coordinate: jets.field.read(place)}))
        element = element.diff(coordinate)
    return parts


def _check_determined(
    sources: Sources, jets: Jets, functions: Sequence[AppliedUndef], result: Eliminated
) -> None:
    """Refuse equations that leave a function free, or nothing to solve."""
    free = [one for one in functions if one not in result.rules]
    if free:
        one, name = free[0], free[0].func.__name__
        raise GravityError(
            f"reduce: expected an equation for each unknown function, got none for {one}: "
            f"{_freedom(sources, jets, one)}, such as conditions=['{name} = 1']."
        )
    if not any(rule.order for rule in result.rules.values()):
        values = ", ".join(f"{f} = {rule.value}" for f, rule in result.rules.items())
        raise GravityError(
            f"reduce: expected a differential equation, got functions without freedom: {values}. "
            "There is nothing to solve."
        )


def _freedom(sources: Sources, jets: Jets, function: AppliedUndef) -> str:
    """The meaning of a function without an equation, and what to do."""
    name = function.func.__name__
    if function in sources.fluid:
        return "the fluid has no equation of state. Give one as a condition"
    if function in sources.connection:
        return f"the theory does not determine {name} of the connection. Choose it by a condition"
    if function in sources.field:
        return f"the field {name} does not enter the equations. Choose it by a condition"
    frame = sources.frame
    column = frame.coordinates.index(jets.variable)
    places = {
        (leg, mu)
        for (leg, mu), entry in frame.coframe.components.nonzero.items()
        if function in unknown_functions([entry])
    }
    if all(mu == column for _, mu in places):
        eta = frame.eta.components.get
        alike = [
            eta((i, i)) == eta((leg, leg)) for i in range(frame.dimension) for leg, _ in places
        ]
        word = "lapse" if sum(alike) == 1 else "radial gauge"
        return (
            f"the {word} is free, because any other {jets.variable} serves as well: choose {name}. "
            "Give a condition"
        )
    return f"the coordinates are not fixed: choose {name}. Give a condition"
