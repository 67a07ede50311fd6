"""Forced bodies in hard cases: gimbal lock, sleeping tops, stiff damping, grazing, thrust."""

from fractions import Fraction
from functools import cache

import mpmath
import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.ode import ODE, When, solve
from tests.ode.engines import every_engine
from tests.rounding import ROUNDED

MASS, ARM, G = 1.0, 0.1, 9.81


def top(omega, watch, t, accuracy=1e-10, moments=(1.0, 1.0, 0.5), **attitude):
    """A symmetric top on a point, its moments taken about the point."""
    return gt.Scene(
        gt.Body(mass=MASS, moments=moments),
        [gt.effects.Gravity(G), gt.effects.Pivot([0, 0, ARM], moments_at="pivot")],
        gt.State(omega=omega, **attitude),
        list(watch),
        t,
        accuracy,
    )


@every_engine
def test_through_gimbal_lock(engine):
    """A top swings as a pendulum through the vertical, where the angles of the paper fail.

    Without spin the nutation obeys theta'' = (m g a / I) sin theta: from rest beside the top it
    falls through the bottom (gimbal lock) and rises on the other side; energy gives the speed.
    """
    theta = 0.3
    scene = top((0, 0, 0), ["nutation", "quaternion", "omega", "energy"], 12.0, euler=(0, theta, 0))
    result = scene.run(engine=engine)
    rate = MASS * G * ARM
    with mpmath.workdps(30):
        # The time to the bottom: quarter period of a pendulum of amplitude pi - theta.
        k2 = mpmath.sin((mpmath.pi - mpmath.mpf(theta)) / 2) ** 2
        quarter = float(mpmath.ellipk(k2) / mpmath.sqrt(mpmath.mpf(MASS) * G * ARM))
    assert result.solved is not None
    # The pole is passed at speed: n1 changes its sign there.
    crossed = result.solved.event_times(
        "n1" if "n1" in result.solved.problem.states else "q1*q3 - q0*q2"
    )
    assert crossed[0] == pytest.approx(quarter, rel=1e-8)
    speed = np.sqrt(2 * rate * (np.cos(theta) - np.cos(result["nutation"])))
    assert np.abs(np.linalg.norm(result["omega"], axis=1) - speed).max() < 1e-8
    assert np.abs((result["quaternion"] ** 2).sum(axis=1) - 1).max() < ROUNDED
    assert result.drift["energy"] < 1e-9
    assert result["nutation"].max() == pytest.approx(np.pi, abs=0.05)


@every_engine
@pytest.mark.parametrize("excess", [1e-3, 0.0, -1e-3])
def test_sleeping_top_at_its_limit(engine, excess):
    """Tilt of a sleeping top a little above, at and below I3^2 w^2 = 4 m g a I1, to 40 digits.

    The truth is integrated with numbers of 40 digits and another method.
    """
    moments = (1.0, 1.0, 0.5)
    spin = 2 * np.sqrt(MASS * G * ARM * moments[0]) / moments[2] * (1 + excess)
    tilt = 1e-4
    scene = top((tilt, 0, spin), ["omega"], [4.0], moments=moments, euler=(0, 0, 0))
    result = scene.run(engine=engine)
    truth = by_long_numbers(moments, (tilt, 0.0, spin), 4)
    assert np.abs(result["omega"][-1] - truth[:3]).max() < 1e-10 * spin
    if result.solved is not None and "n1" in result.solved.problem.states:
        found = [result.solved[name][-1] for name in ("n1", "n2")]
        assert np.abs(np.array(found) - truth[3:5]).max() < 1e-9
    # At equal frequencies the tilt grows with the time instead of oscillating.
    assert np.linalg.norm(truth[3:5]) == pytest.approx(4 * tilt, rel=0.1)


@cache
def by_long_numbers(moments, omega, end, steps=40):
    """Omega and n of a heavy top, by Taylor series of order 30 in 40 digits."""
    with mpmath.workdps(40):
        i1, i2, i3 = (mpmath.mpf(x) for x in moments)
        pull = mpmath.mpf(MASS) * mpmath.mpf(G) * mpmath.mpf(ARM)
        state = [mpmath.mpf(x) for x in (*omega, 0, 0, 1)]
        h = mpmath.mpf(end) / steps

        def cauchy(x, y):
            return mpmath.fsum(a * b for a, b in zip(x, reversed(y), strict=True))

        for _ in range(steps):
            series = [[x] for x in state]
            for k in range(30):
                w1, w2, w3, n1, n2, n3 = series
                slopes = [
                    ((i2 - i3) * cauchy(w2, w3) + pull * n2[k]) / i1,
                    ((i3 - i1) * cauchy(w3, w1) - pull * n1[k]) / i2,
                    (i1 - i2) * cauchy(w1, w2) / i3,
                    cauchy(n2, w3) - cauchy(n3, w2),
                    cauchy(n3, w1) - cauchy(n1, w3),
                    cauchy(n1, w2) - cauchy(n2, w1),
                ]
                for row, slope in zip(series, slopes, strict=True):
                    row.append(slope / (k + 1))
            state = [mpmath.polyval(row[::-1], h) for row in series]
        return [float(x) for x in state]


