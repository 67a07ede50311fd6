"""Stepper: the steps of DOP853 as generated code on plain floats, for systems of few states.

Method, error estimate and step control agree with scipy's DOP853 (E. Hairer,
S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 1993, II.5 and II.10); scipy
spends four fifths of its time on arrays of a few numbers each.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

import numpy as np
import scipy  # loads its parts on first use

from geomtorsion.codegen import Graph, compiled
from geomtorsion.ode.rates import KEPT
from geomtorsion.ode.system import (
    NO_VALUE,
    STEPS_AT_ONCE,
    System,
    WorkLimitError,
    refuse_stiff,
)
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.caching import cached_property

# Larger systems are faster on arrays; the steps are the same.
LARGEST = 24
# Safety factor of the next step, and its smallest and largest ratio to the last one, as in scipy.
SAFETY, SHORTEST, LONGEST = 0.9, 0.2, 10.0
# Up to this number, times are evaluated one by one: faster, with equal results.
FEW_TIMES = 4
# Steps below this number of last places of the time are too small; an end within NEAR_END of these
# smallest steps is reached.
LEAST_ULPS = 10
NEAR_END = LEAST_ULPS**2


class Polynomial:
    """Dense output of one step, of order 7; three more stages are computed on first use.

    rows: makes the coefficients of a step.
    parts: the length of the step, states and rates before and after, all stages.
    """

    def __init__(self, rows: Callable[..., Any], t: float, h: float, parts: Any) -> None:
        self.t: float = t
        self.h: float = h
        self._make, self._parts = rows, parts

    @property
    def width(self) -> int:
        """Number of states."""
        return len(self._parts[0])

    @cached_property
    def _rows(self) -> Any:
        try:
            return self._make(self.h, self._parts)
        except NO_VALUE:
            return [[float("nan")] * self.width] * 7

    def __call__(self, times: Any) -> Any:
        """States at times within the step, shape (m, n)."""
        if len(times) <= FEW_TIMES:
            return np.array([self._at(t) for t in times.tolist()])
        x = ((np.asarray(times) - self.t) / self.h)[:, None]
        total = np.zeros((len(x), self.width))
        for k, row in enumerate(self._rows[::-1]):
            total = (total + row) * (x if k % 2 == 0 else 1 - x)
        return total + self._parts[0]

    def _at(self, time: float) -> list[float]:
        """The same at one time."""
        x = (time - self.t) / self.h
        u = 1 - x
        return [
            y + x * (a + u * (b + x * (c + u * (d + x * (e + u * (f + x * g))))))
            for y, a, b, c, d, e, f, g in zip(self._parts[0], *self._rows, strict=True)
        ]


def too_many_evaluations(most: int, time: float) -> WorkLimitError:
    """The error of a run that evaluates its rates without end."""
    advice = "Request less accuracy or time, use engine=Stiff(), or raise max_evaluations."
    return WorkLimitError(f"{most} evaluations of the rates", time, advice, "t")


class Steps:
    """Steps from a start on, each accepted by its error.

    longest: the longest step from a time on.
    time, state, rates: where it is; count, tried: steps accepted and tried; stuck: why it ended.
    """

    def __init__(
        self,
        system: System,
        values: Sequence[float],
        y0: Sequence[float],
        span: tuple[float, float],
        tolerance: float,
        scales: Sequence[float],
        longest: Callable[[float], float],
        most: int,
    ) -> None:
        self._system: System = system
        self.values: tuple[float, ...] = tuple(values)
        self.state: tuple[float, ...] = tuple(y0)
        self.time: float
        self.end: float
        self.time, self.end = span
        self.duration: float = abs(self.end - self.time)
        self.sign: float = 1.0 if self.end >= self.time else -1.0
        self.tolerance: float = tolerance
        self.floors: tuple[float, ...] = tuple(tolerance * x for x in scales)
        self._longest: Callable[[float], float] = longest
        self.most: int = most
        self._function: Any = system.scalar_function
        self._step, self._rows = step_of(system), rows_of(system)
        self.rates: tuple[float, ...] = tuple(self._function(*self.state, *self.values))
        self.count: int = 0
        self.tried: int = 0
        self.stuck: str = ""
        self._mark = self.time
        self._size = self._first()

    @property
    def evaluations(self) -> int:
        """Evaluations of the rates."""
        return stage_count() * self.tried

    def move(self, state: Sequence[float]) -> None:
        """Continue from another state at the same time."""
        self.state = tuple(state)
        self.rates = tuple(self.inner(*self.state))

    def inner(self, *state: float) -> Any:
        """The rates at a state; NaN where they have no value."""
        try:
            return self._function(*state, *self.values)
        except NO_VALUE:
            return [float("nan")] * len(state)

    def _coefficients(self, h: float, parts: Any) -> Any:
        y, rates, new, new_rates, stages = parts
        return self._rows(self._function, h, *y, *rates, *new, *new_rates, *stages, *self.values)

    def _first(self) -> float:
        """The length of the first step, by Hairer's rule (II.4)."""
        n = len(self.state)
        scale = [t + self.tolerance * abs(y) for t, y in zip(self.floors, self.state, strict=True)]

        def norm(vector: Any) -> float:
            return math.hypot(*(x / s for x, s in zip(vector, scale, strict=True))) / math.sqrt(n)

        here, slope = norm(self.state), norm(self.rates)
        guess = 1e-6 if here < 1e-5 or slope < 1e-5 else 0.01 * here / slope
        guess = min(guess, self.duration)
        if guess == 0:
            # So fast that no step is short enough.
            return 0.0
        there = [y + self.sign * guess * k for y, k in zip(self.state, self.rates, strict=True)]
        bend = norm([a - b for a, b in zip(self.inner(*there), self.rates, strict=True)]) / guess
        largest = max(slope, bend)
        second = (0.01 / largest) ** 0.125 if largest > 1e-15 else max(1e-6, guess * 1e-3)
        # A tiny state beside large ones makes the guess tiny: behind a switch it is tried anyhow.
        least = LEAST_ULPS * math.ulp(self.time) if self.time else 0.0
        return max(min(100 * guess, second, self.duration, self._longest(self.time)), least)

    def advance(self) -> Polynomial | None:
        """One accepted step; None if no step is possible, see `stuck`."""
        rejected = False
        while True:
            size = min(self._size, self._longest(self.time))
            if size < LEAST_ULPS * math.ulp(self.time) or not size > 0:
                self.stuck = "the steps became too small"
                return self._last()
            after = self.time + self.sign * size
            if self.sign * (after - self.end) >= 0:
                after = self.end
            # What the clock advances by, to the last bit.
            h = after - self.time
            size = abs(h)
            self.tried += 1
            if self.tried % STEPS_AT_ONCE == 0 and self._stalls():
                return None
            try:
                fifth, third, new, rates, stages = self._step(
                    self._function, h, self.tolerance, *self.floors,
                    *self.state, *self.rates, *self.values,
                )  # fmt: skip
            except NO_VALUE:
                fifth = third = float("nan")
                new = rates = stages = ()
            error, fifth, third = 0.0, float(fifth), float(third)
            # Measures near the smallest floats have a hundredth that is 0.
            if both := fifth + 0.01 * third:
                error = size * fifth / math.sqrt(both * len(self.state))
            if error < 1:
                break
            # If the error is NaN, take the shortest step.
            shorter = SAFETY * error**-0.125 if error < float("inf") else SHORTEST
            self._size = size * max(SHORTEST, shorter)
            rejected = True
        wider = min(LONGEST, SAFETY * error**-0.125) if error else LONGEST
        self._size = size * (min(1.0, wider) if rejected else wider)
        parts = (self.state, self.rates, new, rates, stages)
        piece = Polynomial(self._coefficients, self.time, h, parts)
        self.time, self.state, self.rates = after, new, rates
        self.count += 1
        return piece

    def _last(self) -> Polynomial | None:
        """The rest of the way, if it is a rounding error of the time and changes nothing.

        Beyond the end of a function such as (1 - t)**(1/3) the rates have no value, and a clock may
        pass it by a rounding error.
        """
        h = self.end - self.time
        if abs(h) > NEAR_END * LEAST_ULPS * math.ulp(self.end):
            return None
        rows = zip(self.state, self.rates, self.floors, strict=True)
        if not all(abs(h * k) <= floor + self.tolerance * abs(y) for y, k, floor in rows):
            return None
        new = tuple([y + h * k for y, k in zip(self.state, self.rates, strict=True)])
        stages = self.rates * (stage_count() - 1)
        parts = (self.state, self.rates, new, self.rates, stages)
        piece = Polynomial(self._coefficients, self.time, h, parts)
        self.time, self.state, self.stuck = self.end, new, ""
        self.count += 1
        return piece

    def _stalls(self) -> bool:
        """Whether time makes no progress; too many steps are an error."""
        check_limits()
        if self.tried * stage_count() > self.most:
            raise too_many_evaluations(self.most, self.time)
        pace, left = abs(self.time - self._mark) / STEPS_AT_ONCE, abs(self.end - self.time)
        # States of a motion that blows up may be beyond doubles.
        with np.errstate(over="ignore"):
            state = [float(x) for x in self.state]
        most = self.most // stage_count()
        refuse_stiff(self._system, state, self.values, pace, self.time, left, most)
        if abs(self.time - self._mark) < 1e-6 * self.duration:
            self.stuck = "time makes no progress"
            return True
        self._mark = self.time
        return False


