"""accuracy_cost: measured errors, times and a recommendation."""

import json
import sys
from types import SimpleNamespace

import pytest

from geomtorsion.accuracy import accuracy_cost, cost
from geomtorsion.curves import autoparallel, geodesic
from geomtorsion.errors import AccuracyError, MissingExtraError, ProofError
from geomtorsion.geometry import cartan
from geomtorsion.ode import RungeKutta
from geomtorsion.ode.engines.taylor import is_available
from geomtorsion.spaces import load

SO3 = load("so3").frame
TURN = autoparallel(cartan(SO3), [0.3, 1.0, 0.2], [0.1, 0.5, -0.2])
TOP = geodesic(SO3, frame_velocity=[1.0, 0.2, 0.1], metric=[1, 2, 3])


def test_errors_are_measured():
    """Errors are measured against the closed form, and each requested accuracy is reached."""
    table = accuracy_cost(TURN, 5.0, accuracies=[1e-4, 1e-8])
    assert table.truth == "the closed form"
    assert len(table.rows) == (4 if is_available() else 2)
    assert all(row.holds for row in table.rows)
    for row in table.rows:
        assert row.estimated is not None
        assert row.achieved is not None
        assert row.estimated >= row.achieved / 10
    assert table.recommendation.startswith("Take ")


def test_what_cannot_be_had_stands_in_the_table():
    """Runge-Kutta at 1e-17 fails, which is a row with a note."""
    table = accuracy_cost(TOP, 5.0, [RungeKutta()], [1e-6, 1e-17])
    assert [row.holds for row in table.rows] == [True, False]
    assert "gets to" in table.rows[1].note
    assert "gets to" in str(table)
    expected = "quadruple precision" if is_available() else "the finest Runge-Kutta solution"
    assert table.truth == expected


def test_json():
    """The table converts to plain data."""
    table = accuracy_cost(TOP, 1.0, [RungeKutta()], [1e-6])
    data = json.loads(json.dumps(table.to_json()))
    assert data["rows"][0]["engine"] == "RungeKutta"
    assert data["recommendation"]


@pytest.mark.parametrize(("lasts", "repeats"), [(0.009, 3), (0.011, 2), (0.019, 2), (0.021, 1)])
def test_what_is_quick_is_repeated(lasts, repeats, monkeypatch):
    """A solution is repeated for twenty milliseconds, after a first one that may compile."""
    found, clock, count = cost.solve(TOP, 1.0, 1e-6, RungeKutta()), [0.0], [0]

    def solve(*_):
        clock[0] += lasts
        count[0] += 1
        return found

    monkeypatch.setattr(cost, "solve", solve)
    monkeypatch.setattr(cost, "time", SimpleNamespace(perf_counter=lambda: clock[0]))
    [row] = accuracy_cost(TOP, 1.0, [RungeKutta()], [1e-6]).rows
    assert count[0] == 1 + repeats
    assert row.total_seconds == pytest.approx(lasts)


def test_refused():
    """An empty list of accuracies and a negative accuracy are refused."""
    with pytest.raises(AccuracyError, match="expected at least one, got none"):
        accuracy_cost(TOP, 1.0, [RungeKutta()], [])
    with pytest.raises(AccuracyError, match="positive"):
        accuracy_cost(TOP, 1.0, [RungeKutta()], [-1e-6])


def test_picture(monkeypatch):
    """plot gives a figure; without matplotlib an error names the extra to install."""
    table = accuracy_cost(TOP, 1.0, [RungeKutta()], [1e-4, 1e-6])
    pytest.importorskip("matplotlib")
    (axes,) = table.plot().axes
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert "RungeKutta" in [text.get_text() for text in axes.get_legend().get_texts()]
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match="plots"):
        table.plot()


def test_a_proof_has_its_price():
    """The table contains the cost of a proof, and whether the finest estimate holds."""
    table = accuracy_cost(TOP, 1.0, [RungeKutta()], [1e-6, 1e-9], proved=True)
    assert table.proof is not None
    assert table.proof.holds
    assert table.proof.steps > 0
    assert "proved" in str(table)
    assert "Take RungeKutta" in str(table)
    assert accuracy_cost(TOP, 1.0, [RungeKutta()], [1e-6]).proof is None


def test_no_proof_has_a_note(monkeypatch):
    """If nothing is proved, the table states the reason."""

    def refused(*_):
        raise ProofError("the motion touches the stop. Move it.")

    monkeypatch.setattr(cost, "prove", refused)
    table = accuracy_cost(TOP, 1.0, [RungeKutta()], [1e-6], proved=True)
    assert "touches the stop" in str(table)
    assert table.proof is not None
    assert table.proof.seconds is None
