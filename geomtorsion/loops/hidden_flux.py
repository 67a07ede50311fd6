"""Hidden flux: a bound by balls where all samples of a torsion that is not zero were zero.

A function such as exp(-(1000 x)^2) is zero as a float at all points of a rule, also where its
integral is not.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from flint import arb

from geomtorsion.codegen import Graph, graph
from geomtorsion.codegen.balls import BallCode, exact_ball
from geomtorsion.geometry.derived import derived
from geomtorsion.loops.arcs import Parameters, Part
from geomtorsion.loops.chains import pairs_of
from geomtorsion.loops.forms import curl
from geomtorsion.support.precision import ball_precision

if TYPE_CHECKING:
    from geomtorsion.geometry import Frame

# Number of times that the worst cell is halved: a twentieth of a second.
HALVINGS = 1000


@derived
def _curls(frame: Frame) -> tuple[tuple[tuple[int, int, int], ...], Graph | None, list[str]]:
    """(row, a, b) of the components of the curl that are not zero, their graph, and parameters."""
    pairs = pairs_of(frame.dimension).T.tolist()
    table = {
        (i, a, b): value
        for a, b in pairs
        for i in range(frame.dimension)
        if (value := curl(frame, i, a, b)).is_zero is not True
    }
    if not table:
        return (), None, []
    needed = {symbol for value in table.values() for symbol in value.symbols}
    parameters = [symbol.name for symbol in frame.parameters if symbol in needed]
    names = [*(symbol.name for symbol in frame.coordinates), *parameters]
    return tuple(table), graph(names, list(table.values()), factor=False), parameters


def hidden_flux(frame: Frame, parts: Sequence[Part], parameters: Parameters | None) -> float:
    """A bound of the flux through the cones over the parts of a loop, largest component.

    Points between samples of a curved arc are taken to be in the box of its samples. The bound is
    infinite where the torsion has no bounds.
    """
    places, values, names = _curls(frame)
    if values is None or frame.complex:
        return 0.0
    function = BallCode(values).real_function()
    table = {str(key): value for key, value in (parameters or {}).items()}
    total = 0.0
    with ball_precision(53):
        numbers = BallCode(values).numbers()
        given = [exact_ball(table[name]) for name in names]
        for part in parts:
            centre = np.array(part.centre)

            def bound(cell: tuple, part=part, centre=centre) -> float:
                number, low, high, inner, outer = cell
                offsets, slopes = part.arcs[number].shape(np.linspace(low, high, 5))
                radius = np.array([inner, outer])
                reach = part.size * (offsets[:, :, None] * radius).reshape(len(centre), -1)
                boxes = [_hull(c + row) for c, row in zip(centre, reach, strict=True)]
                sizes = function([*boxes, *given], numbers)
                rows = np.zeros(frame.dimension)
                for (i, a, b), size in zip(places, sizes, strict=True):
                    area = np.abs(offsets[a] * slopes[b] - offsets[b] * slopes[a]).max()
                    if area:
                        share = (outer**2 - inner**2) / 2 * (high - low)
                        rows[i] += float(abs(size).upper()) * area * share
                return float(rows.max())

            cells = [
                (-bound(cell), cell)
                for cell in ((k, 0.0, 1.0, 0.0, 1.0) for k in range(len(part.arcs)))
            ]
            heapq.heapify(cells)
            for _ in range(HALVINGS):
                worst, (k, low, high, inner, outer) = cells[0]
                if worst == 0:
                    break
                s, r = (low + high) / 2, (inner + outer) / 2
                halves = (
                    ((k, low, s, inner, outer), (k, s, high, inner, outer))
                    if high - low >= outer - inner
                    else ((k, low, high, inner, r), (k, low, high, r, outer))
                )
                heapq.heapreplace(cells, (-bound(halves[0]), halves[0]))
                heapq.heappush(cells, (-bound(halves[1]), halves[1]))
            total += abs(part.times) * part.size**2 * -sum(size for size, _ in cells)
    return total


def _hull(values: np.ndarray) -> arb:
    """The ball around numbers."""
    return arb(float(values.min())).union(arb(float(values.max())))
