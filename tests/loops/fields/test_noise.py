"""Noise: what is told of it against the scatter of many noisy fields, and against all weights."""

import numpy as np
import pytest

from geomtorsion.errors import GridError
from geomtorsion.loops import Loop, SampledFrame

AXES = [np.linspace(-1, 1, 31), np.linspace(0, 2, 29)]
X, Y = np.meshgrid(*AXES, indexing="ij")
SEEDS = 200


def smooth() -> np.ndarray:
    """A distortion of some percent and its torsion."""
    return np.array([[np.cos(X) + Y / 9, X / 20], [X * Y / 30, 1 + np.sin(X * Y) / 20]])


LOOPS = {
    "circle": Loop.circle([0, 1], 0.63),
    "square": Loop.plaquette([-0.4, 0.5], (0.8, 0.9)),
    "twice": Loop.circle([0.1, 1.1], 0.5).times(2),
    "bent": Loop.spline([[0.5, 1], [0, 1.6], [-0.7, 1.1], [0.1, 0.3]]),
}


@pytest.mark.parametrize("loop", LOOPS.values(), ids=LOOPS)
@pytest.mark.parametrize("sigma", [0.01, 0.1])
def test_the_error_told_is_the_scatter(loop, sigma):
    """Two hundred noisy fields: the mean error is the scatter within 20 per cent."""
    rng = np.random.default_rng(5)
    found, told = [], []
    for _ in range(SEEDS):
        noisy = smooth() + sigma * rng.standard_normal((2, 2, *X.shape))
        b = SampledFrame(AXES, noisy, sigma=sigma).burgers(loop)
        found.append(b.vector)
        told.append(b.error)
    exact = SampledFrame(AXES, smooth(), 8).burgers(loop).vector
    scatter = np.sqrt(((np.array(found) - exact) ** 2).mean(axis=0))
    assert np.mean(told) / scatter == pytest.approx([1, 1], abs=0.2)


@pytest.mark.parametrize("options", [{}, {"periodic": True}, {"mask": np.hypot(X, Y - 1) < 0.2}])
@pytest.mark.parametrize("order", [2, 4, 8])
@pytest.mark.parametrize("size", [1, 3, (4, 7), 14])
def test_sigmas_are_the_sum_over_all_weights(size, order, options):
    """b is linear in the values: each node moved by one gives its weight, and these the sigma."""
    axes = [np.linspace(0, 1, 16), np.linspace(0, 3, 15)]
    shape = (16, 15)
    rng = np.random.default_rng(2)
    mask = np.zeros(shape, bool)
    if "mask" in options:
        mask[7, 6:9] = mask[3, 11] = mask[12, 3] = True
    kinds = {"periodic": options.get("periodic", ())}
    sigma = rng.random((1, 2, *shape))
    grid = SampledFrame(axes, rng.random((1, 2, *shape)), order, mask=mask, sigma=sigma, **kinds)
    found = grid.burgers_map(size)
    total = np.zeros(found.known.shape)
    for node in np.argwhere(np.ones((2, *shape), bool)):
        if mask[tuple(node[1:])]:
            continue
        moved = np.zeros((1, 2, *shape))
        moved[(0, *node)] = sigma[(0, *node)]
        one = SampledFrame(axes, moved, order, mask=mask, **kinds).burgers_map(size)
        total += one.vectors[0] ** 2
    known = found.known
    assert known.all() or mask.any()
    assert known.any() or size == 14
    assert found.sigmas[0][known] == pytest.approx(np.sqrt(total[known]), rel=1e-9)
    if not known.any():
        return
    place = tuple(np.argwhere(known)[0])
    m = (size, size) if isinstance(size, int) else size
    corner = [float(axis[0] + s * k) for axis, s, k in zip(axes, grid.steps, place, strict=True)]
    loop = Loop.plaquette(corner, [s * k for s, k in zip(grid.steps, m, strict=True)])
    alone = grid.burgers(loop)
    assert alone.sigmas[0] == pytest.approx(found.sigmas[(0, *place)], rel=1e-9)
    assert alone.vector[0] == pytest.approx(found.vectors[(0, *place)], abs=1e-12)


