"""Displacements: their jumps are taken out before differences are formed."""

import numpy as np
import pytest

from geomtorsion.errors import GridError
from geomtorsion.loops import Loop, SampledFrame
from tests.loops.edge_dislocation import displacement

B = 0.286
AXIS = np.linspace(-3, 3, 60)
X, Y = np.meshgrid(AXIS, AXIS, indexing="ij")


def edge(x: np.ndarray, y: np.ndarray, b: float = B) -> np.ndarray:
    """The displacement of an edge dislocation; its cut is y = 0, x < 0."""
    return displacement(x, y, b)


def test_what_differences_across_the_cut_would_give():
    """The integral of np.gradient closes: nothing is left of the dislocation."""
    beta = np.array([np.gradient(part, AXIS, AXIS) for part in edge(X, Y)])
    found = SampledFrame.from_distortion([AXIS, AXIS], beta).burgers(Loop.circle([0, 0], 2))
    assert abs(found.vector[0]) < 0.1 * B


@pytest.mark.parametrize("branch", [None, B, [[B, 0]], [B, 0], [[B, 0], [B / 2, B * 3**0.5 / 2]]])
def test_an_edge_dislocation(branch):
    """b = (0.286, 0) on every circuit, within the error told, and nothing beside the core."""
    grid = SampledFrame.from_displacement([AXIS, AXIS], edge(X, Y), branch=branch)
    for loop in (Loop.circle([0, 0], 2), Loop.circle([0.4, -0.3], 1.5), grid_square(1.7)):
        found = grid.burgers(loop)
        # The found jump is known as well as the field is smooth across the cut.
        assert np.abs(found.vector - [B, 0]).max() < found.error + (2e-4 if branch is None else 0)
        assert found.error < 0.01 * B
    beside = grid.burgers(Loop.circle([1, 1], 0.7))
    assert np.abs(beside.vector).max() < beside.error + 1e-6
    assert "edges" in grid.source


def grid_square(half: float) -> Loop:
    return Loop.plaquette([-half, -half], (2 * half, 2 * half))


def test_cuts_in_strongly_bent_fields_are_found():
    """A smooth part that changes by more than b from node to node hides no jump."""
    smooth = np.array([4 * X + X**2 / 5 + Y * X / 9, X - 2 * Y])
    assert np.abs(np.diff(smooth[0], axis=0)).min() > 0.6 * B
    for branch in (None, [B, 0]):
        grid = SampledFrame.from_displacement([AXIS, AXIS], edge(X, Y) + smooth, branch=branch)
        found = grid.burgers(Loop.circle([0, 0], 2))
        assert np.abs(found.vector - [B, 0]).max() < 0.005 * B


def test_cuts_in_short_waves_are_found():
    """Waves of eight steps, as high as b: steps farther away say nothing of what is smooth."""
    wave = np.array([B * np.sin(2 * np.pi * Y / (8 * (AXIS[1] - AXIS[0]))), 0 * X])
    grid = SampledFrame.from_displacement([AXIS, AXIS], edge(X, Y) + wave)
    found = grid.burgers(Loop.circle([0, 0], 2))
    assert np.abs(found.vector - [B, 0]).max() < 0.1 * B


def test_two_cuts_of_different_vectors():
    """Two dislocations with jumps of their own: both circuits, and the one round both."""
    u = edge(X - 1.31, Y - 0.9) + edge(X + 1.2, Y + 1.1, 0.4)[::-1]
    grid = SampledFrame.from_displacement([AXIS, AXIS], u)
    one = grid.burgers(Loop.circle([1.31, 0.9], 1.0))
    two = grid.burgers(Loop.circle([-1.2, -1.1], 1.0))
    both = grid.burgers(grid_square(2.7))
    assert one.vector == pytest.approx([B, 0], abs=0.01)
    assert two.vector == pytest.approx([0, 0.4], abs=0.01)
    assert both.vector == pytest.approx([B, 0.4], abs=0.01)
    assert grid.source.count("edges") == 2


def test_noise_and_strain_are_no_cuts():
    """Nothing stands out: no jumps, and circuits close."""
    rng = np.random.default_rng(0)
    for u in (
        rng.standard_normal((2, *X.shape)),
        rng.standard_normal((1, *X.shape)),
        np.array([np.sin(3 * X) * Y, np.exp(-(X**2) - Y**2)]),
        np.zeros((2, *X.shape)),
    ):
        grid = SampledFrame.from_displacement([AXIS, AXIS], u)
        assert grid.source == "a displacement; jumps: none"


