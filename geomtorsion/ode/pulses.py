"""Pulses: times around narrow changes of the rates, over which a step would pass."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
import sympy as sp

from geomtorsion.ode.numbers import PARTS, Real
from geomtorsion.ode.pieces import term_graph
from geomtorsion.ode.rates import Rates
from geomtorsion.support.precision import EPS

# They change only where their arguments are about one, or change by about one.
BENT = {"exp", "sinh", "cosh", "tanh", "erf", "erfc", "atan"}


def pulses(rates: Rates, parameters: Mapping[str, Real], end: float) -> tuple[float, ...]:
    """Times up to an end around each narrow pulse that depends only on the time, in order.

    A pulse is where the argument of a function, or a denominator, is smallest; from its width on,
    each second time is twice as far from it.

    Examples
    --------
    >>> from geomtorsion.ode import ODE
    >>> kick = ODE.of({"x": "exp(-((t - 5)*1e4)**2)"}, [0])
    >>> times = pulses(kick.rates, {}, 10.0)
    >>> 5.0 in times, max(abs(t - 5) for t in times) > 0.1
    (True, True)
    """
    terms = list(_arguments(rates))
    if not terms or not end:
        return ()
    values = term_graph((rates.time, *rates.parameters), terms).numpy()
    numbers = [float(parameters[name]) for name in rates.parameters]

    def sizes(times: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            return np.array([np.broadcast_to(x, times.shape) for x in values(times, *numbers)])

    # Eight samples in each of the longest steps of the finer run, which sees all wider pulses.
    grid = np.linspace(0.0, end, 8 * PARTS + 1)
    marks: set[float] = set()
    for k, row in enumerate(sizes(grid)):
        beside = np.concatenate((row[1:2], row, row[-2:-1]))
        around = np.maximum(beside[:-2], beside[2:])
        lowest = (row <= beside[:-2]) & (row <= beside[2:]) & (2 * row < around)
        for place in np.flatnonzero(lowest).tolist():
            low, high = grid[max(place - 1, 0)], grid[min(place + 1, len(grid) - 1)]
            while True:
                times = np.linspace(low, high, 9)
                near = sizes(times)[k]
                best = int(near.argmin())
                if 2 * near[best] > near.max() or abs(high - low) < 64 * EPS * abs(end):
                    break
                low, high = times[max(best - 1, 0)], times[min(best + 1, 8)]
            if not 2 * near[best] > near.max():
                # A pole, which ends the motion.
                continue
            width, top = abs(float(high - low)) / 2, float(times[best])
            count = 2 * math.ceil(math.log2(abs(end) / (PARTS * width))) + 2
            apart = (s * width * 2.0 ** (j / 2) for j in range(count) for s in (-1, 1))
            marks |= {top, *(top + x for x in apart)}
    return tuple(sorted((t for t in marks if 0 < t / end < 1), key=abs))


def _arguments(rates: Rates) -> Iterator[sp.Expr]:
    """Positive quantities of the time and the parameters that are small only at a pulse."""
    names = {rates.time, *rates.parameters}
    parts = {part for rate in rates.expressions.values() for part in sp.preorder_traversal(rate)}
    for part in sorted(parts, key=sp.default_sort_key):
        inside = part.args[0] if part.args else sp.S.Zero
        symbols = {symbol.name for symbol in inside.free_symbols}
        if rates.time not in symbols or not symbols <= names:
            continue
        if type(part).__name__ in BENT:
            yield sp.sqrt(1 + inside**2)
        elif isinstance(part, sp.Pow) and part.exp.is_negative and not _is_bent(inside):
            yield sp.sqrt(inside**2)


def _is_bent(expr: sp.Expr) -> bool:
    """Whether a function in an expression makes pulses of its own."""
    return any(type(part).__name__ in BENT for part in sp.preorder_traversal(expr))
