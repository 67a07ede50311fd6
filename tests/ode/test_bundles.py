"""Bundles: members of an ensemble that are each stopped at their own time."""

import csv
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import AccuracyError, ArgumentError, StartError
from tests.ode.engines import every_engine

HEIGHTS = np.array([5.0, 20.0, 45.0, 80.0])


def stone(**more):
    """A stone that falls without resistance until it lands."""
    rates = {"z": "v", "v": "-g"}
    return gt.ODE.of(
        rates, [20, 0], parameters={"g": 10}, outputs={"energy": "v**2/2 + g*z + 0*t"},
        events=[gt.When("z")], **more,
    )  # fmt: skip


@every_engine
@pytest.mark.parametrize("scale", [1.0, 1e40])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("times", [3.5, [0.5, 1.5, 2.5, 3.5]])
def test_stones_land_at_their_own_times(engine, scale, sign, times):
    """t = sqrt(2 z/g), in both directions of time; the last one is still on its way."""
    starts = {"z": scale * HEIGHTS, "g": np.full(4, 10 * scale)}
    many = gt.solve_many(stone(), starts, sign * np.array(times), 1e-10, engine)
    landing = sign * np.sqrt(HEIGHTS / 5)
    assert many.finished.all()
    assert many.stopped_by.tolist() == ["z", "z", "z", ""]
    assert many.times_at_stop[:3] == pytest.approx(landing[:3], rel=1e-10)
    assert np.isnan(many.times_at_stop[3])
    assert many.end.time == pytest.approx([*landing[:3], sign * 3.5], rel=1e-10)
    assert many.end["v"] / scale == pytest.approx(-10 * many.end.time, rel=1e-10)
    assert many.end["energy"] / scale**2 == pytest.approx(10 * HEIGHTS, rel=1e-9)
    for row, z in enumerate(HEIGHTS):
        on_the_way = np.abs(many.times) < abs(many.end.time[row])
        on_the_way |= many.stopped_by[row] == ""
        fall = z - 5 * many.times[on_the_way] ** 2
        assert many["z"][row, on_the_way] / scale == pytest.approx(fall, rel=1e-9)
        assert np.isnan(many["z"][row, ~on_the_way]).all()
    assert "3 of them stopped" in str(many)


def test_one_condition_that_holds_nowhere():
    """Without a stop on the way everything is as without a condition."""
    plain = gt.ODE.of({"z": "v", "v": "-10"}, [20, 0])
    free = gt.solve_many(plain, {"z": HEIGHTS}, [0.5, 0.9])
    many = gt.solve_many(stone(), {"z": HEIGHTS}, [0.5, 0.9])
    assert many["z"] == pytest.approx(free["z"], rel=1e-10)
    assert free.stopped_by.tolist() == [""] * 4
    assert np.isnan(free.times_at_stop).all()
    assert free.end["z"] == pytest.approx(free["z"][:, -1], rel=0, abs=0)


def swing():
    """A driven pendulum with changes at times, of which one may carry it beyond its stop."""
    rates = {"x": "v", "v": "-sin(x) + a*cos(t)"}
    changes = [gt.At(1.0, {"v": 1.8}), gt.At(3.0, {"x": 2.2, "a": 0.0})]
    stop = gt.When("2 - x + 4*a")
    return gt.ODE.of(rates, [0.5, 0.2], parameters={"a": 0.1}, events=[*changes, stop])


@every_engine
@pytest.mark.parametrize("times", [5.0, [0.0, 1.0, 2.0, 3.0, 5.0]])
def test_as_one_by_one_across_changes(engine, times):
    """Members are stopped in flight and by a change, as `solve` stops each."""
    starts = np.linspace(-3.0, 1.9, 9)
    many = gt.solve_many(swing(), {"x": starts}, times, 1e-9, engine)
    reasons = set()
    for row, x in enumerate(starts):
        one = gt.solve(swing().with_start({"x": float(x)}), times, 1e-9, engine)
        assert many.stopped_by[row] == one.stopped_by
        assert many.end.time[row] == pytest.approx(one.times[-1], abs=1e-8)
        assert many.end.states[row] == pytest.approx(one.states[-1], abs=1e-8)
        reasons.add((one.stopped_by, one.times[-1] == 3.0))
    assert len(reasons) >= 2


