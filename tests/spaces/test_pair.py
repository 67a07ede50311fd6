"""Pairs of motions: choices are listed, numbers agree with the library, stops are kept."""

import numpy as np
import pytest

from geomtorsion.curves import autoparallel, distance_apart, geodesic
from geomtorsion.errors import AccuracyError, ArgumentError, ShapeError, StartError, TimeError
from geomtorsion.geometry import cartan
from geomtorsion.ode import RungeKutta, solve
from geomtorsion.pictures.curve_files import metadata
from geomtorsion.pictures.curves import error_over_time
from geomtorsion.spaces import load, read_file
from geomtorsion.spaces.pair import Pair, solve_pair

ENGINE = RungeKutta()


@pytest.fixture(scope="module")
def sphere():
    """The usual pair on s2."""
    return solve_pair(load("s2"), engine=ENGINE, accuracy=1e-9, samples=41)


def test_chosen_values_are_listed():
    """Only values that were not given are listed as chosen."""
    space = load("s2")
    options = {"engine": ENGINE, "accuracy": 1e-6, "samples": 3, "t": 1}
    assert solve_pair(space, [1, 0], [0, 1], parameters={"R": 2}, **options).chosen == ()
    assert solve_pair(space, [1, 0], **options).chosen == ("velocity", "parameters")


def test_numbers_agree_with_the_library(sphere):
    """Both curves and their distance agree with separate solves."""
    frame, first = load("s2").frame, sphere.problem
    begin = {"frame_velocity": first.frame_velocity, "parameters": {"R": 1.0}}
    one = solve(autoparallel(cartan(frame), first.start, **begin), sphere.times, 1e-9, ENGINE)
    two = solve(geodesic(frame, first.start, **begin), sphere.times, 1e-9, ENGINE)
    table = sphere.columns()
    assert np.array_equal(table["autoparallel theta"], one.coordinates[:, 0])
    assert np.array_equal(table["geodesic phi'"], two.velocity[:, 1])
    assert np.array_equal(table["geodesic u0"], two.frame_velocity[:, 0])
    assert np.array_equal(table["distance"], distance_apart(one, two))


def test_a_loxodrome_and_a_great_circle(sphere):
    """The closed forms: theta is linear along the loxodrome, the great circle is in a plane."""
    table = sphere.columns()
    assert table["autoparallel theta"] == pytest.approx(1.9 - 0.2 * table["t"], abs=1e-8)
    places = sphere.embedding.places(sphere.coordinates["geodesic"], {"R": 1.0})
    # The smallest singular value of points in a plane through the centre vanishes.
    assert np.linalg.svd(places)[1][-1] < 1e-7


def test_errors_and_drifts_over_time_have_the_known_maxima(sphere):
    """The maxima over time are `Solution.error` and `Solution.drift`."""
    for solution in sphere.curves.values():
        errors = error_over_time(solution)
        assert errors is not None
        assert errors.shape == sphere.times.shape
        assert errors.max() == pytest.approx(solution.error, rel=1e-12)
        drifts = solution.invariant_changes
        assert {name: values.max() for name, values in drifts.items()} == pytest.approx(
            dict(solution.drift)
        )


def test_drift_over_several_charts():
    """The charts of a motion are joined: one value for each time."""
    space = load("s2")
    over_pole = solve_pair(space, [1.5, 1e-3], [-1.0, 0.0], parameters={"R": 1}, t=2, samples=21)
    solution = over_pole.shortest
    assert len(solution.charts) > 1
    for values in solution.invariant_changes.values():
        assert values.shape == (21,)


def test_on_so3_the_two_are_one():
    """Totally antisymmetric torsion has no force; with unequal moments the curves differ."""
    options = {"engine": ENGINE, "accuracy": 1e-8, "samples": 11, "t": 2}
    assert solve_pair(load("so3"), **options).coincide
    assert not solve_pair(load("so3"), moments=[1, 2, 3], **options).coincide


