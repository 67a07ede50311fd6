"""Boundary: free numbers at the start for which functions have given values elsewhere."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NoReturn

import numpy as np
import sympy as sp

from geomtorsion.errors import EndpointError, GravityError, StartError, TimeError
from geomtorsion.gravity.motion.shots import Aim, Leg, Shooter, condition_name, conditions_of
from geomtorsion.gravity.motion.solving import checked_theory
from geomtorsion.gravity.reduced.beginning import Start
from geomtorsion.gravity.reduced.reduction import Reduction
from geomtorsion.gravity.reduced.starts import numbers_of
from geomtorsion.gravity.theory.field_equations import FieldEquations
from geomtorsion.ode import At, Engine, Solution, When
from geomtorsion.ode.derivatives import checked_by
from geomtorsion.ode.error_estimate import AIM
from geomtorsion.ode.newton import SHOTS, Hit, Newton, tried
from geomtorsion.ode.numbers import checked_accuracy
from geomtorsion.support import checks
from geomtorsion.support.outgoing import json_number, measured_text, size_text


@dataclass(frozen=True, eq=False, repr=False)
class Shooting:
    """Result of `shoot`: the solution, and the start values for which its boundary conditions hold.

    values: free numbers by name. errors: estimates of their errors, absolute, which include the
        remainders.
    misses: condition -> its value minus the required value. remainders: condition at infinity ->
        estimate of the error of its extrapolation from finite places.
    solution: from the start; outside: beyond the event at which it ends, or None.
    shots: number of solutions that Newton's iteration computed.
    """

    values: Mapping[str, float]
    errors: Mapping[str, float]
    misses: Mapping[str, float]
    remainders: Mapping[str, float]
    solution: Solution
    outside: Solution | None
    shots: int

    def __str__(self) -> str:
        lines = [
            f"{name} = {measured_text(value, self.errors[name])}"
            for name, value in self.values.items()
        ]
        for name, miss in self.misses.items():
            line = f"{name}: missed by {size_text(abs(miss))}"
            if name in self.remainders:
                line += f", remainder {size_text(self.remainders[name])}"
            lines.append(line)
        return "\n".join([*lines, f"{self.shots} shots", str(self.outside or self.solution)])

    __repr__ = __str__

    def to_json(self) -> dict[str, Any]:
        """The solution, the free numbers and the misses as plain data; see `Solution.to_json`."""
        document = _without_conditions(self.solution, len(self.misses))
        if self.outside is not None:
            document["outside"] = _without_conditions(self.outside, len(self.misses))
        free = {
            name: {"value": value, "error": json_number(self.errors[name])}
            for name, value in self.values.items()
        }
        boundary = {
            name: {"miss": miss, "remainder": self.remainders.get(name)}
            for name, miss in self.misses.items()
        }
        return {**document, "free": free, "boundary": boundary}


def shoot(
    equations: FieldEquations | Reduction,
    variable: object,
    last: object,
    start: Mapping[str, object],
    parameters: Mapping[str, object] | None = None,
    *,
    free: Sequence[str],
    boundary: Mapping[str, object],
    outside: FieldEquations | Reduction | None = None,
    conditions: object = (),
    near: Mapping[str, object] | None = None,
    origin: object = 0,
    outputs: Mapping[str, object] | None = None,
    events: Iterable[At | When] = (),
    accuracy: float = 1e-10,
    engine: Engine | None = None,
) -> Shooting:
    """Solve field equations with boundary values at the end or at infinity, by shooting.

    Newton's iteration, as in `gt.log_map`, changes the free numbers until the conditions hold. If
    it does not converge from the first guess, the conditions are first required at a nearer place,
    which then moves outwards. A value at infinity is extrapolated from the values at the outer
    places by powers of the inverse of the variable; the remainder is the change of the
    extrapolation if the last place is omitted.

    Parameters
    ----------
    equations, variable, start, parameters, conditions, near, origin, outputs, engine
        as for `solve`. The start and the parameters hold first guesses of the free numbers.
    last
        the last value of the variable, or increasing values.
    free
        names of numbers in the start or the parameters that are to be found.
    boundary
        expression over states and outputs -> its value at the end: {"A": 1, "phi_1 + m*phi": 0}.
        "phi(oo)" is the limit at infinity.
    outside
        equations beyond the event that ends the first ones, such as the vacuum around a star; the
        boundary values are then required of their solution.
    events
        as for `solve`, for the first equations.
    accuracy
        of the conditions, relative to the size of each expression at the start.

    Raises
    ------
    GravityError
        there are more or fewer conditions than free numbers.
    EndpointError
        no free numbers were found: the message names the farthest place that was reached.

    Examples
    --------
    A universe of dust whose size has doubled at t = 1:

    >>> import sympy as sp
    >>> import geomtorsion as gt
    >>> t, x, y, z = sp.symbols("t x y z")
    >>> a = sp.Function("a")(t)
    >>> cosmos = gt.Frame([t, x, y, z], sp.diag(1, a, a, a), (-1, 1, 1, 1))
    >>> dust = gt.gravity.fluid("rho(t)", 0, [1, 0, 0, 0])
    >>> equations = gt.gravity.equations(gt.levi_civita(cosmos), "R/2", dust)
    >>> answer = gt.gravity.shoot(
    ...     equations, "t", 1, {"a": 1, "rho": 3}, near={"a_1": 1}, free=["rho"], boundary={"a": 2}
    ... )
    >>> round(answer.values["rho"], 9), round(4 * (2**1.5 - 1) ** 2 / 3, 9)
    (4.457527667, 4.457527667)
    """
    accuracy = checked_accuracy(accuracy)
    numbers = checks.by_name(parameters or {}, "parameters", StartError)
    outputs = checks.by_name(outputs or {}, "outputs", GravityError)
    theories = [checked_theory(equations)]
    if outside is not None:
        theories.append(checked_theory(outside, "outside"))
    reductions = [
        one if isinstance(one, Reduction) else one.reduce(variable, conditions) for one in theories
    ]
    for one in reductions:
        checks.known_name(variable, [one.variable], "variable", GravityError)
    names = checked_by(free, (*checks.by_name(start, "start", StartError), *numbers), "free")
    demands = conditions_of(boundary, outputs, names)
    texts = reductions[-1].read({one.text: one.expression for one in demands}, "boundary value")
    conditional = {condition_name(k): one for k, one in enumerate(texts.values(), 1)}
    legs = [
        Leg(
            reduction=one,
            outputs={**outputs, **(conditional if one is reductions[-1] else {})},
            events=tuple(events) if one is reductions[0] else (),
            # As in `log_map`, solutions are better than the hits.
            accuracy=AIM * accuracy,
            engine=engine,
        )
        for one in reductions
    ]
    guesses = numbers_of({x: {**numbers, **start}[x] for x in names}, names, "free")
    shooter = Shooter(
        legs=tuple(legs),
        start=Start(start, numbers, near or {}, origin),
        conditions=tuple(demands),
        free=names,
        centres=tuple(guesses.values()),
        units=tuple(abs(x) or sp.Integer(1) for x in guesses.values()),
        accuracy=accuracy,
    )
    # A start that does not fit the equations is an error of its own.
    constants = [x for one in reductions for x in one.constants]
    for name in numbers:
        checks.known_name(name, constants, "parameters", GravityError)
    place, _ = legs[0].read(shooter.start).first
    times = checks.array(last, "last", TimeError)
    end = float(times.ravel()[-1])
    if end == float(place):
        raise TimeError(
            f"last: expected a value beyond {variable} = {end:.6g}, where the start is, got this "
            "place. Give another one."
        )
    return _Search(shooter, float(place), end).answer(times)


@dataclass(frozen=True, eq=False)
class _Search:
    """The search for free numbers.

    shooter: around the first guess. place, last: values of the variable, first and last.
    """

    shooter: Shooter
    place: float
    last: float

    @property
    def ones(self) -> np.ndarray:
        """The vector of the centre."""
        return np.ones(len(self.shooter.free))

    def answer(self, times: np.ndarray) -> Shooting:
        """The solution that fulfils the conditions, at the requested values of the variable."""
        shooter, hit, shots = self.followed()
        aim = hit.aim
        assert isinstance(aim, Aim)
        open_orders = [None if one.at_infinity else 0 for one in shooter.conditions]
        if None in open_orders:
            solutions = shooter.solutions(hit.vector, self.last)
            orders = tuple(one.order for one in shooter.limits(solutions, open_orders))
            sharper = replace(aim, orders=orders)
            limited = Newton(shooter, shooter.accuracy).hit(sharper, hit.vector, hit.inverse)
            if limited is None:
                self.refuse(shooter, self.last)
            hit, aim, shots = limited, sharper, shots + limited.shots
        inverse = hit.inverse
        if inverse is None:
            inverse = Newton(shooter, shooter.accuracy).inverse_slopes(hit.shot, aim)
        if inverse is None:
            self.refuse(shooter, self.last)
        whole = shooter.solutions(hit.vector, self.last)
        remainders = [one.remainder for one in shooter.limits(whole, open_orders)]
        noise = [
            sum(x.error for x in whole) * float(np.nanmax(np.abs(whole[-1][condition_name(k)])))
            for k in range(1, len(remainders) + 1)
        ]
        wrong = np.abs(hit.shot.gap) + (np.array(noise) + np.array(remainders)) / aim.scales
        # Twice, because an earlier shot gave the slopes.
        sizes = 2 * np.array(list(map(float, shooter.units))) * (np.abs(inverse) @ wrong)
        values = {name: float(x) for name, x in shooter.numbers(hit.vector).items()}
        texts = [one.written for one in shooter.conditions]
        solutions = shooter.solutions(hit.vector, times) if times.ndim else whole
        return Shooting(
            values=values,
            errors={
                name: max(error, abs(value) * shooter.accuracy)
                for (name, value), error in zip(values.items(), sizes.tolist(), strict=True)
            },
            misses=dict(zip(texts, (hit.shot.gap * aim.scales).tolist(), strict=True)),
            remainders={
                text: remainder
                for text, remainder, one in zip(texts, remainders, shooter.conditions, strict=True)
                if one.at_infinity
            },
            solution=solutions[0],
            outside=solutions[1] if len(solutions) > 1 else None,
            shots=shots,
        )

    def followed(self) -> tuple[Shooter, Hit, int]:
        """The hit at the last value, from the first guess, perhaps by nearer values."""
        shooter, scales, shots = self.shooter, None, 0
        reached, step = self.place, self.last - self.place
        whole = abs(step)
        for _ in range(3 * SHOTS):
            is_last = abs(reached + step - self.place) >= whole
            end = self.last if is_last else reached + step
            hit = None
            if scales is None:
                solutions = tried(shooter.solutions, self.ones, end)
                scales = None if solutions is None else shooter.sizes(solutions)
            if scales is not None:
                aim = Aim(end, scales, (0,) * len(scales), shooter.accuracy)
                hit = Newton(shooter, shooter.accuracy).hit(aim, self.ones)
            if hit is None:
                step /= 2
                if abs(step) < AIM**4 * whole:
                    break
                continue
            shots += hit.shots
            if is_last:
                return shooter, hit, shots
            shooter, reached, step = shooter.around(hit), end, 2 * step
        self.refuse(shooter, reached)

    def refuse(self, shooter: Shooter, reached: float) -> NoReturn:
        """Refuse conditions for which no numbers were found."""
        name = shooter.legs[0].reduction.variable
        values = ", ".join(f"{x} = {float(y):.8g}" for x, y in shooter.numbers(self.ones).items())
        wanted = "; ".join(one.written for one in shooter.conditions)
        if reached != self.place:
            result = (
                f"The conditions hold at {name} = {reached:.6g} for {values}, but not at "
                f"{self.last:.6g}: the end depends too much on the start, or no such solution "
                "continues. Give a nearer last value, or conditions that a growing solution "
                "violates less"
            )
        else:
            result = (
                f"The first guess {values} leads to none, also where the conditions are demanded "
                "nearer. A solution with these values may not exist. Give another first guess"
            )
        raise EndpointError(
            f"shoot: expected {', '.join(shooter.free)} for which {wanted} at {name} = "
            f"{self.last:.6g}, got none. {result}."
        )


def _without_conditions(solution: Solution, count: int) -> dict[str, Any]:
    """The plain data of a solution without the columns of boundary conditions."""
    document = solution.to_json()
    names = {condition_name(k) for k in range(1, count + 1)}
    columns = {x: y for x, y in document["solution"].items() if x not in names}
    return {**document, "solution": columns}
