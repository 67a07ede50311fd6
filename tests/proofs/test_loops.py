"""Loops: integrals in balls, the branches that they assume, and arcs that join."""

from fractions import Fraction

import pytest
import sympy as sp
from flint import arb

import geomtorsion as gt
from geomtorsion.errors import ProofError
from geomtorsion.proofs import arc_integrals
from geomtorsion.proofs.paths import arcs_of, spline_coefficients
from geomtorsion.proofs.wanted import Wanted
from geomtorsion.support.precision import ball_precision
from tests.proofs.test_prove import as_if_around
from tests.rounding import ROUNDED

X, Y, Z = sp.symbols("x y z", real=True)
SO3 = gt.spaces.load("so3").frame
# A frame that needs x > 0: the root is read as x.
U, V = sp.symbols("u v")
HALF = gt.Frame([U, V], [[1, 0], [sp.sqrt(U**2), 1]], domain=[U > 0])


def proved(frame, loop, digits=15, **parameters):
    """Integrals in balls."""
    return arc_integrals.proved_integrals(
        frame, loop, parameters, Wanted.of(digits, arb(0), arb(1))
    ).balls


def test_known_integrals():
    """Areas and lengths of a circle, an ellipse, a plaquette, a triangle, a curve."""
    frame = gt.Frame([X, Y], [[1, 0], [-Y / 2, 1 + X / 2]])
    with ball_precision(200):
        pi = arb.pi()
        cases = [
            (gt.Loop.circle([0.5, 2], 3), 9 * pi),
            (gt.Loop.circle([0.5, 2], Fraction(1, 3)), pi / 9),
            (gt.Loop.ellipse([0, 0], (0.5, 0.25)), pi / 8),
            (gt.Loop.plaquette([1, 2], (0.1, 0.3)), arb(0.1) * arb(0.3)),
            (gt.Loop.polygon([[0, 0], [1, 0], [0, Fraction(1, 3)]]), arb(1) / 6),
            (gt.Loop.parametric(["cos(s)", "sin(2*s)/2"], interval=(0, "2*pi")), arb(0)),
            (gt.Loop.parametric(["cos(s)", "sin(s)**3"], interval=(0, "2*pi")), 3 * pi / 4),
        ]
    for loop, area in cases:
        found = proved(frame, loop, 25)[1]
        assert found.overlaps(area)
        assert found.rad() < 1e-24


def test_floats_are_dyadic_and_fractions_exact():
    """0.1 is not 1/10: the balls of both circles are disjoint, for centres and radii."""
    frame = gt.Frame([X, Y], [[1, 0], [X * Y**2, 1]])
    one = proved(frame, gt.Loop.circle([0.1, 0.7], 0.3), 25)[1]
    other = proved(frame, gt.Loop.circle([Fraction(1, 10), Fraction(7, 10)], Fraction(3, 10)), 25)[
        1
    ]
    assert not one.overlaps(other)
    assert abs(one - other) < ROUNDED
    sides = [proved(frame, gt.Loop.plaquette([0, 0], steps), 25)[1]
             for steps in ((0.1, 0.3), (Fraction(1, 10), Fraction(3, 10)))]  # fmt: skip
    assert not sides[0].overlaps(sides[1])
    tilted = gt.Loop.circle([0, 0, 0], 1, plane=([1, 1, 0], [0, 0.1, 1]))
    area = gt.Frame([X, Y, Z], [[1, 0, 0], [0, 1, 0], [-Y / 2, X / 2, 1]])
    with ball_precision(100):
        # The plane's normal is (1, -1, 0.1).
        truth = arb.pi() * arb(0.1) / (2 + arb(0.1) ** 2).sqrt()
    assert proved(area, tilted, 20)[2].overlaps(truth)


