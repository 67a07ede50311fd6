"""Developments: rows of G' = G Omega(s) along the arcs of a loop, motions like any other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import arb, arb_mat, ctx, fmpq

from geomtorsion.codegen import Graph, graph
from geomtorsion.codegen.balls import exact_ball
from geomtorsion.codegen.steps import Builder
from geomtorsion.errors import ProofError
from geomtorsion.geometry.derived import derived
from geomtorsion.ode.system import System
from geomtorsion.proofs.arc_integrals import Coframe, check_path, values_of
from geomtorsion.proofs.motions import Leg, RefusalError, follow
from geomtorsion.proofs.paths import BallArc, S, arcs_of
from geomtorsion.proofs.series import BallSystem
from geomtorsion.proofs.sets import LohnerSet
from geomtorsion.proofs.steps import Method
from geomtorsion.proofs.wanted import MOST_BITS, SPARE, Wanted, log2
from geomtorsion.support.precision import ball_precision

if TYPE_CHECKING:
    from geomtorsion.geometry import Connection, Frame
    from geomtorsion.loops import Loop


@dataclass(frozen=True)
class DevelopedBalls:
    """A proved development.

    matrix: [[rotation, burgers], [0, 1]] in balls; bits, steps: used.
    """

    matrix: arb_mat
    bits: int
    steps: int

    @property
    def dimension(self) -> int:
        """Number of legs, n."""
        return self.matrix.nrows() - 1

    @property
    def burgers(self) -> list[arb]:
        """b^i."""
        return [self.matrix[i, self.dimension] for i in range(self.dimension)]

    @property
    def rotation(self) -> list[list[arb]]:
        """R^j_i, row by row."""
        rows = range(self.dimension)
        return [[self.matrix[i, j] for j in rows] for i in rows]


def proved_development(
    connection: Connection,
    loop: Loop,
    parameters: Mapping[str, Any],
    wanted: Sequence[Wanted],
    *,
    is_exact: bool = True,
) -> DevelopedBalls:
    """The development of a loop, with the requested accuracy of burgers and of rotation - 1.

    is_exact: whether parameters are numbers, and not wider balls, of which no bits get rid.

    Raises
    ------
    ProofError
        the loop meets a pole or an edge, or is too near to one.
    """
    bits = max(x.bits for x in wanted) + SPARE
    while True:
        with ball_precision(bits):
            try:
                development = _developed(connection, loop, parameters)
                missing = _missing_bits(development, wanted)
            except RefusalError as error:
                development, missing = None, bits
                if error.width is None or bits >= MOST_BITS:
                    raise ProofError(
                        f"the development is not proved: {error.reason} along an arc. Move the "
                        "loop further away from poles and edges."
                    ) from None
        if development is not None and (not missing or bits >= MOST_BITS or not is_exact):
            return development
        bits = min(MOST_BITS, bits + min(max(missing, 8), bits))


def _missing_bits(found: DevelopedBalls, wanted: Sequence[Wanted]) -> int:
    """How many bits more are needed, of the translation and of the turn."""
    n = found.dimension
    turn = [x - int(i == j) for i, row in enumerate(found.rotation) for j, x in enumerate(row)]
    assert n * n == len(turn)
    return max(_missing(found.burgers, wanted[0]), _missing(turn, wanted[1]))


def _missing(balls: Sequence[arb], wanted: Wanted) -> int:
    radius = max(log2(x.rad()) for x in balls)
    largest = max((x.abs_lower() for x in balls), key=log2)
    size = log2(largest) if largest > 0 else None
    if size is None and wanted.error > 0:
        size = log2(wanted.error) + wanted.bits - 10
    # An exactly zero turn or translation: as accurate as the requested digits of the number 1.
    return max(0, int(radius + wanted.bits - (0.0 if size is None else size)) + 1)


def _developed(connection: Connection, loop: Loop, parameters: Mapping[str, Any]) -> DevelopedBalls:
    """The development at the precision in use."""
    n, coframe = connection.frame.dimension, Coframe.of(connection.frame)
    checked = values_of(coframe, parameters)
    total, steps = _unit(n + 1), 0
    for part in loop.parts:
        once, first, last = _unit(n + 1), None, None
        for arc in arcs_of(part):
            check_path(coframe, arc, checked, ctx.prec)
            rows, count = _along(connection, arc, parameters)
            once, steps = once * rows, steps + count
            first = arc.places(arb(0)) if first is None else first
            last = arc.places(arb(1))
        if part.gap:
            assert first is not None
            assert last is not None
            once = once * _back(coframe, n, first, last, checked)
        one = once if part.times > 0 else once.inv()
        for _ in range(abs(part.times)):
            total = total * one
    return DevelopedBalls(total, ctx.prec, steps)


def _unit(n: int) -> arb_mat:
    return arb_mat([[int(i == j) for j in range(n)] for i in range(n)])


def _back(
    coframe: Coframe, n: int, first: Sequence[arb], last: Sequence[arb], values: Sequence[arb]
) -> arb_mat:
    """The turn from the legs at a point to those whole periods further on, at the same point."""
    here, there = (coframe.matrix(n, [*point, *values]) for point in (first, last))
    turn = there * here.inv()
    rows = [[turn[i, j] for j in range(n)] + [arb(0)] for i in range(n)]
    return arb_mat([*rows, [arb(0)] * n + [arb(1)]])


def _along(
    connection: Connection, arc: BallArc, parameters: Mapping[str, Any]
) -> tuple[arb_mat, int]:
    """The development along one arc, and the number of steps."""
    n = connection.frame.dimension
    form = _rates(connection.frame, connection)
    system = _system(form, arc, n)
    constants = [exact_ball(parameters[name]) for name in form.arguments[3 * n :]]
    values = [*arc.values, *constants]
    balls = BallSystem.of(system, lambda: values)
    leg = Leg(balls, fmpq(0), fmpq(1), ())
    rows, steps = [], 0
    for j in range(n):
        start = [*(arb(int(k == j)) for k in range(n)), arb(0), arb(0)]
        path = follow(leg, LohnerSet.of(start), Method.of(ctx.prec))
        assert path.whole is not None
        rows.append(path.whole.hull[: n + 1])
        steps += path.steps
    return arb_mat([*rows, [arb(0)] * n + [arb(1)]]), steps


@derived
def _rates(frame: Frame, connection: Connection) -> Graph:
    """g'_i = g_k omega_ai^k q'^a and shift' = g_k e^k_a q'^a over q, q', g and parameters."""
    n = frame.dimension
    coordinates = [symbol.name for symbol in frame.coordinates]
    slopes, row = [f"slope {k}" for k in range(n)], [f"g {k}" for k in range(n)]
    rates: list[list[Any]] = [[] for _ in range(n + 1)]
    for (a, i, k), value in connection.spin_connection.components.nonzero.items():
        rates[i].append((value, (row[k], slopes[a])))
    for (k, a), value in frame.coframe.components.nonzero.items():
        rates[n].append((value, (row[k], slopes[a])))
    needed = {s.name for terms in rates for element, _ in terms for s in element.symbols}
    parameters = sorted(needed - set(coordinates))
    arguments = [*coordinates, *slopes, *row, *parameters]
    return graph(arguments, [tuple(terms) for terms in rates], parameters, factor=False)


