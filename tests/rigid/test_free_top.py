"""The free top in closed form agrees with fifty digits by other routes."""

import itertools
import math
from fractions import Fraction

import flint
import mpmath
import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import StartError
from geomtorsion.rigid.attitude import product, rotated
from geomtorsion.rigid.double_double import DoubleDouble, reduced, turns
from geomtorsion.rigid.free_top import free_top
from tests.chosen import one_in
from tests.ode.engines import needs_heyoka
from tests.rigid.free_top_truth import by_integrals, by_series
from tests.rounding import ROUNDED

TILTED = (0.5, -0.5, 0.5, -0.5)
SIGNS = [(1, 1, 1), (-1, 1, 1), (1, -1, 1), (1, 1, -1), (-1, -1, 1), (-1, -1, -1)]
LABELLINGS = list(zip(itertools.permutations((0, 1, 2)), SIGNS, strict=True)) + list(
    zip(itertools.permutations((0, 1, 2)), SIGNS[3:] + SIGNS[:3], strict=True)
)


def errors(moments, omega, end, step=0.125):
    """Errors of rates and attitude at one time, against the series in 200 bits."""
    truth = by_series(moments, omega, TILTED, end, step)
    found = free_top(moments, omega, TILTED).states(end)
    pairs = zip(found, truth, strict=True)
    return np.array([abs(float(mpmath.mpf(float(x)) - y)) for x, y in pairs])


@pytest.mark.parametrize(
    ("labelling", "rates"), one_in(2, LABELLINGS, [(1.0, 0.5, 0.7), (1.5, 0.5, 0.2)])
)
def test_every_order_of_moments_and_signs(labelling, rates):
    """L is around the largest or smallest moment, in either sense, for every labelling."""
    order, signs = labelling
    moments, omega = [0.0] * 3, [0.0] * 3
    for k, place in enumerate(order):
        moments[place], omega[place] = (1.0, 2.0, 3.0)[k], rates[k] * signs[k]
    # Largest rate 1.5, so that eps |Omega| t is 1e-15.
    assert errors(tuple(moments), tuple(omega), 3.0).max() < 2e-15


@pytest.mark.parametrize(
    ("moments", "omega", "end"),
    [
        ((1, 2, 3), (1e-12, 1, 0), 60.0),  # past its first flip at 50.26
        pytest.param((1, 2, 3), (1e-12, 1, 1e-12), 30.0, marks=pytest.mark.slow),
        ((1, 2, 3), (math.sqrt(3), 1, 1), 10.0),  # 1 - k^2 = 2e-16, by the rounding of sqrt(3)
        pytest.param(
            (4, 5, 9), (3, 0.5, 1), 8.0, marks=pytest.mark.slow
        ),  # on the separatrix, exactly
        ((4, 5, 9), (3, -0.5, -1), 8.0),
        pytest.param((9, 5, 4), (1, 0.5, -3), -8.0, marks=pytest.mark.slow),
        pytest.param((1, 1, 1 + 1e-12), (0.7, 0.3, 0.5), 10.0, marks=pytest.mark.slow),
        ((1, 1 + 1e-12, 1), (0.7, 0.3, 0.5), 10.0),
        ((1e-6, 1, 1), (0.7, 0.3, 0.5), 10.0),
        pytest.param((1, 1e-6, 1 + 1e-9), (0.7, 0.3, 0.5), 10.0, marks=pytest.mark.slow),
        ((1, 1, 2), (0.7, 0.3, 1e-13), 10.0),
        ((1 - 2e-15, 1 - 2e-15, 1 + 4e-15), (4e-13, 0.7, 4e-14), 10.0),  # half a period is 1e25
        ((1, 1, 2), (1e-170, 0, 1), 10.0),  # a cone that is closed to rounding
        ((1, 2, 3), (1e-9, 1e-9, 1), 10.0),
        pytest.param((1, 2, 3), (1, 1e-9, 1e-9), 10.0, marks=pytest.mark.slow),
        ((2, 2, 2), (0.7, 0.3, 0.5), 10.0),
        ((1, 2, 3), (0, 1.25, 0), 10.0),
        ((1, 2, 3), (0, 0, 0), 1.0),
    ],
)
def test_hard_tops_keep_all_digits(moments, omega, end):
    """1e-12 from the unstable axis, nearly equal and extreme moments, steady rotations."""
    # Slow rates have long series: the long runs, all with |Omega| = 1, need fewer steps.
    assert errors(moments, omega, end, 0.25 if end >= 30 else 0.125).max() < 3e-15


