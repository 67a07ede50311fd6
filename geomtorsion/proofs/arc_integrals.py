"""Loops: proved integrals of the coframe along the arcs of a loop.

Each component is the sum over the arcs of integral e^i_mu(q(s)) q'^mu(s) ds by `acb.integral`:
Petras' algorithm [Johansson, arXiv:1802.07942], Gauss rules whose errors are bounded on ellipses on
which the integrand is analytic.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import acb, arb, arb_mat

from geomtorsion.codegen import Graph, graph
from geomtorsion.codegen.balls import BallCode, exact_ball, integral
from geomtorsion.errors import MissingValueError, ProofError
from geomtorsion.geometry.derived import derived
from geomtorsion.loops.arcs import Number, shown
from geomtorsion.loops.domain import loop_edges
from geomtorsion.proofs.paths import BallArc, arcs_of
from geomtorsion.proofs.wanted import MOST_BITS, SPARE, Wanted, log2, upper
from geomtorsion.support import checks
from geomtorsion.support.allowance import check_limits
from geomtorsion.support.precision import ball_precision

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame
    from geomtorsion.loops import Loop

# No integral of one component along one arc takes more evaluations: some ten seconds.
MOST_EVALUATIONS = 200_000


@dataclass(frozen=True)
class Integrals:
    """Proved integrals of a loop.

    balls: one for each component; bits: the precision that was used; arcs: how many there are.
    """

    balls: tuple[arb, ...]
    bits: int
    arcs: int


@dataclass(frozen=True, eq=False)
class _Row:
    """One row of the coframe.

    columns: the coordinates of its entries; code: the entries over coordinates and parameters.
    """

    columns: tuple[int, ...]
    code: BallCode


@dataclass(frozen=True, eq=False)
class _Condition:
    """Where a branch or the declared domain holds.

    code: the quantity that must be positive; or, where `positive` is false, the root as written and
    as read, which must be equal and not opposite.
    words: the condition; advice: where to move the loop.
    """

    words: str
    advice: str
    positive: bool
    code: BallCode


@dataclass(frozen=True, eq=False)
class Coframe:
    """A coframe as functions of balls.

    parameters: their names, after the coordinates among the arguments.
    rows: index of the frame -> its entries; every: all entries at once, for real balls.
    """

    parameters: tuple[str, ...]
    rows: Mapping[int, _Row]
    every: BallCode
    conditions: tuple[_Condition, ...]

    @classmethod
    def of(cls, frame: Frame) -> Coframe:
        """The coframe of a frame, made once."""
        return _compiled(frame)

    def matrix(self, n: int, arguments: Sequence[arb]) -> arb_mat:
        """e^i_mu at one point."""
        rows = [[arb(0)] * n for _ in range(n)]
        for i, row in self.rows.items():
            for mu, value in zip(row.columns, row.code.real(arguments), strict=True):
                rows[i][mu] = value
        return arb_mat(rows)


def values_of(coframe: Coframe, parameters: Mapping[str, Number]) -> list[arb]:
    """The parameters of a coframe in balls, at the precision in use.

    Raises
    ------
    MissingValueError
        one has no value.
    """
    remedy = "Give parameters={'{missing}': ...}."
    checks.check_values(coframe.parameters, parameters, "parameters", MissingValueError, remedy)
    return [exact_ball(parameters[name]) for name in coframe.parameters]


@derived
def _compiled(frame: Frame) -> Coframe:
    entries = frame.coframe.components.nonzero
    coordinates = [symbol.name for symbol in frame.coordinates]
    needed = {symbol.name for x in entries.values() for symbol in x.symbols}
    branches = frame.field.relied_on
    needed |= {symbol.name for x in branches for symbol in x.radical.free_symbols}
    edges = loop_edges(frame)
    needed |= {symbol.name for edge in edges for symbol in edge.element.symbols}
    parameters = tuple(s.name for s in frame.field.symbols if s.name in needed - set(coordinates))
    names = [*coordinates, *parameters]

    def made(outputs: Sequence, *, factor: bool = True) -> Graph:
        return graph(names, outputs, parameters, factor=factor)

    by_row: dict[int, dict[int, object]] = {}
    for (i, mu), value in entries.items():
        by_row.setdefault(i, {})[mu] = value
    rows = {i: _Row(tuple(row), BallCode(made(list(row.values())))) for i, row in by_row.items()}
    side = "Move the loop to where the branch holds, or state a domain around the loop."
    conditions = [
        _Condition(str(x), side, True, BallCode(made([x.holds], factor=False)))
        if x.holds is not None
        else _Condition(str(x), side, False, BallCode(made([x.radical, x.read_as], factor=False)))
        for x in branches
    ]
    conditions += [
        _Condition(x.condition, "Move the loop inside.", True, BallCode(made([x.element])))
        for x in edges
    ]
    return Coframe(parameters, rows, BallCode(made(list(entries.values()))), tuple(conditions))


def proved_integrals(
    frame: Frame,
    loop: Loop,
    parameters: Mapping[str, Number],
    wanted: Wanted,
    *,
    is_exact: bool = True,
) -> Integrals:
    """Integrals of all rows of a coframe around a loop, with the requested accuracy where possible.

    is_exact: whether parameters are numbers, and not wider balls, of which no bits get rid.

    Raises
    ------
    ProofError
        the loop meets a pole, or the edge of a function or of a branch, or is nearer to one than
        this method can resolve.
    MissingValueError
        a parameter has no value.
    """
    coframe = Coframe.of(frame)
    size = loop.size / max(abs(x) for part in loop.parts for x in (*part.centre, part.size))
    bits = wanted.bits + SPARE + math.ceil(-math.log2(size))
    while True:
        with ball_precision(bits):
            integrals = _integrals(coframe, loop, frame.dimension, parameters, bits)
            lost = missing_bits(integrals.balls, wanted)
        if not lost or bits >= MOST_BITS or not is_exact:
            return integrals
        bits = min(MOST_BITS, bits + min(max(lost, 8), bits))


def missing_bits(balls: Sequence[arb], wanted: Wanted) -> int:
    """Further bits needed: for the largest component, or to judge an error of zero."""
    radius = max((x.rad() for x in balls), key=log2)
    if radius.is_zero():
        return 0
    largest = max((x.abs_lower() for x in balls), key=log2)
    if largest > 0:
        return max(0, math.ceil(log2(radius) - log2(largest)) + wanted.bits)
    if wanted.error > 0:
        return max(0, math.ceil(log2(radius) - log2(wanted.error)) + 10)
    # Zero cannot be distinguished from any smaller number: use the digits of a product of two
    # numbers.
    size = max((upper(x) for x in balls), key=log2)
    return max(0, math.ceil(log2(size)) + 3 * wanted.bits)


def _integrals(
    coframe: Coframe, loop: Loop, dimension: int, parameters: Mapping[str, Number], bits: int
) -> Integrals:
    """The integrals at one precision, which is in use."""
    values = values_of(coframe, parameters)
    total = [arb(0) for _ in range(dimension)]
    tolerance = arb(loop.size) * arb(2) ** (10 - bits)
    arcs = 0
    for part in loop.parts:
        for arc in arcs_of(part):
            arcs += 1
            check_path(coframe, arc, values, bits)
            for i, row in coframe.rows.items():
                value = integral(_integrand(row, arc, values), tolerance, MOST_EVALUATIONS)
                if not value.is_finite():
                    point = shown(float(x.mid()) for x in arc.places(arb(0.5)))
                    raise ProofError(
                        f"b[{i}] has no enclosure on the arc through {point}: after "
                        f"{MOST_EVALUATIONS:,} evaluations on ever shorter pieces, a pole or the "
                        "edge of a function is still too close, or the coframe changes too "
                        "often. Move the loop further away from that point, or divide it."
                    )
                total[i] += part.times * value.real
    return Integrals(tuple(total), bits, arcs)


def _integrand(row: _Row, arc: BallArc, values: Sequence[arb]) -> Callable[[acb, bool], acb]:
    """e^i_mu(q(s)) q'^mu(s) of one row."""
    n, moving = arc.dimension, [(k, mu) for k, mu in enumerate(row.columns) if arc.moving[mu]]
    if not moving:
        return lambda s, analytic: acb(0)
    function, numbers, path = row.code.complex_function(), row.code.numbers(), arc.path

    def integrand(s: acb, analytic: bool) -> acb:
        check_limits()
        point = path(s, analytic)
        entries = function([*point[:n], *values], numbers, analytic)
        return sum((entries[k] * point[n + mu] for k, mu in moving), acb(0))

    return integrand