def test_maps_tell_the_scatter():
    """Squares of eight cells, Nye tensor and density of dislocations, over two hundred fields."""
    rng = np.random.default_rng(7)
    maps, alphas, errors = [], [], []
    grid = SampledFrame(AXES, smooth(), sigma=0.03)
    found = grid.burgers_map(8)
    for _ in range(SEEDS):
        noisy = smooth() + 0.03 * rng.standard_normal((2, 2, *X.shape))
        grid = SampledFrame(AXES, noisy, sigma=0.03)
        found = grid.burgers_map(8)
        maps.append(found.vectors)
        errors.append(found.errors)
        alphas.append(grid.nye)
    scatter = np.std(maps, axis=0)
    # A standard deviation of 200 is known to 5 per cent; the worst of many places to 20.
    assert (scatter / found.sigmas).mean() == pytest.approx(1, abs=0.02)
    assert np.abs(scatter / found.sigmas - 1).max() < 0.25
    assert np.mean(errors) / scatter.mean() == pytest.approx(1, abs=0.2)
    ratio = np.std(alphas, axis=0) / grid.nye_noise
    assert ratio.mean() == pytest.approx(1, abs=0.02)
    density, floor = grid.gnd_density(0.25)
    assert density.shape == floor.shape == X.shape
    assert 0.5 < np.sqrt((density**2).mean()) / np.sqrt((floor**2).mean()) < 1.5


def test_both_parts_are_shown_apart():
    """Interpolation alone without sigma; with it both, and the sum of squares."""
    quiet, noisy = SampledFrame(AXES, smooth()), SampledFrame(AXES, smooth(), sigma=0.01)
    loop = LOOPS["circle"]
    a, b = quiet.burgers(loop), noisy.burgers(loop)
    assert a.noise == 0
    assert a.error == a.interpolation_error + a.quadrature_error
    assert b.error == pytest.approx(
        np.hypot(b.interpolation_error + b.quadrature_error, b.noise), rel=1e-15
    )
    assert b.sigmas.shape == (2,)
    assert "noise" in repr(b)
    assert b.vector == pytest.approx(a.vector, abs=0)
    assert b.significance == pytest.approx(np.sqrt(((b.vector / b.sigmas) ** 2).sum()), rel=0.05)


def test_noise_is_estimated_from_the_data():
    """Each component by itself, whatever the smooth field, cores and holes are; stated how."""
    rng = np.random.default_rng(3)
    levels = np.array([[0.01, 0.02], [0.05, 0.1]])[:, :, None, None]
    values = smooth() + levels * rng.standard_normal((2, 2, *X.shape))
    values[:, :, 10:13, 11] += 5
    grid = SampledFrame(AXES, values, sigma="estimate", mask=X > 0.9)
    assert grid.sigma.ravel() == pytest.approx(levels.ravel(), rel=0.12)
    assert "sixth differences" in grid.sigma_source
    assert grid.burgers(LOOPS["square"]).noise > 0
    exact = SampledFrame(AXES, smooth(), sigma="estimate")
    assert exact.sigma.max() < 1e-6


def test_sigma_of_nodes_may_differ():
    """By node, by component, by both; holes are not asked."""
    loop, mask = LOOPS["square"], X < -0.9
    one = SampledFrame(AXES, smooth(), sigma=0.02).burgers(loop).sigmas
    by_node = np.full(X.shape, 0.02)
    by_node[mask] = np.nan
    for sigma in (by_node, np.full((2, 2), 0.02), np.full((2, 2, *X.shape), 0.02)):
        grid = SampledFrame(AXES, smooth(), sigma=sigma, mask=mask)
        assert grid.burgers(loop).sigmas == pytest.approx(one, rel=1e-12)
    rows = SampledFrame(AXES, smooth(), sigma=np.array([[0.02, 0.02], [0.04, 0.04]]))
    assert rows.burgers(loop).sigmas == pytest.approx([one[0], 2 * one[1]], rel=1e-12)


@pytest.mark.parametrize(
    ("sigma", "message"),
    [
        (-0.1, "sigma: standard deviations of 0 or more were needed, but -0.1"),
        (np.nan, "0 or more were needed, but nan"),
        (np.inf, "0 or more were needed, but inf"),
        (np.where(X > 0.5, -1.0, 1.0), r"but -1 came at node \(23, 0\)"),
        (np.ones(3), r"shape \(31, 29\) \(nodes\), \(2, 2\) \(components\)"),
        ("guess", "sigma: one of estimate"),
        ([["1"]], "sigma: an array of real numbers"),
    ],
)
def test_sigmas_that_are_none(sigma, message):
    """Each with its own message."""
    with pytest.raises(GridError, match=message):
        SampledFrame(AXES, smooth(), sigma=sigma)
