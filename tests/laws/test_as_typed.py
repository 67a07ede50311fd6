"""Law: what takes a frame works for metrics as people type them, and never answers wrongly."""

# pyright: reportOptionalMemberAccess=false

import re
from collections.abc import Callable
from pathlib import Path

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, GeomtorsionError, MetricError, SignatureError
from tests.typed import ROWS, Typed
from tests.typed_calls import calls, charges, positive_calls

# Frames without unknown functions, and frames with them.
EXACT = [row for row in ROWS if not row.functions]
UNKNOWN = [row for row in ROWS if row.functions]
BY_NAME = {row.name: row for row in ROWS}
# One row for each way in which such frames once failed.
SHARP = (
    "Schwarzschild, Painleve and Gullstrand",
    "Schwarzschild, prolate spheroidal",
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
    "Taub, static walls",
    "Goedel, Hawking and Ellis",
    "a plane wave",
    "Nil",
    "Fisher information of normal distributions",
)


def rows(sharp: tuple[str, ...]) -> list:
    """All rows; those that are not sharp are slow."""
    assert set(sharp) <= set(BY_NAME)
    return [
        pytest.param(row, id=row.name, marks=() if row.name in sharp else pytest.mark.slow)
        for row in EXACT
    ]


def test_the_table_covers_the_shipped_spaces():
    """The table has ninety rows and more, of most families of shipped spaces."""
    assert len(ROWS) >= 90
    families = {row.space for row in ROWS}
    assert families >= {"schwarzschild", "kerr", "taub_nut", "de_sitter", "goedel", "s2", "so3"}


@pytest.mark.parametrize("row", rows(SHARP[::4]))
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


@pytest.mark.parametrize("row", rows(SHARP[:3]))
def test_typed_frames_are_the_same_as_shipped(row: Typed):
    """A typed frame is the same as its shipped space with the true values of the parameters."""
    if not row.space:
        pytest.skip("no shipped space")
    # Parameters of the typed frame get the values of its region, and so do the shipped ones.
    own = {str(p): row.frame.region.point[p] for p in row.frame.parameters}
    frame = row.frame.subs(own) if own else row.frame
    shipped = gt.spaces.load(row.space).frame
    values = {k: gt.parse_expression(v, own).subs(own) for k, v in row.values.items()}
    if 0 in values.values():
        pytest.skip("a limit of the shipped space")
    if 3 * sum(signs < 0 for signs in frame.region.signature) > frame.dimension:
        pytest.skip("minus the metric of the shipped space")
    result = gt.same_geometry(frame, shipped.subs(values) if values else shipped)
    assert result.verdict == "same", result


@pytest.mark.parametrize("row", rows(SHARP[3:12]))
def test_what_takes_a_frame_works_as_typed(row: Typed, tmp_path: Path):
    """Each public call that takes a frame returns at the point of the region."""
    frame = row.frame
    assert gt.symmetries(frame).dimension == row.symmetries
    holonomy = gt.levi_civita(frame).holonomy_algebra
    assert (holonomy.dimension == 0) == (row.curvature == "0")
    for name, call in calls(row, tmp_path / "report"):
        try:
            call()
        except GeomtorsionError as refusal:
            pytest.fail(f"{name}: {refusal}")
    names = {str(s) for s in (*frame.coordinates, *frame.parameters)}
    for _, call in charges(row):
        # What the advice names is there.
        assert set(re.findall(r"\{'(\w+)'", refusal_of(call))) <= names
    is_positive = min(frame.region.signature) > 0
    for _, call in positive_calls(row):
        if is_positive:
            call()
        else:
            with pytest.raises((MetricError, SignatureError)) as refusal:
                call()
            # The advice helps, as inside of an ergosphere.
            advice = re.search(r"domain=\[\.\.\., (.*?)\]", str(refusal.value))
            if advice:
                within = row.within(advice[1].replace("'", ""))
                assert gt.constrained(within, [f"d{frame.coordinates[-1]}"])


def refusal_of(call: Callable[[], object]) -> str:
    """The text of a refusal; empty where the call returns."""
    try:
        call()
    except GeomtorsionError as refusal:
        return str(refusal)
    return ""


@pytest.mark.parametrize("row", [pytest.param(row, id=row.name) for row in UNKNOWN])
def test_frames_with_unknown_functions_have_symmetries(row: Typed):
    """Symmetries and the region of a metric with unknown functions; recognition needs values."""
    frame = row.frame
    assert gt.symmetries(frame).dimension == row.symmetries
    assert str(frame.region)
    with pytest.raises(ArgumentError, match="without unknown functions"):
        gt.spaces.identify(frame)


@pytest.mark.parametrize("row", [row for row in ROWS if row.same or row.different])
def test_two_typed_surfaces_are_compared(row: Typed):
    """A catenoid bends into a helicoid, and into no hyperboloid."""
    other = BY_NAME[row.same or row.different].frame
    verdict = gt.same_geometry(row.frame, other).verdict
    assert verdict == ("same" if row.same else "different")
