"""Paths: arcs in balls are the arcs of a loop, and splines join smoothly."""

import pytest
import sympy as sp
from flint import acb, arb

import geomtorsion as gt
from geomtorsion.proofs.paths import arcs_of, spline_coefficients
from geomtorsion.support.precision import ball_precision
from tests.rounding import ROUNDED


@pytest.fixture(autouse=True)
def _bits():
    with ball_precision(100):
        yield


t = sp.Symbol("t", real=True)
LOOPS = [
    gt.Loop.circle([1, 2, 0], 0.25),
    gt.Loop.ellipse([1, 2, 0], [0.5, 0.25]),
    gt.Loop.polygon([[0, 0, 0], [1, 0, 0], [1, 1, 0.5]]),
    gt.Loop.plaquette([1, 2, 0], (0.5, 0.25)),
    gt.Loop.spline([[0.3, 1, 0.2], [0.4, 1, 0.2], [0.3, 1.2, 0.3], [0.2, 1.1, 0.1]]),
    gt.Loop.parametric([2 + sp.cos(t), sp.sin(2 * t), sp.sin(t) / 3], t, (0, 2 * sp.pi)),
]


@pytest.mark.parametrize("loop", LOOPS, ids=lambda loop: type(loop.parts[0].arcs[0]).__name__)
def test_arcs_are_the_arcs_of_the_loop(loop):
    """Coordinates and slopes of each arc agree with the floats of the loop, to rounding."""
    for part in loop.parts:
        for ball_arc, arc in zip(arcs_of(part), part.arcs, strict=True):
            for s in (0.0, 0.25, 0.6):
                points, slopes = part.points(arc, s)
                # Slopes along ellipses and curves are for s from 0 to 1, as here.
                values = ball_arc.path(acb(s), False)
                n = loop.dimension
                for k in range(n):
                    assert abs(values[k].real - float(points[k, 0])) < ROUNDED
                    assert abs(values[n + k].real - float(slopes[k, 0])) < 1e-13
                    assert ball_arc.places(arb(s))[k].overlaps(values[k].real)


def test_arcs_contain_whole_intervals():
    """The place of an interval of s contains all places in it."""
    for part in LOOPS[0].parts:
        (arc,) = arcs_of(part)
        whole = arc.places(arb(0.25, 0.125))
        for s in (0.125, 0.2, 0.3, 0.375):
            here = arc.places(arb(s))
            assert all(x.overlaps(y) for x, y in zip(whole, here, strict=True))


def test_a_spline_has_continuous_slopes_and_bends():
    """Where two cubics meet, values, slopes and second derivatives by the chord agree."""
    points = [[arb(0), arb(0)], [arb(1), arb(0)], [arb(1), arb(2)], [arb(-1), arb(1)]]
    pieces = list(spline_coefficients(points))
    steps_between = [
        [b - a for a, b in zip(points[k], points[(k + 1) % 4], strict=True)] for k in range(4)
    ]
    chords = [sum((x * x for x in row), arb(0)).sqrt() for row in steps_between]
    for k in range(4):
        after = (k + 1) % 4
        for i in range(2):
            a, b, c, d = pieces[k][i]
            e, f, g, h = pieces[after][i]
            assert (a + b + c + d - h).contains(0)
            assert ((3 * a + 2 * b + c) / chords[k] - g / chords[after]).contains(0)
            assert ((6 * a + 2 * b) / chords[k] ** 2 - 2 * f / chords[after] ** 2).contains(0)
            assert e.is_finite()
