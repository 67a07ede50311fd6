"""MathML: expressions for a browser, in MathML Core, which needs no script and no network."""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape
from typing import Any

import sympy
from sympy.core.function import AppliedUndef

from geomtorsion.pictures.text import greek_name, ordered_terms

_TIMES = "<mo>&#x2062;</mo>"
_MINUS = "<mo>−</mo>"
_APPLY = "<mo>&#x2061;</mo>"
_THIN = '<mspace width="0.17em"/>'
_TALL = ("<mfrac", "<mroot", "<mtable")
_SUBSCRIPTED = re.compile(r"(\D+?)_?([0-9]+)")
_MOST_PRIMES = 3
_SUM, _PRODUCT, _ATOM = 1, 2, 3


def mathml(expression: Any) -> str:
    """Presentation markup of an expression, without the surrounding math element.

    Examples
    --------
    >>> r = sympy.Symbol("r")
    >>> mathml(1 / r**2)
    '<mfrac><mn>1</mn><msup><mi>r</mi><mn>2</mn></msup></mfrac>'
    >>> mathml(1 - r)
    '<mrow><mn>1</mn><mo>−</mo><mi>r</mi></mrow>'
    """
    return _written(sympy.sympify(expression))[0]


def identifier(name: str) -> str:
    """Markup of a name: Greek letters, a trailing number or what follows _ as subscript.

    Examples
    --------
    >>> identifier("phi1")
    '<msub><mi>φ</mi><mn>1</mn></msub>'
    """
    head, mark, tail = name.partition("_")
    if mark and head and tail:
        kind = "mn" if tail.isdigit() else "mi"
        return f"<msub>{identifier(head)}<{kind}>{escape(greek_name(tail))}</{kind}></msub>"
    match = _SUBSCRIPTED.fullmatch(name)
    if match:
        return f"<msub>{identifier(match[1])}<mn>{match[2]}</mn></msub>"
    return f"<mi>{escape(greek_name(name))}</mi>"


def row(*parts: str) -> str:
    """Parts side by side as one."""
    return parts[0] if len(parts) == 1 else f"<mrow>{''.join(parts)}</mrow>"


def bracketed(inner: str) -> str:
    """Markup in round brackets, which grow only with what is tall."""
    # Browsers set more space beside a bracket that may grow, even where it does not.
    mark = "<mo>" if any(tall in inner for tall in _TALL) else '<mo stretchy="false">'
    return f"<mrow>{mark}(</mo>{inner}{mark})</mo></mrow>"


def _written(expr: Any) -> tuple[str, int]:
    """Markup of an expression and how tightly it binds."""
    if expr.is_Add:
        return _sum(expr), _SUM
    if expr.is_Mul or (expr.is_Rational and not expr.is_Integer):
        return _product(expr)
    if expr.is_Pow:
        return _power(expr)
    if expr.is_Integer:
        if expr < 0:
            return row(_MINUS, f"<mn>{-expr}</mn>"), _SUM
        return f"<mn>{expr}</mn>", _ATOM
    if expr.is_Symbol:
        return identifier(expr.name), _ATOM
    if isinstance(expr, sympy.exp):
        return f"<msup><mi>e</mi>{_inside(expr.args[0])}</msup>", _PRODUCT
    if isinstance(expr, sympy.Derivative):
        return _derivative(expr)
    if isinstance(expr, sympy.Function):
        return _function(expr, ""), _PRODUCT
    constants = {sympy.pi: "π", sympy.E: "e", sympy.I: "i", sympy.oo: "∞"}
    return f"<mi>{constants.get(expr, escape(str(expr)))}</mi>", _ATOM


def _inside(expr: Any, at_least: int = 0) -> str:
    """Markup of an expression, in brackets unless it binds tightly enough."""
    inner, binding = _written(expr)
    return inner if binding >= at_least else bracketed(inner)


def _sum(expr: Any) -> str:
    pieces: list[str] = []
    for number, term in enumerate(ordered_terms(expr)):
        minus = term.could_extract_minus_sign()
        if minus:
            pieces.append(_MINUS)
        elif number:
            pieces.append("<mo>+</mo>")
        pieces.append(_inside(-term if minus else term, _PRODUCT))
    return row(*pieces)


