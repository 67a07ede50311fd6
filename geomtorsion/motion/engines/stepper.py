"""Stepper: the steps of DOP853 as generated code on plain floats, for systems of few states.

The method, its error estimate and its step control are those of scipy's DOP853 (E. Hairer,
S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 1993, II.5 and II.10); scipy
spends four fifths of its time on arrays of a few numbers each.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from typing import Any

from geomtorsion.errors import LimitError

# Larger systems are faster on arrays.
LARGEST = 24
SAFETY, SHORTEST, LONGEST = 0.9, 0.2, 10.0
# Rates that have no value here.
NO_VALUE = (ZeroDivisionError, ValueError, OverflowError)
STAGES = 12
# Steps between looks at whether time still moves.
STALL = 2000


@lru_cache(maxsize=1)
def _tables() -> Any:
    """scipy's class, which has the coefficients."""
    from scipy.integrate import DOP853

    return DOP853


@lru_cache(maxsize=64)
def _source(n: int, parameters: int) -> str:
    """One step: error measure, new states, new rates, all stages."""
    tables = _tables()
    states = [f"y{i}" for i in range(n)]
    values = [f"p{i}" for i in range(parameters)]

    def stage(s: int) -> list[str]:
        return [f"k{s}_{i}" for i in range(n)]

    def combined(row: Sequence[float], i: int) -> str:
        return " + ".join(f"{float(a)!r}*k{s}_{i}" for s, a in enumerate(row) if a)

    arguments = ", ".join(["f", "h", "rtol", *(f"t{i}" for i in range(n)), *states, *stage(0)])
    lines = [f"def step({arguments}{''.join(', ' + x for x in values)}):"]
    tail = "".join(", " + x for x in values)
    for s in range(1, STAGES):
        row = tables.A[s, :s]
        inside = ", ".join(f"y{i} + h*({combined(row, i)})" for i in range(n))
        lines.append(f"    {', '.join(stage(s))}, = f({inside}{tail})")
    lines += [f"    n{i} = y{i} + h*({combined(tables.B, i)})" for i in range(n)]
    new = [f"n{i}" for i in range(n)]
    lines.append(f"    {', '.join(stage(STAGES))}, = f({', '.join(new)}{tail})")
    lines.append("    fifth = third = 0.0")
    for i in range(n):
        lines.append(f"    a = abs(y{i}); b = abs(n{i}); s = t{i} + rtol*(a if a > b else b)")
        lines.append(f"    e = ({combined(tables.E5, i)})/s; fifth += e*e")
        lines.append(f"    e = ({combined(tables.E3, i)})/s; third += e*e")
    every = ", ".join(name for s in range(1, STAGES) for name in stage(s))
    result = f"({', '.join(new)},), ({', '.join(stage(STAGES))},), ({every},)"
    lines.append(f"    return fifth, third, {result}")
    return "\n".join(lines)


@lru_cache(maxsize=64)
def _step(n: int, parameters: int) -> Callable[..., Any]:
    table: dict[str, Any] = {}
    # Made of our own names and of scipy's numbers.
    exec(compile(_source(n, parameters), "<dop853>", "exec"), table)  # noqa: S102
    return table["step"]


class Polynomial:
    """Dense output of one step, of order 7; three more stages are worked out on first use."""

    def __init__(self, inner: Callable[..., Any], t: float, h: float, parts: Any) -> None:
        self.t, self.h = t, h
        self._inner, self._parts = inner, parts

    @property
    def width(self) -> int:
        """Number of states."""
        return len(self._parts[0])

    @cached_property
    def _rows(self) -> Any:
        import numpy as np

        tables, h = _tables(), self.h
        y, rates, new, new_rates, stages = self._parts
        n = len(y)
        stack = np.empty((16, n))
        stack[0], stack[STAGES] = rates, new_rates
        stack[1:STAGES] = np.reshape(stages, (STAGES - 1, n))
        for s, (row, _) in enumerate(zip(tables.A_EXTRA, tables.C_EXTRA, strict=True), 13):
            between = np.asarray(y) + h * (stack[:s].T @ row[:s])
            stack[s] = self._inner(*between.tolist())
        delta = np.asarray(new) - y
        return np.concatenate(
            (
                [delta, h * stack[0] - delta, 2 * delta - h * (stack[STAGES] + stack[0])],
                h * (tables.D @ stack),
            )
        )

    def __call__(self, times: Any) -> Any:
        """States at times within the step, shape (m, n)."""
        import numpy as np

        x = ((np.asarray(times) - self.t) / self.h)[:, None]
        total = np.zeros((len(x), self.width))
        for k, row in enumerate(self._rows[::-1]):
            total = (total + row) * (x if k % 2 == 0 else 1 - x)
        return total + self._parts[0]


