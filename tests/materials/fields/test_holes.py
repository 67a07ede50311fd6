"""Holes: circuits surround them, their values are ignored, and messages name their nodes."""

from dataclasses import replace

import numpy as np
import pytest

from geomtorsion.errors import GridError
from geomtorsion.loops import Loop, burgers_vector, parallel_screws
from geomtorsion.materials.fields import SampledFrame

AXES = [np.linspace(-1, 1, 41), np.linspace(-1.2, 1.2, 45)]
X, Y = np.meshgrid(*AXES, indexing="ij")


def screw_plane() -> np.ndarray:
    """The third row of the coframe of a screw with b = 1, in the plane: dz + d phi / (2 pi)."""
    with np.errstate(all="ignore"):
        return np.array([[-Y, X]]) / (2 * np.pi * (X**2 + Y**2))


def smooth() -> np.ndarray:
    """Each component depends on x and y; the torsion of row 0 is x cos y - y^2 / 3."""
    return np.array([[np.cos(X) + Y**3 / 9, X**2 / 2 * np.cos(Y)], [X * Y, np.sin(X * Y)]])


def test_a_core_that_is_not_seen():
    """Each circuit around the masked core of a screw has its b, within the error."""
    grid = SampledFrame(AXES, screw_plane(), mask=np.hypot(X, Y) < 0.3)
    assert len(grid.holes) == 1
    for margin in (1, 3, 6):
        loop = grid.loop_around(margin=margin)
        found = grid.burgers(loop)
        assert abs(found.vector[0] - 1) <= found.error < 0.03
    circle = grid.burgers(Loop.circle([0, 0], 0.6))
    assert abs(circle.vector[0] - 1) <= circle.error < 1e-3
    beside = grid.burgers(Loop.circle([0.65, 0.6], 0.3))
    assert abs(beside.vector[0]) <= beside.error < 1e-3


def test_a_nan_is_a_hole_and_values_in_holes_do_not_matter():
    """NaN and mask mean the same, whatever the values in the hole."""
    hole = np.hypot(X - 0.1, Y) < 0.2
    values = smooth()
    filled, empty = values.copy(), values.copy()
    filled[:, :, hole] = 1e30
    empty[0, 1, hole] = np.nan
    one, two = SampledFrame(AXES, filled, mask=hole), SampledFrame(AXES, empty)
    assert (one.mask == two.mask).all()
    loop = one.loop_around(0, 2)
    assert (one.burgers(loop).vector == two.burgers(loop).vector).all()
    a, b = one.burgers_map(5), two.burgers_map(5)
    assert np.array_equal(a.vectors, b.vectors, equal_nan=True)
    assert np.array_equal(one.nye, two.nye, equal_nan=True)


def test_a_loop_that_is_small_beside_a_hole_is_refused_and_names_it():
    """A loop into a hole that is not small beside it is refused; a loop along the rim is not."""
    hole = np.zeros(X.shape, bool)
    hole[20:23, 30:32] = True
    grid = SampledFrame(AXES, smooth(), mask=hole)
    step = grid.steps[0]
    for shift in (0.0, 0.4):
        corner = [AXES[0][15] + shift * step, AXES[1][28] + shift * step]
        with pytest.raises(GridError, match=r"touches a hole at .* node \(2[012], 3[01]\)"):
            grid.burgers(Loop.plaquette(corner, (5 * step, 4 * step)))
    rim = Loop.plaquette([AXES[0][19], AXES[1][29]], (4 * step, 3 * grid.steps[1]))
    assert grid.burgers(rim).error < 1e-4
    with pytest.raises(GridError, match="touches a hole"):
        # Half a step inwards the loop needs nodes of the hole.
        grid.burgers(Loop.plaquette([AXES[0][19] + step / 2, AXES[1][29]], (3 * step, 3 * step)))


@pytest.mark.parametrize("order", [2, 4, 6, 8])
def test_near_holes_values_are_right_within_their_errors(order):
    """With random holes, cells that touch a hole are NaN and all others are right."""
    rng = np.random.default_rng(1)
    hole = rng.random(X.shape) < 0.08
    grid = SampledFrame(AXES, smooth(), order, mask=hole)
    whole = SampledFrame(AXES, smooth(), 8)
    cells, exact = grid.plaquettes(), whole.plaquettes().vectors
    touched = hole[1:, 1:] | hole[:-1, 1:] | hole[1:, :-1] | hole[:-1, :-1]
    assert (cells.known == ~touched).all()
    assert (np.isnan(cells.vectors).any(axis=0) == touched).all()
    assert touched.sum() > 300
    missed = np.abs(cells.vectors - exact)[:, cells.known].max(axis=0)
    # Errors are estimates, which are too small where two of them cancel by chance.
    assert (missed <= 2 * cells.errors[cells.known] + 1e-8).mean() > 0.99
    assert missed.max() < 3 * cells.errors[cells.known].max()
    alpha, known = grid.nye, np.isfinite(grid.nye[0, 0])
    assert not known[hole].any()
    assert known.sum() > 0.9 * (~hole).sum()
    missed = np.abs(alpha - whole.nye)[:, 0, known]
    assert missed.max() < 3 * np.nanmax(grid.torsion()[1]) + 1e-6


