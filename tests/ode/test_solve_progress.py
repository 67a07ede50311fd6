"""progress: called during a run, without changing a bit of the result."""

import pytest

from geomtorsion.curves import geodesic
from geomtorsion.ode import ODE, Stiff, solve
from geomtorsion.ode.solve import Report
from geomtorsion.spaces import load
from tests.ode.engines import ENGINES


def long_run():
    """Three hundred turns: thousands of steps."""
    return ODE.of({"x": "y", "y": "-x"}, [1, 0]), 2000.0


def chart_changes():
    """A geodesic over the poles of a sphere, many times."""
    return geodesic(load("s2").frame, [0.3, 0.1], [1.0, 0.4], parameters={"R": 1}), 100.0


def stiff():
    """Relaxation with a fast part."""
    return ODE.of({"x": "-1000*(x - cos(t))"}, [0]), 0.5


CASES = [(long_run, engine) for engine in ENGINES]
CASES += [(chart_changes, engine) for engine in ENGINES]
CASES += [(stiff, Stiff()), (stiff, Stiff("LSODA"))]


@pytest.mark.parametrize(
    ("case", "engine"), CASES, ids=lambda x: getattr(x, "name", None) or x.__name__
)
def test_watching_changes_nothing(case, engine):
    """The result has the same bits with and without progress; the reports rise from 0 to 1."""
    problem, t = case()
    seen = []
    watched = solve(problem, t, 1e-7, engine, progress=seen.append)
    alone = solve(problem, t, 1e-7, engine)
    assert watched.error == alone.error
    table = watched.problem.columns(watched.at(watched.times))
    for name, column in alone.problem.columns(alone.at(alone.times)).items():
        assert (table[name] == column).all()
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    # Taylor reports once in two thousand series; the sphere takes fewer.
    assert len(seen) > (0 if engine.name == "Taylor" and case is chart_changes else 2)


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.name)
def test_ctrl_c_ends_a_run_midway(engine):
    """An exception of the callback ends the run at that time."""

    def press(part):
        if part > 0.1:
            raise KeyboardInterrupt

    problem, t = long_run()
    with pytest.raises(KeyboardInterrupt):
        solve(problem, t, 1e-7, engine, progress=press)


def test_report_counts_runs():
    """The first run is half of the work, the next half of the rest; tiny steps are not reported."""
    seen = []
    report = Report(seen.append, -10.0)
    first = report.next_run()
    for time in (-1.0, -1.000001, -10.0):
        first(time)
    report.next_run()(-5.0)
    assert seen == [0.05, 0.5, 0.625]