class Steps:
    """Steps from a start on, each accepted by its error.

    time, state, rates: where it is; count, tried: steps accepted and tried; stuck: why it ended.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        values: Sequence[float],
        y0: Sequence[float],
        span: tuple[float, float],
        tolerance: float,
        scales: Sequence[float],
        longest: float,
        most: int,
    ) -> None:
        self.values: tuple[float, ...] = tuple(values)
        self.state: tuple[float, ...] = tuple(y0)
        self.time, self.end = span
        self.duration = abs(self.end - self.time)
        self.sign = 1.0 if self.end >= self.time else -1.0
        self.tolerance, self.floors = tolerance, tuple(tolerance * x for x in scales)
        self.longest, self.most = longest, most
        self._function = function
        self._step = _step(len(self.state), len(self.values))
        self.rates = tuple(function(*self.state, *self.values))
        self.count = self.tried = 0
        self.stuck = ""
        self._mark = self.time
        self._size = self._first()

    def inner(self, *state: float) -> Any:
        """The rates at a state; no numbers where there are none."""
        try:
            return self._function(*state, *self.values)
        except NO_VALUE:
            return [float("nan")] * len(state)

    def _first(self) -> float:
        """The length of the first step, by Hairer's rule (II.4)."""
        n = len(self.state)
        scale = [t + self.tolerance * abs(y) for t, y in zip(self.floors, self.state, strict=True)]

        def norm(vector: Any) -> float:
            return math.hypot(*(x / s for x, s in zip(vector, scale, strict=True))) / math.sqrt(n)

        here, slope = norm(self.state), norm(self.rates)
        guess = 1e-6 if here < 1e-5 or slope < 1e-5 else 0.01 * here / slope
        guess = min(guess, self.duration)
        there = [y + self.sign * guess * k for y, k in zip(self.state, self.rates, strict=True)]
        bend = norm([a - b for a, b in zip(self.inner(*there), self.rates, strict=True)]) / guess
        largest = max(slope, bend)
        second = (0.01 / largest) ** 0.125 if largest > 1e-15 else max(1e-6, guess * 1e-3)
        return min(100 * guess, second, self.duration, self.longest)

    def advance(self) -> Polynomial | None:
        """One accepted step; None where none is: see `stuck`."""
        rejected = False
        while True:
            size = min(self._size, self.longest)
            if size < 10 * math.ulp(self.time) or not size > 0:
                self.stuck = "the steps became too small"
                return None
            after = self.time + self.sign * size
            if self.sign * (after - self.end) >= 0:
                after = self.end
            # What the clock advances by, to the last bit.
            h = after - self.time
            size = abs(h)
            self.tried += 1
            if self.tried % STALL == 0 and self._stalls():
                return None
            try:
                fifth, third, new, rates, stages = self._step(
                    self._function, h, self.tolerance, *self.floors,
                    *self.state, *self.rates, *self.values,
                )  # fmt: skip
            except NO_VALUE:
                fifth = third = float("nan")
                new = rates = stages = ()
            error = 0.0
            if fifth or third:
                error = size * fifth / math.sqrt((fifth + 0.01 * third) * len(self.state))
            if error < 1:
                break
            # An error that is no number shortens the step as far as it goes.
            shorter = SAFETY * error**-0.125 if error < float("inf") else SHORTEST
            self._size = size * max(SHORTEST, shorter)
            rejected = True
        wider = min(LONGEST, SAFETY * error**-0.125) if error else LONGEST
        self._size = size * (min(1.0, wider) if rejected else wider)
        parts = (self.state, self.rates, new, rates, stages)
        piece = Polynomial(self.inner, self.time, h, parts)
        self.time, self.state, self.rates = after, new, rates
        self.count += 1
        return piece

    def _stalls(self) -> bool:
        """Whether time stands still; too many steps are an error."""
        if self.tried * STAGES > self.most:
            raise LimitError(
                f"more than {self.most} evaluations of the rates were needed by "
                f"t = {self.time:.6g}. Ask for less accuracy or time, use engine=Stiff(), or "
                "raise max_evaluations."
            )
        if abs(self.time - self._mark) < 1e-6 * self.duration:
            self.stuck = "time stands still"
            return True
        self._mark = self.time
        return False
