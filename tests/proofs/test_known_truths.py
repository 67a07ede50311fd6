"""Random problems with a known truth, of all kinds that are proved: no ball misses it."""

# pyright: reportArgumentType=false

import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import TypeAlias

import numpy as np
import pytest
import sympy as sp
from flint import acb, arb, fmpq

import geomtorsion as gt
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.ode import Centre
from geomtorsion.support.precision import ball_precision

# Balls, and a function that makes the true values, at the precision in use.
Case: TypeAlias = tuple[list, Callable[[], list]]


def ratio(draw: random.Random, low: int, high: int) -> Fraction:
    """A random ratio between two whole numbers, in eighths."""
    return Fraction(draw.randint(8 * low, 8 * high), 8)


def ball(x: Fraction) -> arb:
    """A ratio as a ball."""
    return arb(fmpq(x.numerator, x.denominator))


def end(problem: gt.ODE, time: Fraction, draw: random.Random) -> list:
    """Balls of all states at a time."""
    proof = gt.prove(gt.solve(problem, [float(time)]), draw.choice([5, 15, 30]))
    return list(proof.at(float(time)).values())


def logistic(draw: random.Random) -> Case:
    """x' = k x (1 - x)."""
    k, x, t = ratio(draw, -2, 2), ratio(draw, 1, 4) / 5, ratio(draw, 1, 4)
    problem = gt.ODE.of({"x": "k*x*(1-x)"}, [x], parameters={"k": k})

    def truth() -> list:
        grown = ball(x) * (ball(k) * ball(t)).exp()
        return [grown / (1 - ball(x) + grown)]

    return end(problem, t, draw), truth


def tangent(draw: random.Random) -> Case:
    """x' = a (1 + x^2) towards its pole: x = tan(a t)."""
    a = ratio(draw, 1, 3)
    t = Fraction(draw.randint(1, 12), 8) / a
    t = Fraction(int(t * 64), 64)
    return end(gt.ODE.of({"x": f"({a})*(1+x**2)"}, [0]), t, draw), lambda: [
        (ball(a) * ball(t)).tan()
    ]


def twist(draw: random.Random) -> Case:
    """A rotation whose speed 1 + r^2 depends on the conserved radius."""
    r, t = ratio(draw, 1, 2) / 2, ratio(draw, 1, 9)
    problem = gt.ODE.of({"x": "-y*(1+x**2+y**2)", "y": "x*(1+x**2+y**2)"}, [r, 0])

    def truth() -> list:
        angle = (1 + ball(r) ** 2) * ball(t)
        return [ball(r) * angle.cos(), ball(r) * angle.sin()]

    return end(problem, t, draw), truth


def driven(draw: random.Random) -> Case:
    """x'' = -x + cos(w t) off resonance, from rest."""
    w, t = draw.choice([2, 3, 5]), ratio(draw, 1, 9)
    problem = gt.ODE.of({"x": "v", "v": f"-x+cos({w}*t)"}, [0, 0])

    def truth() -> list:
        s, share = ball(t), arb(1) / (1 - w * w)
        return [share * ((w * s).cos() - s.cos()), share * (s.sin() - w * (w * s).sin())]

    return end(problem, t, draw), truth


def slopes(draw: random.Random) -> Case:
    """x' = k x^2: x = 1/(1/a - k t), with its derivatives by k and by the start a."""
    k, a = Fraction(1, draw.randint(2, 6)), ratio(draw, 1, 2) / 2
    problem = gt.ODE.of({"x": "k*x**2"}, [a], parameters={"k": k})
    proof = gt.prove(gt.solve(problem, [0.5]), 15, derivatives=["k", "x"])

    def truth() -> list:
        x = 1 / (1 / ball(a) - ball(k) / 2)
        return [x, x * x / 2, (x / ball(a)) ** 2]

    return list(proof.balls[-1]), truth