def test_a_branch_that_is_left_is_refused(monkeypatch):
    """A loop on which the root is not its branch is refused; without the check b would be wrong."""
    inside, over = gt.Loop.circle([2, 0], 1), gt.Loop.circle([0.25, 0], 1)
    assert proved(HALF, inside)[1].contains(0)
    with pytest.raises(ProofError, match="leaves the domain near"):
        proved(HALF, over)
    slope = gt.Frame([U, V], [[1, 0], [V * sp.sqrt(U**2), 1]], domain=[U > 0])
    monkeypatch.setattr(arc_integrals, "check_path", lambda *_: None)
    # The integral of y x dx is minus the integral of x over the disk; y |x| dx gives less.
    assert proved(slope, over)[1].overlaps(-arb.pi() / 4)


def test_pieces_of_a_spline_join():
    """Neighbouring cubics have equal positions, slopes and curvatures; the points are on them."""
    points = [[0.3, 1.0], [0.4, 1.1], [0.3, 1.25], [0.15, 1.1], [0.2, 1.0]]
    with ball_precision(120):
        balls = [[arb(x) for x in point] for point in points]
        pieces = list(spline_coefficients(balls))
        lengths = [
            sum(((a - b) ** 2 for a, b in zip(balls[k], balls[(k + 1) % 5], strict=True)), arb(0))
            .sqrt() for k in range(5)
        ]  # fmt: skip
        for k, piece in enumerate(pieces):
            other = pieces[(k + 1) % 5]
            h, g = lengths[k], lengths[(k + 1) % 5]
            for i in range(2):
                (a, b, c, d), (p, q, r, s) = piece[i], other[i]
                assert d == points[k][i]
                for gap in (
                    a + b + c + d - s,
                    (3 * a + 2 * b + c) / h - r / g,
                    (6 * a + 2 * b) / h**2 - 2 * q / g**2,
                ):
                    assert gap.contains(0)
                    assert gap.rad() < 1e-30
                assert p.is_finite()


def test_a_spline_is_the_curve_that_the_library_follows():
    """Points of the balls agree with the floats, to rounding."""
    loop = gt.Loop.spline([[0.3, 1, 0.2], [0.4, 1, 0.2], [0.3, 1.2, 0.3], [0.2, 1.1, 0.1]])
    (part,) = loop.parts
    with ball_precision(100):
        for arc, ball in zip(part.arcs, arcs_of(part), strict=True):
            for s in (0.0, 0.25, 0.9):
                floats = part.points(arc, s)[0][:, 0]
                for x, y in zip(floats, ball.places(arb(s)), strict=True):
                    assert abs(y - float(x)) < ROUNDED


def test_wrong_splines_would_be_seen(monkeypatch):
    """Cubics with one wrong coefficient do not close: the integral excludes zero."""
    loop = gt.Loop.spline([[0, 0], [1, 0], [1, 1], [0, 1]])
    plain = proved(gt.Frame([X, Y], [[1, 0], [0, 1]]), loop)[0]
    assert plain.contains(0)

    def wrong(points):
        for k, rows in enumerate(spline_coefficients(points)):
            yield [(a + (k == 0), b, c, d) for a, b, c, d in rows]

    monkeypatch.setattr("geomtorsion.proofs.paths.spline_coefficients", wrong)
    assert not proved(gt.Frame([X, Y], [[1, 0], [0, 1]]), loop)[0].contains(0)


def test_bits_and_loops_overlap():
    """Balls of other digits, or of the same loop with another start, have a common point."""
    loop = gt.Loop.circle([0.3, 1, 0.2], 0.1)
    found = [proved(SO3, loop, digits) for digits in (8, 15, 30, 80)]
    other = gt.Loop.ellipse([0.3, 1, 0.2], (0.1, 0.1), plane=([0, 1, 0], [-1, 0, 0]))
    found.append(proved(SO3, other, 20))
    with ball_precision(400):
        for one in found:
            assert all(x.overlaps(y) for x, y in zip(one, found[-1], strict=True))


