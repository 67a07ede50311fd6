"""Law: what takes a frame works for metrics as people type them, and never answers wrongly."""

# pyright: reportOptionalMemberAccess=false

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError
from tests.typed import ROWS, Typed

QUICK = [row for row in ROWS if not row.slow]
# One row for each way in which such frames once failed.
SHARP = (
    "Schwarzschild, Painleve and Gullstrand",
    "Kerr, Boyer and Lindquist, numbers",
    "de Sitter, flat slicing",
    "de Sitter, static",
    "Minkowski, Cartesian",
    "Minkowski, spherical",
    "Minkowski, null coordinates",
    "Rindler",
    "Goedel",
    "the sphere",
    "a root that vanishes at 1",
    "one line",
    "sphere times a line",
    "Kasner",
    "a plane wave",
    "Nil",
    "Fisher information of normal distributions",
)


def rows(sharp: tuple[str, ...]) -> list:
    """All rows; those that are not sharp are slow."""
    assert set(sharp) <= {row.name for row in ROWS}
    return [
        pytest.param(row, id=row.name, marks=() if row.name in sharp else pytest.mark.slow)
        for row in ROWS
    ]


def test_the_table_covers_the_shipped_spaces():
    """The table has forty rows and more, of most families of shipped spaces."""
    assert len(ROWS) >= 40
    families = {row.space for row in ROWS}
    assert families >= {"schwarzschild", "kerr", "taub_nut", "de_sitter", "goedel", "s2", "so3"}


@pytest.mark.parametrize("row", rows(SHARP))
def test_typed_frames_are_identified(row: Typed):
    """The space, its parameters, the curvature and the number of symmetries are true."""
    found = gt.spaces.identify(row.frame)
    assert found.classification.symmetries == row.symmetries
    if row.curvature:
        names = {str(s): s for s in row.frame.parameters}
        truth = gt.parse_expression(row.curvature, names)
        assert sp.simplify(found.classification.curvature - truth) == 0
    for words in row.words:
        assert words in str(found.classification)
    if row.space:
        (match,) = found.matches
        assert match.name == row.space
        assert {k: str(v) for k, v in match.parameters.items()} == row.values
    else:
        assert not found.matches
        # A space that is not found is excluded, or reported.
        assert set(row.undecided) <= set(found.undecided)
    region = row.frame.region
    assert (str(region) in str(found)) == region.assumed


@pytest.mark.parametrize("row", rows(SHARP[:12]))
def test_typed_frames_are_the_same_as_themselves(row: Typed):
    """A frame is the same as itself at once, in each sense, and the answer names the region."""
    frame = row.frame
    for keep in ("metric", "teleparallel", "legs"):
        result = gt.same_geometry(frame, row.frame, keep)
        assert result.verdict == "same", result
        assert frame.region.assumption in str(result)
        assert (result.match.start.keys()) == set(frame.coordinates)


@pytest.mark.parametrize("row", rows(SHARP[2:12]))
def test_what_takes_a_frame_works_as_typed(row: Typed):
    """Symmetries, holonomy and a geodesic from the point of the region, without foreign errors."""
    frame = row.frame
    symmetries = gt.symmetries(frame)
    assert symmetries.dimension == row.symmetries
    holonomy = gt.levi_civita(frame).holonomy_algebra
    assert (holonomy.dimension == 0) == (row.curvature == "0")
    assert str(holonomy)
    point = frame.region.point
    start = [float(point[q]) for q in frame.coordinates]
    values = {str(p): float(point[p]) for p in frame.parameters}
    velocity = [1.0] + [0.0] * (frame.dimension - 1)
    motion = gt.geodesic(frame, start, frame_velocity=velocity, parameters=values)
    try:
        solution = gt.solve(motion, 0.01)
    except GeomtorsionError as refusal:
        pytest.fail(f"no motion from the region's own point: {refusal}")
    assert solution.times[-1] == pytest.approx(0.01)
