"""Burgers vectors of data: the proof contains the exact integral of the interpolant."""

# pyright: reportArgumentType=false

import pickle
import random
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from flint import arb, fmpq

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, ProofError
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.support.precision import ball_precision


def contains(ball, truth, digits):
    """Whether a ball contains a ratio, and is as sharp as requested."""
    with ball_precision(400):
        ratio = arb(fmpq(truth.numerator, truth.denominator))
        sharp = ball.rad() <= abs(ratio) * arb(10) ** -digits or ball.rad() < arb(10) ** -digits
        return ball.overlaps(ratio) and sharp


def bilinear(values, x, y):
    """The polynomial of a cell through its four corners, at a place in units of the spacing."""
    i, j = (min(int(p), n - 2) for p, n in zip((x, y), values.shape, strict=True))
    s, t = x - i, y - j
    corners = ((values[i, j], values[i + 1, j]), (values[i, j + 1], values[i + 1, j + 1]))
    low, high = (a * (1 - s) + b * s for a, b in corners)
    return low * (1 - t) + high * t


def exact_integral(values, points):
    """Integral of (values[0] dx + values[1] dy), bilinear, along a polygon; by Simpson's rule."""
    total = Fraction(0)
    for a, b in zip(points, [*points[1:], points[0]], strict=True):
        step = [q - p for p, q in zip(a, b, strict=True)]
        cuts = {Fraction(0), Fraction(1)}
        for p, d in zip(a, step, strict=True):
            cuts |= {(k - p) / d for k in range(20) if d and 0 < (k - p) / d < 1}
        for low, high in pairwise(sorted(cuts)):
            # A product of two linear functions: Simpson's rule is exact.
            for s, weight in ((low, 1), ((low + high) / 2, 4), (high, 1)):
                # The polynomial of the cell of the middle, also at its edges.
                middle = [p + (low + high) / 2 * d for p, d in zip(a, step, strict=True)]
                i, j = (int(m) for m in middle)
                place = [p + s * d for p, d in zip(a, step, strict=True)]
                for mu in (0, 1):
                    cell = values[mu][i : i + 2, j : j + 2]
                    value = bilinear(cell, place[0] - i, place[1] - j)
                    total += (high - low) * weight / 6 * value * step[mu]
    return total


@pytest.mark.parametrize("seed", range(6))
def test_random_values_have_a_rational_b(seed):
    """Whole numbers at the nodes, order 2, random polygons: b is a ratio, exact to 40 digits."""
    draw = random.Random(seed)
    values = np.array([[[draw.randint(-9, 9) for _ in range(7)] for _ in range(8)] for _ in "xy"])
    grid = SampledFrame([np.arange(8.0), np.arange(7.0)], values[None].astype(float), order=2)
    points = [
        (Fraction(draw.randint(0, 7 * 64), 64), Fraction(draw.randint(0, 6 * 64), 64))
        for _ in range(draw.choice([3, 4, 6]))
    ]
    b = grid.burgers(gt.Loop.polygon([[float(x), float(y)] for x, y in points]))
    proof = gt.prove(b, 40)
    exact = [[[Fraction(int(x)) for x in row] for row in table] for table in values]
    truth = exact_integral([np.array(table, dtype=object) for table in exact], points)
    assert contains(proof.balls[0], truth, 38)
    # Values that jump from node to node: the integral is within the error of the interpolation.
    assert proof.error <= b.systematic_error
    assert any("interpolant" in text for text in proof.assumes)


@pytest.mark.parametrize("order", [4, 6])
@pytest.mark.parametrize(("loop", "centre", "axes"), [
    (gt.Loop.circle([0, 0], 0.5), (0.0, 0.0), (0.5, 0.5)),
    (gt.Loop.circle([0, 0], 1), (0.0, 0.0), (1.0, 1.0)),
    (gt.Loop.circle([0.125, 0.25], 0.5), (0.125, 0.25), (0.5, 0.5)),
    (gt.Loop.circle([0.1, -0.2], 0.3).reversed(), (0.1, -0.2), (0.3, -0.3)),
    (gt.Loop.ellipse([0, 0], [0.75, 0.25]), (0.0, 0.0), (0.75, 0.25)),
])  # fmt: skip
def test_polynomials_are_their_own_interpolants(order, loop, centre, axes):
    """Values of x^2 y and x y^2 + x: b from the curl and the moments of an ellipse."""
    axis = np.linspace(-1, 1, 17)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    grid = SampledFrame([axis, axis], np.array([[x * x * y, x * y * y + x]]), order=order)
    b = grid.burgers(loop)
    with ball_precision(200):
        # The curl y^2 + 1 - x^2 over an ellipse: area (its value at the centre + (q^2 - p^2) / 4).
        p, q = map(arb, axes)
        mean = arb(centre[1]) ** 2 + 1 - arb(centre[0]) ** 2 + (q * q - p * p) / 4
        truth = arb.pi() * p * q * mean
        proof = gt.prove(b, 30)
        assert proof.balls[0].overlaps(truth)
        assert proof.balls[0].rad() < arb(10) ** -29
    assert proof.holds


