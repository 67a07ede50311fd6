"""Noise: reported errors against the scatter of many noisy fields, and against all weights."""

import numpy as np
import pytest

from geomtorsion.errors import GridError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame
from tests.chosen import one_in
from tests.rounding import ROUNDED

AXES = [np.linspace(-1, 1, 31), np.linspace(0, 2, 29)]
X, Y = np.meshgrid(*AXES, indexing="ij")
SEEDS = 200


def smooth() -> np.ndarray:
    """A coframe with small distortion and torsion."""
    return np.array([[np.cos(X) + Y / 9, X / 20], [X * Y / 30, 1 + np.sin(X * Y) / 20]])


LOOPS = {
    "circle": Loop.circle([0, 1], 0.63),
    "square": Loop.plaquette([-0.4, 0.5], (0.8, 0.9)),
    "twice": Loop.circle([0.1, 1.1], 0.5).times(2),
    "bent": Loop.spline([[0.5, 1], [0, 1.6], [-0.7, 1.1], [0.1, 0.3]]),
}


# The other loops test less than `twice`, so only slow runs include them.
@pytest.mark.parametrize(
    "loop",
    [
        pytest.param(loop, id=name, marks=[] if name == "twice" else pytest.mark.slow)
        for name, loop in LOOPS.items()
    ],
)
@pytest.mark.parametrize("sigma", [pytest.param(0.01, marks=pytest.mark.slow), 0.1])
def test_the_reported_error_is_the_scatter(loop, sigma):
    """Over two hundred noisy fields the mean error is the scatter within 20 percent."""
    rng = np.random.default_rng(5)
    found, told = [], []
    for _ in range(SEEDS):
        noisy = smooth() + sigma * rng.standard_normal((2, 2, *X.shape))
        b = SampledFrame(AXES, noisy, sigma=sigma).burgers(loop)
        found.append(b.vector)
        told.append(b.error)
    exact = SampledFrame(AXES, smooth(), 8).burgers(loop).vector
    scatter = np.sqrt(((np.array(found) - exact) ** 2).mean(axis=0))
    assert np.mean(told) / np.linalg.norm(scatter) == pytest.approx(1, abs=0.2)


KINDS = ({}, {"periodic": True}, {"mask": np.hypot(X, Y - 1) < 0.2})


@pytest.mark.parametrize(
    ("size", "order", "options"), one_in(3, (1, 3, (4, 7), 14), (2, 4, 8), KINDS)
)
def test_sigmas_are_the_sum_over_all_weights(size, order, options):
    """b is linear in the values: moving each value by its sigma gives its part of the noise."""
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
    # b of a row depends only on this row, so each row moves one value.
    nodes = np.argwhere(~np.broadcast_to(mask, (2, *shape)))
    moved = np.zeros((len(nodes), 2, *shape))
    moved[np.arange(len(nodes)), *nodes.T] = sigma[0][tuple(nodes.T)]
    each = SampledFrame(axes, moved, order, mask=mask, **kinds).burgers_map(size)
    total = (each.vectors**2).sum(axis=0)
    assert found.known.all() or mask.any()
    assert found.known.any() or size == 14
    # The noise of a detour is an upper bound.
    around = found.detoured
    assert (found.sigmas[0][around] > np.sqrt(total[around])).all()
    known = found.known & ~around
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


def correlated(shape=(2, 2)) -> np.ndarray:
    """A covariance between all components, of a few thousandths."""
    n = int(np.prod(shape))
    root = np.random.default_rng(9).normal(size=(n, n))
    return 1e-4 * (root @ root.T + np.eye(n))


HOLES = np.zeros((13, 12), bool)
HOLES[6, 5:8] = HOLES[2, 9] = HOLES[11, 3] = True