def test_stiff_damping():
    """Damping of 1e6: rates fall before anything else moves, as in the closed form of a ball."""
    body = gt.Body(mass=1.0, moments=(2.0, 2.0, 2.0))
    scene = gt.Scene(
        body, [gt.effects.AngularDamping(1e6)], gt.State(omega=(1, 2, 3)), ["omega"],
        [1e-6, 5e-6, 1.0], 1e-9,
    )  # fmt: skip
    result = scene.run(engine=gt.Stiff("LSODA"))
    decay = np.exp(-np.array([1e-6, 5e-6, 1.0]) * 1e6 / 2)
    assert np.abs(result["omega"] - np.outer(decay, [1, 2, 3])).max() < 3e-9
    uneven = gt.Scene(
        gt.Body(mass=1.0, moments=(1.0, 2.0, 3.0)), [gt.effects.AngularDamping(1e6)],
        gt.State(omega=(1, 2, 3)), ["omega"], [2e-6, 0.5], 1e-8,
    ).run(engine=gt.Stiff("LSODA"))  # fmt: skip
    # At such damping the gyroscopic terms move the rates by only 1e-6.
    first = np.array([1, 2, 3]) * np.exp(-2e-6 * 1e6 / np.array([1, 2, 3]))
    assert uneven["omega"][0] == pytest.approx(first, abs=5e-6)
    assert np.abs(uneven["omega"][1]).max() < 3e-8


@every_engine
@pytest.mark.parametrize("depth", [1e-6, 1e-9])
def test_grazing(engine, depth):
    """A ball that just touches a ceiling is stopped there, or passes slightly below it."""
    height, g = 5.0, 10
    # z = height + depth - g (t - 1)^2 / 2: through the ceiling at 1 - sqrt(2 depth / g).
    ball = ODE.of(
        {"z": "v", "v": "-g"}, {"z": height + depth - g / 2, "v": g}, parameters={"g": g},
        events=[When(f"{height} - z")])  # fmt: skip
    end = solve(ball, 3.0, 1e-9, engine)
    assert end.outcome == "stopped"
    rise = float(Fraction(height + depth - g / 2) - Fraction(height) + Fraction(g) / 2)
    assert end.times[-1] == pytest.approx(1 - np.sqrt(2 * rise / g), abs=2e-9)
    below = ball.with_start(start={"z": height - depth - g / 2})
    assert solve(below, 3.0, 1e-9, engine).outcome == "done"


@every_engine
def test_thrust_at_exact_times(engine):
    """Two burns of a missile that spins about its axis: the velocity has a closed form.

    The force rotates with the body; a force across the axis moves the velocity along an arc.
    """
    spin, force, begin, length = 7.0, 3.0, 1 / 3, 0.7
    burns = [
        gt.effects.Thrust(force=(force, 0, 0), start=begin, end=begin + length),
        gt.effects.Thrust(force=(0, 0, 2.0), start=5.0, end=5.001),
    ]
    scene = gt.Scene(
        gt.Body(mass=2.0, moments=(1, 1, 0.3)),
        [gt.effects.Drift(), *burns],
        gt.State(omega=(0, 0, spin), euler=(0, 0, 0), position=(0, 0, 0), velocity=(0, 0, 0)),
        ["velocity", "position"], [1.0, 6.0, 20.0], 1e-11,
    )  # fmt: skip
    result = scene.run(engine=engine)
    from_angle, to_angle = spin * begin, spin * (begin + length)
    around = force / 2 / spin * np.array(
        [np.sin(to_angle) - np.sin(from_angle), np.cos(from_angle) - np.cos(to_angle)]
    )  # fmt: skip
    along = 2.0 / 2.0 * float(Fraction(5.001) - 5)
    assert result["velocity"][-1, :2] == pytest.approx(around, abs=1e-10)
    assert result["velocity"][-1, 2] == pytest.approx(along, rel=1e-9)
    assert result["position"][-1, 2] == pytest.approx(along * (20 - 5.0005), rel=1e-9)
    assert result["velocity"][0, 2] == 0
