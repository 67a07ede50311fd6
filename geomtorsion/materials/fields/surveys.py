"""Surveys: Burgers vectors of all rectangular circuits of one size on a sampled frame."""

from __future__ import annotations

from functools import partial

from geomtorsion.materials.fields import cells
from geomtorsion.materials.fields.displaced import displaced_circuits
from geomtorsion.materials.fields.samples import Samples
from geomtorsion.materials.fields.sides import Sides
from geomtorsion.materials.rings import Rings
from geomtorsion.materials.survey import Survey, areas, middles
from geomtorsion.materials.widened import widened


def survey_of(
    samples: Samples, plane: tuple[int, int], size: tuple[int, int], *, widen: bool
) -> Survey:
    """Survey of all circuits of a size in a plane; see SampledFrame.burgers_map."""
    grid = samples._grid
    rings = Rings.of(grid.holes, plane, grid.periodic) if grid.has_holes else None
    sides = Sides(samples._field, plane[0]), Sides(samples._field, plane[1])
    survey = _of_one_size(samples, plane, rings, sides, size)
    if rings is None or not widen or size[0] != size[1]:
        return survey
    larger = partial(_of_one_size, samples, plane, rings, sides)
    return widened(survey, rings, lambda side: larger((side, side)), grid.periodic)


def _of_one_size(
    samples: Samples,
    plane: tuple[int, int],
    rings: Rings | None,
    sides: tuple[Sides, Sides],
    size: tuple[int, int],
) -> Survey:
    """Survey of circuits of a size, NaN where a circuit has no b of its own."""
    grid, displacement = samples._grid, samples.displacement
    if displacement is not None:
        every = displaced_circuits(grid, displacement, plane, size, rings)
    else:
        every = cells.circuits(samples._field, plane, size, rings, sides)
    cells_along = dict(zip(plane, size, strict=True))
    along = [cells_along.get(k, 0) for k in range(samples.dimension)]
    starts, counts = [float(axis[0]) for axis in samples.axes], every.vectors.shape[1:]
    passages = every.passages
    return Survey(
        every.vectors,
        middles(starts, grid.steps, counts, along),
        areas(abs(grid.steps[plane[0]] * grid.steps[plane[1]]), size, passages),
        size,
        every.estimate,
        tuple(samples.names),
        plane,
        passages=None if passages is None else passages.count,
        unit=samples.unit,
        vector_unit=samples.vector_unit,
    )
