"""Bounds: each bound of a proof against its closed form, from above and from below.

A bound that is too small makes a ball wrong; one that is much too large would let a mistake in it
pass, so each is compared with its exact value on both sides.
"""

# pyright: reportOptionalMemberAccess=false, reportGeneralTypeIssues=false
# pyright: reportArgumentType=false

from __future__ import annotations

import math

import pytest
import sympy as sp
from flint import acb, arb, arb_mat, fmpq

from geomtorsion.ode import ODE
from geomtorsion.proofs import steps
from geomtorsion.proofs.series import BallSystem, polynomial, taylor, variation
from geomtorsion.proofs.sets import LohnerSet
from geomtorsion.proofs.steps import Disk, Method, Stepper, dyadic_below
from geomtorsion.proofs.wanted import Wanted, around_zero, upper, upper_float
from geomtorsion.support.precision import ball_precision
from tests.proofs.systems import one_step, system_of
from tests.rounding import ROUNDED

# Radii of balls have 30 bits: the relative distance that a few roundings may add.
TIGHT = arb(2) ** -24


def is_least(bound, truth):
    """Whether a bound is not below a truth, nor above it by more than rounding."""
    return bool(bound >= truth.lower()) and bool(bound <= truth.upper() + abs(truth) * TIGHT)


@pytest.fixture(autouse=True)
def _bits():
    with ball_precision(100):
        yield


@pytest.mark.parametrize("order", [0, 1, 4, 9])
@pytest.mark.parametrize("share", [fmpq(1, 8), fmpq(1, 2), fmpq(9, 10)])
def test_the_tail_of_the_variation(share, order):
    """It is the sum of all powers of the share beyond the order, here to 2000 terms."""
    truth = sum((arb(share) ** k for k in range(order + 1, 2000)), arb(0))
    assert is_least(steps.variation_tail(arb(share), order), truth)


@pytest.mark.parametrize("order", [0, 1, 8, 21])
@pytest.mark.parametrize("time", [fmpq(1, 16), fmpq(1, 2), fmpq(3, 4)])
def test_the_integral_of_a_defect(time, order):
    """A defect M (t/R)^N itself has the integral M R/(N + 1) (t/R)^(N + 1)."""
    t, size, radius = arb(time), arb(3), arb(3) / 4
    # The integral of a monomial by differences of its antiderivative, term by term.
    x = sp.Symbol("x")
    exact = sp.integrate(
        3 * (x / sp.Rational(3, 4)) ** order, (x, 0, sp.Rational(int(time.p), int(time.q)))
    )
    truth = arb(fmpq(int(exact.p), int(exact.q)))
    (bound,) = steps.defect_integral([size], radius, t, order)
    assert is_least(bound, truth)
    assert is_least(Disk(0.75, (size,), 0.0).remainder(t, order)[0], truth)


def test_growth_of_neighbours():
    """exp(L t) of a nilpotent, of a diagonal and of a full matrix."""
    t = arb(1) / 2
    nilpotent = steps.growth_of(arb_mat([[0, 3], [0, 0]]), t)
    assert is_least(upper(nilpotent[0, 1]), 3 * t)
    assert is_least(upper(nilpotent[0, 0]), arb(1))
    diagonal = steps.growth_of(arb_mat([[2, 0], [0, 5]]), t)
    assert is_least(upper(diagonal[1, 1]), (5 * t).exp())
    one, other = steps.grown(arb_mat([[0, 1], [1, 0]]), t, [arb(3), arb(7)])
    assert is_least(one, 3 * t.cosh() + 7 * t.sinh())
    assert is_least(other, 7 * t.cosh() + 3 * t.sinh())


def stepper_of(rates, start, order=8):
    """The search for a step, at 64 bits."""
    return Stepper(system_of(rates), LohnerSet.of(start), Method(order, 4), 60)


def test_the_reach_of_a_polynomial():
    """x' = x has the coefficients x0/k!: reach and speed are their sums from order 1 on."""
    found = stepper_of({"x": "x"}, [arb(2)])
    r = arb(3) / 4
    (reach,), (speed,) = found.reach(r)
    assert is_least(reach, sum((2 * r**k / math.factorial(k) for k in range(1, 9)), arb(0)))
    assert is_least(
        speed, sum((2 * k * r ** (k - 1) / math.factorial(k) for k in range(1, 9)), arb(0))
    )


def test_the_box_of_a_disk():
    """It contains the corners of its half sides, and no point beyond."""
    found = stepper_of({"x": "x"}, [arb(2)])
    (box,) = found.box([arb(0.5)], [arb(0.25)])
    for side in (0.75, -0.75):
        assert box.real.contains(2 + arb(side))
        assert box.imag.contains(arb(side))
        assert not box.real.contains(2 + arb(side) * 1.001)
        assert not box.imag.contains(arb(side) * 1.001)


