"""Names: the functions and constants that an expression from outside may use."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any

import sympy

_ONE = (1,)
_CIRCLE = "sin cos tan cot sec csc asin acos atan acot asec acsc"
_HYPERBOLA = "sinh cosh tanh coth sech csch asinh acosh atanh acoth asech acsch exp"

FUNCTIONS: MappingProxyType[str, tuple[Any, tuple[int, ...]]] = MappingProxyType(
    {name: (getattr(sympy, name), _ONE) for name in f"{_CIRCLE} {_HYPERBOLA}".split()}
    | {
        "sqrt": (sympy.sqrt, _ONE),
        "cbrt": (sympy.cbrt, _ONE),
        "log": (sympy.log, (1, 2)),
        "ln": (sympy.log, _ONE),
        "atan2": (sympy.atan2, (2,)),
        "abs": (sympy.Abs, _ONE),
        "Abs": (sympy.Abs, _ONE),
        "arcsin": (sympy.asin, _ONE),
        "arccos": (sympy.acos, _ONE),
        "arctan": (sympy.atan, _ONE),
    }
)
# Special functions, by the names that sympy has for them.
SPECIAL: MappingProxyType[str, tuple[Any, tuple[int, ...]]] = MappingProxyType(
    {
        name: (getattr(sympy, name), _ONE)
        for name in "erf erfc erfi loggamma digamma airyai airybi airyaiprime airybiprime".split()
    }
    | {
        name: (getattr(sympy, name), (2,))
        for name in "besselj bessely besseli besselk polygamma expint uppergamma lowergamma".split()
    }
    | {"LambertW": (sympy.LambertW, (1, 2))}
)
# Also names of what users call so: special functions where all of theirs are declared.
SPECIAL_IF_DECLARED: MappingProxyType[str, tuple[Any, tuple[int, ...]]] = MappingProxyType(
    {name: (getattr(sympy, name), _ONE) for name in "gamma factorial Ei li Si Ci Shi Chi".split()}
    | {"beta": (sympy.beta, (2,))}
)
CONSTANTS = MappingProxyType({"pi": sympy.pi, "π": sympy.pi, "E": sympy.E, "I": sympy.I})
DERIVATIVE_NAMES = frozenset({"diff", "Derivative"})
# Subs(Derivative(f(xi_1), xi_1), xi_1, 2*r), as sympy writes the slope of f at 2*r.
SUBSTITUTION_NAME = "Subs"

_SIGN = "Give the symbol a sign among the parameters (positive, negative) and write it without."
NOT_SMOOTH: MappingProxyType[str, str] = MappingProxyType(
    dict.fromkeys(("sign", "Max", "Min", "max", "min"), _SIGN)
    | dict.fromkeys(
        ("floor", "ceiling", "round", "Piecewise", "Heaviside", "DiracDelta", "Mod"),
        "Write the smooth expression of one region, and name the region as the domain. In gt.ODE.of"
        " write pieces(x, a, 1, b) for a below x = 1 and b above.",
    )
)
