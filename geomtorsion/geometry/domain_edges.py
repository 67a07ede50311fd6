"""Domain edges: where the declared domain of a frame ends, its signs and its branches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from geomtorsion.errors import ExpressionError, StartError
from geomtorsion.exact import Element
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.evaluation import repeats, sign_of

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame


@dataclass(frozen=True)
class Edge:
    """A quantity that is positive as long as the coordinates are valid.

    element: an exact element; a motion on which it falls through zero has reached the edge.
    words: event at the edge, for messages; condition: relation that holds inside.
    is_root: whether it is a root of the frame, so that rates have no value beyond it.
    declared: the relation of the domain, empty for other edges.
    """

    element: Element
    words: str
    condition: str
    is_root: bool = False
    declared: str = ""

    @property
    def relation(self) -> str:
        """The condition as a formula without words."""
        return self.declared or f"{self.element.sympy} > 0"


@derived
def domain_edges(frame: Frame) -> tuple[Edge, ...]:
    """Edges that a frame declares: its domain, signs of coordinates, branches of roots.

    Bounds of an angle over whose full turn the frame repeats itself are none.

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> r, phi = sp.symbols("r phi")
    >>> flat = Frame([r, phi], [[1, 0], [0, r]], domain=[r > 0, phi > 0, phi < 2 * sp.pi])
    >>> [edge.condition for edge in domain_edges(flat)]
    ['the domain is r > 0']
    >>> [edge.relation for edge in domain_edges(flat)]
    ['r > 0']
    """
    return (*_of_domain(frame), *_of_signs(frame), *_of_branches(frame))


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
        shown = str(relation)
        yield Edge(inside, f"{shown} holds no longer", f"the domain is {shown}", declared=shown)


def _of_signs(frame: Frame) -> Iterator[Edge]:
    """Signs that were declared of coordinates, and on which the frame may rely."""
    for symbol in frame.coordinates:
        if sign := sign_of(frame, symbol):
            text = f"{symbol} was declared {'positive' if sign > 0 else 'negative'}"
            yield Edge(frame.field.read(sign * symbol, text), text, text)


def _of_branches(frame: Frame) -> Iterator[Edge]:
    """Edges beyond which a root no longer has the sign with which it was read."""
    for branch in frame.branches:
        if branch.holds is not None:
            yield Edge(branch.holds, str(branch), str(branch))


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
