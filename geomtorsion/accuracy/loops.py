"""Loops: cost of accuracy for closed paths, rules x number of points -> error and time."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

import mpmath
import numpy as np
import scipy  # loads its parts on first use
import sympy as sp
from mpmath.libmp import prec_to_dps

from geomtorsion import checks
from geomtorsion.accuracy.cost import ACCURACIES, LONG_ENOUGH
from geomtorsion.displays import Plot, figure_by
from geomtorsion.errors import LoopError
from geomtorsion.loops import burgers_vector, forms, integrals
from geomtorsion.loops.arcs import exact_number
from geomtorsion.loops.exact_integral import pieces, pulled_back
from geomtorsion.loops.integrals import flux_at, line_at
from geomtorsion.outgoing import size_text
from geomtorsion.precision import CONSTANT_BITS, working_digits

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.loops import Loop

POINTS = (4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128)
RULES = ("trapezoid", "Gauss", "Clenshaw-Curtis", "scipy.quad", "flux", "burgers_vector")
# Points on a ray from the centre, as the flux rule takes them at first.
RAYS = integrals.RAYS[0][1]
# Some fifty: the digits of a double, and those lost by cancellation.
DIGITS = prec_to_dps(CONSTANT_BITS)
Nodes = Callable[[int], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class LoopCost:
    """One rule with one number of points.

    rule: its name; points: evaluations of the coframe (of its curl, for the flux).
    error: measured relative error of the largest component; seconds: best wall time.
    asked: requested accuracy, where the rule is adaptive.
    claimed: the error that the rule itself states, relative; None where it states none.
    """

    rule: str
    points: int
    error: float
    seconds: float
    asked: float | None = None
    claimed: float | None = None


@dataclass(frozen=True)
class LoopCosts:
    """Cost of accuracy on one loop.

    name: which loop in which frame; rows: rule by rule, points rising.
    reference: b^i to 50 digits, as mpmath numbers.
    """

    name: str
    rows: tuple[LoopCost, ...]
    reference: tuple[Any, ...]

    def cheapest(self, accuracy: float) -> LoopCost | None:
        """The fastest row that reached a relative error, or None.

        Examples
        --------
        >>> rows = (LoopCost("a", 8, 1e-3, 1e-4), LoopCost("b", 16, 1e-13, 2e-4))
        >>> LoopCosts("", rows, ()).cheapest(1e-10).rule
        'b'
        """
        good = [row for row in self.rows if row.error <= accuracy]
        return min(good, key=lambda row: row.seconds, default=None)

    plot: ClassVar[Plot] = figure_by("costs", "draw_loop_costs")

    def __str__(self) -> str:
        head = f"{'rule':16}{'points':>8}{'asked':>9}{'error':>10}{'claimed':>10}{'time':>11}"
        lines = [self.name, head]
        for row in self.rows:
            asked = "" if row.asked is None else f"{row.asked:.0e}"
            claimed = "" if row.claimed is None else size_text(row.claimed)
            lines.append(
                f"{row.rule:16}{row.points:8}{asked:>9}{size_text(row.error):>10}{claimed:>10}"
                f"{row.seconds * 1e3:8.3f} ms"
            )
        return "\n".join(lines)


def loop_costs(
    frame: Frame,
    loop: Loop,
    *,
    parameters: Mapping[Any, Any] | None = None,
    rules: Sequence[str] = RULES,
    points: Sequence[int] = POINTS,
) -> LoopCosts:
    """Measure error and time of quadrature rules on one loop, against 50 digits.

    Parameters
    ----------
    rules
        Some of trapezoid, Gauss, Clenshaw-Curtis (fixed points on every side), scipy.quad and
        burgers_vector (adaptive, at tolerances from 1e-3 to 1e-12), and flux (6 points a ray).
    points
        Numbers of points on each side.

    Raises
    ------
    LoopError
        A rule has no such name, the loop is known by numbers only (a spline), or its Burgers
        vector vanishes, so that there is no relative error.
    MissingValueError
        A parameter has no value.

    Examples
    --------
    >>> from geomtorsion.loops import Loop
    >>> from geomtorsion.spaces import load
    >>> circle = Loop.circle([0.3, 1, 0.2], 0.01)
    >>> costs = loop_costs(load("so3").frame, circle, rules=["flux"], points=[16])
    >>> costs.rows[0].points, costs.rows[0].error < 1e-14
    (96, True)
    """
    unknown = [rule for rule in rules if rule not in RULES]
    if unknown:
        raise LoopError(f"rules: expected some of {', '.join(RULES)}, got {unknown[0]!r}.")
    truth = reference(frame, loop, parameters)
    largest = max(abs(x) for x in truth)
    # Values that half of the digits do not distinguish from zero are rounding.
    if largest <= loop.size * mpmath.mpf(10) ** (-_digits(loop) // 2):
        raise LoopError("the Burgers vector of this loop vanishes: it has no relative error.")
    rows: list[LoopCost] = []
    for rule in rules:
        for run, count, asked in _runs(rule, frame, loop, parameters, points):
            value, spent, claimed = run()
            apart = max(
                abs(mpmath.mpmathify(complex(x)) - y) for x, y in zip(value, truth, strict=True)
            )
            error = float(apart / largest)
            seconds = _best_time(run)
            rows.append(LoopCost(rule, spent or count, error, seconds, asked, claimed))
    name = f"{loop.name} of size {loop.size:.3g} in {frame.name or 'a frame'}"
    return LoopCosts(name, tuple(rows), truth)


def reference(
    frame: Frame, loop: Loop, parameters: Mapping[Any, Any] | None = None
) -> tuple[Any, ...]:
    """b^i to about 50 digits, by mpmath from the exact coframe: slow and independent.

    Raises
    ------
    LoopError
        The loop is known by numbers only.
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


