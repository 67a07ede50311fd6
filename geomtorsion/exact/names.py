"""Names: the functions and constants that an expression from outside may use."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from types import MappingProxyType
from typing import Any

import sympy

_ONE = (1,)
_CIRCLE = "sin cos tan cot sec csc asin acos atan acot"
_HYPERBOLA = "sinh cosh tanh coth sech csch asinh acosh atanh exp"

FUNCTIONS: MappingProxyType[str, tuple[Any, tuple[int, ...]]] = MappingProxyType(
    {name: (getattr(sympy, name), _ONE) for name in f"{_CIRCLE} {_HYPERBOLA}".split()}
    | {
        "sqrt": (sympy.sqrt, _ONE),
        "cbrt": (sympy.cbrt, _ONE),
        "log": (sympy.log, (1, 2)),
        "ln": (sympy.log, _ONE),
        "atan2": (sympy.atan2, (2,)),
        "arcsin": (sympy.asin, _ONE),
        "arccos": (sympy.acos, _ONE),
        "arctan": (sympy.atan, _ONE),
    }
)
CONSTANTS = MappingProxyType({"pi": sympy.pi, "π": sympy.pi, "E": sympy.E, "I": sympy.I})
DERIVATIVE_NAMES = frozenset({"diff", "Derivative"})

_SIGN = "Give the symbol a sign among the parameters (positive, negative) and write it without."
_SQUARE = "Write sqrt(x**2) with x positive, or the branch you mean."
NOT_SMOOTH: MappingProxyType[str, str] = MappingProxyType(
    dict.fromkeys(("Abs", "abs"), _SQUARE)
    | dict.fromkeys(("sign", "Max", "Min", "max", "min"), _SIGN)
    | dict.fromkeys(
        ("floor", "ceiling", "round", "Piecewise", "Heaviside", "DiracDelta", "Mod"),
        "Write the smooth expression of one region, and name the region as the domain.",
    )
)

_GREEK: dict[str, str] = dict(
    zip(
        "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho "
        "sigma tau upsilon phi chi psi omega".split(),
        "αβγδεζηθικλμνξοπρστυφχψω",
        strict=True,
    )
)


def near_names(name: str, known: Iterable[str]) -> str:
    """Return the known name that was probably meant, or an empty text.

    Examples
    --------
    >>> near_names("thetta", ["r", "theta", "phi"])
    'theta'
    >>> near_names("θ", ["r", "theta", "phi"])
    'theta'
    >>> near_names("banana", ["r", "theta", "phi"])
    ''
    """
    known = list(known)
    for candidate in known:
        if candidate.lower() == name.lower():
            return candidate
        if _GREEK.get(candidate) == name or _GREEK.get(name) == candidate:
            return candidate
    return next(iter(get_close_matches(name, known, n=1, cutoff=0.65)), "")