def check_path(coframe: Coframe, arc: BallArc, values: Sequence[arb], bits: int) -> None:
    """Refuse a path on which the coframe has no finite value, or a root not its sign.

    By halving the path, on real balls, down to the resolution of the bits.
    """
    codes = [coframe.every, *(x.code for x in coframe.conditions)]
    functions = [(code.real_function(), code.numbers()) for code in codes]
    waiting = [(arb(0), arb(1), 0)]
    while waiting:
        check_limits()
        low, high, depth = waiting.pop()
        places = arc.places(low.union(high))
        arguments = [*places, *values]
        entries, *checked = (function(arguments, numbers) for function, numbers in functions)
        finite = all(x.is_finite() for x in entries)
        verdicts = [_holds(x, y) for x, y in zip(coframe.conditions, checked, strict=True)]
        if finite and all(verdict is True for verdict in verdicts):
            continue
        broken = [x for x, y in zip(coframe.conditions, verdicts, strict=True) if y is not True]
        if False in verdicts or depth > bits:
            point = shown(float(x.mid()) for x in places)
            if finite and broken:
                raise ProofError(
                    f"the loop leaves the domain near {point}: {broken[0].words}. "
                    f"{broken[0].advice}"
                )
            raise ProofError(
                f"the coframe has no finite value near {point}: a pole or an edge is on the loop, "
                f"or closer to it than {bits} bits resolve. Move the loop away from that point."
            )
        middle = ((low + high) / 2).mid()
        waiting += [(middle, high, depth + 1), (low, middle, depth + 1)]


def _holds(condition: _Condition, found: Sequence[arb]) -> bool | None:
    """Whether a branch holds on real balls; None where these do not decide."""
    if condition.positive:
        (value,) = found
        return True if value > 0 or value.is_zero() else False if value < 0 else None
    one, other = found
    if not one.overlaps(other):
        return False
    return None if one.overlaps(-other) and not one.is_zero() else True
