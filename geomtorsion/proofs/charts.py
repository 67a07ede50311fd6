"""Charts: curves in a space for proofs, and sets carried from one chart to another."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp
from flint import arb, arb_mat, fmpq

from geomtorsion.codegen import Graph, graph
from geomtorsion.codegen.balls import BallCode, exact_ball
from geomtorsion.curves import CurveProblem
from geomtorsion.curves.atlas import Chart, TransitionMap
from geomtorsion.curves.equations import Equations
from geomtorsion.errors import ProofError
from geomtorsion.proofs.courses import Position, Stretch
from geomtorsion.proofs.events import Fall
from geomtorsion.proofs.motions import Leg
from geomtorsion.proofs.series import BallSystem
from geomtorsion.proofs.sets import LohnerSet
from geomtorsion.support.caching import cached_property
from geomtorsion.support.precision import PRINTED


@dataclass(frozen=True, eq=False)
class SetMap:
    """A map of states with its derivative, over states and parameters.

    states: names of the arguments that the set is about; values: the graph of the map.
    """

    states: tuple[str, ...]
    values: Graph

    @cached_property
    def _slopes(self) -> BallCode:
        return BallCode(self.values.derivative(self.states))

    def __call__(self, whole: LohnerSet, parameters: Sequence[arb]) -> LohnerSet:
        """The set around the image of a set: the mean value theorem on its hull.

        Raises
        ------
        ProofError
            the map has no derivative on the hull.
        """
        n = len(self.states)
        values = BallCode(self.values).real([*whole.middle, *parameters])
        slopes = self._slopes.real([*whole.hull, *parameters])
        if not all(x.is_finite() for x in (*values, *slopes)):
            raise ProofError("a change of charts is not smooth on the whole set of motions")
        rows = [slopes[k : k + n] for k in range(0, len(slopes), n)]
        return whole.moved(values, arb_mat(rows))


@dataclass(frozen=True, eq=False)
class CurveCourse:
    """A curve in a space, followed through the charts in which its solution was.

    backwards: whether it runs to negative times.
    start, parameters: numbers or balls that replace the values of the problem.
    by: names of `variables` of the problem by which derivatives are taken. Then all parameters and
        constant velocities on which something depends are states, after all others.
    """

    problem: CurveProblem
    backwards: bool
    start: Sequence[Any] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)
    by: tuple[str, ...] = ()

    def stretches(self, times: Sequence[fmpq], hints: Sequence[Stretch]) -> list[Stretch]:
        """The charts of the solution, the last one on to where a stopped curve may end."""
        *before, last = hints
        if self.problem.stops and times[-1] > last.end:
            last = replace(last, end=times[-1], samples=(*last.samples, times[-1]))
        return [*before, last]

    def names(self, label: str) -> tuple[str, ...]:
        """Coordinates of the chart, velocities if they change, carried quantities."""
        equations = self.problem.equations(label)
        return tuple(name for name in equations.states if name != equations.clock)

    def shown(self, label: str, box: Sequence[arb]) -> list[arb]:
        """Velocities in units of the time of users."""
        equations, unit = self.problem.equations(label), arb(self.problem.time_unit)
        numbers = list(box[: len(equations.states)])
        first = equations.width
        if equations.clock:
            numbers.pop(equations.plain_width - 1)
        if equations.moves:
            n = len(equations.velocities)
            numbers[first : first + n] = [x * unit for x in numbers[first : first + n]]
            first += n
        carried = self.problem.carried
        for k, power in enumerate(carried.speed_powers if carried else ()):
            if power:
                numbers[first + k] = numbers[first + k] * unit
        return numbers

    def _values(self) -> dict[str, Any]:
        return {**self.problem.parameters, **self.parameters}

    def enter(self, stretch: Stretch, before: Position | None) -> tuple[Position, Leg]:
        """The set in the chart of a stretch, with the equations there."""
        problem = self.problem
        if before is None:
            point = self._start()
            source = "" if problem.start is None else problem.atlas.home
        else:
            point, source = before.whole, before.label
            if before.constant:
                point = extended(point, problem.equations(source).width, before.constant)
            elif self.by and not problem.equations(source).moves:
                point = self._velocities_first(point, problem.equations(source))
        if source != stretch.label:
            point = self._moved(point, source, stretch.label)
            angles = problem.atlas.route(source, stretch.label)[-1].angles
            point = turned(point, angles, stretch.reference)
        equations = problem.equations(stretch.label)
        constant: tuple[arb, ...] = ()
        if not equations.moves:
            places = range(equations.width, equations.width + len(equations.velocities))
            constant = tuple(point.hull[k] for k in places)
            point = permuted_last(point, places) if self.by else without(point, places)
        position = Position(point, stretch.label, () if self.by else constant)
        return position, self._leg(stretch, equations, constant)

    def _varied(self, equations: Equations) -> tuple[str, ...]:
        """Parameters of the equations that are states, because derivatives are taken by them."""
        if not self.by:
            return ()
        return (*self._varied_parameters, *(() if equations.moves else equations.velocities))

    @property
    def _varied_parameters(self) -> tuple[str, ...]:
        return tuple(name for name in self.problem.parameters if name in self.by)

    def _velocities_first(self, point: LohnerSet, equations: Equations) -> LohnerSet:
        """The set with constant velocities, its last states, after the coordinates again."""
        size, n = len(point.middle), len(equations.velocities)
        rest = range(equations.width, size - n)
        return permuted_last(point, rest)

    def _leg(self, stretch: Stretch, equations: Equations, constant: Sequence[arb]) -> Leg:
        table = {**self._values(), **equations.constants}
        table |= dict(zip(equations.velocities, constant, strict=False))
        varied = self._varied(equations)
        rest = [name for name in equations.parameters if name not in varied]

        def parameters() -> list[arb]:
            return [exact_ball(table[name]) for name in equations.parameters]

        def others() -> list[arb]:
            return [exact_ball(table[name]) for name in rest]

        system = BallSystem.of(equations.system, others, backwards=self.backwards, varied=varied)
        inside, words = conditions_of(equations, (*equations.states, *varied, *rest))
        fall = None
        if self.problem.stops:
            (term,) = self.problem.stop_terms(stretch.label)
            stop_graph = graph((*equations.states, *equations.parameters, ""), [term], factor=False)
            fall = Fall(system, stop_graph, equations.states, parameters, None)
        return Leg(system, stretch.begin, stretch.end, stretch.samples, fall, inside, words)

    def _start(self) -> LohnerSet:
        """Home coordinates, velocities and carried quantities, in units of the speed."""
        problem = self.problem
        unit = arb(problem.time_unit)
        coordinates = [exact_ball(x) for x in self.start or problem.start or ()]
        rates, slopes = self._velocities(coordinates)
        velocities = [x / unit for x in rates]
        carried = []
        if problem.carried is not None:
            pairs = zip(problem.carried.start, problem.carried.speed_powers, strict=True)
            carried = [exact_ball(x) / unit if power else exact_ball(x) for x, power in pairs]
        # Equations with a clock have one chart, where the motion begins at zero.
        clock = [arb(0)] if problem.equations().clock else []
        varied = self._varied_parameters
        values = self._values()
        columns = [
            [
                *(arb(int(name == x)) for x in problem.coordinates[: len(coordinates)]),
                *(slope / unit for slope in column),
                *(arb(0) for _ in clock),
                *(arb(int(name == x)) for x in varied),
            ]
            for name, column in zip(self.by, slopes, strict=True)
        ]
        constants = [exact_ball(values[name]) for name in varied]
        return LohnerSet.of([*coordinates, *velocities, *clock, *carried, *constants], columns)

    def _velocities(self, coordinates: Sequence[arb]) -> tuple[list[arb], list[list[arb]]]:
        """u^i, from q'^mu where that was given, and its derivatives by each of `by`."""
        problem = self.problem
        velocity = problem.coordinate_velocity
        if velocity is None or problem.start is None:
            speeds = list(problem.variables)[-len(problem.frame_velocity) :]
            columns = [[arb(int(name == x)) for x in speeds] for name in self.by]
            return [exact_ball(x) for x in problem.frame_velocity], columns
        chart = problem.chart(problem.atlas.home)
        rates = [f"rate {name}" for name in chart.names]
        rows: list[list[Any]] = [[] for _ in problem.frame_velocity]
        for (i, mu), element in chart.coframe.entries.items():
            rows[i].append((element, (rates[mu],)))
        table = self._values()
        form = graph([*chart.names, *rates, *table], [tuple(x) for x in rows], factor=False)
        numbers = [*coordinates, *(exact_ball(x) for x in (*velocity, *table.values()))]
        speeds = {f"{name}'": rate for name, rate in zip(chart.names, rates, strict=True)}
        columns = [
            BallCode(form.derivative([speeds.get(name, name)])).real(numbers) for name in self.by
        ]
        return BallCode(form).real(numbers), columns

    def _frame_parameters(self) -> tuple[list[str], list[arb]]:
        """Names and values of the quantities in charts that are not states."""
        table = {k: x for k, x in self._values().items() if k not in self._varied_parameters}
        return list(table), [exact_ball(x) for x in table.values()]

    # -- from chart to chart ---------------------------------------------------------------------

    def _moved(self, point: LohnerSet, source: str, target: str) -> LohnerSet:
        """Coordinates, velocities and carried quantities, in another chart."""
        atlas = self.problem.atlas
        turning = not atlas.same_frame(source, target)
        carried = (*self.problem.equations(source).carried, *self._varied_parameters)
        names, values = self._frame_parameters()
        if turning:
            point = _legs_map(atlas.chart(source), carried, names)(point, values)
        for change in atlas.route(source, target):
            point = self._changed(point, change, carried, turning=turning)
        if turning:
            point = _coframe_map(atlas.chart(target), carried, names)(point, values)
        return point

    def _changed(
        self, point: LohnerSet, change: TransitionMap, carried: Sequence[str], *, turning: bool
    ) -> LohnerSet:
        """One map of an atlas."""
        names, values = self._frame_parameters()
        rest = len(point.middle) - len(change.coordinates) - len(carried)
        change_map = _change_map(change, rest, carried, names, turning=turning)
        image = change_map(point, values)
        if change.written is None:
            return image
        # Where a map is written with cases, its expressions are one of these: of the two points of
        # a quaternion that are one rotation, the other one may be meant.
        place = [float(x) for x in point.middle[: len(change.coordinates)]]
        table = {name: float(exact_ball(x).mid()) for name, x in self._values().items()}
        there = change(place, table)
        if _are_near(image, there):
            return image
        if self.problem.chart(change.source).kept is not None:
            opposite = _negated(point, len(change.coordinates))
            image = change_map(opposite, values)
            if _are_near(image, there):
                return image
        raise ProofError(
            f"the change from chart {change.source!r} to {change.target!r} is defined by cases, "
            "and none of them is proved here. Follow the motion in other charts, "
            "with_charts(...)."
        )


