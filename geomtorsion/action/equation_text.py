"""Writing: equations of motion as lines of text and of LaTeX."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.support.displays import latex_of

if TYPE_CHECKING:
    from geomtorsion.exact import Element


def by_powers(element: Element, velocities: Sequence[sp.Symbol]) -> sp.Expr:
    """An element as a sum over products of velocities, where it is at most quadratic in them.

    Each coefficient is by itself as short as possible, as in u2*u3*(I2 - I3)/I1 - k*x/I1.

    Examples
    --------
    >>> from geomtorsion.exact import Field
    >>> u, x, k = sp.symbols("u x k")
    >>> by_powers(Field([x, k, u]).read((u**2 * x + k * u**2 + x * sp.sin(x)) / k), [u])
    u**2*(k + x)/k + x*sin(x)/k
    """
    field, moving = element.field, set(velocities)
    if not element.symbols & moving:
        return element.sympy
    rest, terms = element, []
    for place, velocity in enumerate(velocities):
        slope = element.diff(velocity)
        for two in velocities[place:]:
            value = slope.diff(two)
            if value.is_zero:
                continue
            value = value * Fraction(1, 2) if velocity == two else value
            if value.symbols & moving:
                return element.sympy
            terms.append(value.sympy * velocity * two)
            rest = field.sum([(1, rest), (-1, value, field.symbol(velocity), field.symbol(two))])
    for velocity in velocities:
        value = rest.diff(velocity)
        if not value.is_zero:
            if value.symbols & moving:
                return element.sympy
            terms.append(value.sympy * velocity)
            rest = field.sum([(1, rest), (-1, value, field.symbol(velocity))])
    return sp.Add(*terms, rest.sympy)


def rate_text(rates: Mapping[str, sp.Expr]) -> str:
    """Equations as text, name' = rate, one state a line.

    Examples
    --------
    >>> print(rate_text({"x": sp.Symbol("u1"), "u1": -sp.Symbol("x")}))
    x' = u1
    u1' = -x
    """
    return "\n".join(f"{name}' = {value}" for name, value in rates.items())


def rate_latex(rates: Mapping[str, sp.Expr], remark: str = "") -> str:
    """The same as aligned LaTeX, with a remark below.

    Examples
    --------
    >>> print(rate_latex({"phi1": sp.Symbol("u1")}))
    \\begin{aligned}
    \\dot{\\phi}_{1} &= u_{1}
    \\end{aligned}
    """
    lines = [f"{dotted(name)} &= {latex_of(value)}" for name, value in rates.items()]
    lines += [f"&{remark}"] * bool(remark)
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"


def dotted(name: str, dots: int = 1) -> str:
    """A name in LaTeX with dots over its letter.

    Examples
    --------
    >>> dotted("theta"), dotted("u1", 2)
    ('\\\\dot{\\\\theta}', '\\\\ddot{u}_{1}')
    """
    letter, *rest = latex_of(sp.Symbol(name)).split("_", 1)
    return f"\\{'d' * dots}ot{{{letter}}}" + "".join(f"_{part}" for part in rest)