@cache
def stage_count() -> int:
    """Evaluations of the rates in a step of DOP853."""
    return int(scipy.integrate.DOP853.n_stages)


# Rates whose source has more characters than this are called, not written into the step: that takes
# as long, and less to compile.
LONGEST_SOURCE = 4000


def step_of(system: System) -> Callable[..., Any]:
    """The step of a system: `step(rates, h, rtol, floors, y, y', parameters)`, all spread out.

    It returns error measures of orders five and three, new states, new rates, all stages.
    """
    return _made("step", system.size, system.rates)


def rows_of(system: System) -> Callable[..., Any]:
    """Dense output of a step: `rows(rates, h, y, y', new y, new y', stages, parameters)`.

    It returns seven rows of coefficients, three more stages being worked out.
    """
    return _made("rows", system.size, system.rates)


@lru_cache(maxsize=KEPT)
def _made(name: str, n: int, rates: Graph) -> Callable[..., Any]:
    """A function of the writer; equal rates give the same one."""
    writer = _writer(n, rates)
    code = "\n    ".join(writer.step() if name == "step" else writer.rows())
    return compiled(code, "floats", name)


def _writer(n: int, rates: Graph) -> _Writer:
    """The writer for rates of n states."""
    values = tuple(f"a{k}" for k in range(n, len(rates.arguments)))
    if len(rates.python_source()) > LONGEST_SOURCE:
        return _Writer(n, values, tuple(range(n)), (), ())
    used = {step.detail for step in rates.steps if step.kind == "argument"}
    return _Writer(n, values, tuple(k for k in range(n) if k in used), *rates.python_body)


