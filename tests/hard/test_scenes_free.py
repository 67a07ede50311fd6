"""Free bodies in hard cases: near a separatrix, nearly spherical or flat, very long, very fast."""

# The tests pass bad input and arrays for lists, and use results that could be None.
# pyright: reportArgumentType=false

from fractions import Fraction

import mpmath
import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.ode import ODE, Taylor, solve
from geomtorsion.ode.trajectory import integrate
from tests.ode.engines import needs_heyoka
from tests.rigid.free_top_truth import by_series
from tests.rounding import ROUNDED

ATTITUDE = {"euler": (0.1, 0.2, 0.3)}


def free(moments, omega, t, watch=("omega", "quaternion"), accuracy=1e-10, **more):
    """A body without forces."""
    body = gt.Body(mass=1.0, moments=moments)
    start = gt.State(omega=omega, **(ATTITUDE | more))
    return gt.Scene(body, [], start, list(watch), t, accuracy)


def rates_only(moments):
    """Euler's equations as a flow, with energy and square of the angular momentum."""
    a, b, c = (Fraction(x) for x in moments)
    return ODE.of(
        {"w1": f"({b - c})/({a})*w2*w3", "w2": f"({c - a})/({b})*w1*w3",
         "w3": f"({a - b})/({c})*w1*w2"},
        [1, 2, 3],
        invariants={
            "energy": f"({a})*w1**2 + ({b})*w2**2 + ({c})*w3**2",
            "momentum": f"(({a})*w1)**2 + (({b})*w2)**2 + (({c})*w3)**2",
        },
    )  # fmt: skip


def first_flip(moments, small, spin):
    """First zero of the second component, from (small, spin, 0): a quarter period in K(k)."""
    with mpmath.workdps(40):
        i1, i2, i3 = (mpmath.mpf(x) for x in moments)
        w1, w2 = mpmath.mpf(small), mpmath.mpf(spin)
        energy, square = i1 * w1**2 + i2 * w2**2, (i1 * w1) ** 2 + (i2 * w2) ** 2
        # The sign of L^2 - 2 E I2 decides the axis of rotation; Landau-Lifshitz, paragraph 37.
        if square > energy * i2:
            upper = (i2 - i1) * (energy * i3 - square)
            rate = (i3 - i2) * (square - energy * i1) / (i1 * i2 * i3)
            k2 = upper / ((i3 - i2) * (square - energy * i1))
        else:
            upper = (i2 - i3) * (energy * i1 - square)
            rate = (i1 - i2) * (square - energy * i3) / (i1 * i2 * i3)
            k2 = upper / ((i1 - i2) * (square - energy * i3))
        return mpmath.ellipk(k2) / mpmath.sqrt(rate)


@pytest.mark.parametrize("small", [1e-3, 1e-6, 1e-12])
def test_dzhanibekov(small):
    """The first flip, very close to the unstable axis, agrees to 1e-8 of its time.

    Three routes: the elliptic integral in 40 digits, the closed form, and the integrator.
    """
    moments = (1, 2, 3)
    flip = float(first_flip(moments, small, 1.0))
    top = gt.rigid.free_top(moments, (small, 1.0, 0.0))
    assert top.first_flip == pytest.approx(flip, rel=1e-12)
    scene = free(moments, (small, 1.0, 0.0), 1.5 * flip, ["omega"])
    found = solve(scene.ode, 1.5 * flip, 1e-10)
    assert found.event_times("Omega2")[0] == pytest.approx(flip, rel=1e-8)
    result = scene.run()
    truth = top.omega(result.times)
    assert np.abs(result["omega"] - truth).max() < 1e-9


@pytest.mark.parametrize("accuracy", [1e-8, 1e-10, 1e-12])
@pytest.mark.parametrize(("small", "end"), [(1e-3, 60.0), (1e-6, 60.0), (1e-9, 30.0)])
@needs_heyoka
def test_estimates_near_the_separatrix(small, end, accuracy):
    """Rounding grows ten million times here; errors stay within the request, and estimates hold."""
    unstable = ODE.of({"a": "-b*c", "b": "c*a", "c": "-a*b/3"}, [small, 1, 0])
    truth = solve(unstable, end, 1e-18, Taylor(113)).states.astype(float)
    sol = solve(unstable, end, accuracy)
    gap = np.abs(np.asarray(sol.states, dtype=float) - truth).max(axis=0)
    true = float((gap / np.abs(truth).max(axis=0)).max())
    assert true <= accuracy
    assert sol.error >= 0.1 * true


