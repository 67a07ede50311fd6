"""Uniqueness: starts that a motion may leave at any time, such as x = 0 of x' = sqrt(x)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import sympy as sp

from geomtorsion.ode.numbers import Real
from geomtorsion.ode.pieces import term_graph
from geomtorsion.ode.rates import Rates
from geomtorsion.support.precision import EPS


def undecided_root(
    rates: Rates, start: Sequence[Real], parameters: Mapping[str, Real]
) -> sp.Expr | None:
    """A root in the rates with which more than one motion leaves the start; None without one.

    Its base is zero and remains so, and the growth rate of a small change of it has no bound
    (the condition of Lipschitz fails).

    Examples
    --------
    >>> from geomtorsion.ode import ODE
    >>> [undecided_root(ODE.of({"x": rate}, [1]).rates, [0], {})
    ...  for rate in ("sqrt(x)", "1 + sqrt(x)", "-sqrt(x)")]
    [sqrt(x), None, None]
    """
    roots = list(_roots(rates))
    if not roots:
        return None
    names = [*rates.states, *rates.parameters, rates.time]
    symbols = [sp.Symbol(name, real=True) for name in rates.states]
    count = len(symbols)
    own = {x.name: x for rate in rates.expressions.values() for x in rate.free_symbols}
    by = [own.get(x.name, x) for x in symbols]
    slopes = term_graph(names, [f.diff(x) for f in rates.expressions.values() for x in by])
    speeds = term_graph(names, list(rates.expressions.values())).numpy()
    here = np.array([*map(float, start), *(float(parameters[x]) for x in rates.parameters), 0.0])
    for root in roots:
        time = own.get(rates.time, sp.Symbol(rates.time))
        terms = [root.base, *(root.base.diff(x) for x in (*by, time))]
        with np.errstate(all="ignore"):
            base, *slope = np.array(term_graph(names, terms).numpy()(*here), dtype=float)
            change = np.dot(slope[:-1], np.array(speeds(*here), dtype=float)) + slope[-1]
            if base != 0 or change != 0 or not np.any(slope[:-1]):
                continue
            growth = []
            for step in (EPS**0.5, EPS):
                moved = here.copy()
                moved[:count] += step * np.sign(slope[:-1])
                matrix = np.array(slopes.numpy()(*moved), dtype=float).reshape(count, count)
                finite = np.isfinite(matrix).all()
                growth.append(np.linalg.eigvals(matrix).real.max() if finite else np.nan)
        # The growth rate of a power p is at least step**((p - 1)/count).
        if growth[1] > 2 * max(growth[0], 0.0) > 0:
            return root
    return None


def _roots(rates: Rates) -> Iterator[sp.Pow]:
    """Powers between 0 and 1 whose base depends on a state."""
    states = set(rates.states)
    for part in sorted(sp.Tuple(*rates.expressions.values()).atoms(sp.Pow), key=str):
        number = part.exp.is_Rational or isinstance(part.exp, sp.Float)
        if number and 0 < part.exp < 1 and states & {x.name for x in part.base.free_symbols}:
            yield part