def _written(row: Sequence[float]) -> list[str]:
    """Coefficients in doubles as source; empty where they are zero."""
    return [repr(float(a)) if a else "" for a in row]


@dataclass(frozen=True)
class _Writer:
    """Writes functions line by line.

    n: number of states, which rates know as a0, a1, ...; values: names of the parameters.
    needed: the states that rates ask for; others need not be worked out on the way.
    body, results: the rates written out; where there are none, they are called.
    """

    n: int
    values: tuple[str, ...]
    needed: tuple[int, ...]
    body: tuple[str, ...]
    results: tuple[str, ...]

    def _all(self, letter: str) -> str:
        return ", ".join(f"{letter}{i}" for i in range(self.n))

    def _combined(self, row: Sequence[str], i: int) -> str:
        return " + ".join(f"{a}*k{s}_{i}" for s, a in enumerate(row) if a)

    def _coefficients(self, s: int) -> Sequence[str]:
        """Coefficients of a stage, or (for the number after the last) of the new states."""
        tables = scipy.integrate.DOP853
        return _written(tables.B if s == stage_count() else tables.A[s, :s])

    def _rates(self, s: int) -> list[str]:
        """A stage from the states a0, a1, ..."""
        if not self.results:
            return [f"{self._all(f'k{s}_')}, = rates({', '.join((self._all('a'), *self.values))})"]
        return [*self.body, *(f"k{s}_{i} = {one}" for i, one in enumerate(self.results))]

    def _stage(self, s: int, row: Sequence[str]) -> list[str]:
        places = [f"a{i} = y{i} + h*({self._combined(row, i)})" for i in self.needed]
        return [*places, *self._rates(s)]

    def step(self) -> list[str]:
        """Source of `step`, see `step_of`."""
        tables, each, last = scipy.integrate.DOP853, range(self.n), stage_count()
        arguments = ["rates", "h", "rtol", *map(self._all, ("floor", "y", "k0_")), *self.values]
        lines = [f"def step({', '.join(arguments)}):"]
        for s in range(1, last):
            lines += self._stage(s, self._coefficients(s))
        lines += [f"d{i} = {self._combined(self._coefficients(last), i)}" for i in each]
        lines += [f"n{i} = y{i} + h*d{i}" for i in each]
        lines += [f"a{i} = n{i}" for i in self.needed]
        lines += self._rates(last)
        lines.append("fifth = third = 0.0")
        # The error of third order uses the weights of the new states, except for three stages.
        gaps = [a - b for a, b in zip(tables.B, tables.E3, strict=False)]
        lower = _written([a if abs(a) > 1e-15 else 0.0 for a in gaps])
        fifth = _written(tables.E5)
        for i in each:
            lines.append(f"a = abs(y{i}); b = abs(n{i}); s = floor{i} + rtol*(a if a > b else b)")
            lines.append(f"e = ({self._combined(fifth, i)})/s; fifth += e*e")
            lines.append(f"e = (d{i} - ({self._combined(lower, i)}))/s; third += e*e")
        every = ", ".join(self._all(f"k{s}_") for s in range(1, last))
        parts = f"({self._all('n')},), ({self._all(f'k{last}_')},), ({every},)"
        return [*lines, f"return fifth, third, {parts}"]

    def rows(self) -> list[str]:
        """Source of `rows`, see `rows_of`."""
        tables, each, last = scipy.integrate.DOP853, range(self.n), stage_count()
        stages = [f"k{s}_" for s in range(1, last)]
        spread = map(self._all, ("y", "k0_", "n", f"k{last}_", *stages))
        lines = [f"def rows({', '.join(['rates', 'h', *spread, *self.values])}):"]
        for s, row in enumerate(tables.A_EXTRA, last + 1):
            lines += self._stage(s, _written(row[:s]))
        lines += [f"d{i} = n{i} - y{i}" for i in each]
        rows = [
            [f"d{i}" for i in each],
            [f"h*k0_{i} - d{i}" for i in each],
            [f"2*d{i} - h*(k{last}_{i} + k0_{i})" for i in each],
            *([f"h*({self._combined(row, i)})" for i in each] for row in map(_written, tables.D)),
        ]
        return [*lines, f"return ({', '.join(f'({chr(44).join(row)},)' for row in rows)})"]
