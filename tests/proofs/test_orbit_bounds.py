"""Bounds of theorems: Krawczyk's operator, interval Newton and tails of columns, in closed form."""

import math
from dataclasses import replace

import pytest
from flint import arb, arb_mat, fmpq

from geomtorsion.proofs.closed_orbits import _contraction, _enclosed
from geomtorsion.proofs.sets import LOW_BITS, LohnerSet
from geomtorsion.proofs.steps import Method, Stepper
from geomtorsion.support.precision import ball_precision
from tests.proofs.systems import system_of
from tests.proofs.test_bounds import is_least


@pytest.fixture(autouse=True)
def _bits():
    with ball_precision(100):
        yield


@pytest.mark.parametrize("radius", [fmpq(1, 4), fmpq(1, 8), fmpq(1, 100)])
def test_krawczyks_operator(radius):
    """x^2 - 2 around 3/2 with the slope 3: (1/12 + 2 r^2/3)/r, below 1 where the box has a root."""
    r, inverse = arb(radius), arb_mat([[arb(1) / 3]])
    slopes = arb_mat([[2 * arb(arb(3) / 2, r)]])
    size = _contraction(slopes, inverse, [arb(1) / 4], [r])
    assert is_least(size, (arb(1) / 12 + 2 * r * r / 3) / r)
    holds = abs(arb(2).sqrt() - arb(3) / 2) < r
    assert bool(size < 1) == bool(holds)


def test_krawczyks_operator_in_the_plane():
    """F = A x + b with the inverse 1: the rows of |1 - A| r + |b|, against the radii."""
    slopes = arb_mat([[arb(3) / 4, arb(1) / 8], [arb(-1) / 2, 1]])
    unit = arb_mat([[1, 0], [0, 1]])
    gaps, radii = [arb(1) / 16, arb(-1) / 8], [arb(1), arb(2)]
    assert is_least(_contraction(slopes, unit, gaps, radii), arb(9) / 16)
    assert is_least(_contraction(slopes, unit, gaps, [arb(4), arb(1)]), arb(17) / 8)


@pytest.mark.parametrize("radius", [fmpq(1, 4), fmpq(1, 50)])
def test_interval_newton(radius):
    """m - F(m)/F'(box) for x^2 - 2: its ends, and the root inside."""
    r = arb(radius)
    slopes = arb_mat([[2 * arb(arb(3) / 2, r)]])
    (ball,) = _enclosed([arb(3) / 2], slopes, [arb(1) / 4], arb_mat([[arb(1) / 3]]))
    low, high = (arb(3) / 2 - arb(1) / 4 / (3 + s * 2 * r) for s in (-1, 1))
    assert ball.lower() <= low <= ball.lower() + (high - low) / 1000
    assert ball.upper() - (high - low) / 1000 <= high <= ball.upper()
    if radius == fmpq(1, 4):
        assert ball.contains(arb(2).sqrt())


def column_step(order):
    """A step of x' = x with a column, whose series has only some terms."""
    with ball_precision(53):
        whole = LohnerSet.of([arb(1)], [[arb(1)]])
        stepper = Stepper(system_of({"x": "x"}), whole, Method(20, 6, -60), 53)
        with ball_precision(LOW_BITS):
            step = stepper.proved(stepper.best_disk(1.0, 1.0), fmpq(1))
    assert step is not None
    return replace(step, column_order=order)


@pytest.mark.parametrize("order", [2, 5, 9])
@pytest.mark.parametrize("time", [fmpq(1, 4), fmpq(1)])
def test_the_tail_of_a_column(order, time):
    """The column of x' = x is exp(t): its series ends early, and its tail contains the rest."""
    step, t = column_step(order), arb(time)
    (column,) = step.columns(t)
    assert column[0].contains(t.exp())
    series = sum((t**k / math.factorial(k) for k in range(order + 1)), arb(0))
    share = t / step.outer
    tail = step.growth[0, 0] * share ** (order + 1) / (1 - share)
    assert abs(column[0] - series).upper() <= tail.upper() * arb(1.001) + arb(2) ** -40
