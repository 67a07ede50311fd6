"""Many lines: sums over lines agree with the exact coframe, also for a thousand lines."""

import copy
import pickle

import numpy as np
import pytest
import sympy as sp

from geomtorsion.errors import ShapeError, SingularPointError
from geomtorsion.geometry import Frame, cartan
from geomtorsion.loops import (
    Loop,
    burgers_map,
    burgers_vector,
    develop,
    find_defects,
    parallel_dislocations,
    parallel_screws,
)
from geomtorsion.loops.defects import charge


def scattered(count):
    """Different positions in a square, and whole Burgers vectors other than zero."""
    rng = np.random.default_rng(count)
    places = {tuple(row) for row in rng.integers(0, 10_000, (2 * count, 2)).tolist()}
    chosen = sorted(places)[::2][:count]
    sizes = rng.choice([-2, -1, 1, 3], count).tolist()
    return [(sp.Rational(a, 10_000), sp.Rational(b, 10_000)) for a, b in chosen], sizes


@pytest.mark.parametrize("count", [14, 40, 1000])
def test_a_circle_around_many_screws(count):
    """The vector is the sum of winding numbers times b, counted without integrals."""
    places, sizes = scattered(count)
    frame = parallel_screws(places, sizes)
    found = burgers_vector(frame, Loop.circle([0.5, 0.5, 0], 3))
    inside = found.enclosed
    assert abs(found.vector[2] - sum(sizes)) <= found.error < 1e-9
    assert len(inside) == count
    small = burgers_vector(frame, Loop.circle([0.5, 0.5, 0], 0.25), 1e-6)
    within = [(x - 0.5) ** 2 + (y - 0.5) ** 2 < 1 / 16 for x, y in places]
    expected = sum(b for b, inner in zip(sizes, within, strict=True) if inner)
    assert abs(small.vector[2] - expected) <= small.error < 1e-3


def test_numbers_agree_with_the_exact_coframe():
    """The frame of exact entries, summed over one denominator, gives the same vector."""
    places = [(0, 0), (1, "1/3"), (sp.sqrt(2), -1)]
    vectors = [(1, 0, "1/2"), (0, -2, 0), (0, 0, sp.pi)]
    frame = parallel_dislocations(places, vectors)
    assert frame.anholonomy.is_zero
    plain = Frame(frame.coordinates, frame.coframe.to_sympy())
    loop = Loop.ellipse([0.3, 0.1, 0], (1.2, 0.7), ([1, 0, 1], [0, 1, 1]))
    one, two = burgers_vector(frame, loop), burgers_vector(plain, loop)
    assert np.abs(one.vector - two.vector).max() <= one.error + two.error
    assert develop(cartan(frame), loop).burgers == pytest.approx(one.vector, abs=1e-12)
    first = [str(x) for x in find_defects(frame)]
    assert sorted(first) == sorted(str(x) for x in find_defects(plain))
    lines = np.linspace(-2, 2, 10)
    every = burgers_map(frame, (lines, lines))
    assert np.abs(every.total - [1, -2, 0.5 + np.pi]).max() < 1e-9


def test_places_and_sizes_may_be_parameters():
    """Positions and vectors may be symbols with values given later; b = 0 adds no line."""
    a, b = sp.symbols("a b")
    frame = parallel_screws([(a, 0), (-a, 0), (5, 5)], [b, 1, 0])
    assert [symbol.name for symbol in frame.parameters] == ["a", "b"]
    values = {"a": 0.25, "b": 3.0}
    found = burgers_vector(frame, Loop.circle([0.25, 0, 0], 0.3), parameters=values)
    assert abs(found.vector[2] - 3) <= found.error
    (line, other) = find_defects(frame)
    near = Loop.circle([0.25, 0, 0], 0.1)
    assert charge(cartan(frame), line, near, values).burgers.tolist() == [0, 0, 3]
    assert charge(cartan(frame), other, near, values).burgers.tolist() == [0, 0, 1]


def test_a_line_on_the_loop_is_named():
    """A loop through one of a thousand lines is refused, and the error names the line."""
    places, sizes = scattered(1000)
    x, y = places[500]
    with pytest.raises(SingularPointError, match=r"passes through .*\*\*2 \+ \(y - .* vanishes"):
        burgers_vector(parallel_screws(places, sizes), Loop.circle([x + 1, y, 0], 1))
    with pytest.raises(SingularPointError, match="passes through"):
        burgers_vector(parallel_screws([(0, 0)], [1]), Loop.circle([1, 0, 0], 1))


def test_lines_are_straight():
    """A position that depends on a coordinate, or on a symbol of its name, is refused."""
    for x in (sp.Symbol("x", real=True), sp.Symbol("x")):
        with pytest.raises(ShapeError, match="a straight line needs constants"):
            parallel_screws([(x, 0)], [1])


def test_frames_of_lines_are_copied_and_pickled():
    """A copied or unpickled frame has the same lines, to the last bit."""
    frame = parallel_screws([(0, 0), (1, 0)], [1, 2])
    loop = Loop.circle([0, 0, 0], 3)
    for same in (copy.deepcopy(frame), pickle.loads(pickle.dumps(frame))):
        assert burgers_vector(same, loop).vector[2] == burgers_vector(frame, loop).vector[2]
        assert same.name == "parallel screws"
