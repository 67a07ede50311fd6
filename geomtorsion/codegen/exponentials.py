"""Exponentials: sums of cosh and sinh that merge into powers of exp, and which of exp(x) grow."""

from __future__ import annotations

from math import comb

import sympy
from flint import fmpq

from geomtorsion.exact.form import Monomial, Sum
from geomtorsion.exact.generators import Generator

# What is left of a monomial without hyperbolic functions of some argument; powers of exp of it.
Merged = tuple[Monomial, tuple[tuple[Generator, int], ...]]


def merged(base: Sum) -> dict[Merged, fmpq] | None:
    """The terms of a sum by exp where they are fewer: cosh(x) - sinh(x) is exp(-x).

    Fewer terms cancel less: at x = 20 that difference has no right digit. None where exp saves
    nothing; powers of exp(x) go by the generator of cosh(x).

    Examples
    --------
    >>> import sympy
    >>> from geomtorsion.exact import Field
    >>> from geomtorsion.exact.form import form
    >>> x = sympy.Symbol("x", real=True)
    >>> element = Field([x]).read(sympy.cosh(x) - sympy.sinh(x))
    >>> ((base, _),) = form(element).powers
    >>> [(number, power) for (_, ((_, power),)), number in merged(base).items()]
    [(1, -1)]
    """
    generators = {g for _, monomial in base.terms for g, _ in monomial}
    arguments = {g.shown.args[0]: g for g in generators if g.kind == "cosh"}
    pairs = [g for g in generators if g.kind == "sinh" and g.shown.args[0] in arguments]
    if not pairs:
        return None
    even = {g: arguments[g.shown.args[0]] for g in pairs}
    even |= {g: g for g in even.values()}
    total: dict[Merged, fmpq] = {}
    for value, monomial in base.terms:
        rest = tuple((g, n) for g, n in monomial if g not in even)
        parts: dict[tuple[tuple[Generator, int], ...], fmpq] = {(): value}
        for cosh in dict.fromkeys(even[g] for g, _ in monomial if g in even):
            odd, whole = (
                sum(n for g, n in monomial if even.get(g) is cosh and g.kind == kind)
                for kind in ("sinh", "cosh")
            )
            powers = _powers(whole, odd)
            parts = {
                (*known, (cosh, power)) if power else known: number * factor
                for known, number in parts.items()
                for power, factor in powers.items()
            }
        for powers_of, number in parts.items():
            key = rest, powers_of
            total[key] = total.get(key, fmpq(0)) + number
    found = {key: number for key, number in total.items() if number}
    return found if len(found) < len(base.terms) else None


def _powers(even: int, odd: int) -> dict[int, fmpq]:
    """cosh(x)**even * sinh(x)**odd as {power of exp(x): coefficient}."""
    found: dict[int, fmpq] = {}
    for i in range(even + 1):
        for j in range(odd + 1):
            power = even + odd - 2 * (i + j)
            number = fmpq((-1) ** j * comb(even, i) * comb(odd, j), 2 ** (even + odd))
            found[power] = found.get(power, fmpq(0)) + number
    return found


def never_negative(tree: sympy.Expr) -> bool:
    """Whether an expression is zero or more wherever it has a value: sums of even powers.

    sympy itself says nothing of y**2/x**2, which has no value at x = 0.

    Examples
    --------
    >>> import sympy
    >>> x, y = sympy.symbols("x y", real=True)
    >>> never_negative(x**2 / (2 * y**2) + 1), never_negative(x**2 - y**2)
    (True, False)
    """
    if tree.is_Add or tree.is_Mul:
        return all(never_negative(part) for part in tree.args)
    if tree.is_Pow and tree.exp.is_even and tree.base.is_real:
        return True
    return bool(tree.is_nonnegative)
