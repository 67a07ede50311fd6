"""Defect frames: crystals with parallel straight defect lines along z, as exact frames."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import sympy as sp

from geomtorsion import checks
from geomtorsion.errors import LoopError, ShapeError
from geomtorsion.exact import parse_expression
from geomtorsion.geometry import Frame
from geomtorsion.loops.arcs import Number, exact_number
from geomtorsion.loops.defect_lines import frame_of_lines

# Numbers, expressions, or text such as "1/2".
Exact = Sequence[Number | str]
X, Y, Z = sp.symbols("x y z", real=True)


def parallel_dislocations(
    positions: Sequence[Sequence[Number | str]],
    burgers: Sequence[Sequence[Number | str]],
    name: str | None = None,
) -> Frame:
    """Straight dislocations along z through points of the plane, with any Burgers vectors.

    Equation
    --------
    e^i = dx^i + sum_k b_k^i / (2 pi) dphi_k,  dphi_k = ((x - x_k) dy - (y - y_k) dx) / r_k^2:
    torsion vanishes off the lines, and a loop has b = sum of windings times b_k.

    Parameters
    ----------
    positions
        (x_k, y_k), shape (m, 2); numbers or expressions. Floats are taken as they are written.
    burgers
        b_k^i, shape (m, 3).

    Raises
    ------
    ShapeError
        There is not one Burgers vector per position, or two lines coincide.

    Examples
    --------
    >>> frame = parallel_dislocations([(0, 0), (1, 0)], [(0, 0, 1), (1, 0, 0)])
    >>> frame.anholonomy.is_zero
    True
    """
    places = [_exact(row, 2, f"positions[{k}]") for k, row in enumerate(positions)]
    vectors = [_exact(row, 3, f"burgers[{k}]") for k, row in enumerate(burgers)]
    if not places or len(places) != len(vectors):
        raise ShapeError(
            f"one Burgers vector for each line was needed, but {len(places)} positions and "
            f"{len(vectors)} vectors came."
        )
    if len(set(places)) < len(places):
        raise ShapeError("two lines stand at the same place. Add their Burgers vectors instead.")
    for k, place in enumerate(places):
        symbols = {s.name for x in (*place, *vectors[k]) for s in x.free_symbols}
        if symbols & {"x", "y", "z"}:
            raise ShapeError(
                f"positions[{k}], burgers[{k}]: a straight line needs constants, but x, y or z "
                "stands in them. Rename the symbol, or make a Frame."
            )
    return frame_of_lines((X, Y, Z), places, vectors, name or "parallel dislocations")


def parallel_screws(positions: Sequence[Exact], burgers: Exact) -> Frame:
    """Straight screw dislocations along z, b_k along z.

    Examples
    --------
    >>> from geomtorsion.loops import Loop, burgers_vector
    >>> frame = parallel_screws([(-1, 0), (1, 0)], [1, -2])
    >>> b = burgers_vector(frame, Loop.circle([0, 0, 0], 3))
    >>> round(float(b.vector[2]), 12)
    -1.0
    """
    return parallel_dislocations(positions, [(0, 0, b) for b in burgers], "parallel screws")


def parallel_edges(positions: Sequence[Exact], burgers: Sequence[Exact]) -> Frame:
    """Straight edge dislocations along z, b_k in the plane across, shape (m, 2).

    Examples
    --------
    >>> parallel_edges([(0, 0)], [(1, 0)]).coframe[1, 1]
    1
    """
    return parallel_dislocations(positions, [(*b, 0) for b in burgers], "parallel edges")


def dispiration(alpha: Number | str, b: Number | str) -> Frame:
    """A wedge of angle 2 pi (1 - alpha) cut out and the faces joined one step b higher.

    Equation
    --------
    e^1 = cos phi dr - alpha r sin phi dphi,  e^2 = sin phi dr + alpha r cos phi dphi,
    e^3 = dz + b / (2 pi) dphi, in Cartesian coordinates: a disclination and a screw on one axis.
    With its Levi-Civita connection plus the flat one along z, a loop about the axis turns by
    2 pi (1 - alpha) and moves by b along it, whatever its shape.

    Parameters
    ----------
    alpha
        Share of the full angle that is left; 1: no disclination.
    b
        Step of the screw; 0: a wedge disclination alone.

    Examples
    --------
    >>> dispiration(1, 0).coframe.nonzero()
    {(0, 0): 1, (1, 1): 1, (2, 2): 1}
    """
    left, step = (_expression(value, name) for name, value in (("alpha", alpha), ("b", b)))
    square = X**2 + Y**2
    # dr / r and dphi as coefficients of dx and dy.
    radial, angular = (X / square, Y / square), (-Y / square, X / square)
    rows = [
        [X * radial[k] - left * Y * angular[k] for k in range(2)] + [sp.S.Zero],
        [Y * radial[k] + left * X * angular[k] for k in range(2)] + [sp.S.Zero],
        [step / (2 * sp.pi) * angular[k] for k in range(2)] + [sp.S.One],
    ]
    return Frame(
        [X, Y, Z], [[sp.cancel(entry) for entry in row] for row in rows], name="dispiration"
    )


def _exact(row: Exact, length: int, where: str) -> tuple[sp.Expr, ...]:
    """A row of exact numbers or expressions."""
    if isinstance(row, str) or not hasattr(row, "__len__") or len(row) != length:
        raise ShapeError(f"{where}: {length} numbers were needed, but {checks.shown(row)} came.")
    return tuple(_expression(value, f"{where}[{k}]") for k, value in enumerate(row))


def _expression(value: object, where: str) -> sp.Expr:
    """An exact number or expression; text such as "1/2" is read as a number."""
    read = partial(parse_expression, symbols={}, functions={}, where=where)
    return exact_number(checks.expression(value, where, LoopError, read=read))
