"""Exact circle: the Burgers vector of a circle in closed form, by exact steps."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from geomtorsion.errors import LoopError, UndecidedError
from geomtorsion.geometry import Frame
from geomtorsion.loops.domain import refuse_numbers_outside
from geomtorsion.loops.exact_integral import (
    Piece,
    definite,
    pulled_back,
    sample_of,
    short,
    verified,
)
from geomtorsion.loops.loop import Loop
from geomtorsion.support import checks
from geomtorsion.support.checks import expression


def exact_circle(
    frame: Frame, centre: Sequence[sp.Expr], radius: sp.Expr, plane: tuple[int, int] = (0, 1)
) -> tuple[sp.Expr, ...]:
    """Burgers vector of a circle in closed form, without numerical checks.

    `exact_burgers_vector` takes any loop and searches poles numerically. This function decides
    exactly that no denominator of the coframe has a zero on the circle. If the circle or the domain
    of the frame contains symbols, the caller must ensure that the circle is inside the domain.

    Parameters
    ----------
    centre, radius
        exact expressions in coordinates, shape (n,), and positive.
    plane
        two coordinates, counted from 0; the circle runs from the first towards the second.

    Raises
    ------
    LoopError
        The centre does not have one entry per coordinate, or the plane is invalid.
    ChartEdgeError
        A circle of numbers leaves the declared domain of the frame.
    UndecidedError
        A denominator may vanish on the circle or a root change its sign, or no closed form is
        known.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> exact_circle(load("heisenberg").frame, [0, 0, 0], sp.Symbol("R", positive=True))
    (0, 0, -pi*R**2)
    """
    piece = circle_piece(frame, centre, radius, plane)
    if not sp.Tuple(*piece[0]).free_symbols - {piece[1]}:
        refuse_numbers_outside(frame, Loop.circle(centre, radius, plane).parts)
    forms = pulled_back(frame, piece)
    _refuse_changes(frame, piece)
    components = []
    for i, f in enumerate(forms):
        value = definite(f, *piece[1:])
        if value is None:
            raise UndecidedError(
                f"b^{i} of this circle has no closed form that is known here: the integrand is "
                f"{checks.shown(f)}. Use burgers_vector(...) for a number."
            )
        components.append(short(value))
    where = sample_of(frame, sp.Tuple(*piece[0]).free_symbols - {piece[1]})
    return verified(tuple(components), forms, piece, where)


def circle_piece(
    frame: Frame, centre: Sequence[sp.Expr], radius: sp.Expr, plane: tuple[int, int]
) -> Piece:
    """Coordinates along the circle, its angle, and where that begins and ends."""
    n = frame.dimension
    if len(centre) != n or len({*plane}) != 2 or not all(0 <= k < n for k in plane):
        raise LoopError(
            f"circle: expected {n} coordinates of the centre and two different coordinates from 0 "
            f"to {n - 1} for the plane, got {len(centre)} and {plane}. Give one entry for each."
        )
    t = sp.Dummy("t", real=True)
    path = [expression(x) for x in centre]
    path[plane[0]] += radius * sp.cos(t)
    path[plane[1]] += radius * sp.sin(t)
    return tuple(path), t, sp.S.Zero, 2 * sp.pi


def _refuse_changes(frame: Frame, piece: Piece) -> None:
    """Refuse a circle on which a denominator may vanish, or a root may change its sign."""
    path = piece[0]
    if frame.field.relied_on:
        raise UndecidedError(
            "expected a coframe without choices of sign, got roots that were read for a part "
            "of the space. Use burgers_vector(...) for a number."
        )
    table = dict(zip(frame.coordinates, path, strict=True))
    for value in [*frame.coframe.nonzero().values(), *frame.coframe.undecided().values()]:
        below = sp.simplify(sp.denom(sp.together(value)).subs(table, simultaneous=True))
        # An exponential has no zero, whatever it does along the circle.
        if not below.is_nonzero:
            raise UndecidedError(
                f"the denominator {checks.shown(sp.denom(sp.together(value)))} of the coframe "
                "changes along the circle and may vanish there. Put the centre where it stays the "
                "same, or use burgers_vector(...) for a number."
            )
