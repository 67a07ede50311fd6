"""Shots: solutions as functions of numbers at their start, and by how much they miss conditions."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import sympy as sp

from geomtorsion.errors import EndpointError, GravityError, StartError
from geomtorsion.gravity.reduced.beginning import Beginning, Start
from geomtorsion.gravity.reduced.reduction import Reduction
from geomtorsion.gravity.reduced.requests import Request
from geomtorsion.gravity.reduced.starts import check_parameters, numbers_of
from geomtorsion.ode import ODE, Solution
from geomtorsion.ode.error_estimate import AIM
from geomtorsion.ode.newton import Hit, Shot, lengths_of, tried
from geomtorsion.support import checks
from geomtorsion.support.precision import EPS, GOLDEN

INFINITY = re.compile(r"(.+)\(\s*oo\s*\)\s*")


@dataclass(frozen=True, eq=False)
class Condition:
    """A value that an expression has at the last value of the variable, or at infinity.

    text: as it was given. expression: over states and the variable. value: its value.
    """

    text: str
    expression: object
    value: float
    at_infinity: bool

    @property
    def written(self) -> str:
        """The condition as an equation."""
        return f"{self.text} = {self.value:g}"


def condition_name(number: int) -> str:
    """The output of a solution that is the expression of a condition, counted from 1."""
    return f"condition_{number}"


def conditions_of(
    boundary: object, outputs: Mapping[str, object], names: Sequence[str]
) -> list[Condition]:
    """The conditions of a mapping: expression -> value, "phi(oo)" for a value at infinity.

    names: of the free numbers, of which there are as many.
    """
    table = checks.by_name(boundary, "boundary", GravityError)
    values = numbers_of(table, tuple(table), "boundary")
    result = []
    for text, value in values.items():
        match = INFINITY.fullmatch(text)
        inner = text if match is None else match[1].strip()
        result.append(Condition(text, outputs.get(inner, inner), float(value), match is not None))
    if len(result) != len(names):
        listed = ", ".join(one.written for one in result) or "none"
        drop = "Free another number of the start, or drop a condition."
        add = "Add a condition, or free fewer numbers."
        raise GravityError(
            f"boundary: expected as many conditions as free numbers, got {listed} for "
            f"{', '.join(names)}. {drop if len(result) > len(names) else add}"
        )
    return result


@dataclass(frozen=True, eq=False)
class Limit:
    """The value of a function at the end, or its limit at infinity.

    order: of the extrapolation in the inverse of the variable. remainder: estimate of its error.
    """

    value: float
    order: int
    remainder: float

    @classmethod
    def of(cls, samples: Sequence[float], order: int | None) -> Limit:
        """The limit from values at last, last/q, last/q^2, ...: Richardson's extrapolation.

        order: the best one if None.
        """
        columns = [list(samples)]
        for power in range(1, len(samples) - 1):
            last = columns[-1]
            weight = GOLDEN**-power
            columns.append([(weight * x - y) / (weight - 1) for x, y in pairwise(last)])
        limits = [cls(one[0], k, abs(one[0] - one[1])) for k, one in enumerate(columns)]
        return min(limits, key=lambda one: one.remainder) if order is None else limits[order]


@dataclass(frozen=True, eq=False)
class Leg:
    """Equations between two places, and how they are solved."""

    reduction: Reduction
    request: Request
    # Equations by whether they begin at zero: other numbers need no new compilation.
    _odes: dict[bool, ODE] = field(default_factory=dict, repr=False)
    # Starts by the numbers from which they were completed: a power series takes long.
    _beginnings: dict[tuple, Beginning] = field(default_factory=dict, repr=False)

    def read(self, start: Start) -> Beginning:
        """A start with its numbers read; parameters of other equations are omitted."""
        own = {x: y for x, y in start.parameters.items() if x in self.reduction.constants}
        check_parameters(self.reduction.parameters, own)
        return self.reduction.beginning(replace(start, parameters=own))

    def beginning(self, start: Start) -> Beginning:
        """The same for numbers that were read before, each start once."""
        tables = (start.values, start.parameters, start.near, {"origin": start.origin})
        key = tuple(tuple(table.items()) for table in tables)
        if key not in self._beginnings:
            self._beginnings[key] = self.read(start)
        return self._beginnings[key]

    def solved(self, start: Start, last: float | np.ndarray) -> Solution:
        """The solution from a start to a last value of the variable, or to an event."""
        reduction, beginning = self.reduction, self.beginning(start)
        place, full = beginning.first
        ode = self._odes.get(bool(place))
        if ode is None:
            ode = reduction.ode_at(place, full, beginning.written, self.request)
            self._odes[bool(place)] = ode
        numbers = {name: beginning.written[name] for name in reduction.parameters}
        if place:
            numbers[reduction.place_name] = place
        times = np.asarray(last, dtype=float) - float(place)
        if not np.all(times > 0) and not np.all(times < 0):
            raise EndpointError(f"the last value is not beyond {float(place):g}")
        return self.request.solved(ode.with_start(full, numbers), times)


def ends_of(leg: Leg, solution: Solution) -> tuple[float, float]:
    """First and last value of the variable."""
    name = leg.reduction.variable
    if name == solution.problem.time_name:
        return 0.0, float(solution.times[-1])
    place = float(solution.problem.parameters[leg.reduction.place_name])
    return place, place + float(solution.times[-1])


@dataclass(frozen=True, eq=False)
class Aim:
    """Conditions at a last value of the variable.

    scales: sizes of the expressions. orders: of extrapolations; None for the best.
    rounding: a miss that counts as a hit where all numbers vanish.
    """

    last: float
    scales: np.ndarray
    orders: tuple[int | None, ...]
    rounding: float


@dataclass(frozen=True, eq=False)
class Shooter:
    """Solutions as functions of free numbers: a vector of ones is their centre.

    legs: the equations, one or more; the next ones begin where an event ends the ones before.
    start: of the first leg. free: names of the free numbers.
    centres, units: of the free numbers.
    """

    legs: tuple[Leg, ...]
    start: Start
    conditions: tuple[Condition, ...]
    free: tuple[str, ...]
    centres: tuple[sp.Rational, ...]
    units: tuple[sp.Rational, ...]
    accuracy: float

    def numbers(self, vector: np.ndarray) -> dict[str, sp.Rational]:
        """The free numbers of a vector, exactly."""
        rows = zip(self.free, self.centres, self.units, vector.tolist(), strict=True)
        return {name: centre + unit * (sp.Rational(x) - 1) for name, centre, unit, x in rows}

    def start_of(self, vector: np.ndarray) -> Start:
        """The start of the first leg with the free numbers of a vector."""
        numbers = self.numbers(vector)
        values, parameters = (
            {**table, **{name: numbers[name] for name in self.free if name in table}}
            for table in (self.start.values, self.start.parameters)
        )
        return replace(self.start, values=values, parameters=parameters)

    def continued(
        self,
        reduction: Reduction,
        solution: Solution,
        parameters: Mapping[str, object],
        origin: float,
    ) -> Start:
        """The start of a leg where an event ended the solution of the one before."""
        values = {x: float(solution[x][-1]) for x in reduction.states if x in solution}
        near = {**values, **self.start.near}
        return Start(_without_constrained(reduction, values), parameters, near, origin)

    def solutions(self, vector: np.ndarray, last: float | np.ndarray) -> tuple[Solution, ...]:
        """The solutions of all legs."""
        start = self.start_of(vector)
        end = float(np.ravel(last)[-1])
        solutions = list[Solution]()
        for number, leg in enumerate(self.legs, 1):
            is_last = number == len(self.legs)
            if solutions:
                origin = ends_of(self.legs[number - 2], solutions[-1])[1]
                start = self.continued(leg.reduction, solutions[-1], start.parameters, origin)
            solution = leg.solved(start, last if is_last else end)
            if not is_last and solution.outcome != "stopped":
                raise EndpointError("the first equations reach the last value before their event")
            if is_last and solution.outcome == "stopped" and not leg.request.events:
                raise EndpointError("the solution ends before the last value")
            solutions.append(solution)
        return tuple(solutions)

    def limits(
        self, solutions: Sequence[Solution], orders: Sequence[int | None]
    ) -> tuple[Limit, ...]:
        """The values of all conditions."""
        solution, leg = solutions[-1], self.legs[-1]
        begin, end = ends_of(leg, solution)
        result = []
        for number, (condition, order) in enumerate(zip(self.conditions, orders, strict=True), 1):
            name = condition_name(number)
            if order == 0 or not condition.at_infinity:
                result.append(Limit(float(solution[name][-1]), 0, 0.0))
                continue
            # Places with this ratio need only the outer part of a solution.
            places = [end]
            while abs(places[-1]) * GOLDEN > max(abs(begin), EPS * abs(end)):
                places.append(places[-1] * GOLDEN)
            if len(places) < 3 or solution.outcome == "stopped":
                variable = self.legs[-1].reduction.variable
                raise EndpointError(
                    f"shoot: expected a solution beyond {variable} = {begin / GOLDEN**2:.6g} for a "
                    f"limit at infinity, got one that ends at {end:.6g}. Give a larger last value."
                )
            shift = end - float(solution.times[-1])
            values = solution.at(np.array([x - shift for x in places]))[name]
            result.append(Limit.of(values.tolist(), order))
        return tuple(result)

    def sizes(self, solutions: Sequence[Solution]) -> np.ndarray:
        """Sizes of the conditions: of their values, or of the expressions where a leg begins."""
        sizes = []
        for number, one in enumerate(self.conditions, 1):
            size = abs(one.value) or abs(float(solutions[-1][condition_name(number)][0]))
            sizes.append(size if size and np.isfinite(size) else 1.0)
        return np.array(sizes)

    def gaps(self, limits: Sequence[Limit], aim: Aim) -> np.ndarray:
        """Misses in units of the sizes."""
        values = [one.value - c.value for one, c in zip(limits, self.conditions, strict=True)]
        return np.array(values) / aim.scales

    def shot(self, vector: np.ndarray, aim: Aim) -> Shot:
        """The solution of a vector, with its miss."""
        try:
            solutions = self.solutions(vector, aim.last)
        except (StartError, GravityError) as error:
            raise EndpointError(str(error)) from None
        gap = self.gaps(self.limits(solutions, aim.orders), aim)
        if not np.isfinite(gap).all():
            raise EndpointError("a condition has no value at the end")
        return Shot(vector, gap, float(lengths_of(gap)))

    def slopes(self, shot: Shot, aim: Aim) -> np.ndarray:
        """d gap / d v by central differences, smaller ones where the end depends much on them."""
        columns = []
        for unit in np.eye(len(shot.vector)):
            step = self.difference(shot.vector, aim)
            while True:
                ahead, behind = (
                    tried(self.shot, shot.vector + x * unit, aim) for x in (step, -step)
                )
                if ahead is not None and behind is not None:
                    gap = ahead.gap - behind.gap
                    if lengths_of(gap) <= AIM * max(1.0, shot.size):
                        columns.append(gap / (2 * step))
                        break
                step *= AIM**2
                if step < EPS:
                    raise EndpointError("the end depends too much on the start")
        return np.array(columns).T

    def difference(self, vector: np.ndarray, aim: Aim) -> float:
        """The step at which errors of ends and third derivatives balance in differences."""
        return float(lengths_of(vector)) * max(self.accuracy, EPS) ** (1 / 3)

    def around(self, hit: Hit) -> Shooter:
        """The same with a hit as its centre, and units in which the end changes by its size."""
        numbers = self.numbers(hit.vector)
        shares = np.ones(len(self.free))
        if hit.inverse is not None:
            shares = np.minimum(np.abs(hit.inverse).sum(axis=1), 1.0)
        units = [unit * sp.Rational(x) for unit, x in zip(self.units, shares.tolist(), strict=True)]
        return replace(
            self,
            centres=tuple(numbers.values()),
            units=tuple(x or y for x, y in zip(units, self.units, strict=True)),
        )


def _without_constrained(reduction: Reduction, start: Mapping[str, object]) -> dict[str, object]:
    """A start without one state for each constraint, from which it follows."""
    values = dict(start)
    for constraint in reduction.constraints:
        names = {x.name for x in constraint.free_symbols}
        # The highest derivative enters with the lowest power.
        for name in reversed(reduction.states):
            if name in names and name in values:
                del values[name]
                break
    return values