@every_engine
def test_an_end_that_depends_on_the_error(engine):
    """A ball that rolls up to the top of a hill is named; the others keep their ends."""
    hill = gt.ODE.of({"x": "v", "v": "x"}, [1, -1], events=[gt.When("x + 0.5")])
    speeds = {"v": [-0.9, -1.0, -1.1]}
    with pytest.raises(AccuracyError, match=r"That is so for member 1\.") as caught:
        gt.solve_many(hill, speeds, 60.0, 1e-6, engine)
    others = caught.value.ensemble
    assert [bool(text) for text in others.stopped_by] == [False, False, True]
    # cosh(t) - 1.1 sinh(t) = -1/2 for exp(t) = 5 + sqrt(46).
    assert others.times_at_stop[2] == pytest.approx(np.log(5 + np.sqrt(46)), rel=1e-6)
    assert others.finished.tolist() == [True, False, True]


@every_engine
def test_two_falls_in_one_step(engine):
    """The first of two falls ends a motion, also between the ends of a step."""
    wave = gt.ODE.of({"x": "w"}, [0], parameters={"w": 1}, events=[gt.When("cos(x) - x/9")])
    many = gt.solve_many(wave, {"w": [0.5, 1.0, 4.0]}, 40.0, 1e-9, engine)
    roots = many.end["x"]
    # The first root of cos(x) = x/9, by bisection to the digits of doubles.
    low, high = 1.0, 2.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if np.cos(middle) > middle / 9 else (low, middle)
    assert roots == pytest.approx(low, rel=1e-9)
    assert many.end.time == pytest.approx(low / np.array([0.5, 1.0, 4.0]), rel=1e-9)


def test_any_number_of_workers_gives_the_same_bits(monkeypatch: pytest.MonkeyPatch):
    """Stops, times and states; with parts so small that few members make several."""
    monkeypatch.setattr("geomtorsion.ode.batch.STACKED", 400)
    starts = {"z": np.linspace(1.0, 80.0, 800)}
    plain = gt.solve_many(stone(), starts, [1.0, 2.0, 3.0])
    for workers in (1, 3):
        with ThreadPoolExecutor(workers) as pool:
            sent = gt.solve_many(stone(), starts, [1.0, 2.0, 3.0], executor=pool)
        for name in ("times_at_stop", "stopped_by", "errors", "states"):
            one, two = getattr(plain, name), getattr(sent, name)
            assert one.tobytes() == two.tobytes(), name
        assert plain.end.states.tobytes() == sent.end.states.tobytes()


def test_a_start_beyond_the_stop_is_refused():
    """The error names the member."""
    with pytest.raises(StartError, match=r"stop above zero at the start, got z = -1 for member 1"):
        gt.solve_many(stone(), {"z": [1.0, -1.0]}, 1.0)


def test_the_table_of_the_ends(tmp_path):
    """One row for each member, every digit kept."""
    many = gt.solve_many(stone(), {"z": HEIGHTS}, 3.5)
    many.to_csv(tmp_path / "ends.csv")
    with (tmp_path / "ends.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["stopped_by"] for row in rows] == ["z", "z", "z", ""]
    assert [float(row["t"]) for row in rows] == many.end.time.tolist()
    assert [float(row["v"]) for row in rows] == many.end["v"].tolist()
    assert list(rows[0]) == ["member", "finished", "error", "stopped_by", "t", "z", "v", "energy"]


def test_an_end_given_to_the_solver_is_answered_with_its_place():
    """Ends belong to the problem."""
    fall = gt.ODE.of({"z": "v", "v": "-10"}, {"z": 1, "v": 0})
    unknown: Any = {"stop": "z"}
    for solver in (gt.solve, gt.solve_many):
        with pytest.raises(ArgumentError, match=r"events=\[gt\.When"):
            solver(fall, t=3.0, **unknown)
