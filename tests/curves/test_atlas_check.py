"""Atlases are checked: shipped ones here, atlases of users when they are given."""

# Tests pass what users pass, wrong input included, and read values that may be missing.
# pyright: reportArgumentType=false

import pytest
import sympy as sp

from geomtorsion.curves import geodesic
from geomtorsion.curves.atlas import Atlas, Chart, TransitionMap, atlas_of
from geomtorsion.curves.atlas_check import check_atlas
from geomtorsion.errors import ArgumentError, CoordinateError, ShapeError
from geomtorsion.geometry import Frame
from geomtorsion.ode import solve
from geomtorsion.spaces import load, names

R, PHI = sp.symbols("r phi", real=True)
X, Y = sp.symbols("x y", real=True)
THERE = (R * sp.cos(PHI), R * sp.sin(PHI))
BACK = (sp.sqrt(X**2 + Y**2), sp.atan2(Y, X))
LEGS = [[sp.cos(PHI), -R * sp.sin(PHI)], [sp.sin(PHI), R * sp.cos(PHI)]]


def plane(there=THERE, back=BACK, angles=(1,), coframe=((1, 0), (0, R)), keeps=False, domain=None):
    """The plane in polar and Cartesian coordinates."""
    polar = Frame([R, PHI], [list(row) for row in coframe], domain=domain, name="polar")
    plain = Frame([X, Y], [[1, 0], [0, 1]], name="plain")
    maps = (
        TransitionMap("polar", "plain", (R, PHI), there),
        TransitionMap("plain", "polar", (X, Y), back, angles=angles),
    )
    makers = {
        "polar": lambda: Chart.of(polar, edge=R, margin=0.1),
        "plain": lambda: Chart.of(plain, keeps_frame=keeps),
    }
    return polar, Atlas("polar", makers, lambda: maps)


def posed(frame, atlas):
    """A straight line through the origin."""
    return geodesic(frame, [1.0, 0.4], [-1.0, 0.0], atlas=atlas)


CHARTED = [name for name in names() if load(name).atlas is not None]


@pytest.mark.parametrize(
    "name", [pytest.param(x, marks=pytest.mark.slow) if x in ("kerr", "s7") else x for x in CHARTED]
)
def test_shipped_atlases_are_right(name):
    """Each map is right at three generic points; therefore use does not check it again."""
    frame = load(name).frame
    atlas = atlas_of(frame)
    assert check_atlas(frame, atlas) >= 3 * len(atlas.changes()) >= 6


@pytest.mark.parametrize("domain", [None, R > 0])
def test_a_right_atlas_is_taken_once(domain):
    """Samples with r < 0 come back as r > 0, by another name of the same point."""
    frame, atlas = plane(domain=domain)
    end = solve(posed(frame, atlas), [3.0], 1e-10).coordinates[-1]
    assert end[0] == pytest.approx(2.0, abs=1e-9)
    assert atlas.checked_for == {frame}


def test_a_frame_that_is_kept():
    """dx and dy, written in polar coordinates, are kept; the compass frame is not."""
    posed(*plane(coframe=LEGS, keeps=True))
    with pytest.raises(
        CoordinateError, match="expected a map that keeps the frame, got x-component .* of leg 0"
    ):
        posed(*plane(keeps=True))


WRONG = {
    "x doubled": (
        {"there": (2 * THERE[0], THERE[1])},
        "from chart 'polar' to chart 'plain': expected a map that preserves the metric, got ",
    ),
    "atan2 swapped": (
        {"back": (BACK[0], sp.atan2(X, Y))},
        "expected maps that are inverse to each other, got phi = ",
    ),
    "moved": ({"back": (BACK[0], BACK[1] + 1)}, "inverse to each other, got phi"),
    "radius halved": (
        {"back": (BACK[0] / 2, BACK[1])},
        "inverse to each other, got r = |from chart 'plain' to chart 'polar': expected",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_maps_are_refused(name):
    """The error names the map and the component."""
    change, message = WRONG[name]
    frame, atlas = plane(domain=R > 0, **change)
    with pytest.raises(CoordinateError, match=message):
        posed(frame, atlas)
    assert not atlas.checked_for


def test_maps_of_the_wrong_size():
    """A map has one expression for each target coordinate; the home chart has the coordinates."""
    with pytest.raises(ShapeError, match="2 expressions over"):
        posed(*plane(there=(R,)))
    frame, _ = plane()
    _, other = plane()
    sphere = load("s2").frame
    with pytest.raises(CoordinateError, match="home chart 'polar' has"):
        geodesic(sphere, [1.0, 0.4], [-1.0, 0.0], parameters={"R": 1}, atlas=other)
    with pytest.raises(ArgumentError, match="atlas"):
        geodesic(frame, [1.0, 0.4], [-1.0, 0.0], atlas="polar")


def test_a_redundant_chart():
    """The unit circle in two coordinates is accepted, and refused with the opposite rotation."""
    angle = sp.Symbol("a", real=True)
    c, s = sp.symbols("c s", real=True)
    frame = Frame([angle], [[1]], name="circle")
    for sign in (1, -1):
        maps = (
            TransitionMap("circle", "unit", (angle,), (sp.cos(angle), sp.sin(angle))),
            TransitionMap("unit", "circle", (c, s), (sp.atan2(s, c),), angles=(0,)),
        )
        makers = {
            "circle": lambda: Chart.of(frame),
            "unit": lambda sign=sign: Chart.redundant(
                "unit", [c, s], [[-sign * s], [sign * c]], kept=c**2 + s**2
            ),
        }
        atlas = Atlas("circle", makers, lambda maps=maps: maps)
        if sign == 1:
            assert check_atlas(frame, atlas) >= 6
        else:
            with pytest.raises(CoordinateError, match="got c-component .* of leg 0"):
                check_atlas(frame, atlas)
