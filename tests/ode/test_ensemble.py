"""solve_many on first-order equations: the results of single solves, starts and parameters."""

import numpy as np
import pytest

from geomtorsion.errors import AccuracyError, StartError
from geomtorsion.ode import ODE, At, solve, solve_many
from tests.ode.engines import every_engine, needs_heyoka
from tests.rounding import ROUNDED


def driven(**more):
    """A driven decay and a rotation, with events, a clock and a unit pair."""
    return ODE.of(
        {"x": "-k*x + a*cos(t)", "q0": "-w*q1/2", "q1": "w*q0/2"},
        [1, 1, 0],
        parameters={"k": 1.0, "a": 0.0, "w": 3},
        outputs={"pair": ["x", "k*x"], "mixed": "k*x + t*a"},
        normalized=[("q0", "q1")],
        **more,
        events=[At(1.25, {"a": 2.0}), At(2, {"x": 5})],
    )


@every_engine
def test_same_as_one_by_one(engine):
    """States and outputs agree at all times, across events."""
    times = [0.5, 1.25, 2.0, 3.0]
    starts = {"k": np.array([0.5, 1, 2]), "x": [1, 2, 3]}
    many = solve_many(driven(), starts, times, 1e-10, engine)
    assert len(many) == 3
    assert many.finished.all()
    assert many.error <= 1e-10
    for row, (k, x) in enumerate(zip(starts["k"], starts["x"], strict=True)):
        one = driven().with_start(start={"x": x}, parameters={"k": float(k)})
        alone = solve(one, times, 1e-12)
        assert many.states[row] == pytest.approx(alone.states, abs=2e-9)
        assert many["pair"][row] == pytest.approx(alone["pair"], abs=2e-9)
        assert many["mixed"][row] == pytest.approx(alone["mixed"], abs=2e-9)
    assert np.abs((many.states[..., 1:] ** 2).sum(axis=-1) - 1).max() < ROUNDED
    assert "3 of 3 motions" in str(many)


@every_engine
def test_arrays_of_states(engine):
    """States keep their order; one time gives only the end; times may be negative."""
    swing = ODE.of({"x": "v", "v": "-x"}, [1, 0])
    angles = np.linspace(0, 6, 20)
    starts = np.array([np.cos(angles), -np.sin(angles)]).T
    for end in (2.0, -2.0):
        many = solve_many(swing, starts, end, 1e-10, engine)
        assert many.states.shape == (20, 1, 2)
        assert many["x"][:, 0] == pytest.approx(np.cos(angles + end), abs=1e-9)


def test_parameters_only():
    """Derived numbers are computed for each motion."""
    rates = {"a": "(I2 - I3)/I1*b*c", "b": "(I3 - I1)/I2*a*c", "c": "(I1 - I2)/I3*a*b"}
    body = ODE.of(rates, [1, 0.1, 2], parameters={"I1": 1, "I2": 2, "I3": 3})
    third = np.array([2.5, 3.0, 4.0])
    many = solve_many(body, {"I3": third}, 3.0, 1e-11)
    for row, value in enumerate(third):
        alone = solve(body.with_start(parameters={"I3": float(value)}), [3.0], 1e-12)
        assert many.states[row, -1] == pytest.approx(alone.states[-1], abs=1e-10)


@every_engine
def test_some_do_not_arrive(engine):
    """A motion that runs away is reported as unfinished; the others are not affected."""
    away = ODE.of({"x": "x**2/(1 + t)"}, [1], events=[At(0.5, {})])
    many = solve_many(away, {"x": [0.1, 20.0, 0.2]}, 1.0, 1e-9, engine)
    assert many.finished.tolist() == [True, False, True]
    assert many.unfinished == (1,)
    assert "not finished: member 1." in str(many)
    assert np.isfinite(many.errors).tolist() == [True, False, True]
    assert np.isnan(many.states[1]).all()
    # 1/x falls by log(1 + t).
    exact = [1 / (1 / x - np.log(2)) for x in (0.1, 0.2)]
    assert many["x"][[0, 2], -1] == pytest.approx(exact, rel=1e-8)