def test_the_trivial_case():
    """A constant coframe has b = 0, also along lines of nodes and their edges."""
    grid = SampledFrame([np.arange(5.0)] * 2, np.ones((2, 2, 5, 5)))
    for corners in ([[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [2.5, 1], [2.5, 3.5], [1, 3.5]]):
        proof = gt.prove(grid.burgers(gt.Loop.polygon(corners)))
        with ball_precision(100):
            assert all(x.contains(0) for x in proof.balls)
        assert proof.holds is not False


def test_holes_and_periods():
    """Linear data around a hole: curl times area; and a loop around a period of constant data."""
    axis = np.arange(9.0)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    mask = (abs(x - 4) < 2) & (abs(y - 4) < 2)
    grid = SampledFrame([axis, axis], np.array([[-y, x]]) / 2, mask=mask)
    b = grid.burgers(grid.loop_around(0))
    assert contains(gt.prove(b, 20).balls[0], Fraction(16), 19)
    ring = SampledFrame([axis, axis], np.full((1, 2, 9, 9), 0.5), periodic=("x",))
    around = gt.Loop.polygon([[0, 2], [4, 2], [9, 2], [9, 3], [4, 3], [0, 3]])
    with ball_precision(100):
        assert gt.prove(ring.burgers(around)).balls[0].contains(0)


def test_three_dimensions():
    """x dy - y dx and z dx in space: a circle across z has the curl through its disk."""
    axes = [np.linspace(-1, 1, 9)] * 3
    x, y, z = np.meshgrid(*axes, indexing="ij")
    zero = np.zeros_like(x)
    grid = SampledFrame(axes, np.array([[-y, x, zero], [z, zero, zero]]))
    proof = gt.prove(grid.burgers(gt.Loop.circle([0, 0, 0.1], 0.5, plane=(0, 1))))
    with ball_precision(100):
        assert proof.balls[0].overlaps(arb.pi() / 2)
        assert proof.balls[1].contains(0)


def test_words_and_copies():
    """The text names the interpolant, also for a copy by pickle."""
    grid = SampledFrame([np.arange(6.0)] * 2, np.random.default_rng(1).normal(size=(2, 2, 6, 6)))
    b = grid.burgers(gt.Loop.circle([2.5, 2.4], 1.3))
    proof = gt.prove(pickle.loads(pickle.dumps(b)))
    assert "interpolant of order 4" in str(proof)
    assert "error of the integral" in str(proof)
    assert proof["b1"] is proof.balls[1]


AXES = [np.arange(9.0)] * 2
PLANE = SampledFrame(AXES, np.ones((1, 2, 9, 9)))
CIRCLE = gt.Loop.circle([4, 4], 2.3)
REFUSED = [
    (lambda: gt.prove(SampledFrame.from_displacement(AXES, np.ones((1, 9, 9))).burgers(CIRCLE)),
     ProofError, "without an interpolant"),
    (lambda: gt.prove(PLANE.burgers(gt.Loop.spline([[1, 1], [5, 2], [4, 6]]))), ProofError,
     "straight and elliptic"),
    (lambda: gt.prove(PLANE.burgers(CIRCLE), parameters={"k": 1}), ArgumentError, "data"),
    (lambda: gt.prove(PLANE.burgers(CIRCLE), start=[1]), ArgumentError, "start"),
    (lambda: gt.prove(PLANE.burgers(CIRCLE), derivatives=["k"]), ArgumentError, "derivatives"),
    (lambda: gt.prove(PLANE), ArgumentError, "expected a BurgersVector"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_refusals(call, error, words):
    """Each refusal names the reason."""
    with pytest.raises(error, match=words):
        call()