@pytest.mark.parametrize(("times_accuracy", "one"), [(1.8, True), (2.2, False)])
def test_one_within_twice_the_accuracy(times_accuracy, one):
    """Two curves coincide up to twice the accuracy, because each may be off by it."""
    pair = solve_pair(load("s2"), engine=ENGINE, accuracy=1e-8, samples=5)
    size = np.abs(pair.coordinates["geodesic"]).max()
    # A cached property is kept in the object: only the distance is set, the rest is as solved.
    pair.__dict__["distance"] = np.array([0.0, times_accuracy * 1e-8 * size])
    assert pair.coincide is one


def test_a_motion_that_stops_is_kept():
    """A loxodrome ends in the pole; the other curve continues, and the table has both."""
    pair = solve_pair(load("s2"), [0.5, 0.0], [-0.2, 1.0], t=6, engine=ENGINE, samples=25)
    assert "chart 's2' ends" in pair.stops["autoparallel"]
    table = pair.columns()
    assert len(table["autoparallel phi"]) == len(table["distance"]) < 25
    assert len(table["geodesic phi"]) == len(table["t"]) == 25


def test_the_connection_of_the_space_is_followed(tmp_path):
    """In a space with its own connection the pair follows that connection."""
    file = tmp_path / "bent.toml"
    file.write_text(
        'coordinates = ["x", "y"]\ncoframe = [[1, 0], [0, 1]]\nconnection = {"0,0,1" = "1"}\n'
    )
    pair = solve_pair(read_file(file), [0, 0], [1, 0], t=1, engine=ENGINE, samples=3)
    # y'' = -x'^2 with x' = 1.
    assert pair.straight.coordinates[-1] == pytest.approx([1.0, -0.5], abs=1e-9)
    assert pair.shortest.coordinates[-1] == pytest.approx([1.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(
    ("name", "options", "error", "words"),
    [
        ("frw", {}, StartError, "unknown function a"),
        ("kerr_kinnersley", {}, StartError, "complex"),
        ("s2", {"start": [1]}, ShapeError, "2 numbers"),
        ("s2", {"t": 0}, StartError, "expected a time other than 0"),
        ("s2", {"samples": 1}, StartError, "a whole number from 2 on"),
        ("s2", {"samples": "9"}, StartError, "whole number"),
        ("s2", {"t": "3"}, TimeError, "t: expected a number, got '3'"),
        ("s2", {"t": [1, 2]}, TimeError, "t: expected a number"),
        ("s2", {"parameters": [1]}, ArgumentError, "names with values"),
        ("s2", {"parameters": {"Q": 1}}, StartError, "expected a parameter of this frame, got 'Q'"),
        ("s2", {"accuracy": -1}, AccuracyError, "positive"),
    ],
)
def test_bad_input(name, options, error, words):
    """Each refusal names the given value and a remedy."""
    with pytest.raises(error, match=words):
        solve_pair(load(name), **options)


def test_a_frame_is_refused_as_space():
    """A pair follows the connection of a space, which a frame does not have."""
    with pytest.raises(ArgumentError, match="space: expected a Space"):
        solve_pair(load("s2").frame)  # pyright: ignore[reportArgumentType]


def test_two_solutions_make_a_pair():
    """A pair of given solutions needs no other input: no curve stopped, nothing was chosen."""
    space = load("so3")
    known = solve_pair(space, engine=RungeKutta())
    pair = Pair(space, known.straight, known.shortest)
    assert metadata(pair)["curves"]["geodesic"]["stopped"] == ""


def test_what_the_distance_is(sphere):
    """The distance is the true one on a sphere only; files and captions state this."""
    assert "true distance when small" in metadata(sphere)["columns"]
    hole = solve_pair(load("schwarzschild"), engine=ENGINE, accuracy=1e-6, samples=3, t=1)
    assert "no invariant" in metadata(hole)["columns"]


def test_arrays_as_start_and_velocity():
    """Arrays as start and velocity give the same pair as lists."""
    given = {"t": 1.0, "samples": 3, "engine": RungeKutta()}
    pair = solve_pair(load("s2"), np.array([1.0, 0.0]), np.array([0.0, 1.0]), **given)
    assert pair.chosen == ("parameters",)
    same = solve_pair(load("s2"), [1.0, 0.0], [0.0, 1.0], **given)
    assert np.array_equal(pair.distance, same.distance)
