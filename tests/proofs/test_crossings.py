"""Crossings of a surface: their balls contain closed forms, and derivatives follow the surface."""

# pyright: reportArgumentType=false

import pickle
import random

import pytest
from flint import arb

import geomtorsion as gt
from geomtorsion.errors import ArgumentError, ProofError, UnknownNameError
from geomtorsion.support.precision import ball_precision

SPRING = gt.ODE.of({"x": "v", "v": "-x"}, [1, 0])


def test_a_spring():
    """x = cos t falls through zero at pi/2, with v = -1; there dv/dx = -1 and dt/dv = 1."""
    crossing = gt.poincare(SPRING, "x", 4, digits=25)
    with ball_precision(200):
        assert crossing.time.overlaps(arb.pi() / 2)
        assert crossing.time.rad() < arb(10) ** -25
        assert crossing["v"].contains(-1)
        # From (x, v) the point is (0, -sqrt(x^2 + v^2)), the time pi/2 + v/x.
        for row, truth in (
            (crossing.derivative["x"], (0, 0)), (crossing.derivative["v"], (-1, 0)),
            (crossing.time_derivative, (0, 1)),
        ):  # fmt: skip
            assert all(ball.contains(x) for ball, x in zip(row, truth, strict=True))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_returns(count):
    """From a point on the section the crossings are one period apart."""
    crossing = gt.poincare(SPRING.with_start([0, -1]), gt.When("x"), 20, count=count)
    with ball_precision(200):
        assert crossing.time.overlaps(2 * count * arb.pi())
        assert crossing["v"].contains(-1)


def test_rising_crossings():
    """-g falls where g rises, at 3 pi/2."""
    with ball_precision(200):
        assert gt.poincare(SPRING, "-x", 9).time.overlaps(3 * arb.pi() / 2)


@pytest.mark.parametrize("seed", range(8))
def test_random_spirals_with_known_truth(seed):
    """r' = -k r, phi' = w from a ball of starts: each corner arrives inside the balls."""
    draw = random.Random(seed)
    k, w = draw.randint(1, 9), draw.randint(4, 20)
    rates = {"x": f"-{k}/16*x - {w}/8*y", "y": f"-{k}/16*y + {w}/8*x"}
    angle, size, radius = draw.uniform(0.1, 3), draw.uniform(0.5, 2), draw.choice([1e-9, 1e-4, 0.0])
    with ball_precision(200):
        point = [(size * arb(angle).cos()).mid(), (size * arb(angle).sin()).mid()]
        start = [arb(x, radius) for x in point]
    crossing = gt.poincare(gt.ODE.of(rates, [1, 0]), "y", 9, start=start)
    for signs in ((0, 0), (-1, -1), (-1, 1), (1, -1), (1, 1)):
        with ball_precision(200):
            x, y = (p + s * arb(radius) for p, s in zip(point, signs, strict=True))
            time = (arb.pi() - arb.atan2(y, x)) * 8 / w
            far = (x * x + y * y).sqrt() * (-time * k / 16).exp()
            assert crossing.time.overlaps(time)
            assert crossing["x"].overlaps(-far)
            assert crossing["y"].contains(0)
            # d far = exp(-k time / 16) (dr - r k/16 dtime), with dtime = -8/w dphi.
            turn = [-y / (x * x + y * y), x / (x * x + y * y)]
            for ball, slope, part, along in zip(
                crossing.derivative["x"], crossing.time_derivative, turn, (x, y), strict=True
            ):
                change = -part * 8 / w
                assert slope.overlaps(change)
                assert ball.overlaps(-far * (along / (x * x + y * y) - change * k / 16))


REFUSED = [
    (lambda: gt.poincare(SPRING, "x-2", 9), ProofError, "no further crossing"),
    (lambda: gt.poincare(SPRING, "x-1", 9), ProofError, "along the section"),
    (lambda: gt.poincare(SPRING, "x+1", 9), ProofError, "touches"),
    (lambda: gt.poincare(gt.ODE.of({"x": 0}, [0]), "x", 1), ProofError, "along"),
    (lambda: gt.poincare(SPRING, ["x", "v"], 9), ArgumentError, "one expression"),
    (lambda: gt.poincare(SPRING, "x", -1), ArgumentError, "time above zero"),
    (lambda: gt.poincare(SPRING, "x", 9, count=0), ArgumentError, "count"),
    (lambda: gt.poincare(SPRING, "x", 9, start={"y": 1}), UnknownNameError, "y"),
    (lambda: gt.poincare(SPRING, "x", 9, parameters={"k": 1}), UnknownNameError, "k"),
    (lambda: gt.poincare("x", "x", 9), ArgumentError, "ODE"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "error", "words"), REFUSED)
def test_refusals(call, error, words):
    """Each refusal names the missing part."""
    with pytest.raises(error, match=words):
        call()


def test_displays():
    """Lines with certain digits, and a copy by pickle."""
    crossing = gt.poincare(SPRING, "x", 4)
    assert "time = 1.5707963267949" in str(crossing)
    assert str(pickle.loads(pickle.dumps(crossing))) == str(crossing)
    with pytest.raises(UnknownNameError):
        crossing["y"]
