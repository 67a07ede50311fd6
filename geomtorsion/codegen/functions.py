"""Functions: what the functions of sympy are called where code runs."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Names:
    """Names of one function; empty where it does not exist.

    math: in generated source; of the math module, but for power, sign and what scipy brings.
    numpy: of numpy, or of scipy.special.
    mpmath: of mpmath.
    heyoka: of heyoka.
    roundings: to how many of them NumPy and SciPy are right.
    """

    math: str
    numpy: str
    mpmath: str
    heyoka: str = ""
    roundings: int = 4


def _plain(name: str, numpy: str = "") -> Names:
    """A function that everybody has."""
    return Names(name, numpy or name, name, name)


# By the names of sympy's classes.
FUNCTIONS = {
    **{name: _plain(name) for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log")},
    **{name: _plain(name, "arc" + name[1:]) for name in ("asin", "acos", "atan", "asinh", "acosh",
                                                         "atanh", "atan2")},
    "Abs": Names("fabs", "abs", "fabs"),
    "sign": Names("sign", "sign", "sign"),
    "floor": Names("floor", "floor", "floor"),
    "ceiling": Names("ceil", "ceil", "ceil"),
    "Max": Names("max", "maximum", "max"),
    "Min": Names("min", "minimum", "min"),
    "erf": Names("erf", "erf", "erf", roundings=16),
    "erfc": Names("erfc", "erfc", "erfc", roundings=16),
    "erfi": Names("erfi", "erfi", "erfi", roundings=16),
    "gamma": Names("gamma", "gamma", "gamma", roundings=16),
    "loggamma": Names("lgamma", "gammaln", "loggamma", roundings=16),
    "besselj": Names("jv", "jv", "besselj", roundings=16),
    "bessely": Names("yv", "yv", "bessely", roundings=16),
    "besseli": Names("iv", "iv", "besseli", roundings=16),
    "besselk": Names("kv", "kv", "besselk", roundings=16),
    "Ei": Names("expi", "expi", "ei", roundings=16),
}  # fmt: skip
