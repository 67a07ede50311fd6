"""Edges: where the coordinates of a frame end, from its domain, its roots and its branches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.errors import ExpressionError, StartError
from geomtorsion.exact import Element
from geomtorsion.exact.generators import Generator
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.evaluation import repeats, sign_of
from geomtorsion.ode.rates import changes_with_sign

if TYPE_CHECKING:
    from collections.abc import Iterator

    from geomtorsion.exact.tower import Tower
    from geomtorsion.geometry import Frame

# Functions without a root of their own that may enter a sum of squares.
_REAL = ("symbol", "cos", "sin", "cosh", "sinh", "exp", "log")


@dataclass(frozen=True)
class Edge:
    """A quantity that is positive as long as the coordinates hold.

    element: an exact element; a motion on which it falls through zero has reached the edge.
    words: event at the edge, for messages; condition: relation that holds inside.
    is_root: whether it is a root of the frame, so that rates have no value beyond it.
    """

    element: Element
    words: str
    condition: str
    is_root: bool = False


@derived
def edges_of(frame: Frame) -> tuple[Edge, ...]:
    """All edges of a frame: its declared domain, roots that vanish, branches that end.

    A root is watched itself, not its radicand: motions that come to rest on the edge touch it, and
    there the radicand has a double zero, which rounding hides, but its root a simple one.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> r, phi = sp.symbols("r phi")
    >>> flat = Frame([r, phi], [[1, 0], [0, r]], domain=[r > 0, phi > 0, phi < 2 * sp.pi])
    >>> [edge.words for edge in edges_of(flat)]
    ['r > 0 holds no longer']
    """
    edges = [
        *_of_domain(frame), *_of_signs(frame), *_of_roots(frame), *_of_branches(frame)
    ]  # fmt: skip
    inside = set(frame.coordinates)
    moving = {edge.element: edge for edge in reversed(edges) if edge.element.symbols & inside}
    return tuple(reversed(moving.values()))


def _of_domain(frame: Frame) -> Iterator[Edge]:
    """Relations of the domain, except bounds of an angle."""
    turns = {symbol for symbol in frame.coordinates if is_angle(frame, symbol)}
    for relation in frame.domain:
        if not isinstance(relation, sp.StrictGreaterThan | sp.StrictLessThan | sp.Ge | sp.Le):
            continue
        if len(relation.free_symbols) == 1 and relation.free_symbols <= turns:
            continue
        if relation.gts == sp.oo or relation.lts == -sp.oo:
            continue
        try:
            inside = frame.field.read(relation.gts - relation.lts, f"domain {relation}")
        except ExpressionError:
            raise StartError(
                f"domain: expected relations that can be evaluated along a motion, got {relation}. "
                "Write it without absolute values and cases, for instance as two relations."
            ) from None
        yield Edge(inside, f"{relation} holds no longer", f"the domain is {relation}")


def _of_signs(frame: Frame) -> Iterator[Edge]:
    """Signs that were declared of coordinates, and on which the frame may rely."""
    for symbol in frame.coordinates:
        if sign := sign_of(frame, symbol):
            text = f"{symbol} was declared {'positive' if sign > 0 else 'negative'}"
            yield Edge(frame.field.read(sign * symbol, text), text, text)


def is_angle(frame: Frame, symbol: sp.Symbol) -> bool:
    """Whether the domain gives a coordinate one turn over which the frame repeats itself."""
    below = full_turn(frame, symbol)
    if below is None:
        return False
    # A frame that degenerates there ends, whether it repeats itself or not.
    return repeats(frame, symbol) and frame.determinant.element().sympy.subs(symbol, below) != 0


def full_turn(frame: Frame, symbol: sp.Symbol) -> sp.Expr | None:
    """The lower bound of a coordinate whose domain is as long as a full turn; None of others."""
    above: sp.Expr | None = None
    # For a symbol declared positive sympy drops the condition phi > 0.
    below: sp.Expr | None = sp.S.Zero if symbol.is_nonnegative else None
    for relation in frame.domain:
        if relation.free_symbols != {symbol} or not hasattr(relation, "gts"):
            continue
        if relation.gts == symbol:
            below = relation.lts
        elif relation.lts == symbol:
            above = relation.gts
    if above is None or below is None or above - below != 2 * sp.pi:
        return None
    return below


def _of_branches(frame: Frame) -> Iterator[Edge]:
    """Edges beyond which a root no longer has the sign with which it was read."""
    for branch in frame.branches:
        if branch.holds is not None:
            yield Edge(branch.holds, str(branch), str(branch))


def _of_roots(frame: Frame) -> Iterator[Edge]:
    """Roots and arguments of logarithms that may fall through zero."""
    waiting = [value for matrix in frame.given.values() for value in matrix.values()]
    seen: set[Generator] = set()
    while waiting:
        element = waiting.pop(0)
        for generator in element.field.generators_of(element):
            if generator in seen:
                continue
            seen.add(generator)
            if generator.tail is not None:
                waiting.append(generator.tail)
            if generator.kind == "root" and (
                not _is_sum_of_squares(generator.tail) or _has_a_kink(frame, generator)
            ):
                root = element.field.generator_element(generator)
                shown = generator.shown
                yield Edge(root, f"{shown} = 0", f"it needs {shown}", is_root=True)
            elif generator.kind == "log" and isinstance(generator.argument, Element):
                shown = generator.argument
                yield Edge(shown, f"{shown} = 0", f"it needs log({shown})")
            elif generator.kind == "primitive":
                _, slope, _ = generator.argument
                # Inverse functions end where their slope has a pole, most of them a root.
                waiting.append(slope)
                room = slope.inverse()
                if generator.shown.func is sp.atanh:
                    yield Edge(room, f"{room} = 0", f"it needs {generator.shown}")


def _is_sum_of_squares(element: Element | None) -> bool:
    """Whether an element has even powers of real functions only, with positive numbers."""
    if element is None:
        return False
    field: Tower = element.field
    odd = [g.kind not in _REAL for g in field.generators]
    for polynomial in (field.lift(element), *(field.factors[k] for k, _ in element._den)):
        for powers, number in polynomial.to_dict().items():
            if number < 0 or any(power % 2 for power in powers):
                return False
            if any(power and strange for power, strange in zip(powers, odd, strict=True)):
                return False
    return True


def _has_a_kink(frame: Frame, root: Generator) -> bool:
    """Whether the root of a sum of squares may vanish, and the metric is odd in it.

    Series continue with its other sign beyond the point where it vanishes.
    """
    tail = root.tail
    assert tail is not None
    field: Tower = tail.field
    inside = set(frame.coordinates)
    still = [not g.depends & inside for g in field.generators]
    for powers in field.lift(tail).to_dict():
        if all(fixed for power, fixed in zip(powers, still, strict=True) if power):
            return False
    entries = {**frame.metric.nonzero(), **frame.metric.undecided()}.values()
    return any(changes_with_sign(entry, root.shown**2) for entry in entries)
