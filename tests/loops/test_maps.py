"""Maps: many loops in one call agree with single loops, and finished work is kept."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, cast

import numpy as np
import pytest

from geomtorsion.errors import LoopError, MissingValueError
from geomtorsion.geometry import Frame, cartan
from geomtorsion.loops import Loop, burgers_map, burgers_vector, burgers_vectors, maps
from geomtorsion.spaces import load

SAME = 1e-10  # the requested accuracy
GRID = np.linspace(-1, 1, 12)


@pytest.fixture(scope="module")
def so3() -> Frame:
    return load("so3").frame


def random_circles(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Centres away from gimbal lock and radii from 1e-12 to 0.3."""
    rng = np.random.default_rng(5)
    centres = rng.uniform([0, 0.6, 0], [6, 2.4, 6], (count, 3))
    return centres, 10 ** rng.uniform(-12, -0.5, count)


@pytest.mark.parametrize("plane", [(0, 1), (2, 0), ([1, 1, 0], [0, 1, 2])])
def test_many_circles_agree_with_single_circles(so3: Frame, plane: tuple) -> None:
    """The same vectors as single calls, with errors that hold."""
    centres, radii = random_circles(60)
    found = burgers_vectors(so3, centres, radii, plane)
    assert found.complete
    for k in range(len(radii)):
        b = burgers_vector(so3, Loop.circle(centres[k], radii[k], plane), 1e-13)
        apart = np.abs(found.vectors[:, k] - b.vector).max()
        assert apart <= SAME * np.abs(b.vector).max()
        assert apart <= 10 * (found.errors[k] + b.error)


def test_small_circles_have_twice_torsion_times_area(so3: Frame) -> None:
    """Small circles have the vectors expected from the torsion of the Cartan connection."""
    centres, _ = random_circles(20)
    found = burgers_vectors(so3, centres, 1e-8)
    assert found.vectors / 1e-16 == pytest.approx(found.expected / 1e-16, rel=1e-12)
    torsion = cartan(so3).torsion.T
    names = ("phi1", "phi2", "phi3")
    for k in range(5):
        point = dict(zip(names, centres[k], strict=True))
        b = so3.coframe.at(point) @ torsion.at(point)[0, 1]
        assert found.density[:, k] == pytest.approx(b, rel=1e-12, abs=1e-12)


def test_small_circles_take_few_points_and_lose_nothing(so3: Frame) -> None:
    """Circles of radius 0.01 need only the first two levels, and lose no digits."""
    found = burgers_vectors(so3, np.tile([0.3, 1, 0.2], (4, 1)), 0.01)
    assert found.evaluations < 4 * 100
    assert (found.errors < 1e-14 * np.abs(found.vectors).max(axis=0)).all()