def test_the_bound_of_a_defect():
    """x' = x on a disk: |x| at the corner of the box, and the speed of P."""
    found = stepper_of({"x": "x"}, [arb(2)])
    (reach,), (speed,) = found.reach(0.5)
    disk = found.disk(0.5)
    assert is_least(disk.defect[0], ((2 + reach) ** 2 + reach**2).sqrt() + speed)


def test_the_bound_of_a_jacobian():
    """v' = -sin(x) + v x/5: the entries of |J| at the places of their columns."""
    found = stepper_of({"x": "v", "v": "-3*x+v/5"}, [arb(1), arb(1)])
    bound = found._bound(found.system.slopes_on(found.box([arb(0), arb(0)])))
    rows = [[float(bound[i, j]) for j in range(2)] for i in range(2)]
    assert rows == [[0, 1], [3, pytest.approx(0.2, rel=ROUNDED)]]


def test_a_tube_contains_its_widest_motion():
    """x' = x from 1 +- 1/2: the tube is no narrower than its motions, nor much wider."""
    step = one_step({"x": "x"}, [arb(1, 0.5)], Method(20, 6), fmpq(1, 4))
    (tube,) = step.tube
    assert tube.contains(1.5 * arb(0.25).exp())
    assert tube.contains(arb(0.5))
    assert tube.rad() < 5


@pytest.mark.parametrize(("radius", "size"), [(0, 3), (0.5, 0), (0.25, 1)])
def test_the_width_of_a_tube(radius, size):
    """Starts within rho and a defect M t/R deviate by exp(L t) (rho + M t^2 / (2 R)) at most."""
    whole, outer = LohnerSet.of([arb(1, radius)]), 2.5
    search = Stepper(system_of({"x": "x"}), whole, Method(1, 1), 60)
    bound, (width,) = search._tube(Disk(4.0, (arb(size),), 0.0), outer)
    truth = arb(outer).exp() * (whole.radii[0] + arb(size) * arb(outer) ** 2 / 8)
    assert is_least(bound[0, 0], arb(1))
    assert truth < width < 3 * truth


def test_a_tube_bounds_its_jacobian():
    """x' = x^2: |J| = 2 |x| at the corner of the reach of P and the width of the tube."""
    search = Stepper(system_of({"x": "x**2"}), LohnerSet.of([arb(1, 0.01)]), Method(8, 4), 60)
    bound, (width,) = search._tube(search.disk(0.3), 0.2)
    side = search.reach(0.2)[0][0] + width
    assert is_least(bound[0, 0], 2 * ((1 + side) ** 2 + side**2).sqrt())


def test_the_remainder_grows_with_the_motion():
    """x' = x: the remainder is exp(t) times the integral of the defect."""
    search, time = stepper_of({"x": "x"}, [arb(1)]), fmpq(1, 4)
    disk = search.best_disk(1.0, 1.0)
    step = search.proved(disk, time)
    (defect,) = disk.remainder(arb(time), 8)
    assert is_least(step.remainder[0], arb(time).exp() * defect)


def test_a_tube_reaches_as_far_as_its_motion():
    """x' = x from 1 itself: the tube ends at exp(t), up to a fiftieth of the way."""
    step = one_step({"x": "x"}, [arb(1)], Method(20, 6), fmpq(1, 4))
    (tube,) = step.tube
    way = arb(0.25).exp() - 1
    assert tube.contains(1 + way)
    assert tube.rad() < way * 1.02


@pytest.mark.parametrize("length", [fmpq(1, 8), fmpq(1, 2)])
def test_the_remainder_of_a_step(length):
    """x' = x: |x - P| is the rest of the exponential series, below the remainder."""
    step = one_step({"x": "x"}, [arb(1)], Method(8, 4), length)
    t = arb(length)
    rest = sum((t**k / math.factorial(k) for k in range(9, 60)), arb(0))
    assert step.remainder[0] >= rest
    assert step.middle(t)[0].contains(t.exp())
    assert step.hull(t)[0].contains(t.exp())


@pytest.mark.parametrize("share", [fmpq(1, 2), fmpq(1, 1)])
def test_the_variation_of_a_step(share):
    """The radius of V beside its polynomial is growth times the tail of its series."""
    step = one_step({"x": "x"}, [arb(1)], Method(20, 6, -60), fmpq(3, 2))
    time, order = arb(fmpq(3, 2) * share), step.variation_order
    series = sum((time**k / math.factorial(k) for k in range(order + 1)), arb(0))
    tail = (time / step.outer) ** (order + 1) / (1 - time / step.outer)
    assert is_least(step.growth[0, 0].upper(), step.outer.exp())
    assert is_least(arb(upper(step.variation(time)[0, 0] - series)), step.growth[0, 0] * tail)