def _system(form: Graph, arc: BallArc, n: int) -> System:
    """Rates of a row, of the translation and of s, with the arc inserted."""
    states = (*form.arguments[2 * n : 3 * n], "shift", S.name)
    numbers = [f"arc {name}" for name in arc.graph.arguments[1:]]
    parameters = (*numbers, *form.arguments[3 * n :])
    names = (*states, *parameters)
    builder, inner = Builder(), list[int]()
    positions = {name: k for k, name in enumerate(names)}
    for step in arc.graph.steps:
        if step.kind == "argument":
            name = S.name if step.detail == 0 else numbers[step.detail - 1]
            inner.append(builder.argument(positions[name], constant=step.detail > 0))
        else:
            places = tuple(inner[place] for place in step.operands)
            inner.append(builder.add(step.kind, places, step.detail, signs=step.signs))
    path = [
        inner[place] if sign > 0 else builder.product(builder.number(Fraction(-1)), inner[place])
        for sign, place in arc.graph.outputs
    ]
    outer: list[int] = []
    for step in form.steps:
        if step.kind == "argument" and step.detail < 2 * n:
            outer.append(path[step.detail])
        elif step.kind == "argument":
            name = form.arguments[step.detail]
            outer.append(builder.argument(positions[name], constant=step.detail >= 3 * n))
        else:
            places = tuple(outer[place] for place in step.operands)
            outer.append(builder.add(step.kind, places, step.detail, signs=step.signs))
    outputs = [(sign, outer[place]) for sign, place in form.outputs]
    rates = Graph(names, *builder.needed([*outputs, (1, builder.number(Fraction(1)))]))
    groups = tuple((k,) for k in range(len(states)))
    return System(states, parameters, rates, groups)
