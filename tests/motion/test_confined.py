"""Confined geodesics: who is one, the equations in cosines, and truth without them."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from geomtorsion.motion import RungeKutta, Taylor, geodesic, solve
from geomtorsion.motion.charts import Chart
from geomtorsion.motion.engines.taylor import is_available
from geomtorsion.motion.equations import written
from geomtorsion.motion.journey import departure, travel
from geomtorsion.motion.laws import Hamel
from geomtorsion.motion.reduced import confined
from geomtorsion.motion.reduced.confined import Confined
from geomtorsion.spaces import load
from tests.motion.reduced_truth import reduction_of

with_heyoka = pytest.mark.skipif(not is_available(), reason="needs more than double precision")

# Starts t, r, theta, phi and velocities in Kerr's space, and whether they are confined.
ORBITS = {
    "bound": ([0, 8.0, 1.4, 0], [1.2, 0.05, 0.2, 0.36], True),
    "wide": ([0, 30.0, 1.2, 0], [1.02, 0.02, 0.05, 0.14], True),
    "backwards": ([0, 12.0, 1.9, 0], [1.1, 0.01, -0.1, -0.4], True),
    "on the equator": ([0, 10.0, np.pi / 2, 0], [1.1, 0.05, 0.0, 0.36], True),
    "light": ([0, 8.0, 1.4, 0], [0.55, -0.4, 0.12, 0.36], False),
    "leaving": ([0, 8.0, 1.4, 0], [1.9, 1.2, 0.1, 0.4], False),
    "near the pole": ([0, 8.0, 1.0, 0], [1.2, 0.05, 0.47, 1e-3], False),
    "falling": ([0, 8.0, 1.4, 0], [1.05, -0.2, 0.1, 0.2], False),
    "no angular momentum": ([0, 8.0, 1.2, 0], [1.2, 0.05, 0.1, 0.0], False),
}


def orbit(start, velocity, a=0.6, charts=("kerr",)):
    """A geodesic of Kerr's space."""
    frame, numbers = load("kerr").frame, {"M": 1, "a": a}
    found = geodesic(frame, start, frame_velocity=velocity, parameters=numbers, causal=None)
    return found.with_charts(*charts) if charts else found


def unreduced(problem):
    """The same problem, followed by its full equations."""
    equations = problem.equations(problem.charts[0])
    equations.__dict__["reduction"] = None
    return problem


def opened(problem, engine=None):
    """What the smaller system begins with."""
    name, _, vector, parameters = departure(problem, 53)
    return reduction_of(problem.equations(name)).opened(engine or Taylor(), vector, parameters)


@pytest.mark.parametrize("name", ORBITS)
def test_who_is_confined(name):
    """Bound and away from axis and horizon, as the turning points say."""
    start, velocity, stays = ORBITS[name]
    found = opened(orbit(start, velocity))
    assert found is not None
    assert found.confined is stays
    if stays:
        assert found.start[2] == pytest.approx(np.cos(start[2]), rel=1e-15, abs=1e-16)


def test_a_fall_through_both_horizons_is_not_confined():
    """Between horizons that are near each other no look may fall."""
    found = opened(orbit([0, 8.0, 1.4, 0], [1.05, -0.2, 0.02, 0.05], a=0.99999))
    assert found is not None
    assert not found.confined


FALLS = [
    # Each distance, each momentum and each spin in the normal run; all their pairs in the long one.
    pytest.param(far, momentum, a, marks=() if (i + j + k) % 6 == 0 else pytest.mark.slow)
    for i, far in enumerate([30.0, 150.0, 300.0, 2e3, 1e6, 1e10])
    for j, momentum in enumerate([0.3, 1.0, 1.8])
    for k, a in enumerate([0.0, 0.5, 0.998, 1.0])
]


@pytest.mark.parametrize(("far", "momentum", "a"), FALLS)
def test_a_fall_from_afar_is_not_confined(far, momentum, a):
    """With less angular momentum than any bound orbit has, all fall, from wherever."""
    across = momentum / far
    velocity = [np.hypot(1.0, across), 0, across * 0.3, across * 0.95]
    found = opened(orbit([0, far, 1.4, 0], velocity, a=a))
    assert found is None or not found.confined


@with_heyoka
def test_a_fall_from_afar():
    """It goes through the horizon in another chart, as by the full equations."""
    frame, numbers = load("schwarzschild").frame, {"M": 1}
    start, velocity = [0, 255.0, np.pi / 2, 0], [1.0000041266590871, 0, 0, 0.003]

    def fall():
        return geodesic(frame, start, frame_velocity=velocity, parameters=numbers, causal=None)

    sol = solve(fall(), 4529.5, 1e-9)
    plain = replace(fall(), _written={})
    for chart in plain.charts:
        plain.equations(chart).__dict__["reduction"] = None
    truth = travel(plain, Taylor(113), 1e-28, np.array([0.0, 4529.5]) * plain.speed)
    assert sol.charts == ("schwarzschild", "kerr_schild")
    last = truth.segments[-1].states[-1].astype(float)
    assert sol.in_chart("kerr_schild")[-1] == pytest.approx(last[:4], rel=1e-9, abs=1e-9)