def test_times_with_all_their_digits_where_half_a_period_is_1e12():
    """t is lost beside the phase (2e12) unless both parts of their sum are kept."""
    step = 0.1532117
    assert errors((1, 1, 1 + 1e-12), (0.7, 0.3, 0.5), 64 * step, step).max() < 3e-15


def test_small_rates_are_right_relative_to_their_own_size():
    """At 1e-12 off the axis, the small rates have twelve digits of their own."""
    omega = (1e-12, 1, 1e-12)
    truth = by_series((1, 2, 3), omega, TILTED, 5.0)
    found = free_top((1, 2, 3), omega).omega(5.0)
    for k in (0, 2):
        assert abs(float((mpmath.mpf(float(found[k])) - truth[k]) / truth[k])) < 1e-12


def random_top(rng):
    """Moments and rates over many sizes, nearly equal, nearly steady or near the separatrix."""
    kind = rng.integers(4)
    moments = 10 ** (rng.uniform(-6, 6, 3) if kind == 0 else rng.uniform(-0.3, 0.3, 3))
    omega = rng.normal(size=3)
    if kind == 1:
        moments = 1 + rng.integers(-2, 3, 3) * 10.0 ** rng.uniform(-15, -1)
    if kind in (1, 2):
        omega *= 10 ** rng.uniform(-15, 0, 3)
    if kind == 3:
        low, mid, high = (int(k) for k in np.argsort(moments))
        a, b, c = moments[[low, mid, high]]
        near = 1 + rng.choice([-1, 1]) * 10 ** rng.uniform(-16, -6)
        omega[high] = omega[low] * math.sqrt(a * (b - a) / (c * (c - b))) * near
    return moments, omega


def test_tops_that_start_on_the_way_go_the_same_way():
    """A new top from the state at t1 reaches the state of the first one at t1 + t2."""
    rng = np.random.default_rng(8)
    for _ in range(200):
        moments, omega = random_top(rng)
        top = free_top(moments, omega, TILTED)
        speed = np.linalg.norm(omega)
        rate = max(speed, top.constants.rate if top.constants else 0)
        first, second = rng.uniform(0, 30) / speed, rng.uniform(0, 2) / rate
        state = top.states(first)
        later = free_top(moments, state[:3], state[3:]).states((first + second) - first)
        size = np.array([abs(top.omega(np.linspace(0, 30 / speed, 7))).max()] * 3 + [1] * 4)
        # The start is rounded, and rounding grows by exp(rate * t2) < 8 near the separatrix.
        assert (abs(later - top.states(first + second)) / size).max() < 1e-13


@pytest.mark.parametrize("time", [pytest.param(3.5, marks=pytest.mark.slow), 1e6])
def test_no_error_builds_up_with_time(time):
    """At t = 1e6, after 114141 periods and 3e5 turns, errors are still rounding."""
    moments, omega = (1, 2, 3), (0.3, 0.5, 0.7)
    rates, matrix = by_integrals(moments, omega, time)
    top = free_top(moments, omega)
    pairs = zip(rates, map(mpmath.mpf, top.omega(time)), strict=True)
    assert max(abs(float(x - y)) for x, y in pairs) < ROUNDED
    columns = [rotated(top.quaternion(time), np.eye(3)[k]) for k in range(3)]
    assert abs(np.array(matrix.tolist(), dtype=float) - np.transpose(columns)).max() < ROUNDED


def test_the_two_truths_agree():
    """The two independent routes agree to 30 digits."""
    moments, omega = (1, 2, 3), (0.3, 0.5, 0.7)
    rates, _ = by_integrals(moments, omega, 3.5)
    series = by_series(moments, omega, (1, 0, 0, 0), 3.5)
    assert max(abs(x - y) for x, y in zip(rates, series[:3], strict=True)) < mpmath.mpf(10) ** -30


