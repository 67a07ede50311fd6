"""Solutions and problems: files, tables, text."""

import sys

import mpmath
import numpy as np
import pytest
import sympy as sp

from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.curves.atlas import atlas_of
from geomtorsion.curves.linear import closed_form
from geomtorsion.errors import FileFormatError, MetricError, MissingExtraError, StartError
from geomtorsion.geometry import Frame, cartan
from geomtorsion.ode import RungeKutta, SavedSolution, Taylor, solve
from geomtorsion.ode.engines import taylor
from geomtorsion.spaces import load
from tests.chosen import one_in
from tests.ode.engines import every_engine, needs_heyoka
from tests.rounding import ROUNDED

SO3 = load("so3").frame
PROBLEM = autoparallel(cartan(SO3), [0.3, 1.0, 0.2], [0.1, 0.5, -0.2])


def test_saved_and_read(tmp_path):
    """Arrays are restored bit by bit, metadata as text and numbers."""
    sol = solve(PROBLEM, 3.0, engine=RungeKutta())
    sol.save(tmp_path / "motion.npz")
    back = SavedSolution.load(tmp_path / "motion.npz")
    assert (back["coordinates"] == sol.coordinates).all()
    assert (back["frame_velocity"] == sol.frame_velocity).all()
    assert (back["velocity"] == sol.velocity).all()
    assert back.error == sol.error
    assert back.metadata["problem"]["space"] == "so3"
    assert back.metadata["problem"]["coordinates"] == ["phi1", "phi2", "phi3"]


def test_invalid_files_are_refused(tmp_path):
    """Missing, truncated and foreign files are refused by name."""
    path = tmp_path / "motion.npz"
    with pytest.raises(FileFormatError, match=r"motion\.npz"):
        SavedSolution.load(path)
    path.write_bytes(b"PK\x03\x04 nothing")
    with pytest.raises(FileFormatError, match="not a solution saved"):
        SavedSolution.load(path)
    np.savez(path, times=np.zeros(3))
    with pytest.raises(FileFormatError, match="not a solution saved"):
        SavedSolution.load(path)


def test_pandas(monkeypatch):
    """A table needs pandas; the error without it names the command to install it."""
    sol = solve(PROBLEM, 1.0, engine=RungeKutta())
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(MissingExtraError, match="pip install pandas"):
        sol.to_pandas()

    class Pandas:
        DataFrame = dict

    monkeypatch.setitem(sys.modules, "pandas", Pandas())
    assert list(sol.to_pandas()) == [
        "t", "phi1", "phi2", "phi3", "phi1'", "phi2'", "phi3'", "u1", "u2", "u3",
    ]  # fmt: skip


def test_without_heyoka(monkeypatch):
    """engine=None falls back to Runge-Kutta; an explicit Taylor names the package to install."""
    monkeypatch.setitem(sys.modules, "heyoka", None)
    with pytest.raises(MissingExtraError, match=r"geomtorsion\[fast\]"):
        solve(PROBLEM, 1.5, 1.7e-9, engine=Taylor(128))
    monkeypatch.setattr(sys.modules["geomtorsion.ode.solve"], "is_available", lambda: False)
    sol = solve(PROBLEM, 1.0, 1e-9)
    assert sol.engine == "RungeKutta"
    assert "heyoka is not installed" in sol.reason
    assert taylor.heyoka is not None


def test_equations_in_words():
    """Text and LaTeX show every state once."""
    text = PROBLEM.text
    assert text.count("=") == 6
    assert "u3' = 0" in text
    assert PROBLEM.latex.count(r"\dot") == 6
    top = geodesic(SO3, frame_velocity=[1, 2, 3], metric=[[2, 1, 0], [1, 3, 0], [0, 0, 4]])
    assert top.text.count("'") == 3