@pytest.mark.parametrize("moments", [(1, 1, 1 + 1e-12), (1e-6, 1, 1), (1, 1, 2), (1, 1.5, 2.5)])
def test_nearly_spherical_and_nearly_flat_bodies(moments):
    """States agree with fifty digits, by the closed form and by the integrator."""
    omega, quaternion = (1.0, 2.0, 3.0), (0.5, 0.5, -0.5, 0.5)
    start = {"euler": None, "quaternion": quaternion}
    # The thin body rotates about its axis 1e6 times faster than it tumbles; a second is long.
    end = 0.5
    truth = [float(x) for x in by_series(moments, omega, quaternion, end, step=0.125)]
    scene = free(moments, omega, [0.25, end], accuracy=1e-11, **start)
    for engine in (None, Taylor() if needs_heyoka.args[0] is False else gt.RungeKutta()):
        result = scene.run(engine=engine)
        assert np.abs(result["omega"][-1] - truth[:3]).max() < 4e-11
        assert np.abs(result["quaternion"][-1] - truth[3:]).max() < 2e-11


def test_difference_of_moments_is_exact():
    """Moments 1 and 1 + 1e-12: the rate of the precession has all its digits."""
    tiny = 1e-12
    sol = solve(rates_only((1.0, 1.0, 1.0 + tiny)), 1e6, 1e-9)
    # Omega1 + i Omega2 rotates at (I3 - I1) / I1 Omega3.
    turn = float((Fraction(1.0 + tiny) - 1) * 3) * 1e6
    angle = np.arctan2(sol["w2"], sol["w1"])
    assert angle[-1] - angle[0] == pytest.approx(turn, rel=1e-7)


def test_million_seconds():
    """t = 1e6: energy and angular momentum drift below 1e-12; attitude of length one."""
    watch = ["omega", "quaternion", "energy", "angular_momentum_space"]
    result = free((1, 2, 3), (1, 2, 3), 1e6, watch).run()
    assert result.closed_form is not None
    assert result.error < 1e-10
    assert max(result.drift[k] for k in ("energy", "angular_momentum_space")) < 1e-12
    assert np.abs((result["quaternion"] ** 2).sum(axis=1) - 1).max() < ROUNDED


@needs_heyoka
def test_drift_grows_at_most_in_proportion_to_time():
    """Drifts of the integrator at its finest tolerance grow no faster than time."""
    top, drifts = rates_only((1, 2, 3)), []
    ends = [2e3, 1.4e4, 1e5]
    for end in ends:
        # A single run at the finest tolerance, not an accuracy with its checks.
        run = integrate(top.first_stage(53, 0.0), np.linspace(0, end, 65), 1e-17, Taylor())
        w1, w2, w3 = np.asarray(run.segments[0].states).T
        energy = w1**2 + 2 * w2**2 + 3 * w3**2
        square = w1**2 + 4 * w2**2 + 9 * w3**2
        drifts.append(max(np.ptp(x) / x[0] for x in (energy, square)))
    # Six sigma of one rounding in each unit of time, added at random.
    assert max(drifts) < 6 * np.sqrt(ends[-1]) * np.finfo(float).eps
    # A factor 50 in time: at most 50 in drift, and a factor 3 for the luck of rounding.
    assert drifts[-1] / drifts[0] < 3 * 50


@needs_heyoka
def test_a_million_radians_a_second():
    """A spin of 1e6 rad/s with a push of a millisecond: closed form, relative accuracy kept."""
    spin, moment, inertia = 1e6, 250.0, 2.0
    body = gt.Body(mass=1.0, moments=(1, 1, inertia))
    push = gt.effects.Thrust(force=(moment, 0, 0), point=(0, -1, 0), start=0.002, end=0.003)
    scene = gt.Scene(
        body, [gt.effects.Drift(), push],
        gt.State(omega=(0, 0, spin), euler=(0, 0, 0), position=(0, 0, 0), velocity=(0, 0, 0)),
        ["omega", "quaternion"], [0.001, 0.0025, 0.004], 1e-10,
    )  # fmt: skip
    result = scene.run()
    after = spin + moment / inertia * 0.001
    assert result["omega"][-1, 2] == pytest.approx(after, rel=ROUNDED)
    angle = spin * 0.002 + spin * 0.001 + moment / inertia * 0.001**2 / 2 + after * 0.001
    q = result["quaternion"][-1]
    expected = np.array([np.cos(angle / 2), 0, 0, np.sin(angle / 2)])
    assert min(np.abs(q - expected).max(), np.abs(q + expected).max()) < 2e-10


@pytest.mark.parametrize("accuracy", [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10])
@needs_heyoka
def test_single_orders_may_serve_badly(accuracy):
    """A smaller tolerance with a larger error does not yet show that the limit is reached."""
    moments, omega = (1, 2, 3), (0.5, 0.4, 1)
    scene = free(moments, omega, 1000.0, ["omega"], accuracy)
    result = scene.run(engine=Taylor())
    true = np.abs(result["omega"] - gt.rigid.free_top(moments, omega).omega(result.times)).max()
    assert true <= accuracy
    assert result.error >= 0.1 * true