def _product(expr: Any) -> tuple[str, int]:
    coefficient, rest = expr.as_coeff_Mul()
    if not coefficient.is_Rational:
        coefficient, rest = sympy.S.One, expr
    above: list[Any] = []
    below: list[Any] = []
    for factor in sympy.Mul.make_args(rest) if rest != 1 else ():
        base, exponent = (1, 1) if isinstance(factor, sympy.exp) else factor.as_base_exp()
        if exponent != 1 and exponent.is_number and exponent.is_negative:
            below.append(base**-exponent)
        else:
            above.append(factor)
    p, q = abs(coefficient.p), coefficient.q
    inner = _factors(p, _arranged(above))
    if below or q != 1:
        inner = f"<mfrac>{inner}{_factors(q, _arranged(below))}</mfrac>"
    if coefficient < 0:
        return row(_MINUS, inner), _SUM
    return inner, _PRODUCT


def _arranged(factors: Sequence[Any]) -> list[Any]:
    """Factors as a person orders them: names, roots and powers, sums, functions last."""

    def rank(factor: Any) -> tuple[int, str]:
        base = factor.as_base_exp()[0]
        if isinstance(base, AppliedUndef | sympy.Derivative):
            return 3, ""
        if isinstance(factor, sympy.exp) or base == sympy.E:
            return 4, ""
        if isinstance(base, sympy.Function):
            return 5, ""
        if base.is_Symbol:
            return 1, base.name
        return 2 if base.is_Add else int(not base.is_number), ""

    return sorted(factors, key=rank)


def _factors(number: int, factors: Sequence[Any]) -> str:
    """Markup of a product of a positive integer and factors; a single one needs no brackets."""
    if number == 1 and len(factors) == 1:
        return _inside(factors[0])
    parts = [f"<mn>{number}</mn>"] if number != 1 or not factors else []
    for factor in factors:
        if parts:
            named = isinstance(factor.as_base_exp()[0], sympy.Function)
            parts.append(_TIMES + _THIN if named else _TIMES)
        parts.append(_inside(factor, _PRODUCT))
    return row(*parts)


def _power(expr: Any) -> tuple[str, int]:
    base, exponent = expr.args
    if exponent.is_number and exponent.is_negative:
        return f"<mfrac><mn>1</mn>{_inside(base**-exponent)}</mfrac>", _PRODUCT
    if exponent.is_Rational and exponent.q != 1:
        inner = _inside(base if exponent.p == 1 else base**exponent.p)
        if exponent.q == 2:
            return f"<msqrt>{inner}</msqrt>", _ATOM
        return f"<mroot>{row(inner)}<mn>{exponent.q}</mn></mroot>", _ATOM
    if base == sympy.E:
        return f"<msup><mi>e</mi>{_inside(exponent)}</msup>", _PRODUCT
    written = _inside(exponent)
    if isinstance(base, sympy.Function) and not isinstance(base, sympy.exp | AppliedUndef):
        return _function(base, written), _PRODUCT
    if isinstance(base, AppliedUndef | sympy.Derivative):
        return f"<msup>{_inside(base)}{written}</msup>", _ATOM
    return f"<msup>{_inside(base, _ATOM)}{written}</msup>", _ATOM


def _function(expr: Any, power: str) -> str:
    """A function and its arguments; the power of a named one stands at the name."""
    names = {"log": "ln", "asin": "arcsin", "acos": "arccos", "atan": "arctan"}
    name = expr.func.__name__
    unknown = isinstance(expr, AppliedUndef)
    head = identifier(name) if unknown else f"<mi>{names.get(name, name)}</mi>"
    if power:
        head = f"<msup>{head}{power}</msup>"
    simple = len(expr.args) == 1 and (expr.args[0].is_Symbol or expr.args[0].is_Integer)
    if simple and not unknown:
        return row(head, _APPLY, _THIN, _inside(expr.args[0], _ATOM))
    inner = "<mo>,</mo>".join(_inside(argument) for argument in expr.args)
    return row(head, _APPLY, bracketed(inner))


def _derivative(expr: Any) -> tuple[str, int]:
    function = expr.expr
    if not isinstance(function, AppliedUndef):
        return f"<mtext>{escape(str(expr))}</mtext>", _ATOM
    name = identifier(function.func.__name__)
    if len(function.args) == 1:
        count = int(expr.derivative_count)
        if count <= _MOST_PRIMES:
            head = row(name, f'<mo lspace="0" rspace="0">{"′" * count}</mo>')
        else:
            head = f"<msup>{name}{bracketed(f'<mn>{count}</mn>')}</msup>"
    else:
        by = [_inside(v) for v, count in expr.variable_count for _ in range(int(count))]
        head = f'<msub><mo rspace="0">∂</mo>{row(*by)}</msub>{name}'
    inner = "<mo>,</mo>".join(_inside(argument) for argument in function.args)
    return row(head, _APPLY, bracketed(inner)), _PRODUCT