def test_stencils_near_a_hole_keep_their_order():
    """Beside a hole stencils are one-sided: halving the step divides the error by more than 8."""
    errors = []
    for count in (21, 41):
        axis = np.linspace(-1, 1, count)
        x, y = np.meshgrid(axis, axis, indexing="ij")
        values = np.array([[np.cos(2 * y) * np.exp(x), np.sin(2 * x) * np.cos(3 * y)]])
        grid = SampledFrame([axis, axis], values, mask=np.maximum(abs(x), abs(y)) < 0.31)
        found = grid.burgers(Loop.plaquette([-0.4, -0.4], (0.8, 0.8)))
        # Sides along y: 4/3 sin 0.8 sin 1.2; sides along x cancel.
        exact = 4 / 3 * np.sin(0.8) * np.sin(1.2)
        errors.append(abs(found.vector[0] - exact))
        assert errors[-1] <= found.error
    assert errors[0] < 1e-3
    assert np.log2(errors[0] / errors[1]) > 3


def test_holes_are_numbered_and_counted():
    """Neighbours by corners are one hole, also over a periodic seam."""
    mask = np.zeros((12, 10), bool)
    mask[2, 3] = mask[3, 4] = mask[8, 8] = True
    mask[0, 5] = mask[11, 6] = True
    axes = [np.arange(12.0), np.arange(10.0)]
    values = np.ones((1, 2, 12, 10))
    flat = SampledFrame(axes, values, mask=mask)
    assert [len(hole.nodes) for hole in flat.holes] == [1, 2, 1, 1]
    ring = SampledFrame(axes, values, mask=mask, periodic=("x",))
    assert [len(hole.nodes) for hole in ring.holes] == [2, 2, 1]
    assert (ring.holes[0].low, ring.holes[0].high) == ((11, 5), (12, 6))
    loop = ring.loop_around(0)
    assert loop.points(40)[0].min().round(9) == 10
    assert abs(ring.burgers(loop).vector[0]) < 1e-12
    assert repr(flat).endswith("4 holes of 5 nodes)")


def test_circuits_in_three_dimensions_surround_tubes():
    """Each plane across a masked tube along z has the same b; a plane along it is refused."""
    axes = [np.linspace(-1, 1, 21), np.linspace(-1, 1, 21), np.linspace(0, 1, 7)]
    x, y, _ = np.meshgrid(*axes, indexing="ij")
    with np.errstate(all="ignore"):
        row = np.array([[-y, x, 0 * x]]) / (2 * np.pi * (x**2 + y**2))
    grid = SampledFrame(axes, row, mask=np.hypot(x, y) < 0.25)
    for k in (0, 3, 6):
        found = grid.burgers(grid.loop_around(at=[0, 0, k], margin=2))
        assert abs(found.vector[0] - 1) <= found.error
    with pytest.raises(GridError, match="reaches the edge of the grid: along z"):
        grid.loop_around(plane=(1, 2))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda g: g.loop_around(7), "hole: expected a whole number from 0 to 1"),
        (lambda g: g.loop_around(), "expected the number of one of 2 holes, got none"),
        (lambda g: g.loop_around(0, 30), "reaches the edge"),
        (lambda g: g.loop_around(0, 8), r"touches another hole at node \(30, 21\)"),
        (lambda g: g.loop_around(0, 0), "margin: expected a whole number from 1"),
        (lambda g: g.loop_around(0, plane=(0, 0)), "two different axes"),
        (lambda g: g.cochain, "got a grid with holes"),
    ],
)
def test_circuits_that_there_are_not(call, message):
    """Each wrong call has its own message."""
    mask = np.zeros(X.shape, bool)
    mask[22, 22] = mask[30, 21] = True
    with pytest.raises(GridError, match=message):
        call(SampledFrame(AXES, smooth(), mask=mask))
    with pytest.raises(GridError, match="no holes"):
        SampledFrame(AXES, smooth()).loop_around()


@pytest.mark.parametrize(
    "mask", [np.zeros((3, 3), bool), np.zeros(X.shape), "no", [[True], [1, 2]]]
)
def test_invalid_masks_are_refused(mask):
    """Only truth values with the shape of the grid are accepted."""
    with pytest.raises(GridError, match="mask: expected truth values of shape"):
        SampledFrame(AXES, smooth(), mask=mask)


def test_a_masked_frame_of_three_rows_agrees_with_the_exact_one():
    """b of a sampled analytic frame with a masked core agrees within the error."""
    frame = parallel_screws([(0, 0)], [2])
    axes = [np.linspace(-1, 1, 30), np.linspace(-1, 1, 30), np.linspace(0, 1, 5)]
    x, y, _ = np.meshgrid(*axes, indexing="ij")
    grid = SampledFrame.from_frame(frame, axes, mask=np.hypot(x, y) < 0.2)
    loop = Loop.ellipse([0, 0, 0.5], (0.7, 0.5))
    found = grid.burgers(loop)
    assert np.abs(found.vector - burgers_vector(frame, loop).vector).max() <= found.error < 0.01


def test_many_holes_on_a_circuit_count_once_each():
    """Torsion 1: the error of a detour is the area of the rings, 4 cells around each lone node."""
    axes = [np.arange(41.0)] * 2
    x, y = np.meshgrid(*axes, indexing="ij")
    mask = np.zeros((41, 41), dtype=bool)
    nodes = [(30, 20), (20, 30), (10, 20), (20, 10), (20, 20)]
    mask[tuple(np.array(nodes).T)] = True
    frame = SampledFrame(axes, np.array([[-y, x]]) / 2, mask=mask)
    # A square through four of the five missing nodes.
    square = Loop.polygon([[10, 10], [30, 10], [30, 30], [10, 30]])
    found = frame.burgers(square)
    assert found.detour is not None
    assert len(found.detour.nodes) == 4
    assert found.detour.error == pytest.approx(4 * 4, rel=1e-12)
    # With noise, the part that noise explains is not counted twice.
    noisy = replace(frame, sigma=1e3).burgers(square)
    assert noisy.detour is not None
    assert noisy.detour.error == 0
