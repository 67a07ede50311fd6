"""Speed of motions: solve beside hand-written heyoka and scipy on Christoffel symbols.

Run with `python -m pytest tests/benchmarks/test_motion_speed.py -s`. Ratios are taken in one run;
errors are asserted, times are not.
"""

from __future__ import annotations

import time
from functools import partial

import numpy as np
import pytest

from geomtorsion.curves import geodesic
from geomtorsion.errors import AccuracyError
from geomtorsion.ode import RungeKutta, Taylor, solve, solve_many
from geomtorsion.spaces import load
from tests.benchmarks.motion_rivals import (
    best_times,
    christoffel_ode,
    heyoka_by_hand,
    scipy_by_hand,
    scipy_on_christoffel,
)
from tests.benchmarks.motions import MOMENTS, carter, cases, kerr, kerr_orbit, true_error

hy = pytest.importorskip("heyoka")
ACCURACIES = (1e-6, 1e-9, 1e-12)


RACES = ((Taylor(), heyoka_by_hand), (RungeKutta(), scipy_by_hand))


def _ms(seconds: float | None) -> str:
    return "-" if seconds is None else f"{1e3 * seconds:.3g}"


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
def test_against_rivals(case, capsys):
    """The error is within the accuracy and its estimate holds; CPU milliseconds are printed."""
    hy.llvm_state.set_diskcache_enabled(False)
    rows = []
    for accuracy in ACCURACIES:
        # Compile time of the Taylor engine; zero if the same order was compiled before.
        seconds = solve(case.problem, case.t, accuracy).cost.compile_seconds
        for engine, by_hand in (
            (Taylor(), heyoka_by_hand),
            (RungeKutta(), scipy_by_hand),
        ):
            try:
                sol = solve(case.problem, case.t, accuracy, engine)
            except AccuracyError as refusal:
                rows.append(f"{accuracy:.0e} {engine.name:<11} refused: {refusal}")
                continue
            best_times([partial(solve, case.problem, case.t, accuracy, engine)], 1.0)
            error = true_error(case, sol)
            rival = by_hand(case, accuracy)
            ours = partial(solve, case.problem, case.t, accuracy, engine)
            alone = min(ours().cost.run_seconds for _ in range(50))
            whole, *theirs = best_times([ours, *(rival or ())])
            rows.append(
                f"{accuracy:.0e} {sol.engine:<11} error {error:.1e} (estimated {sol.error:.1e}): "
                f"run {_ms(alone)}, checked {_ms(whole)}"
            )
            if theirs:
                plain, checked = theirs
                rows[-1] += (
                    f"; by hand {_ms(plain)}, checked {_ms(checked)}: "
                    f"ratios {alone / plain:.2f}, {whole / checked:.2f}"
                )
            else:
                rows[-1] += "; by hand never"
            if by_hand is heyoka_by_hand:
                christoffel = scipy_on_christoffel(case, accuracy)
                rows[-1] += f"; compiled in {seconds:.2f} s"
                if christoffel:
                    rows[-1] += (
                        f"; scipy on Christoffel symbols {_ms(christoffel)}: "
                        f"{christoffel / whole:.0f} times"
                    )
            assert error <= accuracy
            assert sol.error >= 0.1 * error
            assert sol.error <= 100 * error or error < 1e-15
        assert seconds < 60
    with capsys.disabled():
        print(f"\n{case.name}, t = {case.t:g}, milliseconds")
        print("\n".join(rows))


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
def test_frame_beats_christoffel_symbols(case, capsys):
    """Equations in the frame and with Christoffel symbols agree; milliseconds are printed."""
    other = christoffel_ode(case)
    if other is None:
        pytest.skip("no geodesic: no Christoffel symbols")
    rows, n = [], case.problem.frame.dimension
    # With Christoffel symbols the top in its angles does not reach 1e-12.
    for accuracy in ACCURACIES[:2]:
        for engine in (Taylor(), RungeKutta()):
            runs = [partial(solve, p, case.t, accuracy, engine) for p in (case.problem, other)]
            ours, theirs = [run() for run in runs]
            apart = ours.coordinates - theirs.states[:, :n]  # up to whole turns of an angle
            apart -= 2 * np.pi * np.round(apart / (2 * np.pi))
            assert np.abs(apart).max() <= 2 * accuracy * np.abs(theirs.states).max()
            plain = [min(run().cost.run_seconds for _ in range(20)) for run in runs]
            rows.append(
                f"{accuracy:.0e} {ours.engine:<11} {_ms(plain[0])} and {_ms(plain[1])}: "
                f"{plain[1] / plain[0]:.1f} times cheaper"
            )
    with capsys.disabled():
        print(f"\n{case.name}, t = {case.t:g}, in the frame and with Christoffel symbols, ms")
        print("\n".join(rows))