def _best_time(run: Callable[[], Any]) -> float:
    """The shortest of several runs."""
    best, spent = float("inf"), 0.0
    while spent < LONG_ENOUGH:
        start = time.perf_counter()
        run()
        used = time.perf_counter() - start
        best, spent = min(best, used), spent + used
    return best


def _runs(
    rule: str,
    frame: Frame,
    loop: Loop,
    parameters: Mapping[Any, Any] | None,
    points: Sequence[int],
) -> list[tuple[Callable[[], tuple[Any, int, float | None]], int, float | None]]:
    """Ready calls of one rule, with their number of points and the requested accuracy."""
    if rule == "burgers_vector":
        return [(partial(_ours, frame, loop, parameters, asked), 0, asked) for asked in ACCURACIES]
    if rule == "scipy.quad":
        return [(partial(_quad, frame, loop, parameters, asked), 0, asked) for asked in ACCURACIES]
    nodes: Nodes = {"Gauss": _gauss, "Clenshaw-Curtis": _clenshaw_curtis}.get(rule, _equal)
    if rule == "flux":
        nodes = _equal if loop.parts[0].arcs[0].is_periodic else _gauss
    sides = sum(len(part.arcs) for part in loop.parts)
    each = sides * (RAYS if rule == "flux" else 1)
    call = partial(_fixed, rule, frame, loop, parameters)
    return [(partial(call, *nodes(count)), count * each, None) for count in points]


def _ours(
    frame: Frame, loop: Loop, parameters: Mapping[Any, Any] | None, asked: float
) -> tuple[Any, int, float]:
    """burgers_vector at one accuracy."""
    b = burgers_vector(frame, loop, asked, parameters=parameters)
    return b.vector, b.evaluations, b.relative_error


def _quad(
    frame: Frame, loop: Loop, parameters: Mapping[Any, Any] | None, asked: float
) -> tuple[Any, int, float]:
    """scipy.integrate.quad on every component of every side."""
    compiled = forms(frame, parameters)
    total, error, spent = np.zeros(frame.dimension), 0.0, 0
    with warnings.catch_warnings():
        # It warns where rounding keeps it from the tolerance; the table shows that as error.
        warnings.simplefilter("ignore")
        for part in loop.parts:
            for side in part.arcs:
                for i in range(frame.dimension):
                    value, bound, info = scipy.integrate.quad(
                        lambda s, part=part, side=side, i=i: line_at(
                            compiled, part, *side.shape(np.array([s]))
                        )[i, 0],
                        0,
                        1,
                        epsabs=0,
                        epsrel=asked,
                        full_output=True,
                    )[:3]
                    total[i] += part.times * part.size * value
                    error = max(error, part.size * bound)
                    spent += info["neval"]
    return total, spent, error / float(np.abs(total).max() or 1)


def _fixed(
    rule: str,
    frame: Frame,
    loop: Loop,
    parameters: Mapping[Any, Any] | None,
    s: np.ndarray,
    weights: np.ndarray,
) -> tuple[Any, int, None]:
    """A rule with fixed nodes and weights on every side."""
    compiled = forms(frame, parameters)
    total = np.zeros(frame.dimension)
    for part in loop.parts:
        for side in part.arcs:
            if rule == "flux":
                values = flux_at(compiled, part, *side.shape(s), (RAYS,))
                total = total + part.times * part.size * (part.size * (values @ weights))
            else:
                values = line_at(compiled, part, *side.shape(s))
                total = total + part.times * part.size * (values @ weights)
    return total, 0, None


def _equal(count: int) -> tuple[np.ndarray, np.ndarray]:
    """The trapezoid rule on a closed curve."""
    return np.arange(count) / count, np.full(count, 1 / count)


def _gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss and Legendre on (0, 1)."""
    x, w = np.polynomial.legendre.leggauss(count)
    return (1 + x) / 2, w / 2


def _clenshaw_curtis(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Clenshaw and Curtis on (0, 1), ends included."""
    k = np.arange(count)
    angles = np.pi * k / (count - 1)
    # Integrals of Chebyshev polynomials over (-1, 1): odd ones vanish [ClenshawCurtis1960].
    moments = np.where(k % 2, 0.0, 2.0 / (1.0 - np.where(k % 2, 0, k) ** 2))
    weights = np.linalg.solve(np.cos(np.outer(k, angles)), moments)
    return (1 - np.cos(angles)) / 2, weights / 2
