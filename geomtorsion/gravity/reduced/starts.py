"""Starts: values of all states, those that are missing from constraints."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import partial

import mpmath
import sympy as sp

from geomtorsion.errors import StartError
from geomtorsion.exact import parse_expression
from geomtorsion.support import checks
from geomtorsion.support.precision import EXACT_BITS, PRINTED, working_precision


def numbers_of(
    values: Mapping[str, object], names: Sequence[str], subject: str
) -> dict[str, sp.Expr]:
    """Real numbers by known names, exact where they are.

    Examples
    --------
    >>> numbers_of({"a": "1/3", "b": 0.5}, ["a", "b"], "start")
    {'a': 1/3, 'b': 1/2}
    """
    result = {}
    for name, value in checks.by_name(values, subject, StartError).items():
        checks.known_name(name, names, subject, StartError)
        fraction = checks.fraction(value)
        if fraction is None:
            where = f"{subject}: {name}"
            read = partial(parse_expression, symbols={}, functions={}, where=where, decimals=True)
            number = checks.expression(value, where, StartError, read=read)
        else:
            number = sp.Rational(fraction.numerator, fraction.denominator)
        if number.free_symbols or not number.is_real or not number.is_finite:
            raise StartError(
                f"{subject}: expected a finite real number for {name}, got {checks.shown(value)}."
            )
        result[name] = number
    return result


def completed(
    rates: Mapping[str, sp.Expr],
    constraints: Sequence[sp.Expr],
    start: Mapping[str, sp.Expr],
    known: Mapping[str, sp.Expr],
    near: Mapping[str, sp.Expr],
) -> dict[str, sp.Expr]:
    """A number for each state, by the constraints where the start has none.

    known: numbers of the parameters and of the variable.
    """
    symbols = {x.name: x for one in (*rates.values(), *constraints) for x in one.free_symbols}
    check_parameters(set(symbols) - set(rates), known)
    table = {symbols[name]: value for name, value in known.items() if name in symbols}
    here = [one.xreplace(table) for one in constraints]
    with working_precision(EXACT_BITS):
        values = _filled(rates, constraints, here, symbols, start, near)
        table |= {symbols[name]: value for name, value in values.items() if name in symbols}
        for one in constraints:
            check_constraint(one, table)
        for name, rate in rates.items():
            _check_rate(name, rate, table)
    return {name: values[name] for name in rates}


def check_parameters(names: Collection[str], known: Collection[str]) -> None:
    """Refuse parameters without a number."""
    missing = sorted(set(names) - set(known))
    if missing:
        raise StartError(
            f"parameters: expected a number for each, got none for {', '.join(missing)}. Add "
            f"parameters={{{missing[0]!r}: ...}}."
        )


def _filled(
    rates: Mapping[str, sp.Expr],
    constraints: Sequence[sp.Expr],
    here: Sequence[sp.Expr],
    symbols: Mapping[str, sp.Symbol],
    start: Mapping[str, sp.Expr],
    near: Mapping[str, sp.Expr],
) -> dict[str, sp.Expr]:
    """The start with the states that follow from constraints.

    here: the constraints with numbers for parameters and the variable.
    """
    values = filled(here, list(rates), symbols, start, near, constraints)
    left = [name for name in rates if name not in values]
    if left:
        raise StartError(
            f"start: expected numbers for all states that the constraints leave free, got none for "
            f"{', '.join(left)}. "
            + (
                f"The constraints are {'; '.join(f'0 = {one}' for one in constraints)}. Add a "
                "number for one of these states."
                if constraints
                else "There are no constraints. Add a number for each of these states."
            )
        )
    return values


def filled(
    equations: Sequence[sp.Expr],
    names: Sequence[str],
    symbols: Mapping[str, sp.Symbol],
    start: Mapping[str, sp.Expr],
    near: Mapping[str, sp.Expr],
    shown: Sequence[sp.Expr] | None = None,
) -> dict[str, sp.Expr]:
    """The start with numbers for names, each from an equation with a single unknown.

    shown: the equations as messages write them.
    """
    values = dict(start)
    while True:
        left = [name for name in names if name not in values]
        step = _next(equations, left, symbols, values, shown or equations)
        if step is None:
            return values
        name, equation, constraint = step
        values[name] = root_of(equation, symbols[name], constraint, near.get(name))


def _next(
    constraints: Sequence[sp.Expr],
    left: Sequence[str],
    symbols: Mapping[str, sp.Symbol],
    values: Mapping[str, sp.Expr],
    shown: Sequence[sp.Expr],
) -> tuple[str, sp.Expr, sp.Expr] | None:
    """A state that is the only one left in a constraint, and the constraint with numbers."""
    table = {symbols[name]: value for name, value in values.items() if name in symbols}
    for constraint, written in zip(constraints, shown, strict=True):
        equation = constraint.xreplace(table)
        unknown = [name for name in left if symbols.get(name) in equation.free_symbols]
        if len(unknown) == 1:
            return unknown[0], equation, written
    return None


def root_of(
    equation: sp.Expr, symbol: sp.Symbol, constraint: sp.Expr, near: sp.Expr | None
) -> sp.Expr:
    """The root of an equation in one symbol: the only one, or the one near a number."""
    roots = _roots(sp.fraction(sp.together(equation))[0], symbol, near)
    if not roots:
        raise StartError(
            f"start: expected values for which a real {symbol} solves 0 = {constraint}, got "
            f"values for which there is none. Change the start or the parameters."
        )
    if near is not None:
        return min(roots, key=lambda root: abs(float(root - near)))
    if len(roots) > 1:
        listed = " or ".join(f"{float(root):.6g}" for root in roots)
        raise StartError(
            f"start: expected one solution of 0 = {constraint}, got {symbol} = {listed}. Choose "
            f"one by a rough value: near={{'{symbol}': {float(roots[-1]):.3g}}}."
        )
    return roots[0]


def _roots(equation: sp.Expr, symbol: sp.Symbol, near: sp.Expr | None) -> list[sp.Expr]:
    """The real roots of a polynomial, in order; one root of any other equation."""
    if not equation.is_polynomial(symbol):
        if near is None:
            raise StartError(
                f"start: expected a rough value of {symbol}, which solves 0 = {equation}, got "
                f"none. Add near={{'{symbol}': ...}}."
            )
        try:
            return [sp.nsolve(equation, symbol, near, prec=mpmath.mp.dps)]
        except (ValueError, ZeroDivisionError):
            return []
    polynomial = sp.Poly(equation, symbol)
    if all(one.is_Rational for one in polynomial.all_coeffs()):
        roots = sorted(set(polynomial.real_roots()), key=float)
        return [_number(root) if isinstance(root, sp.CRootOf) else root for root in roots]
    numbers = [mpmath.mpf(_number(one)) for one in polynomial.all_coeffs()]
    # Multiple roots have half of the digits, or fewer.
    every = mpmath.polyroots(numbers, maxsteps=EXACT_BITS, extraprec=EXACT_BITS)
    limit = mpmath.sqrt(mpmath.mp.eps)
    real = [x.real for x in every if abs(x.imag) <= limit * (1 + abs(x))]
    return [sp.Float(x, mpmath.mp.dps) for x in sorted(real)]


def _number(value: sp.Expr) -> sp.Expr:
    """A value at the working precision."""
    return sp.N(value, mpmath.mp.dps)


def check_constraint(constraint: sp.Expr, table: Mapping[sp.Symbol, sp.Expr]) -> None:
    """Refuse a start that violates a constraint by more than rounded numbers do."""
    terms = [_number(one.xreplace(table)) for one in sp.Add.make_args(sp.expand(constraint))]
    size, value = sum(map(abs, terms)), abs(sum(terms))
    if value > PRINTED * size:
        raise StartError(
            f"start: expected values with 0 = {constraint}, got {float(value / size):.3g} times "
            "its terms. Omit one of the values, which then follows from the constraint."
        )


def _check_rate(name: str, rate: sp.Expr, table: Mapping[sp.Symbol, sp.Expr]) -> None:
    """Refuse a start at which an equation is singular."""
    below = sp.fraction(rate)[1].xreplace(table)
    if below == 0 or abs(_number(below)) < sp.Float(mpmath.sqrt(mpmath.mp.eps)):
        raise StartError(
            f"start: expected a regular point, got one where the leading coefficient of {name}' "
            f"vanishes: {name}' = {checks.cut(str(rate))}. Start at another place."
        )