@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize("with_attitude", [False, True], ids=["rates", "attitude"])
def test_batch(accuracy, with_attitude, capsys):
    """Ten thousand tops to t = 10, beside a plain loop over a hand-written batch integrator."""
    spins = np.random.default_rng(0).normal(size=(10_000, 3))
    start = [0.3, 1.0, 0.2] if with_attitude else None
    problem = geodesic(load("so3").frame, start, frame_velocity=[1, 0, 0], metric=MOMENTS)

    solved = partial(solve_many, problem, None, 10.0, accuracy, frame_velocities=spins)
    many = _verified(solved, accuracy)
    rate, hand = 0.0, 0.0
    for _ in range(4):
        rate = max(rate, _rate(solved))
        hand = max(hand, _by_hand(spins, many.tolerance, with_attitude))
    stacked = _rate(partial(solved, engine=RungeKutta()))
    with capsys.disabled():
        print(
            f"\n{accuracy:.0e} {'attitude' if with_attitude else 'rates'}: {rate:.3g} per second, "
            f"by hand {hand:.3g} at the same tolerance (ratio {rate / hand:.2f}), "
            f"stacked RungeKutta {stacked:.3g}"
        )


@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_batch_of_orbits(accuracy, capsys):
    """Two thousand bound Kerr orbits, beside Carter's equations in hand-written batches."""
    problem = kerr().with_charts("kerr")
    ahead = np.array([float(u) for u in problem.frame_velocity])
    velocities = ahead * (1 + 0.03 * np.random.default_rng(0).normal(size=(2000, 4)))
    solved = partial(solve_many, problem, None, 1500.0, accuracy, frame_velocities=velocities)
    many = _verified(solved, accuracy)
    opened = [carter(problem, velocity) for velocity in velocities]
    columns, pars = (np.array([one[k] for one in opened]).T for k in (0, 1))
    rates, _, _ = kerr_orbit(hy)
    rate, hand = 0.0, 0.0
    for _ in range(3):
        rate = max(rate, _rate(solved))
        hand = max(hand, _batches(rates, columns, pars, 4, many.tolerance, 1500.0))
    with capsys.disabled():
        print(
            f"\n{accuracy:.0e} Kerr orbits: {rate:.3g} per second, by hand {hand:.3g} at the same "
            f"tolerance (ratio {rate / hand:.2f})"
        )


def _verified(solved, accuracy):
    """The ensemble; at most one in a thousand members, unstable ones, may miss the accuracy."""
    try:
        many = solved()
    except AccuracyError as lacking:
        many = lacking.ensemble
    assert many.error <= accuracy
    assert many.finished.mean() >= 0.999
    return many


def _rate(solved):
    """Motions per CPU second of a call of solve_many that verifies one member."""
    began = time.process_time()
    many = solved(check=1)
    return len(many) / (time.process_time() - began)


def _by_hand(spins, tolerance, with_attitude):
    """Trajectories per CPU second of heyoka's batch mode in a plain loop."""
    from tests.benchmarks.motions import attitude, euler_rates

    rates, start, values = (attitude if with_attitude else euler_rates)(hy)
    columns = np.tile(np.array(start)[:, None], len(spins))
    columns[-3:] = spins.T
    pars = np.tile(np.array(values)[:, None], len(spins))
    return _batches(rates, columns, pars, 8 if with_attitude else 16, tolerance, 10.0)


def _batches(rates, columns, pars, lanes, tolerance, end):
    """Trajectories per CPU second of heyoka's batch mode in a plain loop, one per column."""
    integrator = hy.taylor_adaptive_batch(
        rates, columns[:, :lanes].copy(), pars=pars[:, :lanes].copy(), tol=tolerance
    )
    out = np.zeros(columns.shape)
    began = time.process_time()
    for k in range(0, columns.shape[1], lanes):
        integrator.set_time(0.0)
        integrator.state[:] = columns[:, k : k + lanes]
        integrator.pars[:] = pars[:, k : k + lanes]
        integrator.propagate_until(end)
        out[:, k : k + lanes] = integrator.state
    return columns.shape[1] / (time.process_time() - began)
