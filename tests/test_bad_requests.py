"""Bad requests: names, indices, contractions, points and shapes that do not fit are refused."""

# Calls that a checker of types refuses as well.
# pyright: reportArgumentType=false

from typing import Any

import numpy as np
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    GeomtorsionError,
    LoopError,
    NetworkError,
    ShapeError,
    SingularPointError,
    TensorIndexError,
    TimeError,
    UnknownNameError,
)

x, y = sp.symbols("x y", real=True)
r = sp.Symbol("r", positive=True)
UNIT = [[1, 0], [0, 1]]


def test_unknown_space_lists_near_names():
    """An unknown name of a space is refused; the message lists similar names."""
    with pytest.raises(UnknownNameError, match="kerr"):
        gt.spaces.load("ker")


def test_unknown_quantity_lists_near_names():
    """An unknown name of a quantity is refused; the message lists similar names."""
    with pytest.raises(UnknownNameError, match="ricci"):
        gt.Frame([x, y], UNIT).quantity("ricc")


def test_index_out_of_range_or_too_few():
    """Indices out of range, too many of them, and unknown names are refused."""
    metric = gt.Frame([x, y], UNIT).metric
    bad: list[Any] = [(0, 2), (0, 0, 0), (0, -3), ("q", 0), (0.0, 1)]
    for index in bad:
        with pytest.raises(TensorIndexError, match="2"):
            metric[index]


WHOLE: list[Any] = [np.int64(1), sp.Integer(1), np.array(1)]


@pytest.mark.parametrize("one", WHOLE, ids=["numpy", "sympy", "array"])
def test_whole_numbers_of_every_kind_are_indices(one: Any):
    """Each kind of whole number is accepted as an index, a coordinate, a count and an edge."""
    frame = gt.Frame([x, y], [[1, 0], [0, x]])
    assert frame.coframe[one, one] == x
    if type(one).__hash__:  # an array cannot be a key
        assert [row.value for row in frame.coframe.table(where={one: one})] == [x]
    loop = gt.Loop.circle([1, 2], 0.5, plane=(0, one))
    assert loop.points(8) == pytest.approx(gt.Loop.circle([1, 2], 0.5, plane=(0, 1)).points(8))
    assert loop.times(one).name == "circle"
    square = gt.Cochain.of_edges([[0, 1], [1, 0]], [[1], [2]])
    if type(one).__hash__:
        assert square.over({one: 1}).vectors.tolist() == [[2]]


@pytest.mark.parametrize("none", [True, 1.0, "1"])
def test_anything_but_a_whole_number_is_refused_everywhere(none: Any):
    """Truth values, floats and text are refused as whole numbers."""
    frame = gt.Frame([x, y], [[1, 0], [0, x]])
    with pytest.raises(TensorIndexError, match="each a whole number"):
        frame.coframe[none, 1]
    with pytest.raises(TensorIndexError, match="expected an index of"):
        frame.coframe.table(where={none: 1})
    with pytest.raises(LoopError, match="coordinate numbers.* or vectors"):
        gt.Loop.circle([1, 2], 0.5, plane=(0, none))
    with pytest.raises(LoopError, match="whole number of turns"):
        gt.Loop.circle([1, 2], 0.5).times(none)


MASKED = np.ma.masked_greater(np.array([0.1, 0.2]), 0.15)
TIMES: list[Any] = ["abc", [0.1, "x"], 1j, [[1, 2], [3]], True, object(), MASKED]


@pytest.mark.parametrize("times", TIMES, ids=range(len(TIMES)))
def test_invalid_times_are_refused(times: Any):
    """Closed forms and results of scenes refuse wrong times, also masked ones, with a TimeError."""
    with pytest.raises(TimeError):
        gt.rigid.free_top((1, 2, 3), (0.1, 1, 0.2)).omega(times)
    body = gt.Body(mass=1.0, moments=(1, 1, 0.5))
    result = gt.Scene(body, start=gt.State(omega=(0.1, 0, 20)), watch=["omega"], t=1).run()
    with pytest.raises(TimeError):
        result.at(times)


def test_invalid_positions_are_refused():
    """Text is refused as a position of a network without a graph."""
    places: Any = [["a", 0], [1, 0]]
    network = gt.loops.Network(
        gt.Frame([x, y], UNIT), gt.loops.EdgeList(places, np.array([[0, 1]]))
    )
    with pytest.raises(NetworkError, match="positions: expected an array of real numbers"):
        _ = network.cycle_count


def test_contraction_that_does_not_fit():
    """A contraction joins an upper and a lower index of one kind; a letter occurs once or twice."""
    frame = gt.Frame([r, x], [[1, 0], [0, r]])
    s, g = gt.cartan(frame).torsion.S, frame.metric
    with pytest.raises(TensorIndexError, match="(?i)down|lower|upper"):
        gt.contract("abc,bd->acd", s, g)  # two lower indices
    with pytest.raises(TensorIndexError, match="(?i)frame|kind"):
        gt.contract("abc,cd->abd", s, g.in_frame())  # coordinate index with frame index
    with pytest.raises(TensorIndexError):
        gt.contract("ab,cd->abd", s, g)  # too few letters
    with pytest.raises(TensorIndexError):
        gt.contract("abc,cd->abe", s, g)  # an unknown letter
    with pytest.raises(TensorIndexError):
        gt.contract("abc,cc->ab", s, g)  # a letter three times
    with pytest.raises(TensorIndexError):
        gt.contract("abc,cd", s, g, g)  # too many tensors
    assert gt.contract("abc,cd->abd", s, g).slots == "ddd"


def test_tensors_of_two_frames_do_not_mix():
    """Tensors of two different frames cannot be added."""
    one, two = gt.Frame([x, y], UNIT), gt.Frame([x, y], [[1, 0], [0, 2]])
    with pytest.raises(TensorIndexError, match="frame"):
        _ = one.metric + two.metric


def test_singular_point():
    """At the edge of the chart an error is raised; no infinity is returned."""
    frame = gt.Frame([r, x], [[1, 0], [0, sp.sin(r)]])
    with pytest.raises(SingularPointError, match="(?i)finite|singular|vanish"):
        frame.inverse_metric.at({r: 0, x: 0})


def test_connection_coefficients_of_wrong_shape():
    """Connection coefficients without n x n x n entries are refused."""
    frame = gt.Frame([x, y], UNIT)
    with pytest.raises((ShapeError, TensorIndexError), match="2"):
        gt.from_coefficients(frame, [[0, 0], [0, 0]])


def test_spin_connection_of_wrong_shape():
    """A spin connection without one matrix per coordinate is refused."""
    frame = gt.Frame([x, y], UNIT)
    with pytest.raises((ShapeError, TensorIndexError), match="2"):
        gt.from_spin_connection(frame, [[0, 0], [0, 0]])


def test_blend_of_two_frames():
    """Connections of two different frames cannot be blended."""
    one, two = gt.Frame([x, y], UNIT), gt.Frame([x, y], [[1, 0], [0, 2]])
    with pytest.raises(GeomtorsionError, match="frame"):
        gt.blend(gt.cartan(one), gt.levi_civita(two), sp.Rational(1, 2))


def test_velocity_of_wrong_length():
    """The torsion force refuses a velocity without one component per coordinate."""
    frame = gt.Frame([x, y], UNIT)
    with pytest.raises(ShapeError, match="2"):
        gt.cartan(frame).torsion.force([1, 2, 3])
