"""System: first-order equations y' = f(y) with a guard, ready for every engine."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from geomtorsion.codegen import Graph
from geomtorsion.copies import only_fields

# Functions that have a value everywhere.
ENTIRE = ("sin", "cos", "sinh", "cosh", "exp")
# What a scalar function raises where it has no value.
NO_VALUE = (ZeroDivisionError, ValueError, OverflowError)
ScalarRates = Callable[[float, np.ndarray], Sequence[float]]


def columns(parts: Sequence[np.ndarray], values: Iterable[Any]) -> np.ndarray:
    """States in doubles, part after part, above the parameters: what functions of arrays take.

    parts: rows of states, each (m_k, size). values: of the parameters, the same for all.

    Examples
    --------
    >>> columns([np.array([[1.0, 2.0]]), np.array([[3.0, 4.0], [5.0, 6.0]])], [7]).tolist()
    [[1.0, 3.0, 5.0], [2.0, 4.0, 6.0], [7.0, 7.0, 7.0]]
    """
    states = np.concatenate(parts).astype(float)
    numbers = np.array([float(x) for x in values])
    return np.concatenate([states.T, np.repeat(numbers[:, None], len(states), axis=1)])


@dataclass(frozen=True, eq=False)
class System:
    """Rates of named states; the values of the parameters come with each run.

    states: names of the unknowns, in order.
    parameters: names of everything else that occurs.
    rates: graph over states, then parameters, with one output for each state.
    groups: indices of states whose errors are measured against their common size (coordinates;
        velocities; a quaternion); each state is in one of them.
    guard: graph over the same arguments; where one of its outputs falls through zero a run ends.
    end: the guard of the very end of a chart, where `guard` is that of its margin.
    clock: (state, unit) where a state is the time in such units; an engine may put its own time
        in the place of that state, which rounds at every step.
    """

    states: tuple[str, ...]
    parameters: tuple[str, ...]
    rates: Graph
    groups: tuple[tuple[int, ...], ...]
    guard: Graph | None = None
    end: Graph | None = None
    clock: tuple[str, int] | None = None

    def __getstate__(self) -> dict[str, object]:
        return only_fields(self)

    @property
    def size(self) -> int:
        """Number of states."""
        return len(self.states)

    @cached_property
    def groups_but_clock(self) -> tuple[tuple[int, ...], ...]:
        """The groups without the state that is the time."""
        clock = None if self.clock is None else self.states.index(self.clock[0])
        groups = (tuple(k for k in group if k != clock) for group in self.groups)
        return tuple(group for group in groups if group)

    @cached_property
    def idle(self) -> tuple[int, ...]:
        """Indices of states that stand in no rate."""
        used = {step.detail for step in self.rates.steps if step.kind == "argument"}
        return tuple(k for k in range(self.size) if k not in used)

    @cached_property
    def key(self) -> tuple[str, str | None, int | None]:
        """What two systems share exactly when one compiled integrator serves both."""
        clock = None if self.clock is None else self.states.index(self.clock[0])
        return self.rates.key, None if self.guard is None else self.guard.key, clock

    @cached_property
    def scalar_function(self) -> Callable[..., tuple[float, ...]]:
        """f(*states, *parameters) on plain floats; raises one of NO_VALUE."""
        return self.rates.python()

    @cached_property
    def array_function(self) -> Callable[..., np.ndarray]:
        """f(*states, *parameters) on arrays, shape (size, ...)."""
        return self.rates.numpy()

    @cached_property
    def long_function(self) -> Callable[..., np.ndarray]:
        """The same in long doubles, but for the numbers in the equations."""
        return self.rates.numpy(np.longdouble)

    def scalar_rates(self, values: Sequence[float]) -> ScalarRates:
        """f(t, y) for one motion, on plain floats; not a number where there is no value."""
        inner = self.scalar_function
        bad = [float("nan")] * self.size

        def rates(_: float, y: np.ndarray) -> Sequence[float]:
            try:
                return inner(*y.tolist(), *values)
            except NO_VALUE:
                return bad

        return rates

    @cached_property
    def _jacobian(self) -> Callable[..., tuple[float, ...]]:
        return self.rates.derivative(self.states).python()

    def jacobian(self, state: Sequence[float], values: Sequence[float]) -> np.ndarray:
        """df_i/dy_j, shape (size, size); not a number where there is no value."""
        n = self.size
        try:
            return np.array(self._jacobian(*state, *values)).reshape(n, n)
        except NO_VALUE:
            return np.full((n, n), np.nan)

    @cached_property
    def guard_is_entire(self) -> bool:
        """Whether the guard has a value, and a series, at all states but poles."""
        steps = () if self.guard is None else self.guard.steps
        return all(
            step.detail in ENTIRE if step.kind == "call" else step.kind != "root" for step in steps
        )

    @cached_property
    def _guard_above_rounding(self) -> Graph | None:
        # Motions that come to rest on an edge stay within rounding of it, with ever shorter steps.
        return None if self.guard is None else self.guard.above_rounding()

    @cached_property
    def _scalar_guard(self) -> Callable[..., tuple[float, ...]] | None:
        guard = self._guard_above_rounding
        return None if guard is None else guard.python()

    def guard_at(self, state: Sequence[float], values: Sequence[float]) -> float:
        """The least output of the guard at one state, less its rounding; below zero where there is
        no value. Where it is a root, its radicand stands for it.
        """
        inner = self._scalar_guard
        if inner is None:
            return float("inf")
        try:
            found = min(inner(*state, *values))
        except NO_VALUE:
            return -1.0
        return found if found == found else -1.0

    def guard_along(self, states: np.ndarray, values: Sequence[float] | np.ndarray) -> np.ndarray:
        """The same on arrays of states, shape (size, ...)."""
        assert self._guard_above_rounding is not None
        least = self._guard_above_rounding.numpy()(*states, *values).min(axis=0)
        return np.where(np.isnan(least), -1.0, least)

    @cached_property
    def _hoisted(self) -> tuple[System, list[Graph]]:
        """See `hoisted`, and the graphs that make its further parameters, one after another."""
        names, parts, made = self.parameters, list[Graph](), list[Graph]()
        for k, part in enumerate((self.rates, self.guard)):
            if part is not None:
                wide = replace(part, arguments=(*self.states, *names))
                rest, constants = wide.hoisted(self.size, f"constant {k}")
                names = rest.arguments[self.size :]
                parts.append(rest)
                made.append(constants)
        rates = replace(parts[0], arguments=(*self.states, *names))
        guard = None if self.guard is None else parts[1]
        return replace(self, parameters=names, rates=rates, guard=guard, end=None), made

    @property
    def hoisted(self) -> System:
        """The same equations, over further parameters where these are made of others alone."""
        return self._hoisted[0]

    def with_constants(self, values: np.ndarray) -> np.ndarray:
        """Parameters of `hoisted` in doubles, from those of this; the last axis counts them."""
        for made in self._hoisted[1]:
            if made.size:
                further = made.numpy()(*np.moveaxis(values, -1, 0))
                values = np.concatenate((values, np.moveaxis(further, 0, -1)), axis=-1)
        return values

    def with_long_constants(self, values: Sequence[Any] | np.ndarray, bits: int) -> list[Any]:
        """The same for one motion in numbers of more bits."""
        found = list(values)
        for made in self._hoisted[1]:
            try:
                found += made.exactly(found, bits)
            except NO_VALUE:
                found += [float("nan")] * made.size
        return found

    @cached_property
    def unguarded(self) -> System:
        """The same equations with nothing to watch."""
        return self if self.guard is None else replace(self, guard=None, end=None)

    @cached_property
    def to_the_end(self) -> System:
        """The same equations, watched up to where the chart ends and not to its margin."""
        return self if self.end is None else replace(self, guard=self.end, end=None)