@every_engine
def test_long_rates(engine):
    """Rates that are not read exactly also work in batches."""
    root = ODE.of({"x": "-x/sqrt(1 + x**2) + a*cos(t)"}, [1], parameters={"a": 0.5})
    many = solve_many(root, {"a": [0.1, 0.2, 0.9], "x": [1, 2, 3]}, 3.0, 1e-10, engine)
    for row, (a, x) in enumerate([(0.1, 1), (0.2, 2), (0.9, 3)]):
        alone = solve(root.with_start(start=[x], parameters={"a": a}), [3.0], 1e-12)
        assert many["x"][row, -1] == pytest.approx(alone["x"][-1], abs=1e-9)


@needs_heyoka
@every_engine
def test_each_member_has_its_own_error(engine):
    """Each pendulum has an honest error; the one near the separatrix is named when it fails."""
    swing = ODE.of({"x": "v", "v": "-sin(x)"}, [1.0, 0.0])
    heights = np.array([0.3, 1.0, 2.0, np.pi - 1e-6, 2.5])
    many = solve_many(swing, {"x": heights}, 25.0, 1e-7, engine)
    assert many.finished.all()
    assert many.errors.shape == (5,)
    assert (many.errors <= 1e-7).all()
    assert many.error == many.errors.max()
    assert many.checked == 5
    true = []
    for row, height in enumerate(heights):
        exact = solve(swing.with_start(start={"x": float(height)}), [25.0], 1e-18).states[-1]
        exact = exact.astype(float)
        size = np.maximum(np.abs(exact), [height, 0.0])
        true.append(float((np.abs(many.states[row, -1] - exact) / size).max()))
        assert true[-1] <= 1e-7
        assert many.errors[row] >= 0.5 * true[-1] or true[-1] < 1e-12
    with pytest.raises(AccuracyError, match=r"That is so for member 3\.") as caught:
        solve_many(swing, {"x": heights}, 40.0, 1e-7, engine)
    # The error carries the results of the other members.
    assert caught.value.ensemble.unfinished == (3,)
    assert caught.value.ensemble.error <= 1e-7
    assert solve_many(swing, {"x": np.delete(heights, 3)}, 40.0, 1e-7, engine).error <= 1e-7


@every_engine
def test_only_some_members_are_verified(engine):
    """The errors of unchecked members are nan and do not count in `error`."""
    swing = ODE.of({"x": "v", "v": "-sin(x)"}, [1.0, 0.0])
    many = solve_many(swing, {"x": np.linspace(0.1, 2, 9)}, 10.0, 1e-8, engine, check=3)
    assert np.isfinite(many.errors).tolist() == [True, *[False] * 3, True, *[False] * 3, True]
    assert many.checked == 3
    assert many.error == np.nanmax(many.errors)
    assert many.finished.all()
    for wrong in (0, -1, 1.5, True, "3"):
        with pytest.raises(StartError, match="check: expected a whole number from 1 on"):
            solve_many(swing, {"x": [0.1, 0.2]}, 1.0, 1e-8, engine, check=wrong)  # type: ignore[arg-type]


@every_engine
def test_a_thousand_pendulums_one_on_the_separatrix(engine):
    """The error of v = 2/cosh(t) holds; the energies show that the other errors hold."""
    swing = ODE.of({"x": "v", "v": "-sin(x)"}, [0, 2])
    speeds = np.linspace(1.5, 2.5, 1000)
    speeds[500] = 2.0
    many = solve_many(swing, {"x": np.zeros(1000), "v": speeds}, 12.0, 1e-8, engine)
    assert many.finished.all()
    assert many.errors.shape == (1000,)
    assert many.error == many.errors.max()
    assert abs(many["v"][500, -1] - 2 / np.cosh(12)) / 2 <= many.errors[500] <= 1e-8
    energies = many["v"] ** 2 / 2 - np.cos(many["x"])
    assert np.abs(energies[:, -1] - energies[:, 0]).max() <= 1e-8
    with pytest.raises(AccuracyError, match=r"That is so for member 500\."):
        solve_many(swing, {"x": np.zeros(1000), "v": speeds}, 20.0, 1e-8, engine)
