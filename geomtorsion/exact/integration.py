"""Integration: integrals that sympy finds, in a process that can be ended.

An integral may take sympy any time, and nothing ends it but the end of its process. This file is
also the script of that process: its requests are lines of JSON, with expressions as text, which
the reader of all expressions reads.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import IO, Any

import sympy as sp
from sympy.core.function import AppliedUndef

from geomtorsion.errors import GeomtorsionError
from geomtorsion.exact import parse_expression
from geomtorsion.exact.other_process import OtherProcess
from geomtorsion.exact.tokens import Limits

# What sympy finds may be longer than what a person writes.
_LIMITS = replace(Limits(), depth=200, exponent=10_000, digits=20_000)
# Functions of integrals that no entry of a frame may have.
_FOUND: Mapping[str, Any] = {
    name: getattr(sp, name)
    for name in (
        "Abs sign gamma factorial Ei li Si Ci Shi Chi beta fresnels fresnelc elliptic_e elliptic_f "
        "elliptic_k elliptic_pi erf erfc erfi expint besselj bessely besseli besselk polylog zeta"
    ).split()
}


def antiderivative(f: sp.Expr, t: sp.Symbol) -> sp.Expr | None:
    """An integral of f over t, also with unknown functions; None where no method finds one.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> F = sp.Function("F")(x, y)
    >>> antiderivative(2 * F * F.diff(x) + y, x)
    x*y + F(x, y)**2
    """
    total: sp.Expr = sp.S.Zero
    # What multiplies the highest derivative is integrated over the one below it.
    while slopes := [d for d in f.atoms(sp.Derivative) if t in d.variables]:
        highest = max(slopes, key=lambda d: (d.variables.count(t), len(d.variables), str(d)))
        others = list(highest.variables)
        others.remove(t)
        below = highest.expr.diff(*others) if others else highest.expr
        jets = sorted(f.atoms(sp.Derivative, AppliedUndef) | {below}, key=str)
        names = {jet: sp.Dummy(f"j{k}") for k, jet in enumerate(jets)}
        factor = sp.diff(f.xreplace(names), names[highest])
        if factor.has(names[highest]):
            return None
        part = _primitive(factor, names[below])
        if part is None:
            return None
        part = part.xreplace({name: jet for jet, name in names.items()})
        total, f = total + part, sp.cancel(f - part.diff(t))
        if f.has(highest):
            return None
    unknown = f.atoms(AppliedUndef) | f.atoms(sp.Derivative)
    if any(t in jet.free_symbols for jet in unknown):
        return None
    names = {jet: sp.Dummy(f"j{k}") for k, jet in enumerate(sorted(unknown, key=str))}
    rest = _primitive(f.xreplace(names), t)
    return None if rest is None else total + rest.xreplace({x: jet for jet, x in names.items()})


def _primitive(f: sp.Expr, t: sp.Symbol) -> sp.Expr | None:
    """An integral over t of an expression without unknown functions."""
    if not f.has(t):
        return f * t
    return sp.integrate(f, t) if f.is_polynomial(t) else integrated(f, t)


def integrated(f: sp.Expr, t: sp.Symbol, *ends: sp.Expr) -> sp.Expr | None:
    """The integral of f over t that sympy finds, from the other process; None where it finds none.

    ends: from where to where; without them the integral is indefinite. None also for an expression
    that is not in our syntax, such as one with unknown functions.
    """
    expressions = (f, *ends)
    if any(x.has(AppliedUndef) for x in expressions):
        return None
    # Letters of any kind are names of symbols, and not all are read back.
    symbols = sorted(set().union(*(x.free_symbols for x in expressions)) | {t}, key=str)
    renamed = {x: sp.Symbol(f"v{k}", **x.assumptions0) for k, x in enumerate(symbols)}
    parts = [str(x.xreplace(renamed)) for x in expressions]
    declared = {new.name: _declared(new) for new in renamed.values()}
    request = {"parts": parts, "variable": renamed[t].name, "symbols": declared}
    answer = _PROCESS.ask(json.dumps(request)).strip()
    if not answer:
        return None
    try:
        integral = _read(answer, {new.name: new for new in renamed.values()})
    except GeomtorsionError:
        return None
    return integral.xreplace({new: old for old, new in renamed.items()})


def _declared(symbol: sp.Symbol) -> dict[str, bool]:
    """The assumptions of a symbol."""
    return {key: bool(value) for key, value in symbol.assumptions0.items() if value is not None}


def _read(text: str, symbols: Mapping[str, sp.Symbol]) -> sp.Expr:
    return parse_expression(text, symbols, _FOUND, where="integral", limits=_LIMITS)


def answer(parts: Sequence[str], variable: str, symbols: Mapping[str, Mapping[str, bool]]) -> str:
    """The integral as text, or nothing."""
    table = {name: sp.Symbol(name, **assumptions) for name, assumptions in symbols.items()}
    f, *ends = (_read(part, table) for part in parts)
    integral = sp.integrate(f, (table[variable], *ends))
    return "" if integral.has(sp.Integral, sp.nan, sp.zoo, sp.Piecewise) else str(integral)


def serve(requests: IO[str], replies: IO[str]) -> None:
    """Answer each request with a line."""
    for line in requests:
        try:
            text = answer(**json.loads(line))
        # Whatever sympy raises: there is no closed form then.
        except Exception:  # noqa: BLE001
            text = ""
        # A blank distinguishes an answer without an integral from a process that has ended.
        replies.write(f"{text} \n")
        replies.flush()


_PROCESS = OtherProcess(__file__)

if __name__ == "__main__":
    serve(sys.stdin, sys.stdout)
