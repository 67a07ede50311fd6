"""Grid: periodic axes, units, and maps of three columns."""

import numpy as np
import pytest

from geomtorsion.errors import GridError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame
from tests.rounding import ROUNDED

N = 24
AXIS = np.arange(N) * 2 * np.pi / N
X, Y = np.meshgrid(AXIS, AXIS, indexing="ij")
WAVES = np.array([[np.cos(X + Y), np.sin(X) * np.cos(Y)], [np.sin(2 * Y), np.cos(X - Y)]])


@pytest.mark.parametrize("order", [2, 4, 6, 8])
def test_a_periodic_axis_is_an_endless_one(order):
    """A periodic grid gives the same as the middle of three copies side by side."""
    long = np.concatenate([AXIS - 2 * np.pi, AXIS, AXIS + 2 * np.pi])
    tiled = SampledFrame([long, long], np.tile(WAVES, (1, 1, 3, 3)), order)
    grid = SampledFrame([AXIS, AXIS], WAVES, order, periodic=True)
    middle = (slice(None), slice(N, 2 * N), slice(N, 2 * N))
    for size in (1, 5):
        found = grid.burgers_map(size)
        assert found.vectors.shape == (2, N, N)
        assert np.abs(found.vectors - tiled.burgers_map(size).vectors[middle]).max() < ROUNDED
    assert np.abs(grid.nye[:, 0] - tiled.nye[:, 0][middle]).max() < 1e-12
    assert np.abs(grid.plaquettes().vectors.sum(axis=(1, 2))).max() < 1e-12
    loop = Loop.circle([0.1, 6.2], 1)
    a, b = grid.burgers(loop), tiled.burgers(loop)
    assert a.vector == pytest.approx(b.vector, abs=1e-13)
    assert a.error == pytest.approx(b.error, rel=1e-6)


def test_one_axis_may_be_periodic():
    """A name or truth values select the periodic axis; the other axis still ends."""
    by_name = SampledFrame([AXIS, AXIS], WAVES, periodic="y")
    assert by_name.periodic == (False, True)
    assert by_name.plaquettes().vectors.shape == (2, N - 1, N)
    assert SampledFrame([AXIS, AXIS], WAVES, periodic=[True, False]).periodic == (True, False)
    assert by_name.burgers(Loop.circle([3, 0], 1)).error < 0.1
    with pytest.raises(GridError, match="axis x runs from 0"):
        by_name.burgers(Loop.circle([0, 3], 1))
    assert "periodic in y" in repr(by_name)
    cochain = by_name.cochain
    assert cochain.coboundary().values.shape[0] == (N - 1) * N


def test_loops_around_a_period():
    """Around a torus the mean of the coframe gives b; grid and loop need the same period."""
    values = np.array([[1 + 0.1 * np.cos(X), 0.2 * np.sin(Y)]])
    loop = Loop.parametric(["s", "1"], interval=(0, "2*pi"), periods={0: "2*pi"})
    grid = SampledFrame([AXIS, AXIS], values, periodic=True)
    assert grid.burgers(loop).vector == pytest.approx([2 * np.pi], abs=1e-12)
    open_ = SampledFrame([AXIS * 1.2, AXIS], values)
    with pytest.raises(GridError, match=r"ends 6.28319 from its start along x, .* not periodic"):
        open_.burgers(loop)
    other = SampledFrame([AXIS * 1.2, AXIS], values, periodic=True)
    with pytest.raises(GridError, match="has the period 7.53982"):
        other.burgers(loop)


@pytest.mark.parametrize("periodic", ["z", [True], ["x", 1], 3, ("x", "z")])
def test_invalid_periods_are_refused(periodic):
    """Only truth values or names of axes are accepted."""
    with pytest.raises(GridError, match="periodic"):
        SampledFrame([AXIS, AXIS], WAVES, periodic=periodic)


def test_units_are_kept_and_shown():
    """Results, grids and maps show the units of lengths and of b."""
    grid = SampledFrame([AXIS, AXIS], WAVES, unit="um", vector_unit="a/um um")
    b = grid.burgers(Loop.circle([3, 3], 1))
    assert b.unit == "a/um um"
    assert "a/um um" in repr(b)
    assert "in um, b in a/um um" in repr(grid)
    assert "lengths in um" in repr(grid.burgers_map(2))
    assert SampledFrame([AXIS, AXIS], WAVES, unit="nm").burgers(Loop.circle([3, 3], 1)).unit == "nm"
    with pytest.raises(GridError, match="unit: expected text"):
        SampledFrame([AXIS, AXIS], WAVES, unit=3)  # type: ignore[arg-type]