@pytest.mark.parametrize(
    ("size_order", "options", "by_node"),
    one_in(
        2,
        ((1, 2), (3, 4), ((4, 7), 8), (10, 4)),
        ({}, {"periodic": True}, {"mask": HOLES}),
        (False, True),
    ),
)
def test_covariances_are_the_sum_over_all_weights(size_order, options, by_node):
    """Moving each component of each node by one gives its weight, and the weights give C_b."""
    size, order = size_order
    axes = [np.linspace(0, 1, 13), np.linspace(3, 0, 12)]
    rng = np.random.default_rng(4)
    values = rng.random((2, 2, 13, 12))
    table = correlated()[..., None, None] * np.ones((13, 12))
    if by_node:
        table = table * (0.5 + rng.random((13, 12)))
    given = table if by_node else correlated()
    frame = SampledFrame(axes, values, order, covariance=given, **options)
    found = frame.burgers_map(size)
    straight = np.argwhere(found.known & ~found.detoured)
    place = tuple(straight[len(straight) // 2])
    weights = np.zeros((2, 2, 2, 13, 12))
    moved = np.eye(2 * 13 * 12).reshape(-1, 2, 13, 12)
    each = SampledFrame(axes, moved, order, **options).burgers_map(size)
    weights[0, 0] = weights[1, 1] = each.vectors[(slice(None), *place)].reshape(2, 13, 12)
    flat, holes = weights.reshape(2, 4, -1), options.get("mask", np.zeros((13, 12), bool))
    each = table.reshape(4, 4, -1) * ~holes.ravel()
    exact = np.einsum("apn,pqn,bqn->ab", flat, each, flat)
    assert found.sigmas[(slice(None), *place)] == pytest.approx(np.sqrt(np.diag(exact)), rel=1e-9)
    assert np.broadcast_to(found.estimated.covariance[0, 1], found.known.shape)[
        place
    ] == pytest.approx(exact[0, 1], rel=1e-9)
    m = (size, size) if isinstance(size, int) else size
    if not any(frame.periodic):
        corner = [float(axis[k]) for axis, k in zip(axes, place, strict=True)]
        corner[1] += m[1] * frame.steps[1]
        loop = Loop.plaquette(corner, [abs(s) * k for s, k in zip(frame.steps, m, strict=True)])
        alone = frame.burgers(loop)
        assert alone.covariance == pytest.approx(exact, rel=1e-9)
        assert alone.vector == pytest.approx(found.vectors[(slice(None), *place)], abs=1e-12)
        other = alone.systematic_error
        c = alone.covariance + other**2 * np.eye(2)
        size = np.sqrt(alone.vector @ np.linalg.solve(c, alone.vector))
        assert alone.significance == pytest.approx(size, rel=1e-9)
    c = np.diag(exact) * np.eye(2) + exact[0, 1] * np.array([[0, 1], [1, 0]])
    c += found.systematic_error[place] ** 2 * np.eye(2)
    b = found.vectors[(slice(None), *place)]
    assert found.significance[place] == pytest.approx(np.sqrt(b @ np.linalg.solve(c, b)), rel=1e-9)


@pytest.mark.parametrize("options", [{}, {"periodic": True}, {"mask": HOLES}])
def test_noise_of_displacements_cancels_around_circuits(options):
    """Differences cancel around circuits: the noise of b is only the chance of a wrong jump."""
    axes = [np.arange(13) / 4, np.arange(12) / 3]
    rng = np.random.default_rng(5)
    u = 0.02 * rng.standard_normal((1, 13, 12))
    frame = SampledFrame.from_displacement(axes, u, sigma=0.02, **options)
    for size in (1, 3, (4, 7)):
        assert not np.nan_to_num(frame.burgers_map(size).sigmas).any()
    loop = Loop.circle([2.3, 2.7], 0.4)
    assert frame.burgers(loop).noise == 0
    assert np.nan_to_num(frame.nye_noise).max() == 0
    # A difference of 0 with sigma sqrt(2) 0.02: the chance that it was a lattice vector.
    loud = SampledFrame.from_displacement(axes, 0 * u, sigma=0.02, branch=0.2, **options)
    edge = 0.2 * np.exp(-((0.2 / 0.02) ** 2) / 8)
    assert loud.burgers_map(1).sigmas[0, 2, 2] == pytest.approx(2 * edge, rel=1e-6)
    assert 2 * edge <= loud.burgers(loop).noise < 10 * edge


@pytest.mark.parametrize("made", ["covariance", "displacement"])
def test_noise_of_single_edges(made):
    """For edges of the grid and edges through it, moving each value by one gives its weight."""
    axes, rng = [np.arange(8) / 4, np.arange(9) / 3], np.random.default_rng(7)
    starts, ends = np.array([[0.1, 0.2], [1.0, 2.0]]), np.array([[1.3, 1.9], [0.3, 0.4]])
    if made == "covariance":
        table, shape = correlated(), (2, 2, 8, 9)
        frame = SampledFrame(axes, np.zeros(shape), covariance=table)
        moved = lambda v: SampledFrame(axes, v)  # noqa: E731
        spread = np.einsum("pq,nm->pnqm", table, np.eye(72)).reshape(288, 288)
    else:
        shape, sigma = (2, 8, 9), 0.01 * (1 + rng.random((8, 9)))
        frame = SampledFrame.from_displacement(axes, np.zeros(shape), sigma=sigma, branch=9.0)
        moved = lambda v: SampledFrame.from_displacement(axes, v, branch=9.0)  # noqa: E731
        spread = np.diag(np.tile(sigma.ravel() ** 2, 2))
    still = moved(np.zeros(shape)).cochain.values
    across = moved(np.zeros(shape)).along_edges(starts, ends).vectors
    along, through = [], []
    for row in np.eye(int(np.prod(shape))):
        one = moved(row.reshape(shape))
        along.append(one.cochain.values - still)
        through.append(one.along_edges(starts, ends).vectors - across)
    for weights, told in (
        (np.array(along), frame.cochain.bounds),
        (np.array(through), frame.along_edges(starts, ends).errors),
    ):
        variance = np.einsum("nei,nm,mei->ei", weights, spread, weights).max(axis=1)
        if made == "displacement" and len(told) == 2:
            assert (told > 0.9 * np.sqrt(variance)).all()
        else:
            assert told == pytest.approx(np.sqrt(variance), rel=1e-6)


def test_covariances_are_estimated_from_the_data():
    """On a smooth field all covariances are estimated within 8 %, and the method is named."""
    rng = np.random.default_rng(6)
    put_in, axes = correlated(), [np.linspace(0, 1, 90), np.linspace(0, 1, 100)]
    noise = rng.multivariate_normal(np.zeros(4), put_in, (90, 100))
    values = np.moveaxis(noise, -1, 0).reshape(2, 2, 90, 100) + np.sin(axes[1])
    frame = SampledFrame(axes, values, covariance="estimate")
    scale = np.sqrt(np.outer(np.diag(put_in), np.diag(put_in)))
    assert np.abs(frame.covariance.reshape(4, 4) - put_in).max() < 0.08 * scale.max()
    assert "sums and differences" in frame.sigma_source
    assert frame.burgers(Loop.circle([0.5, 0.5], 0.2)).noise > 0


def test_correlated_noise_is_reported():
    """Over two hundred fields with correlated noise, b scatters as its reported covariance."""
    rng = np.random.default_rng(8)
    found, told = [], None
    for _ in range(SEEDS):
        noise = rng.multivariate_normal(np.zeros(4), correlated(), X.shape)
        values = smooth() + np.moveaxis(noise, -1, 0).reshape(2, 2, *X.shape)
        told = SampledFrame(AXES, values, covariance=correlated()).burgers(LOOPS["circle"])
        found.append(told.vector)
    assert told is not None
    scatter = np.cov(np.array(found).T)
    assert told.sigmas == pytest.approx(np.sqrt(np.diag(scatter)), rel=0.2)
    size = np.sqrt(np.outer(np.diag(scatter), np.diag(scatter)))
    assert np.abs((told.covariance - scatter) / size).max() < 0.2


@pytest.mark.parametrize(
    ("covariance", "message"),
    [
        (np.eye(3), r"covariance: expected shape \(2, 2, 2, 2\) or \(4, 4\), optionally followed"),
        (np.triu(np.ones((4, 4))), "got entries that differ from their transpose by 1. "),
        (np.ones((4, 4)) - 2 * np.eye(4), "got the eigenvalue -"),
        (np.full((4, 4), np.inf), "covariance: expected finite numbers"),
        ("guess", "covariance: expected one of estimate"),
    ],
)
def test_invalid_covariances_are_refused(covariance, message):
    """Each wrong covariance has its own message; sigma and covariance together are refused."""
    with pytest.raises(GridError, match=message):
        SampledFrame(AXES, smooth(), covariance=covariance)
    with pytest.raises(GridError, match="expected either sigma or covariance, got both"):
        SampledFrame(AXES, smooth(), covariance=np.eye(4), sigma=0.1)


def test_errors_of_maps_are_the_scatter():
    """Squares of eight cells, Nye tensor and dislocation density over two hundred fields."""
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
    # 200 samples give a standard deviation to 5 percent, at the worst of many nodes to 20.
    assert (scatter / found.sigmas).mean() == pytest.approx(1, abs=0.02)
    assert np.abs(scatter / found.sigmas - 1).max() < 0.25
    assert np.mean(errors) / np.linalg.norm(scatter, axis=0).mean() == pytest.approx(1, abs=0.2)
    ratio = np.std(alphas, axis=0) / grid.nye_noise
    assert ratio.mean() == pytest.approx(1, abs=0.02)
    density, floor = grid.gnd_density(0.25)
    assert density.shape == floor.shape == X.shape
    assert 0.5 < np.sqrt((density**2).mean()) / np.sqrt((floor**2).mean()) < 1.5


def test_both_parts_are_shown_apart():
    """Without sigma the error is only interpolation; with sigma it is the root of both squares."""
    quiet, noisy = SampledFrame(AXES, smooth()), SampledFrame(AXES, smooth(), sigma=0.01)
    loop = LOOPS["circle"]
    a, b = quiet.burgers(loop), noisy.burgers(loop)
    assert a.noise == 0
    assert a.error == a.systematic_error
    assert b.error == pytest.approx(np.hypot(b.systematic_error, b.noise), rel=ROUNDED)
    assert b.sigmas.shape == (2,)
    assert "noise" in repr(b)
    assert b.vector == pytest.approx(a.vector, abs=0)
    assert b.significance == pytest.approx(np.sqrt(((b.vector / b.sigmas) ** 2).sum()), rel=0.05)


def test_noise_is_estimated_from_the_data():
    """Each component is estimated by itself, despite field, core and holes; the method is named."""
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
    """sigma may differ by node, by component, or by both; values in holes are ignored."""
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
        (-0.1, "sigma: expected standard deviations of 0 or more, got -0.1"),
        (np.nan, "0 or more, got nan"),
        (np.inf, "0 or more, got inf"),
        (np.where(X > 0.5, -1.0, 1.0), r"got -1 at node \(23, 0\)"),
        (np.ones(3), r"shape \(31, 29\) \(nodes\), \(2, 2\) \(components\)"),
        ("guess", "sigma: expected one of estimate"),
        ([["1"]], "sigma: expected an array of real numbers"),
    ],
)
def test_invalid_sigmas_are_refused(sigma, message):
    """Each wrong sigma has its own message."""
    with pytest.raises(GridError, match=message):
        SampledFrame(AXES, smooth(), sigma=sigma)