@pytest.mark.parametrize(
    ("share", "allowed"), [pytest.param(0.01, 0.1, marks=pytest.mark.slow), (0.04, 0.3)]
)
def test_noisy_displacements(share, allowed):
    """Some per cent of a lattice vector, 60 seeds: jumps are found, the error is the scatter."""
    rng = np.random.default_rng(1)
    loop = Loop.circle([0, 0], 2)
    found, told = [], []
    u, grid = X, None
    for k in range(60):
        u = edge(X, Y) + share * B * rng.standard_normal((2, *X.shape))
        grid = SampledFrame.from_displacement([AXIS, AXIS], u, sigma="estimate", branch=B)
        b = grid.burgers(loop)
        found.append(b.vector)
        told.append(b.error)
        if k < 5:
            assert np.abs(b.vector - [B, 0]).max() < allowed * B
            searched = SampledFrame.from_displacement([AXIS, AXIS], u).burgers(loop)
            assert searched.vector == pytest.approx(b.vector, abs=allowed * B)
    scatter = np.sqrt(((np.array(found) - [B, 0]) ** 2).mean(axis=0))
    assert np.mean(told) / scatter == pytest.approx([1, 1], abs=0.2)
    fixed = SampledFrame.from_displacement([AXIS, AXIS], u, sigma=share * B, branch=B)
    assert grid is not None
    assert grid.sigma[:, :, ~grid.mask].mean() / fixed.sigma[
        :, :, ~fixed.mask
    ].mean() == pytest.approx(1, abs=0.1)


def test_noise_that_spoils_a_jump_is_a_hole():
    """A quarter of a lattice vector: many cells do not close, and no number is given there."""
    rng = np.random.default_rng(2)
    u = edge(X, Y) + 0.25 * B * rng.standard_normal((2, *X.shape))
    grid = SampledFrame.from_displacement([AXIS, AXIS], u, branch=B)
    assert grid.mask.mean() > 0.5
    with pytest.raises(GridError, match="touches a hole"):
        grid.burgers(Loop.circle([0, 0], 2))


def test_holes_and_periods():
    """An unseen core; a displacement that a period adds a strain to."""
    u = edge(X, Y)
    u[0, np.hypot(X, Y) < 0.6] = np.nan
    grid = SampledFrame.from_displacement([AXIS, AXIS], u)
    found = grid.burgers(grid.loop_around(margin=3))
    assert found.vector == pytest.approx([B, 0], abs=2e-3)
    n = 20
    line = np.arange(n) * 2 * np.pi / n
    x, y = np.meshgrid(line, line, indexing="ij")
    u = 0.1 * np.sin(x + 2 * y)
    ring = SampledFrame.from_displacement([line, line], u[None], periodic=True, branch=1.0)
    assert np.abs(ring.plaquettes().vectors).max() < 2e-4
    assert ring.coframe[0, 0] == pytest.approx(1 + 0.1 * np.cos(x + 2 * y), abs=2e-3)
    # A displacement modulo the period, as a phase is.
    shear = SampledFrame.from_displacement([line, line], x[None], periodic=True, branch=2 * np.pi)
    assert shear.coframe[0, 0] == pytest.approx(np.full((n, n), 2), abs=1e-12)


@pytest.mark.parametrize(
    ("u", "options", "message"),
    [
        (np.zeros((2, 5, 60)), {}, r"displacement: shape \(rows, 60, 60\) was needed"),
        (np.zeros((60, 60)), {}, "displacement: shape"),
        ("u", {}, "displacement: an array of real numbers"),
        (edge(X, Y), {"branch": [[1, 0], [2, 0]]}, "branch: a length, or up to 2 independent"),
        (edge(X, Y), {"branch": [[1, 0, 0]]}, "vectors of 2 components"),
        (edge(X, Y), {"branch": 0}, "branch: a length"),
        (edge(X, Y), {"branch": "a"}, "branch: an array of real numbers"),
        (edge(X, Y) * np.nan, {}, "nothing is known"),
        (edge(X, Y), {"sigma": -1}, "sigma: standard deviations"),
    ],
)
def test_displacements_that_are_none(u, options, message):
    """Each with its own message."""
    with pytest.raises(GridError, match=message):
        SampledFrame.from_displacement([AXIS, AXIS], u, **options)
