"""Special functions: arrays of numbers, by Arb where SciPy has none, and slopes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np
import sympy
from flint import acb, arb

from geomtorsion.errors import ExpressionError
from geomtorsion.exact.special_values import VALUES
from geomtorsion.support.precision import ball_precision

# Functions of scipy.special that are right to a few double roundings for all arguments.
_OF_SCIPY = {
    "besselj": "jv", "bessely": "yv", "besseli": "iv", "besselk": "kv", "erf": "erf",
    "erfc": "erfc", "erfi": "erfi", "gamma": "gamma", "beta": "beta", "Ei": "expi",
}  # fmt: skip
# More bits than any number type of NumPy has.
_BITS = 128


def of_arrays(name: str) -> Callable[..., np.ndarray]:
    """A function of arrays of one type; not a number where real arguments have no real value.

    Examples
    --------
    >>> of_arrays("LambertW")(np.array([0.0, np.e, -1.0]))
    array([ 0.,  1., nan])
    """
    return partial(_values, name)


def of_floats(name: str) -> Callable[..., float]:
    """A function of floats; a ValueError where it has no value."""

    def value(*arguments: float) -> float:
        result = float(_values(name, *arguments))
        if not np.isfinite(result):
            raise ValueError(f"{name} has no value at {arguments}")
        return result

    return value


def _values(name: str, *arguments: Any) -> np.ndarray:
    arrays = np.broadcast_arrays(*arguments)
    kind = np.result_type(*arrays, float)
    if name in _OF_SCIPY and kind in (np.float64, np.complex128):
        # Few expressions need it, and loading scipy.special costs more than everything else here.
        return getattr(import_module("scipy.special"), _OF_SCIPY[name])(*arrays)
    result = np.empty(arrays[0].shape, dtype=kind)
    is_real = not np.issubdtype(kind, np.complexfloating)
    with ball_precision(_BITS):
        for place in np.ndindex(result.shape):
            values = [array[place] for array in arrays]
            result[place] = _value(name, values, result.dtype.type, is_real=is_real)
    return result[()]


def _value(name: str, values: Sequence[Any], kind: Callable[..., Any], *, is_real: bool) -> Any:
    """One value by Arb."""
    if not all(np.isfinite(value) for value in values):
        return np.nan
    ball = VALUES[name](*(acb(_exact(value.real), _exact(value.imag)) for value in values))
    if not ball.is_finite() or (is_real and not ball.imag.is_zero()):
        return np.nan
    return _rounded(ball.real) if is_real else kind(complex(ball))


def _exact(value: Any) -> arb:
    """A float, also one of more than double precision."""
    high = float(value)
    return arb(high) + float(value - high)


def _rounded(value: arb) -> np.longdouble:
    """A ball's midpoint in the longest floats that NumPy has."""
    high = float(value)
    return np.longdouble(high) + np.longdouble(float(value - high))


def slope(name: str, values: Sequence[sympy.Expr], place: int) -> sympy.Expr:
    """The derivative of a function with respect to one of its arguments.

    Examples
    --------
    >>> x = sympy.Symbol("x")
    >>> slope("besselj", [sympy.Integer(0), x], 1)
    -besselj(1, x)
    """
    if name == "LambertW":
        # W/(z (1 + W)) has no value at z = 0.
        own = sympy.LambertW(*values)
        return sympy.exp(-own) / (1 + own)
    marked = [sympy.Dummy() if k == place else value for k, value in enumerate(values)]
    derivative = getattr(sympy, name)(*marked).diff(marked[place])
    if derivative.has(sympy.Derivative, sympy.Subs):
        raise ExpressionError(
            f"expected a derivative of {name} in closed form, got none by its argument "
            f"{place + 1}. Keep that argument constant."
        )
    return derivative.subs(marked[place], values[place])
