"""Exact interpolants: the polynomials between the nodes of a grid, as a proof integrates them."""

from __future__ import annotations

from geomtorsion.loops import Interpolant, Loop
from geomtorsion.materials.fields.grid import Grid
from geomtorsion.materials.fields.samples import Samples


def interpolant_of(samples: Samples, loop: Loop) -> Interpolant | None:
    """The polynomials that a loop integrates; None where it sums jumps of a displacement."""
    if samples.displacement is not None:
        return None
    grid = Grid(tuple(samples.axes), tuple(samples.names), samples.periodic, samples.mask)
    origin = tuple(float(axis[0]) for axis in samples.axes)
    values = samples.coframe[:, : samples.dimension]
    return Interpolant(loop, origin, grid.steps, grid.periodic, values, grid.known, samples.order)