def test_no_step_is_longer_than_its_dyadic_bound():
    """A step is rounded down, by less than 2^-11."""
    for value in (0.1, 1 / 3, 7.9, 2.0**-40 * 1.999):
        below = dyadic_below(value)
        exact = fmpq(*value.as_integer_ratio())
        assert exact * fmpq(2047, 2048) < below <= exact


def test_the_series_of_the_variation():
    """V of x'' = -x is the rotation by t: it has the coefficients of cosine and sine."""
    _, slopes = taylor(system_of({"x": "v", "v": "-x"}), [arb(1), arb(0)], 6, 6)
    found = variation(slopes, arb_mat([[1, 0], [0, 1]]), 6)
    for k, matrix in enumerate(found):
        cos = (-1) ** (k // 2) / arb(math.factorial(k)) if k % 2 == 0 else arb(0)
        sin = (-1) ** (k // 2) / arb(math.factorial(k)) if k % 2 else arb(0)
        truth = [[cos, sin], [-sin, cos]]
        for i in range(2):
            for j in range(2):
                assert matrix[i, j].contains(truth[i][j])
                assert matrix[i, j].rad() < 1e-25
    assert polynomial([arb(1), arb(2), arb(3)], arb(10)) == 321


def test_the_variation_along_a_motion():
    """x' = x^2 from 1 has V = 1/(1 - t)^2, with the coefficients k + 1."""
    _, slopes = taylor(system_of({"x": "x**2"}), [arb(1)], 8, 8)
    for k, matrix in enumerate(variation(slopes, arb_mat([[1]]), 8)):
        assert matrix[0, 0].contains(k + 1)
        assert matrix[0, 0].rad() < 1e-25


def test_slopes_and_rates_of_a_system():
    """They are not finite across a branch point; backwards in time rates have the other sign."""
    root = system_of({"x": "x**(5/2)"})
    boxes = acb(arb(1, 0.5), arb(0, 0.5)), acb(arb(0, 0.5), arb(0, 0.5))
    for function in (root.rates_on, root.slopes_on):
        assert [function([box])[0].is_finite() for box in boxes] == [True, False]
    system = ODE.of({"x": "3*x"}, [1]).system
    signs = [
        BallSystem.of(system, list, backwards=back).rates_at([arb(2)])[0] for back in (False, True)
    ]
    assert signs == [6, -6]


def test_the_hull_of_a_set():
    """Radii are the sums of |A| r, row by row; the hull has these."""
    whole = LohnerSet((arb(1), arb(2)), arb_mat([[1, -2], [3, 0.5]]), (arb(0.5), arb(0.25)))
    assert [is_least(x, y) for x, y in zip(whole.radii, (arb(1), arb(1.625)), strict=True)] == [
        True,
        True,
    ]
    for ball, middle, radius in zip(whole.hull, (1, 2), (1, 1.625), strict=True):
        for side in (1, -1):
            assert ball.contains(arb(middle + side * radius))
            assert not ball.contains(arb(middle + side * radius * 1.001))


def test_the_image_of_a_set():
    """Under (x, y) -> (x + y, y) each side is the sum of both, and values add their radii."""
    whole = LohnerSet.of([arb(0, 1), arb(0, 2)])
    values = [arb(5, 0.25), arb(6)]
    slopes = arb_mat([[1, 1], [0, 1]])
    first, second = whole.image(values, slopes)
    assert is_least(upper(first - 5), arb(3.25))
    assert is_least(upper(second - 6), arb(2))
    moved = whole.moved(values, slopes)
    for corner in ([8.25, 8.0], [1.75, 4.0], [3.75, 4.0], [6.25, 8.0]):
        away = moved.axes.inv() * arb_mat(
            [[arb(x) - m] for x, m in zip(corner, moved.middle, strict=True)]
        )
        assert all(abs(away[k, 0]) <= r * (1 + TIGHT) + TIGHT for k, r in enumerate(moved.spread))
    assert moved.hull[0].rad() < 2 * 3.25


def test_small_bounds():
    """Upper bounds of balls and floats, and how many bits a judged error needs."""
    assert is_least(upper(arb(-3, 0.5)), arb(3.5))
    assert around_zero(arb(2, 0.5)).contains(arb(2.5))
    assert not around_zero(arb(2, 0.5)).contains(arb(2.51))
    third = arb(1) / 3
    assert arb(upper_float(third)) >= third.upper()
    assert upper_float(third) <= 1 / 3 * (1 + 2.0**-50)
    assert 1.5 <= upper_float(arb(1, 0.5)) <= 1.5 * (1 + 2.0**-29)
    assert upper_float(arb(1) / 0) == math.inf
    assert Wanted.of(15, arb(0), arb(1)).bits == 51
    assert Wanted.of(1, arb(2) ** -100, arb(1)).bits == 104