def test_a_map_finds_the_dislocation() -> None:
    """One cell encloses the line, and the sum over all cells is b of the outline."""
    for name, values in (
        ("screw_dislocation", {"b": 3}),
        ("edge_dislocation_elastic", {"b": 3, "nu": 0.3}),
    ):
        found = burgers_map(load(name).frame, (GRID, GRID), parameters=values)
        assert np.argwhere(found.enclosed).tolist() == [[5, 5]]
        outline = Loop.polygon([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
        expected = burgers_vector(load(name).frame, outline, parameters=values).vector
        assert found.total == pytest.approx(expected, abs=1e-9)
        assert found.reached.all()
        assert "1 enclose a defect" in repr(found)


def test_a_map_of_a_smooth_core() -> None:
    """No cell encloses a defect, and the sum over all cells is the vector of the outline."""
    values = {"b": 3, "c": 0.05}
    frame = load("screw_core").frame
    found = burgers_map(frame, (GRID, GRID), parameters=values)
    assert not found.enclosed.any()
    outline = Loop.polygon([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    expected = burgers_vector(frame, outline, parameters=values).vector
    assert found.total == pytest.approx(expected, abs=1e-9)


def test_a_map_elsewhere_and_in_a_spanned_plane(so3: Frame) -> None:
    """Cells of unequal size, at a given point and in any plane."""
    plane, at = ([1, 0, 1], [0, 2, 0]), [0.3, 1.0, 0.2]
    edges = (np.array([0, 0.1, 0.3]), np.array([-0.2, 0.1, 0.2, 0.25]))
    found = burgers_map(so3, edges, plane, at)
    assert found.vectors.shape == (3, 2, 3)
    u, v = np.array(plane)
    for i, j in ((0, 0), (1, 2)):
        corner = np.array(at) + edges[0][i] * u + edges[1][j] * v
        a, c = np.diff(edges[0])[i], np.diff(edges[1])[j]
        b = burgers_vector(so3, Loop.plaquette(corner, (a, c), plane))
        assert found.vectors[:, i, j] == pytest.approx(b.vector, rel=1e-9, abs=1e-13)
        assert found.areas[i, j] == pytest.approx(a * c)


def test_singular_loops_are_marked_and_the_others_done() -> None:
    """A circle through the axis has no vector; the other circles have one."""
    frame = load("screw_dislocation").frame
    found = burgers_vectors(
        frame, [[1, 0, 0], [1, 0, 0], [5, 0, 0]], [1.0, 2.0, 1.0], parameters={"b": 1}
    )
    assert np.isnan(found.vectors[:, 0]).all()
    assert found.errors[0] == np.inf
    assert found.vectors[2, 1:] == pytest.approx([1, 0], abs=1e-10)
    assert found.enclosed.tolist() == [False, True, False]


def test_an_interruption_keeps_finished_work(so3: Frame, monkeypatch: pytest.MonkeyPatch) -> None:
    """After Ctrl-C the finished part is returned, and the rest is NaN."""

    @contextmanager
    def interrupted(what: str, total: int, *, patience: float) -> Iterator[Callable[[int], object]]:
        def show(done: int) -> None:
            if done == 20:
                raise KeyboardInterrupt

        yield show

    monkeypatch.setattr(maps, "bar", interrupted)
    monkeypatch.setattr(maps, "TOGETHER", 10)
    centres, radii = random_circles(45)
    found = burgers_vectors(so3, centres, radii)
    assert found.done == 20
    assert not found.complete
    assert np.isfinite(found.vectors[:, :20]).all()
    assert np.isnan(found.vectors[:, 20:]).all()
    assert np.isfinite(found.total).all()


def test_bad_maps(so3: Frame) -> None:
    """Shapes, numbers and parameters are checked before the computation."""
    for make, message in (
        (lambda: burgers_vectors(so3, [[0, 1, 0]], 0), "circle 0 has radius 0"),
        (lambda: burgers_vectors(so3, [[0, 1]], 1), "centres have 2 coordinates"),
        (lambda: burgers_vectors(so3, cast(Any, [0, 1, 0]), 1), "expected 2 axes"),
        (lambda: burgers_vectors(so3, [[0, np.nan, 0]], 1), r"centres\[0, 1\] = nan is not finite"),
        (lambda: burgers_vectors(so3, "abc", 1), "an array of real numbers"),
        (
            lambda: burgers_vectors(so3, [[0, 1, 0]], cast(Any, [[1]])),
            "one number, or one for each",
        ),
        (lambda: burgers_vectors(so3, [[0, 1, 0]], 1, accuracy=0), "accuracy"),
        (
            lambda: burgers_map(so3, (GRID, GRID[::-1])),
            r"edges\[1\]: expected at least two increasing",
        ),
        (lambda: burgers_map(so3, (GRID, [1])), r"edges\[1\]"),
        (lambda: burgers_map(so3, cast(Any, GRID[:3])), "edges: expected two arrays"),
    ):
        with pytest.raises(LoopError, match=message):
            make()
    with pytest.raises(MissingValueError, match="expected a value for b, got none"):
        burgers_map(load("screw_dislocation").frame, (GRID, GRID))