def turned(point: LohnerSet, angles: Sequence[int], near: Sequence[float]) -> LohnerSet:
    """The set with some states shifted by whole turns to near where they are given."""
    middle = list(point.middle)
    radii = [arb(0)] * len(middle)
    for k in angles:
        turns = round((near[k] - float(middle[k])) / (2 * math.pi))
        if turns:
            shifted = middle[k] + 2 * turns * arb.pi()
            middle[k], radii[k] = shifted.mid(), arb(shifted.rad())
    return widened(replace(point, middle=tuple(middle)), radii)


def _legs_map(chart: Chart, carried: Sequence[str], parameters: Sequence[str]) -> SetMap:
    """(q, u, carried) -> (q, q' = E u, carried)."""
    columns = chart.frame_vectors.shape[1]
    velocities = [f"velocity {k}" for k in range(columns)]
    rows = [tuple((x, (velocities[i],)) for i, x in row) for row in chart.legs]
    return _with_rest(chart.names, velocities, rows, carried, parameters)


def _coframe_map(chart: Chart, carried: Sequence[str], parameters: Sequence[str]) -> SetMap:
    """(q, q', carried) -> (q, u = e q', carried)."""
    rates = [f"velocity {k}" for k in range(len(chart.names))]
    rows: list[list[Any]] = [[] for _ in range(chart.coframe.shape[0])]
    for (i, mu), element in chart.coframe.entries.items():
        rows[i].append((element, (rates[mu],)))
    return _with_rest(chart.names, rates, [tuple(x) for x in rows], carried, parameters)