def test_velocity_of_the_start():
    """The coordinate velocity of the start is given back."""
    assert PROBLEM.velocity == pytest.approx([0.1, 0.5, -0.2], abs=ROUNDED)


def test_velocities_only():
    """On a group the velocities need no coordinates."""
    top = geodesic(SO3, frame_velocity=[1.0, 0.1, 0.2], metric=[1, 2, 3])
    sol = solve(top, 10.0, 1e-10, RungeKutta())
    assert sol.coordinates.shape == (65, 0)
    both = solve(
        geodesic(SO3, [0.3, 1, 0.2], frame_velocity=[1.0, 0.1, 0.2], metric=[1, 2, 3]), 10.0, 1e-10
    )
    assert sol.frame_velocity == pytest.approx(both.frame_velocity, abs=1e-9)
    assert set(sol.drift) == {"energy", "angular momentum squared"}


def test_full_kinetic_metric():
    """A metric with off-diagonal entries is the diagonal one in rotated axes."""
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1.0]])
    moments = turn @ np.diag([1.0, 2.0, 3.0]) @ turn.T
    moments = (moments + moments.T) / 2
    u = np.array([0.3, 0.8, 0.5])
    turned = solve(geodesic(SO3, frame_velocity=turn @ u, metric=moments), 8.0, 1e-10)
    plain = solve(geodesic(SO3, frame_velocity=u, metric=[1, 2, 3]), 8.0, 1e-10)
    assert turned.frame_velocity == pytest.approx(plain.frame_velocity @ turn.T, abs=1e-8)


ROOT = sp.sqrt(2)


@pytest.mark.parametrize(
    "metric",
    [
        [1, ROOT, 3],
        [[1, 0, 0], [0, ROOT, 0], [0, 0, 3]],
        [[1, ROOT / 4, 0], [sp.sqrt(8) / 8, ROOT, 0], [0, 0, sp.pi]],
    ],
    ids=str,
)
@pytest.mark.parametrize("start", [None, [0.3, 1.0, 0.2]])
def test_a_kinetic_metric_of_exact_constants(metric, start):
    """Roots and pi are exact moments; the motion is the one of the same numbers as floats."""
    u = [0.3, 0.8, 0.5]
    exact = solve(geodesic(SO3, start, frame_velocity=u, metric=metric), 8.0, 1e-11)
    floats = np.array(sp.Matrix(metric).tolist(), float).squeeze()
    plain = solve(geodesic(SO3, start, frame_velocity=u, metric=floats.tolist()), 8.0, 1e-11)
    assert exact.frame_velocity == pytest.approx(plain.frame_velocity, abs=1e-9)
    assert max(exact.drift.values()) < 1e-9
    assert "energy" in exact.drift


@pytest.mark.parametrize(
    ("metric", "words"),
    [
        ([1, sp.sqrt(2) - ROOT, 3], "singular"),
        ([[ROOT, 2, 0], [2, sp.sqrt(8), 0], [0, 0, 1]], "singular"),
        ([[1, ROOT, 0], [1, 3, 0], [0, 0, 1]], "not symmetric"),
        ([1, sp.zoo, 3], "expected a number, got"),
        ([1, sp.Symbol("a"), 3], "expected a number, got"),
    ],
    ids=str,
)
def test_a_kinetic_metric_that_is_refused(metric, words):
    """A singular or asymmetric metric is found exactly, and entries must be numbers."""
    with pytest.raises((MetricError, StartError), match=words):
        geodesic(SO3, frame_velocity=[1, 1, 1], metric=metric)