def loop(draw: random.Random) -> Case:
    """exp(k x) dy around a circle: 2 pi r I_1(k r) exp(k c)."""
    x, y = sp.symbols("x y", real=True)
    k, c, r = draw.randint(1, 40), draw.uniform(-1, 1), draw.choice([1e-3, 0.3, 1.0])
    frame = gt.Frame([x, y], [[1, sp.exp(k * x)], [0, 1]])
    proof = gt.prove(gt.burgers_vector(frame, gt.Loop.circle([c, 0.25], r)))

    def truth() -> list:
        size = k * arb(r)
        return [2 * arb.pi() * arb(r) * size.bessel_i(1) * (k * arb(c)).exp(), arb(0)]

    return list(proof.balls), truth


def cycle(draw: random.Random) -> Case:
    """r' = m r (R^2 - r^2), phi' = w: the start R, the period and the multiplier."""
    m, size, w = (Fraction(draw.randint(2, 9), draw.randint(4, 9)) for _ in range(3))
    grow = f"({m})*({size**2}-x**2-y**2)"
    rates = {"x": f"{grow}*x-({w})*y", "y": f"{grow}*y+({w})*x"}
    problem = gt.ODE.of(rates, [float(size) * draw.uniform(0.9, 1.1), 0])
    orbit = gt.closed_orbit(problem, 6.2 / float(w), section="y", digits=12)

    def truth() -> list:
        period = 2 * arb.pi() / ball(w)
        return [ball(size), period, (-2 * period * ball(m) * ball(size) ** 2).exp()]

    return [orbit["x"], orbit.period, orbit.multipliers[0].real], truth


def crossing(draw: random.Random) -> Case:
    """The first fall of cos(w t) through a level."""
    w, level = draw.randint(1, 6), Fraction(draw.randint(-7, 7), 8)
    problem = gt.ODE.of({"x": "v", "v": f"-{w * w}*x"}, [1, 0])
    found = gt.poincare(problem, f"x-({level})", 9)

    def truth() -> list:
        turn = ball(level).acos()
        return [turn / w, -w * turn.sin()]

    return [found.time, found["v"]], truth


def pole(draw: random.Random) -> Case:
    """y'' + 2 y'/x + k^2 y = 0, regular at 0: sin(k x)/(k x)."""
    k, t = draw.randint(1, 5), ratio(draw, 1, 2)
    rates = {"y": "v", "v": f"-2*v/(a+s)-{k * k}*y"}
    x = 0.25 * k
    start = [np.sin(x) / x, (np.cos(x) - np.sin(x) / x) * 4]
    problem = gt.ODE.of(rates, start, parameters={"a": "1/4"}, time="s")
    problem = replace(problem, centre=Centre(0, "a", {"y": 1, "v": 0}))

    def truth() -> list:
        x = ball(t) + arb(1) / 4
        y = (k * x).sin() / (k * x)
        return [y, (k * x).cos() / x - y / x]

    return end(problem, t, draw), truth


def data(draw: random.Random) -> Case:
    """(x^2 y, x y^2 + x) on a grid, along a circle: its interpolant is exact."""
    axis = np.linspace(-1, 1, draw.choice([9, 17, 33]))
    x, y = np.meshgrid(axis, axis, indexing="ij")
    grid = SampledFrame([axis, axis], np.array([[x * x * y, x * y * y + x]]))
    a, b, r = draw.uniform(-0.2, 0.2), draw.uniform(-0.2, 0.2), draw.choice([0.25, 0.5, 0.7])
    proof = gt.prove(grid.burgers(gt.Loop.circle([a, b], r)), draw.choice([15, 40]))
    return list(proof.balls), lambda: [arb.pi() * arb(r) ** 2 * (arb(b) ** 2 + 1 - arb(a) ** 2)]


FAMILIES = (logistic, tangent, twist, driven, slopes, loop, cycle, crossing, pole, data)


@pytest.mark.parametrize("seed", [
    seed if seed < len(FAMILIES) else pytest.param(seed, marks=pytest.mark.slow)
    for seed in range(10 * len(FAMILIES))
])  # fmt: skip
def test_balls_contain_the_truth(seed):
    """Ten problems of each of ten families; one of each in the normal run."""
    draw = random.Random(seed)
    balls, truth = FAMILIES[seed % len(FAMILIES)](draw)
    with ball_precision(400):
        values = truth()
        assert len(balls) == len(values)
        for one, value in zip(balls, values, strict=True):
            assert isinstance(one, arb | acb)
            assert one.is_finite()
            assert one.overlaps(value)
