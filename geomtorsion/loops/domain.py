"""Domain: loops are refused where they leave the domain that a frame declares, as curves are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from geomtorsion.codegen import numpy_function
from geomtorsion.errors import ChartEdgeError, UnknownNameError
from geomtorsion.geometry.derived import derived
from geomtorsion.geometry.domain_edges import Edge, domain_edges
from geomtorsion.loops.arcs import Arc, Parameters, Part, shown
from geomtorsion.loops.forms import Poles, parameter_values
from geomtorsion.loops.poles import arc_samples
from geomtorsion.loops.quadrature import NARROWEST
from geomtorsion.support import checks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from geomtorsion.geometry import Frame


@derived
def loop_edges(frame: Frame) -> tuple[Edge, ...]:
    """Edges of the declared domain that depend on a coordinate.

    Frames of parallel lines declare none: their coframe has no finite value on a line.
    """
    inside, branches = set(frame.coordinates), {str(branch) for branch in frame.branches}
    edges = (edge for edge in domain_edges(frame) if edge.element.symbols & inside)
    # Values of the coframe themselves refuse the other side of a branch.
    return tuple(edge for edge in edges if edge.condition not in branches)


@derived
def _compiled(frame: Frame, edges: tuple[Edge, ...]) -> tuple[Poles, tuple]:
    """Edges as one function of arrays, and the parameters in them."""
    needed = {symbol for edge in edges for symbol in edge.element.symbols}
    parameters = tuple(s for s in frame.field.symbols if s in needed - set(frame.coordinates))
    arguments = [*frame.coordinates, *parameters]
    function = numpy_function([edge.element for edge in edges], arguments, check=False)
    return Poles(function, tuple(edge.condition for edge in edges)), parameters


def edge_values(frame: Frame, parameters: Parameters | None) -> Poles | None:
    """Quantities that are positive inside the domain of a frame; None without edges.

    Raises
    ------
    MissingValueError
        A parameter of the domain has no value.
    """
    edges = loop_edges(frame)
    if not edges:
        return None
    function, wanted = _compiled(frame, edges)
    names = {symbol.name for symbol in frame.field.symbols}
    table = checks.by_name(parameters, "parameters", UnknownNameError)
    own = {name: value for name, value in table.items() if name in names}
    numbers = parameter_values(frame, wanted, own)
    return Poles(function.function, function.names, numbers=numbers)


def refuse_outside(frame: Frame, parts: Sequence[Part], parameters: Parameters | None) -> None:
    """Refuse a loop that leaves the declared domain of a frame.

    Raises
    ------
    ChartEdgeError
        It does; the message names the condition and a point.
    """
    edges = edge_values(frame, parameters)
    if edges is not None:
        _refuse_parts(edges, parts)


def refuse_numbers_outside(frame: Frame, parts: Sequence[Part]) -> None:
    """Refuse a loop of numbers that leaves the domain; edges with parameters are not checked.

    Raises
    ------
    ChartEdgeError
        It does; the message names the condition and a point.
    """
    inside = set(frame.coordinates)
    edges = tuple(edge for edge in loop_edges(frame) if edge.element.symbols <= inside)
    if edges:
        _refuse_parts(_compiled(frame, edges)[0], parts)


def _refuse_parts(edges: Poles, parts: Sequence[Part]) -> None:
    for part in parts:
        # As close as the places of a closer look, so that a dip shows by those beside it.
        for owner, s, points in arc_samples(part, closer=4):
            rows = np.real(edges.values(points))
            inside = rows > 0
            if not inside.all():
                row = rows[int(np.argmin(inside.all(axis=1)))]
                worst = int(np.argmin(np.where(np.isfinite(row), row, -np.inf)))
                refuse_points(edges, points[:, worst : worst + 1])
            for k, place, j in np.argwhere(_dips(rows.reshape(-1, len(owner), len(s)))).tolist():
                ends = s[max(j - 1, 0)], s[min(j + 1, len(s) - 1)]
                _refuse_dip(edges, k, part, part.arcs[owner[place]], *ends)


def _dips(rows: np.ndarray) -> np.ndarray:
    """Where values along the last axis are smallest, and below half of a value beside them."""
    before = np.concatenate((rows[..., :1], rows[..., :-1]), axis=-1)
    after = np.concatenate((rows[..., 1:], rows[..., -1:]), axis=-1)
    return (rows <= np.minimum(before, after)) & (2 * rows < np.maximum(before, after))


def refuse_points(edges: Poles, points: np.ndarray, owner: str = "a loop") -> None:
    """Refuse points, shape (n, k), outside the domain; owner: of the points, for the message."""
    outside = ~(np.real(edges.values(points)) > 0)
    if outside.any():
        k, j = np.argwhere(outside)[0]
        raise ChartEdgeError(
            f"expected {owner} inside the domain of the frame, {edges.names[k]}, got the point "
            f"{shown(points[:, j])}. Outside, the coframe is singular or does not describe the "
            "space. Move it inside, make it larger or smaller, or use other coordinates."
        )


def _refuse_dip(edges: Poles, k: int, part: Part, arc: Arc, low: float, high: float) -> None:
    """Refuse an arc on which one edge has a zero between two values of s."""
    while high - low > NARROWEST:
        near = np.linspace(low, high, 9)
        points = part.points(arc, near)[0]
        refuse_points(edges, points)
        values = np.real(edges.values(points)[k])
        best = int(values.argmin())
        if 2 * values[best] > values.max():
            # So flat a dip does not reach zero.
            break
        low, high = near[max(best - 1, 0)], near[min(best + 1, 8)]