def test_a_wave_of_forty_turns():
    """A loop with forty waves has the area pi (1 + 1/200)."""
    wave = gt.Loop.parametric(
        ["(1 + cos(40*s)/10)*cos(s)", "(1 + cos(40*s)/10)*sin(s)"], interval=(0, "2*pi")
    )
    frame = gt.Frame([X, Y], [[1, 0], [-Y / 2, 1 + X / 2]])
    with ball_precision(100):
        assert proved(frame, wave)[1].overlaps(arb.pi() * (1 + arb(1) / 200))


def test_periods_of_angles():
    """A loop that closes after a whole turn of an angle has the length of a circle of latitude."""
    theta, phi = sp.symbols("theta phi", real=True)
    frame = gt.Frame([theta, phi], [[1, 0], [0, sp.sin(theta)]])
    loop = gt.Loop.parametric(["1", "s"], interval=(0, "2*pi"), periods={1: "2*pi"})
    with ball_precision(100):
        assert proved(frame, loop)[1].overlaps(2 * arb.pi() * arb(1).sin())


@pytest.mark.parametrize("k", [1, 10, 100, 1000])
def test_a_narrow_bump(k):
    """A bump at (1, 0) is exp(2 k^2 (x - 1)) on the circle: b = 2 pi I_1(2 k^2)/exp(2 k^2)."""
    bump = sp.exp(-((k * (X - 1)) ** 2) - (k * Y) ** 2)
    found = proved(gt.Frame([X, Y], [[1, bump], [0, 1]]), gt.Loop.circle([0, 0], 1), 20)[0]
    with ball_precision(400):
        size = 2 * arb(k) ** 2
        assert found.overlaps(2 * arb.pi() * size.bessel_i(1) * (-size).exp())
        assert found.rel_accuracy_bits() > 60


def test_bumps_across_a_loop():
    """exp(-(100 x)^2) dy around the unit circle vanishes, as x does by its mirror image."""
    bump = sp.exp(-((100 * X) ** 2))
    for entry in (bump, 1 + bump, bump * Y**2, bump + sp.exp(-((100 * X - 30) ** 2)) * Y):
        frame = gt.Frame([X, Y], [[1, entry], [0, 1]])
        assert proved(frame, gt.Loop.circle([0, 0], 1))[0].contains(0)


def test_a_pole_between_points_is_seen():
    """A narrow pole on the loop is found, independent of samples."""
    narrow = gt.Frame([X, Y], [[1, 0], [1 / (X - sp.Rational(123457, 10**6)), 1]])
    with pytest.raises(ProofError, match="a pole or an edge is on the loop"):
        proved(narrow, gt.Loop.circle([0, 0], 1))


def test_a_result_of_another_loop_does_not_hold():
    """A result for another loop is found to be wrong."""
    b = gt.burgers_vector(SO3, gt.Loop.circle([0.3, 1, 0.2], 0.1))
    assert gt.prove(as_if_around(b, gt.Loop.circle([0.3, 1, 0.2], 0.101))).holds is False


def test_an_integrand_is_analytic_on_its_ellipses(monkeypatch):
    """Without the flag `analytic` the integral of a root near its branch point is wrong."""
    frame = gt.Frame([X, Y], [[1, 0], [Y * sp.sqrt(X), 1]])
    loop = gt.Loop.polygon([[1, 1], [4, 1], [4, 0], [1, 0]])
    with ball_precision(80):
        # Along y = 1 from 1 to 4; the other sides have y = 0 or dx = 0.
        truth = arb(14) / 3
    assert proved(frame, loop)[1].overlaps(truth)
    plain = arc_integrals._integrand

    def unflagged(*arguments):
        function = plain(*arguments)
        return lambda s, analytic: function(s, False)

    monkeypatch.setattr(arc_integrals, "_integrand", unflagged)
    assert not proved(frame, loop)[1].overlaps(truth)