def test_everything_comes_back_from_a_file(tmp_path):
    """Holes, noise, periods and units read back, and the file has the given name."""
    mask = np.hypot(X - 3, Y - 3) < 0.5
    sigma = np.abs(WAVES) + 0.1
    grid = SampledFrame(
        [AXIS, AXIS], WAVES, mask=mask, sigma=sigma, periodic=("x",), unit="um", vector_unit="b"
    )
    grid.save(tmp_path / "grid.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["grid.npz"]
    again = SampledFrame.read(tmp_path / "grid.npz")
    assert np.array_equal(again.coframe, grid.coframe, equal_nan=True)
    assert (again.sigma == grid.sigma).all()
    assert (again.mask == mask).all()
    assert (again.periodic, again.unit, again.vector_unit) == ((True, False), "um", "b")


def test_plane_maps_may_have_three_columns():
    """In a plane map with three columns, the third column enters no circuit."""
    three = np.concatenate([WAVES, np.full((2, 1, N, N), np.nan)], axis=1)
    three = np.concatenate([three, three[:1]])
    grid = SampledFrame.from_distortion([AXIS, AXIS], three)
    assert grid.rows == 3
    assert not grid.mask.any()
    flat = SampledFrame.from_distortion([AXIS, AXIS], WAVES)
    loop = Loop.circle([3, 3], 1)
    assert grid.burgers(loop).vector[:2] == pytest.approx(flat.burgers(loop).vector, abs=ROUNDED)
    assert grid.nye.shape == (3, 1, N, N)


def test_descending_axes_give_the_same_circuits():
    """A reversed axis gives the same Burgers vectors at the same positions."""
    grid = SampledFrame([AXIS, AXIS], WAVES)
    turned = SampledFrame([AXIS[::-1], AXIS], WAVES[:, :, ::-1])
    assert turned.plaquettes().area > 0
    assert np.abs(turned.plaquettes().vectors[:, ::-1] - grid.plaquettes().vectors).max() < ROUNDED
    assert np.abs(turned.nye[:, :, ::-1] - grid.nye).max() < 1e-12
    hole = np.hypot(X - 3, Y - 3) < 0.5
    one = SampledFrame([AXIS, AXIS], WAVES, mask=hole)
    two = SampledFrame([AXIS[::-1], AXIS], WAVES[:, :, ::-1], mask=hole[::-1])
    a, b = (grid.burgers(grid.loop_around(margin=2)) for grid in (one, two))
    assert np.abs(a.vector - b.vector).max() < a.error < 0.02


@pytest.mark.parametrize(("off", "taken"), [(5e-5, True), (5e-4, False)])
def test_how_equal_steps_have_to_be(off, taken):
    """32-bit floats keep a step to 1e-4 of itself; larger deviations are refused."""
    axis = np.arange(12.0)
    axis[5:] += off
    values = np.broadcast_to(np.eye(2)[:, :, None, None], (2, 2, 12, 12))
    if taken:
        assert SampledFrame([axis, axis], values).plaquettes().vectors.shape == (2, 11, 11)
    else:
        with pytest.raises(
            GridError, match="axis x: expected equal steps other than 0, got .* at step 4"
        ):
            SampledFrame([axis, axis], values)


@pytest.mark.parametrize(("beyond", "taken"), [(1e-9, True), (1e-6, False)])
def test_rounding_of_positions_is_accepted(beyond, taken):
    """Far from the origin half of a step's digits may be lost; a larger excess leaves the grid."""
    axis = 1e6 + np.arange(12.0)
    values = np.broadcast_to(np.eye(2)[:, :, None, None], (2, 2, 12, 12))
    grid = SampledFrame([axis, axis], values)
    loop = Loop.plaquette([1e6 - beyond] * 2, (11.0, 11.0))
    if taken:
        assert np.abs(grid.burgers(loop).vector).max() < 1e-9
    else:
        with pytest.raises(GridError, match="the loop leaves the grid"):
            grid.burgers(loop)