def _with_rest(
    coordinates: Sequence[str],
    velocities: Sequence[str],
    rows: Sequence[Any],
    carried: Sequence[str],
    parameters: Sequence[str],
) -> SetMap:
    """A map of velocities that changes nothing else."""
    states = (*coordinates, *velocities, *carried)
    outputs = [*map(sp.Symbol, coordinates), *rows, *map(sp.Symbol, carried)]
    return SetMap(states, graph([*states, *parameters], outputs, factor=False))


def _change_map(
    change: TransitionMap,
    velocities: int,
    carried: Sequence[str],
    parameters: Sequence[str],
    *,
    turning: bool,
) -> SetMap:
    """(q, velocities, carried) in other coordinates; coordinate velocities turn with them."""
    names = [sp.Symbol(f"velocity {k}") for k in range(velocities)]
    moved: list[sp.Expr] = list(names)
    if turning:
        pairs = list(zip(change.coordinates, names, strict=True))
        moved = [sp.Add(*(x.diff(q) * v for q, v in pairs)) for x in change.expressions]
    outputs = [*change.expressions, *moved, *map(sp.Symbol, carried)]
    states = (*(q.name for q in change.coordinates), *(v.name for v in names), *carried)
    return SetMap(states, graph([*states, *parameters], outputs, factor=False))