def test_many_are_looked_at_in_parts(monkeypatch):
    """A share of memory at a time, with the same answers."""
    problem = orbit(*ORBITS["bound"][:2])
    _, _, vector, parameters = departure(problem, 53)
    small = reduction_of(problem.equations("kerr"))
    opening = small.opening(vector, parameters, 53)
    start = np.repeat(vector[:, None], 7, axis=1)
    numbers = np.repeat(opening.numbers[:, None], 7, axis=1)
    start[2, ::2] = 0.05
    together = small.confined.holds(list(start), list(numbers))
    assert together.tolist() == [False, True] * 3 + [False]
    monkeypatch.setattr(confined, "MEMORY", 2 * confined.LOOKS**2)
    assert (small.confined.holds(list(start), list(numbers)) == together).all()


def test_room_enough_to_the_margin():
    """Where other charts wait, an orbit that dips below this chart's margin is not confined."""
    frame, start = load("kerr").frame, [0, 8.0, 1.4, 0]
    problem = orbit(start, [1.2, 0.05, 0.2, 0.36], charts=())
    assert len(problem.charts) > 1
    found = opened(problem)
    assert found is not None
    assert found.confined
    edge = sp.sin(frame.coordinates[2]) - sp.Rational(95, 100)
    equations = written(frame, Hamel(), Chart.of(frame, edge=edge))
    small = reduction_of(equations)
    _, _, vector, parameters = departure(problem, 53)
    found = small.opened(Taylor(), vector, parameters)
    assert found is not None
    assert not found.confined


@pytest.mark.parametrize("name", ["kerr", "schwarzschild", "de_sitter"])
def test_equations_in_cosines(name):
    """Put back, each rate is that of the system in angles; that of z is -sin(theta) theta'."""
    frame = load(name).frame
    smaller = reduction_of(written(frame, Hamel(), Chart.of(frame)))
    small, found = smaller.written, Confined(smaller.full_system, smaller.written)
    (place,) = found.cosines
    theta = frame.coordinates[place]
    field = frame.field

    def back(row):
        cosine = {s: sp.cos(theta) for value, _ in row for s in value.symbols if "cos" in s.name}
        return {names: field.read(value.sympy.subs(cosine)) for value, names in row}

    for k, (one, two) in enumerate(zip(small.system.rates, found.system.rates, strict=True)):
        factor = field.read(-sp.sin(theta)) if k == place else field.one
        assert back(two) == {names: field.read(value.sympy) * factor for value, names in one}
    for (_, one), (_, two) in zip(small.system.given, found.system.given, strict=True):
        assert back(two) == {names: field.read(value.sympy) for value, names in one}
    one, two = small.system.scale, found.system.scale
    assert (one is None) is (two is None)
    if one is not None and two is not None:
        assert back(((two, ()),)) == {(): field.read(one.sympy)}
    assert found.system.edge is None


@with_heyoka
@pytest.mark.parametrize("name", [name for name, (*_, stays) in ORBITS.items() if stays])
@pytest.mark.parametrize("accuracy", [1e-6, 1e-9, 1e-12])
def test_against_the_full_equations(name, accuracy):
    """Errors told hold against 113 bits of the equations of the frame itself."""
    start, velocity, _ = ORBITS[name]
    grid = np.linspace(0, 400.0, 33)
    plain = unreduced(orbit(start, velocity))
    truth = travel(plain, Taylor(113), 1e-28, grid * plain.speed)
    precise = truth.segments[0].states.astype(float)
    for engine in (Taylor(), RungeKutta()):
        problem = orbit(start, velocity)
        sol = solve(problem, grid, accuracy, engine)
        states = np.concatenate((sol.coordinates, sol.in_frame() / problem.speed), axis=1)
        error = max(
            np.abs(states - precise)[:, block].max() / np.abs(precise[:, block]).max()
            for block in (slice(0, 4), slice(4, 8))
        )
        assert error <= accuracy
        assert 0.1 * error <= sol.error <= accuracy


@with_heyoka
def test_more_digits():
    """Cosines serve at all precisions."""
    start, velocity, _ = ORBITS["bound"]
    grid = np.linspace(0, 100.0, 5)
    plain, problem = unreduced(orbit(start, velocity)), orbit(start, velocity)
    truth = travel(plain, Taylor(300), 1e-60, grid * plain.speed).segments[0].states
    for bits, tolerance, most in ((64, 1e-18, 1e-16), (113, 1e-32, 1e-29)):
        (found,) = travel(problem, Taylor(bits), tolerance, grid * problem.speed).segments
        gaps = [
            abs(float(x - y)) / max(abs(float(y)), 1e-3)
            for x, y in zip(Taylor(300).array(found.states.ravel()), truth.ravel(), strict=True)
        ]
        assert max(gaps) < most