@every_engine
@pytest.mark.parametrize(("charts", "accuracy"), one_in(2, [(), ("so3", "so3_xyz")], [1e-5, 1e-9]))
def test_error_between_the_times(engine, charts, accuracy):
    """With few times far apart, error_between covers the error of dense output within limits."""
    problem = autoparallel(
        cartan(load("so3").frame), [0.3, 1.0, 0.2], frame_velocity=[0.1, 1.3, 0.2]
    )
    known = closed_form(problem)
    assert known is not None
    _, exact = known
    own = problem.with_charts(*charts) if charts else problem
    sol = solve(own, [10.0, 20.0], accuracy, engine)
    assert len(sol.charts) > 1 or not charts
    assert sol.error_between >= sol.error
    times = np.random.default_rng(5).uniform(0, 20, 60)
    moment = sol.at(times)
    there = atlas_of(problem.frame).route("so3", "quaternion")[0]
    found = np.asarray(there(moment.coordinates.T, {})).T
    states = np.array(exact(times), dtype=float)
    gap = np.minimum(np.abs(found - states).max(axis=1), np.abs(found + states).max(axis=1)).max()
    assert gap <= 10 * sol.error_between
    # Angles are worse than the attitude near the edge of their chart.
    assert sol.error_between <= 300 * max(gap, 1e-14)


def test_error_of_the_velocity_in_coordinates():
    """A quick ripple in the coframe adds little error to coordinates and much to velocities."""
    q, y = sp.symbols("x y", real=True)
    frame = Frame([q, y], [[2 + sp.sin(40 * q), 0], [0, 1]])
    sol = solve(autoparallel(cartan(frame), [0, 0], frame_velocity=[1, 1]), 20.0, 1e-9)
    with mpmath.workdps(30):
        # 2 x - cos(40 x)/40 = t - 1/40
        exact = [
            mpmath.findroot(
                lambda q, t=t: 2 * q - mpmath.cos(40 * q) / 40 - t + 0.025,
                (0, 15),
                solver="anderson",
            )
            for t in sol.times.tolist()
        ]
        speeds = np.array([1 / (2 + mpmath.sin(40 * q)) for q in exact], dtype=float)
    places = np.array(exact, dtype=float)
    gap = np.abs(sol.coordinates[:, 0] - places).max() / 20
    slip = np.abs(sol.velocity[:, 0] - speeds).max() / speeds.max()
    assert gap < sol.error_of("x") < sol.error / 10
    assert slip < sol.error_of("velocity") < 100 * slip
    assert sol.error == pytest.approx(sol.error_of("velocity"), rel=1e-6)
    assert sol.error_of("x") == pytest.approx(sol.error_of("coordinates"), rel=2)


def test_dense_output_may_be_worse_than_the_times():
    """With one time at the end of a step, dense output is less accurate, as reported."""
    problem = autoparallel(
        cartan(load("so3").frame), [0.3, 1.0, 0.2], frame_velocity=[0.1, 1.3, 0.2]
    )
    sol = solve(problem, [6.0], 1e-9, RungeKutta())
    known = closed_form(problem)
    assert known is not None
    times = np.linspace(0.05, 5.95, 60)
    ((_, states, _),) = sol.trajectory.at(times * problem.time_unit)
    gap = np.abs(states - np.array(known[1](times), dtype=float)).max()
    assert sol.error < sol.error_between
    assert 0.5 * gap < sol.error_between < 20 * gap


@needs_heyoka
def test_velocities_are_read_off_before_states_are_rounded():
    """sqrt(y**2 + 1) - 1 keeps few digits of y, so velocities are computed before rounding."""
    x, y = sp.symbols("x y", real=True)
    frame = Frame([x, y], [[sp.sqrt(y**2 + 1) - 1, 0], [0, 1]])
    problem = autoparallel(cartan(frame), [0, 1e-6], frame_velocity=[1e-12, 1e-6])
    sol = solve(problem, 4.0, 1e-9, Taylor(113))
    place = 1e-6 * (1 + sol.times)
    exact = 1e-12 * (np.sqrt(place**2 + 1) + 1) / place**2
    assert sol.velocity.dtype == float
    assert sol.velocity[:, 0] == pytest.approx(exact, rel=1e-9)
    assert sol.error_of("velocity") < 1e-9