def _are_near(point: LohnerSet, there: Iterable[float]) -> bool:
    """Whether coordinates equal those computed with floats, up to rounding."""
    pairs = zip(point.middle, there, strict=False)
    return all(abs(float(x) - float(y)) <= PRINTED * (1 + abs(float(y))) for x, y in pairs)


def _negated(point: LohnerSet, count: int) -> LohnerSet:
    """The first states with the other sign."""
    signs = [-1 if k < count else 1 for k in range(len(point.middle))]
    middle = tuple(s * x for s, x in zip(signs, point.middle, strict=True))
    rows = [[s * point.axes[i, j] for j in range(point.axes.ncols())] for i, s in enumerate(signs)]
    columns = tuple(_negated(column, count) for column in point.columns)
    return LohnerSet(middle, arb_mat(rows), point.spread, columns)


def extended(point: LohnerSet, place: int, balls: Sequence[arb]) -> LohnerSet:
    """The set with further states inserted at a position, each anywhere in its ball."""
    rows, columns, more = len(point.middle), point.axes.ncols(), len(balls)
    middle = (*point.middle[:place], *(x.mid() for x in balls), *point.middle[place:])
    table = [[point.axes[i, j] for j in range(columns)] + [arb(0)] * more for i in range(rows)]
    new = [[arb(int(j == columns + k)) for j in range(columns + more)] for k in range(more)]
    axes = arb_mat([*table[:place], *new, *table[place:]])
    return LohnerSet(middle, axes, (*point.spread, *(arb(x.rad()) for x in balls)))


def without(point: LohnerSet, places: Sequence[int]) -> LohnerSet:
    """The set without some of its states."""
    return selected(point, [k for k in range(len(point.middle)) if k not in places])


def permuted_last(point: LohnerSet, places: Sequence[int]) -> LohnerSet:
    """The set with some of its states after all others."""
    others = [k for k in range(len(point.middle)) if k not in places]
    return selected(point, [*others, *places])


def selected(point: LohnerSet, indices: Sequence[int]) -> LohnerSet:
    """The set of some of its states, in an order."""
    axes = arb_mat([[point.axes[i, j] for j in range(point.axes.ncols())] for i in indices])
    columns = tuple(selected(column, indices) for column in point.columns)
    return LohnerSet(tuple(point.middle[k] for k in indices), axes, point.spread, columns)


def widened(point: LohnerSet, radii: Sequence[arb]) -> LohnerSet:
    """The set with each state wider by a radius."""
    if all(x.is_zero() for x in radii):
        return point
    rows, columns = len(point.middle), point.axes.ncols()
    table = [
        [point.axes[i, j] for j in range(columns)] + [arb(int(i == j)) for j in range(rows)]
        for i in range(rows)
    ]
    return replace(point, axes=arb_mat(table), spread=(*point.spread, *radii))


def conditions_of(
    equations: Equations, arguments: Sequence[str]
) -> tuple[Graph | None, tuple[str, ...]]:
    """Quantities that stay positive while the equations of a chart hold, and their words.

    arguments: states and parameters, in the order of the graph.
    """
    chart = equations.chart
    if chart is None:
        return None, ()
    outputs: list[Any] = [edge.element for edge in chart.edges]
    words = [edge.words for edge in chart.edges]
    for branch in chart.field.relied_on if chart.frame is not None else ():
        condition = branch.radical * branch.read_as if branch.holds is None else branch.holds
        names = {symbol.name for symbol in branch.radical.free_symbols}
        if names <= {*equations.states, *equations.parameters}:
            outputs.append(condition)
            words.append(str(branch))
    if not outputs:
        return None, ()
    return graph(arguments, outputs, equations.parameters, factor=False), tuple(words)
