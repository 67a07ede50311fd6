"""Integration process: a script in which sympy integrates; its requests are lines of JSON.

An integral may take sympy any time, and nothing ends it but the end of its process. Expressions
are sent as text, which the reader of all expressions reads.
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


def integrated(f: sp.Expr, t: sp.Symbol, low: sp.Expr, high: sp.Expr) -> sp.Expr | None:
    """The integral of f over t that sympy finds, from the other process; None where it finds none.

    None also for an expression that is not in our syntax, such as one with unknown functions.
    """
    expressions = (f, low, high)
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
    f, low, high = (_read(part, table) for part in parts)
    integral = sp.integrate(f, (table[variable], low, high))
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