@pytest.mark.parametrize("omega", [(0.3, 0.5, 0.7), (1e-12, 1, 1e-12), (1.0, 0.1, 0.2)])
def test_energy_and_momentum_stay_for_a_million(omega):
    """T and L in space at 2000 times up to 1e6: no error grows."""
    top = free_top((1, 2, 3), omega, TILTED)
    times = np.linspace(0, 1e6, 2000)
    rates, attitude = top.omega(times), top.quaternion(times)
    energy = (np.array(top.moments) * rates**2).sum(axis=1) / 2
    assert abs(energy / top.energy - 1).max() < ROUNDED
    momentum = rotated(attitude, rates * np.array(top.moments))
    assert abs(momentum - top.momentum).max() < ROUNDED * np.linalg.norm(top.momentum)
    assert abs((attitude**2).sum(axis=1) - 1).max() < ROUNDED


def test_first_flip_of_a_racket_thrown_1e_12_off():
    """The first flip agrees with mpmath's F(phi, m) in 50 digits, independent of the package."""
    offset = 1e-12
    with mpmath.workdps(50):
        e = mpmath.mpf(offset)
        # Moments 1, 2, 3 and Omega = (e, 1, e): L^2 = 4 + 10 e^2, 2T = 2 + 4 e^2.
        energy2, square = 2 + 4 * e**2, 4 + 10 * e**2
        m = (energy2 * 3 - square) / (square - energy2)
        rate = mpmath.sqrt((square - energy2) / 6)
        amplitude = mpmath.sqrt((energy2 * 3 - square) / 2)
        u0 = mpmath.ellipf(mpmath.asin(1 / amplitude), m)
        # Omega_2' > 0 here: it grows to its crest first, then falls through zero.
        first = (2 * mpmath.ellipk(m) - u0) / rate
        between = 2 * mpmath.ellipk(m) / rate
    top = free_top((1, 2, 3), (offset, 1, offset))
    assert top.first_flip == pytest.approx(float(first), rel=ROUNDED)
    assert top.flip_time == pytest.approx(float(between), rel=ROUNDED)
    assert top.period == 2 * top.flip_time
    before, after = top.omega([top.first_flip - 1e-9, top.first_flip + 1e-9])
    assert before[1] * after[1] < 0


