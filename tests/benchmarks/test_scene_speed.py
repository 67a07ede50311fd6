"""Speed of scenes: the free top beside three equations by hand, and the cost of each effect.

Run with `python -m pytest tests/benchmarks/test_scene_speed.py -s`. Ratios are taken in one run;
errors and states are asserted, times are not.
"""

from __future__ import annotations

import time

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.rigid.attitude import rotated
from tests.rigid.free_top_truth import by_integrals

hy = pytest.importorskip("heyoka")
E = gt.effects
MOMENTS, OMEGA = (1.0, 2.0, 3.0), (0.3, 1.0, 0.2)
ROUNDS = 300


def best(run):
    """Shortest of many runs, in seconds."""
    seconds = []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        run()
        seconds.append(time.perf_counter() - began)
    return min(seconds)


def by_hand(tolerance, times):
    """Three equations as a user of heyoka writes them, with numbers compiled in."""
    a, b, c = hy.make_vars("a", "b", "c")
    i, j, k = MOMENTS
    rates = [(a, (j - k) / i * b * c), (b, (k - i) / j * c * a), (c, (i - j) / k * a * b)]
    integrator = hy.taylor_adaptive(rates, list(OMEGA), tol=tolerance)

    def run():
        integrator.time = 0.0
        integrator.state[:] = OMEGA
        return integrator.propagate_grid(times)[5]

    return run


@pytest.mark.parametrize(
    ("accuracy", "last"), [(1e-6, 100), (1e-9, 100), (1e-12, 100), (1e-6, 1000), (1e-9, 1000)]
)
def test_free_top_against_three_equations(accuracy, last, capsys):
    """A scene that watches omega integrates only three equations, within its accuracy."""
    times = np.linspace(0, last, 65)
    scene = gt.Scene(
        gt.Body(moments=MOMENTS), (), gt.State(omega=OMEGA), ["omega"], times, accuracy
    )
    assert scene.selection.states == ("Omega1", "Omega2", "Omega3")
    truth = gt.rigid.free_top(MOMENTS, OMEGA).omega(times)
    engine = gt.Taylor()
    result = scene.run(engine=engine)
    assert np.abs(result["omega"] - truth).max() < accuracy
    solution = gt.solve(scene.ode, times, accuracy, engine)
    # The solution only, without the finer run that gives its error.
    solved = [gt.solve(scene.ode, times, accuracy, engine) for _ in range(ROUNDS)]
    ours = min(each.cost.run_seconds for each in solved)
    hand = best(by_hand(solution.trajectory.tolerance, times))
    whole = best(lambda: scene.run(engine=engine))
    closed = scene.run().form
    assert closed is not None
    formula = best(lambda: closed.states(times))
    with capsys.disabled():
        print(
            f"\n{accuracy:.0e} to t = {last}: scene {1e3 * ours:.4f} ms, by hand at the same "
            f"tolerance {1e3 * hand:.4f} ms (ratio {ours / hand:.2f}); with check and reading "
            f"{1e3 * whole:.3f} ms; closed form {1e3 * formula:.3f} ms"
        )


def test_a_free_top_in_closed_form(capsys):
    """A thousand attitudes and rates up to t = 1e6 have errors below 5e-15 against 50 digits."""
    rates, start = (0.3, 0.5, 0.7), (1.0, 0.0, 0.0, 0.0)
    times = np.linspace(1e3, 1e6, 1000)
    found = gt.rigid.free_top(MOMENTS, rates, start).states(times)
    worst = 0.0
    for k in (0, 499, 999):
        exact, matrix = by_integrals(MOMENTS, rates, times[k])
        turned = [rotated(found[k, 3:], axis) for axis in np.eye(3)]
        worst = max(worst, *(abs(float(x - y)) for x, y in zip(exact, found[k], strict=False)))
        worst = max(worst, abs(np.array(matrix.tolist(), dtype=float) - np.transpose(turned)).max())
    assert worst < 5e-15
    seconds = best(lambda: gt.rigid.free_top(MOMENTS, rates, start).states(times))
    with capsys.disabled():
        print(f"\na thousand attitudes: {1e3 * seconds:.2f} ms, errors below {worst:.0e}")


def test_cost_of_each_effect(capsys):
    """`scene.cost()` of a body with many effects counts the states that each effect adds."""
    effects = [
        E.AngularDamping(0.01), E.BodyMoment((0, 0, 0.01)), E.Magnet((0, 0, 0.1), (0, 0, 1)),
        E.Rotor((0, 0, 1), 0.2), E.Gravity(), E.LinearDrag(0.05), E.Thrust((0, 0, 1), end=5),
    ]  # fmt: skip
    start = gt.State(omega=OMEGA, euler=(0, 0.3, 0), velocity=(1, 0, 0))
    scene = gt.Scene(gt.Body(moments=MOMENTS), effects, start, ["omega"], 10, title="watch omega")
    cost = scene.cost(repeats=30)
    # Gravity and drag at the centre of mass do not affect the rotation: they cost nothing.
    assert [row.states for row in cost.rows] == [3, 3, 3, 6, 6, 6, 6, 6]
    whole = scene.with_values(watch=["omega", "position"], title="watch omega and position")
    full = whole.cost(repeats=30)
    assert [row.states for row in full.rows] == [6, 6, 6, 9, 9, 10, 12, 13]
    with capsys.disabled():
        print(f"\n{cost}\n{full}")


def test_time_to_the_first_number(capsys):
    """Time to plan and assemble the equations, without compiling, in milliseconds."""
    start = gt.State(omega=(0, 0, 20), euler=(0, 0.3, 0))

    def planned():
        return gt.Scene(
            gt.Body(moments=(1, 1, 0.5)),
            [E.Gravity(), E.Pivot([0, 0, 0.1])],
            start,
            ["nutation"],
            1,
        ).ode

    _ = planned()
    began = time.perf_counter()
    for _ in range(10):
        _ = planned()
    with capsys.disabled():
        print(f"\nheavy top, from words to equations: {100 * (time.perf_counter() - began):.1f} ms")


@pytest.mark.parametrize("name", ["missile", "lagrange_loop", "rolling_disc", "thrown_body"])
def test_a_changed_number_costs_little(name, capsys):
    """A run after a changed value, beside the same run again, and beside its solver."""
    scene = gt.scenes.load(name)
    mass = float(scene.body.mass)
    changes = iter(range(1, ROUNDS + 2))
    seconds = {
        "solve": best(lambda: gt.solve(scene.ode, scene.times, scene.accuracy)),
        "run again": best(scene.run),
        "changed": best(
            lambda: scene.with_values({"body.mass": mass * (1 + 1e-6 * next(changes))}).run()
        ),
    }
    with capsys.disabled():
        print(f"\n{name}: " + ", ".join(f"{key} {1e3 * x:.2f} ms" for key, x in seconds.items()))
