"""Switching: a motion whose equations and states change at levels of terms, stage by stage.

Each surface is a level of a term; a motion is above or below each of them. The sides choose the
branches of expressions by pieces. A stage ends at the next level above or below, where conditions
act, or at the next time at which something changes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
import sympy as sp

from geomtorsion.codegen import Graph, graph
from geomtorsion.errors import ExpressionError
from geomtorsion.ode.derivatives import Jump, along
from geomtorsion.ode.error_estimate import NOISE
from geomtorsion.ode.numbers import Real, floats
from geomtorsion.ode.pieces import Choice, all_pieces, ends, has_pieces, pieces, resolved
from geomtorsion.ode.rates import Rates
from geomtorsion.ode.system import STANDSTILL
from geomtorsion.ode.terms import At, When
from geomtorsion.ode.trajectory import MOST_STAGES, State
from geomtorsion.support.caching import cached_property


class Switched(Protocol):
    """Equations whose stages are made here; see `ODE`."""

    @property
    def rates(self) -> Rates:
        """Rates, which may be given by pieces."""
        ...

    @property
    def start(self) -> tuple[Real, ...]:
        """Numbers at t = 0."""
        ...

    @property
    def parameters(self) -> Mapping[str, Real]:
        """Name -> number."""
        ...

    @property
    def events(self) -> tuple[At, ...]:
        """Changes at times."""
        ...

    @property
    def switches(self) -> tuple[When, ...]:
        """Conditions with changes."""
        ...

    @property
    def resting(self) -> tuple[str, ...]:
        """States that are parameters between changes."""
        ...

    @property
    def varied(self) -> tuple[str, ...]:
        """Names by which the last states are derivatives."""
        ...

    def normalized_state(self, state: Sequence[Real], precision: int, /) -> list[Real]:
        """A state with its normalized groups rescaled to length one."""
        ...

    def normalizer(self, precision: int, /) -> Callable[[State], State] | None:
        """The function `Stage.kept`."""
        ...


@dataclass(frozen=True)
class Surface:
    """A level of a term, at which the equations change or conditions fall.

    term: over states and the time. level: over the parameters.
    down, up: numbers of the conditions that fall where the term decreases or increases through it.
    is_border: whether an expression by pieces changes here.
    """

    term: sp.Expr
    level: sp.Expr
    down: tuple[int, ...] = ()
    up: tuple[int, ...] = ()
    is_border: bool = False

    def acting(self, *, down: bool) -> tuple[int, ...]:
        """Numbers of the conditions that fall in one direction."""
        return self.down if down else self.up


@dataclass(frozen=True, eq=False)
class Position:
    """State of a motion between two stages.

    time: when. states, parameters: their numbers. above: whether the motion is above each surface.
    fell: surface -> the last time at which its conditions acted. count: number of changes so far.
    """

    time: float
    states: list[Real]
    parameters: Mapping[str, Real]
    above: tuple[bool, ...]
    fell: Mapping[int, float] = field(default_factory=dict)
    count: int = 0

    @property
    def moment(self) -> float:
        """The time as a float."""
        return float(self.time)


class Ended(Exception):  # not an error of a user: the motion cannot continue
    """The reason why a motion cannot continue behind a change."""


@dataclass(frozen=True, eq=False)
class Mode:
    """The equations between two changes.

    rates: with the branches that hold. terms: graph of the terms of the surfaces, of the stops, and
    of the rates of both along the motion, over states, parameters and the time.
    """

    rates: Rates
    terms: Graph
    ended: str


class Switching:
    """The stages of a problem whose equations change on the way."""

    def __init__(self, problem: Switched) -> None:
        self.problem, self.rates = problem, problem.rates
        self._modes: dict[object, Mode] = {}
        self._jumps: dict[object, Jump] = {}
        self._level_numbers: dict[object, list[Real]] = {}
        self._knots: dict[object, list[tuple[float, int]]] = {}
        self.time = sp.Symbol(self.rates.time, real=True)
        self.moving = {self.time, *(sp.Symbol(name, real=True) for name in self.rates.states)}
        self.surfaces: list[Surface] = []
        self._index: dict[tuple[sp.Expr, sp.Expr], int] = {}
        # For each expression by pieces, each level: the surface and its direction, or a number.
        self.places: dict[pieces, list[tuple[int, bool] | sp.Expr]] = {}
        for part in all_pieces((*self.rates.expressions.values(), *self.rates.stops)):
            self.places[part] = [self._place(part.term, x) for x in part.levels]
        for k, switch in enumerate(problem.switches):
            self._add_condition(k, switch)
        self.terms = list(dict.fromkeys(x.term for x in self.surfaces))
        # Surfaces of terms that are not the time, each with the place of its term.
        self.watched = [
            (k, self.terms.index(x.term), x)
            for k, x in enumerate(self.surfaces)
            if x.term != self.time
        ]
        self.untimed = list(dict.fromkeys(x.term for _, _, x in self.watched))

    # -- surfaces --------------------------------------------------------------------------------

    def _split(self, gap: sp.Expr) -> tuple[sp.Expr, sp.Expr, bool] | None:
        """Term, level and direction of a gap: True where both increase together."""
        constant, rest = gap.as_independent(*self.moving, as_Add=True)
        factor, term = rest.as_coeff_Mul()
        if not term.free_symbols & self.moving:
            return None
        if term.is_Add and not factor.is_negative and term.could_extract_minus_sign():
            factor, term = -factor, -term
        return term, -constant / factor, bool(factor > 0)

    def _surface(self, term: sp.Expr, level: sp.Expr) -> int:
        """Number of a surface, new or not."""
        k = self._index.setdefault((term, level), len(self.surfaces))
        if k == len(self.surfaces):
            self.surfaces.append(Surface(term, level))
        return k

    def _place(self, term: sp.Expr, level: sp.Expr) -> tuple[int, bool] | sp.Expr:
        """A surface at which a branch changes."""
        if has_pieces([term, level]):
            raise ExpressionError(
                f"pieces: expected a term without pieces, got {term}. Write its pieces outside."
            )
        parts = self._split(term - level)
        if parts is None:
            return term - level
        k = self._surface(*parts[:2])
        self.surfaces[k] = replace(self.surfaces[k], is_border=True)
        return k, parts[2]

    def _add_condition(self, number: int, switch: When) -> None:
        """A surface at which a condition falls."""
        parts = None if has_pieces([switch.falls]) else self._split(switch.falls)
        if parts is None:
            raise ExpressionError(
                f"events: expected a condition that changes during the motion and has no pieces, "
                f"got When({switch.falls}). Give an expression in the states or the time."
            )
        k, falls_down = self._surface(*parts[:2]), parts[2]
        one = self.surfaces[k]
        down = (*one.down, number) if falls_down else one.down
        up = one.up if falls_down else (*one.up, number)
        self.surfaces[k] = replace(one, down=down, up=up)

    # -- modes -----------------------------------------------------------------------------------

    @cached_property
    def _levels(self) -> Graph:
        """Levels, then the levels of pieces that do not change, over the parameters."""
        return graph(self.rates.parameters, [*(x.level for x in self.surfaces), *self._still])

    @cached_property
    def _still(self) -> list[sp.Expr]:
        """Gaps of pieces whose term does not change."""
        return [x for rows in self.places.values() for x in rows if isinstance(x, sp.Expr)]

    def numbers(self, parameters: Mapping[str, Real], bits: int = 53) -> list[Real]:
        """Levels of the surfaces, then of pieces that do not change; floats up to 53 bits."""
        values = tuple(parameters[x] for x in self.rates.parameters)
        key = values, bits
        if key not in self._level_numbers:
            numbers = self._levels.exactly(list(values), max(bits, 53 + 20))
            self._check_order(floats(numbers))
            self._level_numbers[key] = floats(numbers) if bits == 53 else numbers
        return self._level_numbers[key]

    def _check_order(self, numbers: Sequence[float]) -> None:
        """Refuse values of parameters for which the levels of pieces do not increase."""
        still = dict(zip(self._still, numbers[len(self.surfaces) :], strict=True))
        for part, rows in self.places.items():
            if all(level.is_number for level in part.levels):
                continue
            places = [x for x in rows if not isinstance(x, sp.Expr)]
            if len({self.surfaces[k].term for k, _ in places}) > 1:
                # Levels that move have no order of their own.
                continue
            levels = [numbers[k] if up else -numbers[k] for k, up in places]
            levels = levels or [-still[x] for x in rows if isinstance(x, sp.Expr)]
            if levels != sorted(levels):
                words = ", ".join(map(str, part.levels))
                raise Ended(f"the levels {words} of pieces in {part.term} do not increase")

    def times(self, parameters: Mapping[str, Real]) -> list[tuple[float, int]]:
        """Times at which something changes, in order, each with its surface."""
        values = tuple(parameters[x] for x in self.rates.parameters)
        if values not in self._knots:
            levels = self.numbers(parameters)
            rows = [
                (float(levels[k]), k) for k, x in enumerate(self.surfaces) if x.term == self.time
            ]
            self._knots[values] = sorted(rows)
        return self._knots[values]

    def mode(self, position: Position) -> Mode:
        """The equations on the sides of a position."""
        still: dict[sp.Expr, bool] = {}
        if self._still:
            values = self.numbers(position.parameters)[len(self.surfaces) :]
            still = {x: bool(value >= 0) for x, value in zip(self._still, values, strict=True)}
        key = position.above, tuple(still.values())
        if key not in self._modes:

            def choice(part: pieces) -> int:
                passed = [
                    still[x] if isinstance(x, sp.Expr) else position.above[x[0]] == x[1]
                    for x in self.places[part]
                ]
                return sum(passed)

            self._modes[key] = self._made(choice)
        mode = self._modes[key]
        if mode.ended:
            raise Ended(mode.ended)
        return mode

    def _made(self, choice: Choice) -> Mode:
        """The equations with the branches of a choice."""
        rates = self.rates
        expressions = {name: resolved(x, choice) for name, x in rates.expressions.items()}
        stops = tuple(resolved(x, choice) for x in rates.stops)
        marks = sorted(
            {str(y.args[0]) for x in (*expressions.values(), *stops) for y in x.atoms(ends)}
        )
        clocked = rates.has_clock or any(x.has(self.time) for x in self.untimed)
        one = replace(rates, expressions=expressions, stops=stops, is_clocked=clocked)
        if marks:
            return Mode(one, graph((), []), f"a table of {marks[0]} has no rows beyond")
        watched = [*self.terms, *stops]
        slopes = [along(x, expressions, self.time) for x in watched]
        return Mode(one, graph(rates.names, [*watched, *slopes], factor=False), "")

    def looked(self, mode: Mode, position: Position) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Values, slopes and sizes of the terms of the surfaces, then of the stops."""
        numbers = [position.parameters[x] for x in self.rates.parameters]
        arguments = floats([*position.states, *numbers, position.moment])
        with np.errstate(all="ignore"):
            values = np.asarray(mode.terms.numpy()(*arguments), dtype=float).reshape(2, -1)
            sizes = np.asarray(mode.terms.sizes(*arguments), dtype=float).reshape(2, -1)
        return values[0], values[1], sizes[0]

    # -- from side to side -----------------------------------------------------------------------

    def settled(
        self,
        position: Position,
        elapsed: float,
        bits: int,
        *,
        crossed: int | None = None,
        acts: bool = True,
    ) -> Position:
        """The sides on which the motion continues, after all conditions that fall now have acted.

        elapsed: time since the last change. crossed: the surface that was reached; None: a change
        at a time. acts: whether borders count as changes, which they do not at the start.
        """
        met = set() if crossed is None else {crossed}
        returned: set[int] = set()
        if crossed is not None:
            position = self.crossed(self._placed(position, crossed, bits), crossed, bits)
        while True:
            mode = self.mode(position)
            values, slopes, sizes = self.looked(mode, position)
            levels = self.numbers(position.parameters)
            for k, place, surface in self.watched:
                level, slope = float(levels[k]), float(slopes[place])
                gap = float(values[place]) - level
                reach = abs(slope) * (abs(position.moment) + elapsed)
                noise = NOISE * 2.0**-53 * (float(sizes[place]) + abs(level) + reach)
                is_on = abs(gap) <= noise or (k == crossed and self._stays(surface, position))
                if is_on and not slope:
                    side = self._side_at_rest(mode, position, k)
                else:
                    side = slope > 0 if is_on else gap > 0
                if side != position.above[k]:
                    break
            else:
                return position
            if k not in met:
                met.add(k)
                position = self.crossed(position, k, bits, acts=acts)
            elif (
                k in returned
                or surface.is_border
                or not self._may_return(surface, position.above[k])
            ):
                raise Ended(self._sliding(surface))
            else:
                # It leaves on the side from which it came, as a ball does from a wall.
                returned.add(k)
                sides = [not x if j == k else x for j, x in enumerate(position.above)]
                position = replace(position, above=tuple(sides))

    def _side_at_rest(self, mode: Mode, position: Position, k: int) -> bool:
        """The side on which a motion continues from a surface on which its term is at rest."""
        surface, rates = self.surfaces[k], mode.rates
        slope = along(surface.term, rates.expressions, self.time)
        bend = along(slope, rates.expressions, self.time)
        numbers = [position.parameters[x] for x in self.rates.parameters]
        arguments = floats([*position.states, *numbers, position.moment])
        value = float(graph(rates.names, [bend], factor=False).numpy()(*arguments)[0])
        if not value:
            # It stays, and the conditions wait for a fall.
            waits = surface.down or surface.up
            return bool(surface.down) if waits else position.above[k]
        if surface.acting(down=value < 0):
            raise Ended(
                f"it rests on {surface.term} = {surface.level}, where a condition would fall again "
                "and again"
            )
        return value > 0

    def _placed(self, position: Position, k: int, bits: int) -> Position:
        """A position that has reached a surface; a state that is the term is exactly on it.

        An engine that measures errors by the size of a state would take very small steps from a
        state that is as small as a rounding.
        """
        name = str(self.surfaces[k].term)
        if name not in self.rates.states:
            return position
        states = list(position.states)
        states[self.rates.states.index(name)] = self.numbers(position.parameters, bits)[k]
        return replace(position, states=states)

    def _stays(self, surface: Surface, position: Position) -> bool:
        """Whether the changes at a surface leave its term as it is."""
        touched = {
            name for k in (*surface.down, *surface.up) for name in self.problem.switches[k].changes
        }
        return not touched & {
            x.name for x in (surface.term.free_symbols | surface.level.free_symbols)
        }

    def _may_return(self, surface: Surface, above: bool) -> bool:
        """Whether a motion may leave a surface where it came, and nothing falls again at once."""
        acting, opposite = surface.acting(down=not above), surface.acting(down=above)
        changed = {name for k in acting for name in self.problem.switches[k].changes}
        moved = changed & {*self.rates.states} - {*self.problem.resting}
        return bool(moved) or not opposite

    def _sliding(self, surface: Surface) -> str:
        return (
            f"it slides along {surface.term} = {surface.level}, because the equations on both "
            "sides carry it back at once"
        )

    def crossed(self, position: Position, k: int, bits: int, *, acts: bool = True) -> Position:
        """The position on the other side of a surface, after its conditions have acted."""
        surface, down = self.surfaces[k], position.above[k]
        above = tuple(not x if j == k else x for j, x in enumerate(position.above))
        entries = surface.acting(down=down)
        if not entries and not (surface.is_border and acts):
            return replace(position, above=above)
        time = position.moment
        if entries and k in position.fell and time - position.fell[k] <= STANDSTILL * abs(time):
            raise Ended(
                f"infinitely many events at {surface.term} = {surface.level} follow each other in "
                "a finite time"
            )
        fell = {**position.fell, k: time} if entries else position.fell
        if position.count >= MOST_STAGES:
            raise Ended(f"more than {MOST_STAGES:,} events have happened")
        changes: dict[str, Any] = {}
        for entry in entries:
            changes |= self.problem.switches[entry].changes
        after = replace(position, above=above, fell=fell, count=position.count + 1)
        key = k, entries
        if key not in self._jumps:
            self._jumps[key] = Jump.of(
                self.rates, self.problem.varied, changes, surface.term, surface.level
            )
        return self._jumped(self._jumps[key], position, after, bits)

    def acted(self, position: Position, event: At, number: int, bits: int) -> Position:
        """The position after a change at a time."""
        key = "time", number
        if key not in self._jumps:
            at = event.time if isinstance(event.time, sp.Expr) else None
            self._jumps[key] = Jump.of(self.rates, self.problem.varied, event.changes, None, at)
        return self._jumped(self._jumps[key], position, position, bits)

    def _jumped(self, jump: Jump, before: Position, after: Position, bits: int) -> Position:
        """States and parameters behind a change; derivatives include the shift of its time."""
        names, size = self.rates.parameters, jump.size

        def values(position: Position) -> list[Real]:
            numbers = [position.parameters[x] for x in names]
            return [*position.states, *numbers, position.time]

        arguments = values(before)
        try:
            states, parameters = jump.changed(
                before.states, dict(after.parameters), arguments, bits
            )
            moved = replace(after, states=states, parameters=parameters)
            if self.problem.varied:
                rates = [
                    self.mode(one).rates.rate_graph.exactly(values(one), bits)[:size]
                    for one in (before, moved)
                ]
                states = jump.derivatives(states, arguments, rates[0], rates[1], bits)
        except ZeroDivisionError:
            raise Ended(
                f"a change at t = {before.moment:.6g} has no finite value, as where a motion only "
                "touches a surface"
            ) from None
        return replace(moved, states=states)

    def sides(self, position: Position) -> Position:
        """On which sides of all surfaces a position is; nothing acts."""
        levels = [float(x) for x in self.numbers(position.parameters)]
        numbers = [position.parameters[x] for x in self.rates.parameters]
        arguments = floats([*position.states, *numbers, position.moment])
        function = graph(self.rates.names, self.terms, factor=False).numpy()
        with np.errstate(all="ignore"):
            values = dict(zip(self.terms, function(*arguments), strict=True))
        above = []
        for surface, level in zip(self.surfaces, levels, strict=False):
            # On a level the conditions there may fall at once.
            from_below = bool(surface.up) and not surface.down
            value = values[surface.term]
            above.append(bool(value > level if from_below else value >= level))
        return replace(position, above=tuple(above))
