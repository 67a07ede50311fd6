"""Reference: Burgers vectors to fifty digits by mpmath, by none of the routes of the package."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import mpmath
import sympy as sp
from mpmath.libmp import prec_to_dps

from geomtorsion.loops.arcs import exact_number
from geomtorsion.loops.exact_integral import pieces, pulled_back
from geomtorsion.support import checks
from geomtorsion.support.precision import CONSTANT_BITS, working_digits

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.loops import Loop

# Some fifty: the digits of a double, and those lost by cancellation.
DIGITS = prec_to_dps(CONSTANT_BITS)


def reference(
    frame: Frame, loop: Loop, parameters: Mapping[Any, Any] | None = None
) -> tuple[Any, ...]:
    """b^i to about 50 digits, by mpmath from the exact coframe: slow and independent.

    Raises
    ------
    LoopError
        The loop is only known numerically.
    """
    given = checks.by_name(parameters, "parameters")
    values = {name: exact_number(value) for name, value in given.items()}
    table = {symbol: values[symbol.name] for symbol in frame.field.symbols if symbol.name in values}
    table |= {symbol: values[symbol.name] for symbol in loop.symbols if symbol.name in values}
    total = [mpmath.mpf(0)] * frame.dimension
    digits = _digits(loop)
    with working_digits(digits):
        for times, piece in pieces(loop):
            _, t, low, high = piece
            bounds = [mpmath.mpmathify(x.subs(table).evalf(digits + 10)) for x in (low, high)]
            for i, f in enumerate(pulled_back(frame, piece)):
                if f != 0:
                    function = sp.lambdify(t, f.subs(table), "mpmath")
                    total[i] += times * mpmath.quad(function, mpmath.linspace(*bounds, 5))
        return tuple(total)


def _digits(loop: Loop) -> int:
    """With how many digits a loop is integrated."""
    # A loop of size 1e-12 cancels 24 digits.
    return DIGITS + int(2 * max(0, -mpmath.log10(loop.size)))
