"""Integrals: rounding is estimated, and the two routes differ around a defect."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from scipy.special import iv

from geomtorsion.errors import SingularPointError
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop, Network, burgers_vector, integrals
from geomtorsion.loops.chains import ClosedCurve
from geomtorsion.loops.forms import forms
from geomtorsion.loops.integrals import Places, by_levels
from geomtorsion.spaces import load
from tests.loops.reference import reference
from tests.loops.test_network import grid_graph
from tests.rounding import ROUNDED

X, Y = sp.symbols("x y")


def test_rounding_is_estimated_from_both_sides() -> None:
    """Far from the origin coordinates have few digits, and both error estimates hold.

    The largest error of 12 loops is between 1 % and 40 % of its estimate; a probe sixteen times
    smaller or larger would fail.
    """
    frame = Frame([X, Y], [[1, 0], [0, 2 + sp.sin(X)]])
    shares = []
    for k in range(12):
        loop = Loop.circle([1e6 + 0.37 * k, 0.1 * k], 1.0)
        found = burgers_vector(frame, loop)
        true = np.array([float(x) for x in reference(frame, loop)])
        check = found.check
        assert check.flux is not None
        assert check.flux_error is not None
        shares.append(
            [
                np.abs(check.line - true).max() / check.line_error,
                np.abs(check.flux - true).max() / check.flux_error,
            ]
        )
        assert check.line_error > 1e-10
    worst = np.max(shares, axis=0)
    assert (worst > 0.01).all()
    assert (worst < 0.4).all()


@pytest.mark.parametrize("b", [1e-12, 3e-13, 1e-14, 1e-16])
def test_a_weak_defect_is_seen(b: float) -> None:
    """Line and flux differ by b, from 200 times the line's error of 5e-15 down to a fiftieth.

    Where b is below the error, the denominator of the frame shows the line.
    """
    frame = load("screw_dislocation").frame
    found = burgers_vector(frame, Loop.circle([0.2, 0, 0], 1), parameters={"b": b})
    assert found.check.line_error == pytest.approx(5e-15, rel=0.3)
    assert found.check.agrees is False
    assert abs(found.vector[2] - b) <= min(found.error, 1e-14)


def test_smooth_loops_have_no_defect() -> None:
    """Both routes agree on 200 smooth loops of any size."""
    rng = np.random.default_rng(3)
    frame = load("so3").frame
    for centre in rng.uniform([0, 0.7, 0], [6, 2.3, 6], (200, 3)):
        loop = Loop.circle(centre, 10 ** rng.uniform(-9, -0.5))
        assert burgers_vector(frame, loop, 1e-9).check.agrees


def test_many_copies_agree_with_single_copies() -> None:
    """One call for five places gives the results of five calls, for line and flux."""
    compiled = forms(load("so3").frame, None)
    (part,) = Loop.circle([0.3, 1.0, 0.2], 0.1).parts
    shape = ClosedCurve(part.arcs[0])
    centres = np.array(part.centre)[:, None] + np.linspace(0, 0.5, 5)
    sizes = np.linspace(0.1, 0.3, 5)
    for degree in (1, 2):
        together = by_levels(compiled, shape, Places(centres, sizes), 1e-12, degree)
        assert together is not None
        assert together.converged.all()
        for k in range(5):
            place = Places(centres[:, [k]], sizes[[k]])
            single = by_levels(compiled, shape, place, 1e-12, degree)
            assert single is not None
            # One place and many places take the same sums, in different order.
            assert together.values[:, k] == pytest.approx(
                single.values[:, 0], rel=1e-13, abs=ROUNDED
            )


PARALLELOGRAMS = {
    "a plaquette": Loop.plaquette([0.1, 0.7, 0.2], (0.6, -0.4), ((1, 0.2, 0.3), (0, 1, -0.5))),
    "far from its centre": Loop.polygon(
        [[1, 2, 0], [2, 2, 1], [1.5, 3, 0], [0.5, 3, -1]], centre=[0.3, 1, 0.2], size=0.125
    ),
    "tiny": Loop.polygon([[0, 0, 1], [0, 2, 0], [1, 2, 2], [1, 0, 3]], [0.3, 1, 0.2], 1e-9),
    "of coordinates": Loop.polygon([[0.1, 0.7, 0], [0.7, 0.7, 0], [0.7, 1.3, 0], [0.1, 1.3, 0]]),
}


@pytest.mark.parametrize("name", PARALLELOGRAMS)
def test_a_parallelogram_is_a_cell_of_a_map(name: str) -> None:
    """By line and by flux it has the vector of the same outline with a fifth corner."""
    loop = PARALLELOGRAMS[name]
    (part,) = loop.parts
    corners = [side.shape(np.zeros(1))[0][:, 0] for side in part.arcs]
    fifth = (corners[0] + corners[1]) / 2
    other = Loop.polygon([corners[0], fifth, *corners[1:]], part.centre, part.size)
    frame = load("so3").frame
    one, two = (burgers_vector(frame, x, 1e-12) for x in (loop, other))
    assert "points a side" in one.check.text
    assert "Kronrod" in two.check.text
    assert one.check.agrees
    assert np.abs(one.vector - two.vector).max() <= one.error + two.error
    assert one.check.flux is not None
    assert two.check.flux is not None
    for a, b, bound in (
        (one.check.line, two.check.line, one.check.line_error + two.check.line_error),
        (one.check.flux, two.check.flux, 1e-12 * two.magnitude),
    ):
        assert np.abs(a - b).max() <= bound


def test_a_general_quadrangle_has_its_own_area() -> None:
    """With one corner moved it is not treated as one, and its area is the integral of x dy."""
    frame = Frame([X, Y], [[1, 0], [0, X]])
    for corner in (1.0, 1.0 + 1e-12, 1.1):
        found = burgers_vector(frame, Loop.polygon([[0, 0], [1, 0], [1, corner], [0, 1]]), 1e-14)
        assert abs(found.vector[1] - (1 + corner) / 2) <= found.error < 1e-14
        assert ("points a side" in found.check.text) == (corner == 1.0)


def test_a_cycle_is_a_polygon() -> None:
    """A cycle of a network has the same integral as the polygon of its edges."""
    frame = load("heisenberg").frame
    values = {symbol.name: 0.7 for symbol in frame.parameters}
    net = Network(frame, grid_graph((3, 3, 2), 1.3), parameters=values)
    for cycle in net.cycles()[::2]:
        line = burgers_vector(frame, net.loop(cycle), parameters=values).check
        found = net.burgers(cycle)
        assert np.abs(found.vector - line.line).max() <= found.error + line.line_error


@pytest.mark.parametrize(("most", "given"), [(6400, True), (3200, False)])
def test_an_integral_that_converges_badly_is_given_or_refused(most, given, monkeypatch) -> None:
    """A result with two right digits has a bound that covers it; with fewer it is refused."""
    frame = Frame([X, Y], [[1, 0], [sp.sin(300 * X * Y), 1]])
    loop = Loop.polygon([[-1, -1], [1.3, 1], [1, -1.2]])
    monkeypatch.setattr(integrals, "MOST_POINTS", most)
    if given:
        found = burgers_vector(frame, loop)
        assert not found.reached
        assert abs(found.vector[1] + 0.0694572847855) < found.error < 0.01
    else:
        with pytest.raises(SingularPointError, match="vary faster than can be resolved"):
            burgers_vector(frame, loop)


def test_rounding_is_probed_at_enough_places_and_not_at_more() -> None:
    """Rounding is 3,000 times as large on one side of this loop as on the other.

    Probes at a third of the places would miss it, and then no rule would be fine enough; probes
    at all places would take most of the evaluations.
    """
    frame = Frame([X, Y], [[1, 0], [0, sp.exp(4 * (10**6 - X))]])
    found = burgers_vector(frame, Loop.circle([1e6, 0.1], 1.0))
    assert abs(found.vector[1] + 2 * np.pi * iv(1, 4)) < found.error / 10
    assert found.evaluations < 300