def test_first_flip_is_the_first():
    """The rate about the middle axis keeps one sign before the first flip, whatever the start."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        top = free_top((1, 2, 3), rng.normal(size=3))
        inside = top.omega(np.linspace(1e-9, top.first_flip - 1e-9, 50))[:, 1]
        assert (np.sign(inside) == np.sign(inside[0])).all()
        assert abs(top.omega(top.first_flip)[1]) < ROUNDED


def test_kinds_and_their_periods():
    assert free_top((1, 2, 3), (0, 0, 0)).kind == "rest"
    assert free_top((2, 2, 2), (1, 2, 3)).kind == "spherical"
    assert free_top((1, 2, 3), (0, 1, 0)).kind == "steady"
    assert free_top((1, 1, 2), (1, 1, 0)).kind == "steady"
    assert math.isnan(free_top((1, 1, 2), (1, 1, 0)).period)
    cone = free_top((1, 1, 2), (1, 0, 0.25))
    # Omega_c rotates at (I_3 - I_1) Omega_3 / I_1.
    assert cone.kind == "symmetric"
    assert cone.period == pytest.approx(2 * math.pi / 0.25, rel=ROUNDED)
    edge = free_top((4, 5, 9), (3, 0.5, 1))
    assert edge.kind == "separatrix"
    assert math.isinf(edge.period)
    assert edge.omega(1e4).tolist() == pytest.approx([0, math.sqrt(46.25 / 5), 0])


def test_the_quaternion_is_continuous():
    """Neighbouring attitudes have near quaternions, over flips as well: signs do not jump."""
    for omega in ((0.01, 1, 0.01), (0.3, 0.5, 0.7), (1.5, 0.1, -0.2)):
        top = free_top((3, 2, 1), omega)
        path = top.quaternion(np.linspace(-40, 40, 8001))
        assert abs(np.diff(path, axis=0)).max() < 0.02


def test_the_start_is_where_it_was_asked_to_be():
    top = free_top((1, 3, 2), (0.1, -2, 0.3), TILTED)
    assert abs(top.states(0.0) - np.array([0.1, -2, 0.3, *TILTED])).max() < ROUNDED


def test_any_shape_of_times():
    top = free_top((1, 2, 3), (0.1, 1, 0.2))
    assert top.omega(1.0).shape == (3,)
    assert top.quaternion(np.zeros((2, 5))).shape == (2, 5, 4)
    assert top.states([]).shape == (0, 7)
    steady = free_top((1, 2, 3), (0, 1, 0))
    assert steady.states(np.zeros((2, 5))).shape == (2, 5, 7)


def test_products_of_quaternions_turn_one_after_the_other():
    rng = np.random.default_rng(0)
    p, q = (x / np.linalg.norm(x) for x in rng.normal(size=(2, 4)))
    v = rng.normal(size=3)
    assert abs(rotated(product(p, q), v) - rotated(p, rotated(q, v))).max() < ROUNDED


def test_turns_are_exact_for_whole_numbers():
    """Turns agree with fractions of Python, up to 2^50 turns."""
    with flint.ctx.workprec(140):
        long = DoubleDouble.of(flint.arb(2).sqrt())
    exact = Fraction(long.high) + Fraction(long.low)
    counts = np.array([1.0, 7.0, 1e6 + 3, 2.0**50 + 1, -5.0])
    for count, found in zip(counts, turns(counts, long), strict=True):
        whole = Fraction(count) * exact
        assert abs(float(whole - round(whole)) - found) < ROUNDED


def test_times_are_reduced_exactly():
    with flint.ctx.workprec(140):
        offset, step = DoubleDouble.of(flint.arb(1) / 3), DoubleDouble.of(flint.arb.pi())
    times = np.array([0.0, 1e3, 1e9, -1e6, 1e13])
    count, high = reduced(times, offset, step)
    for k, time in enumerate(times):
        whole = Fraction(offset.high) + Fraction(offset.low) + Fraction(time)
        rest = whole - int(count[k]) * (Fraction(step.high) + Fraction(step.low))
        assert abs(float(rest - Fraction(high[k]))) < ROUNDED
        assert abs(high[k]) < 1.58


@pytest.mark.parametrize("unit", [4e76, 1e-76])
@pytest.mark.parametrize("rate", [4e76, 1.0, 1e-76])
def test_moments_and_rates_of_any_size(unit, rate):
    """A top scales with its units while products of four are doubles; beyond, it is refused."""
    moments, omega, times = np.array([1, 1.6, 2.1]), np.array([0.3, 1, 0.2]), np.array([0.0, 1, 7])
    top = free_top(tuple(unit * moments), tuple(rate * omega))
    expected = free_top(tuple(moments), tuple(omega)).quaternion(times)
    assert top.quaternion(times / rate) == pytest.approx(expected, abs=ROUNDED)
    for far in (1.1e77, 0.9e-77):
        with pytest.raises(StartError, match=r"expected sizes between 1e-77 and 1e\+77"):
            free_top((far, far, far), tuple(omega))
        with pytest.raises(StartError, match=r"expected sizes between 1e-77 and 1e\+77"):
            free_top((1, 1, 1), (far, 0, 0))


@needs_heyoka
@pytest.mark.parametrize("omega", [(0.3, 0.5, 0.7), (1e-3, 1.0, 0.0)])
def test_the_taylor_engine_in_34_digits_comes_to_the_same(omega):
    """Rates and attitude agree over a hundred time units, near the separatrix as well."""
    rates = {
        "w1": "-w2*w3", "w2": "w1*w3", "w3": "-w1*w2/3",
        "q0": "(-q1*w1 - q2*w2 - q3*w3)/2", "q1": "(q0*w1 + q2*w3 - q3*w2)/2",
        "q2": "(q0*w2 + q3*w1 - q1*w3)/2", "q3": "(q0*w3 + q1*w2 - q2*w1)/2",
    }  # fmt: skip
    flow = gt.ODE.of(rates, [*omega, *TILTED], normalized=(("q0", "q1", "q2", "q3"),))
    solution = gt.solve(flow, np.linspace(0, 100, 11), 1e-20, gt.Taylor(precision=113))
    truth = np.asarray(solution.states, dtype=float)
    assert abs(free_top((1, 2, 3), omega, TILTED).states(solution.times) - truth).max() < ROUNDED
