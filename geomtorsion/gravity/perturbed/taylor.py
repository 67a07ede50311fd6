"""Taylor: unknown functions in a Lagrangian as polynomials about flat space."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement
from math import factorial, prod

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GravityError
from geomtorsion.gravity.theory.field_equations import FieldEquations
from geomtorsion.gravity.theory.lagrangian import Lagrangian
from geomtorsion.gravity.theory.matter import ScalarField


@dataclass(frozen=True)
class FlatTheory:
    """A theory whose unknown functions are polynomials, f_0 + f_R R + f_RR R^2/2 + ...

    lagrangian: the theory in these coefficients.
    conditions: values of coefficients for which flat space is a solution, f_0 = 0.
    """

    lagrangian: Lagrangian
    conditions: dict[sp.Symbol, sp.Expr]


def about_flat_space(
    system: FieldEquations, order: int, moving: Collection[str] = ()
) -> FlatTheory:
    """Unknown functions of invariants, which vanish in flat space, to an order in these.

    system: equations of the theory on any frame.
    moving: names of fields that do not vanish in flat space; functions of them stay as they are.
    """
    theory, expression = system.lagrangian, system.expression
    invariants = [sp.Symbol(name) for name in system.invariant_names]
    functions = sorted(expression.atoms(AppliedUndef), key=str)
    calls = [one for one in functions if not {x.name for x in one.free_symbols} & {*moving}]
    if not calls:
        return FlatTheory(theory, {})
    taken = {x.name for x in expression.free_symbols}
    values: dict[sp.Basic, sp.Expr] = {}
    coefficients: dict[sp.Symbol, None] = {}
    for call in calls:
        terms = []
        for symbol, weight in _terms(call, invariants, order):
            if symbol.name in taken:
                raise GravityError(
                    f"lagrangian: expected another name than {symbol} for a constant, which is a "
                    f"derivative of {call} here. Rename the constant."
                )
            coefficients[symbol] = None
            terms.append(symbol * weight)
        values[call] = sp.Add(*terms)
    # A function may occur under a derivative by its argument, G_X(X).
    whole = expression.xreplace(values).doit()
    zero = dict.fromkeys(invariants, sp.S.Zero)
    scalars = [one.symbol for one in system.matter if isinstance(one, ScalarField)]
    fields = {*scalars} - {*moving}
    still = [whole, *(whole.diff(x) for x in invariants if x.name in fields)]
    conditions = _conditions([one.xreplace(zero) for one in still], coefficients)
    whole = whole.xreplace(conditions)
    occurring = (x.name for x in coefficients if whole.has(x))
    constants = tuple(dict.fromkeys([*system.constants, *occurring]))
    return FlatTheory(replace(theory, expression=whole, constants=constants), conditions)


def _conditions(
    rests: Sequence[sp.Expr], coefficients: Collection[sp.Symbol]
) -> dict[sp.Symbol, sp.Expr]:
    """Values of coefficients, in order, for which expressions without other symbols vanish."""
    conditions: dict[sp.Symbol, sp.Expr] = {}
    for one in rests:
        rest = sp.expand(one.xreplace(conditions))
        free = [x for x in coefficients if rest.has(x)]
        # Other values, such as a cosmological constant, are refused with the background.
        if free and rest.free_symbols <= {*coefficients}:
            (value,) = sp.solve(rest, free[0])
            conditions[free[0]] = value
    return conditions


def _terms(
    call: AppliedUndef, invariants: Collection[sp.Symbol], order: int
) -> Iterator[tuple[sp.Symbol, sp.Expr]]:
    """Coefficients of the Taylor polynomial of a function with the products they multiply."""
    name = call.func.__name__
    zero = dict.fromkeys(invariants, sp.S.Zero)
    changes = [x - x.xreplace(zero) for x in call.args]
    marks = [str(x) if x.is_Symbol else str(k) for k, x in enumerate(call.args, start=1)]
    gap = "" if all(len(x) == 1 for x in marks) else "_"
    places = range(len(call.args))
    for total in range(order + 1):
        for chosen in combinations_with_replacement(places, total):
            mark = gap.join(marks[k] for k in chosen) or "0"
            number = prod(factorial(chosen.count(k)) for k in places)
            yield sp.Symbol(f"{name}_{mark}"), sp.Mul(*(changes[k] for k in chosen)) / number
