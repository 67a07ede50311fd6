"""Edges: where functions in equations end, or go on otherwise than their series do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import sympy as sp

# What is positive as long as an inverse function of u has a series that is right.
_INSIDE: Mapping[str, Callable[[sp.Expr], sp.Expr]] = {
    "acos": lambda u: 1 - u**2,
    "asin": lambda u: 1 - u**2,
    "atanh": lambda u: 1 - u**2,
    "acosh": lambda u: u - 1,
    "asec": lambda u: 1 - u**-2,
    "acsc": lambda u: 1 - u**-2,
    "acoth": lambda u: 1 - u**-2,
    "asech": lambda u: 1 / u - 1,
    "log": lambda u: u,
}


def edges_of(terms: Iterable[sp.Expr], moving: set[str]) -> Mapping[sp.Expr, str]:
    """What is positive until a function in some terms ends -> what happens there, in words.

    Roots are watched themselves, and so is the root of what other functions need: where it is
    touched, as 1 - x**2 is by x = cos(t), it has a double zero and its root a simple one, beyond
    which series go on as they were, but roots and inverse functions do not.

    moving: names of what changes on the way.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> edges_of([sp.sqrt(x) + sp.acos(y)], {"x", "y"})
    {sqrt(x): 'sqrt(x) = 0', sqrt(1 - y**2): '1 - y**2 = 0, where acos(y) ends'}
    """
    found: dict[sp.Expr, str] = {}
    for term in terms:
        for part in sp.preorder_traversal(term):
            if not part.args or not _moves(part.args[0], moving):
                continue
            inside = _INSIDE.get(type(part).__name__)
            if inside is not None:
                room = inside(part.args[0])
                root = sp.sqrt(room)
                if not root.has(sp.Abs):
                    found.setdefault(root, f"{room} = 0, where {part} ends")
            elif isinstance(part, sp.Pow):
                root = sp.sqrt(part.base)
                if part.exp.is_Rational or isinstance(part.exp, sp.Float):
                    if _is_even_root(part.exp) and _may_end(term, part, moving):
                        found[root] = f"{root} = 0"
                elif not (part.exp.is_integer or part.base.is_positive or root.has(sp.Abs)):
                    room = _unless_whole(part.base, part.exp, moving)
                    found[sp.sqrt(room)] = f"{part.base} = 0, in {part}"
    return found


def _moves(expr: sp.Basic, moving: set[str]) -> bool:
    """Whether an expression changes on the way."""
    return any(symbol.name in moving for symbol in expr.free_symbols)


def _is_even_root(exponent: sp.Expr) -> bool:
    """Whether a power has no value where its base is below zero, but a series may have one."""
    return sp.Rational(exponent).q % 2 == 0


def _unless_whole(base: sp.Expr, exponent: sp.Expr, moving: set[str]) -> sp.Expr:
    """The base of a power, but one if the exponent, known at run time, is a whole number."""
    if _moves(exponent, moving):
        return base
    broken = sp.sign(exponent - sp.floor(exponent))
    return broken * base + 1 - broken


def _may_end(term: sp.Expr, root: sp.Pow, moving: set[str]) -> bool:
    """Whether a root may vanish with a finite term around it that its other sign would change.

    That of what may be negative always may; that of a sum of squares only touches zero, and not
    where one of them does not change.
    """
    base = root.base
    if not base.is_nonnegative:
        return True
    if base.is_positive or root.exp < -sp.S.Half:
        return False
    if base.is_Add and not all(_moves(square, moving) for square in base.args):
        return False
    return changes_with_sign(term, base)


def changes_with_sign(term: sp.Expr, base: sp.Expr) -> bool:
    """Whether a term is another one when the square root of a part of it changes its sign.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> radius = sp.sqrt(x**2 + y**2)
    >>> [changes_with_sign(term, x**2 + y**2) for term in (x / radius, sp.cos(radius))]
    [True, False]
    """
    positive = sp.Dummy(positive=True)

    def with_root(value: sp.Expr) -> sp.Expr:
        return term.replace(
            lambda x: isinstance(x, sp.Pow) and x.base == base, lambda x: value ** (2 * x.exp)
        )

    return with_root(positive) != with_root(-positive)
