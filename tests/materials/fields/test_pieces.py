"""Loops through rough data: pieces end at lines of nodes, so that the quadrature is right."""

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import GridError

AXES = [np.linspace(0, 2, 24), np.linspace(1.5, -1, 29)]


def rough(order: int, seed: int, missing: float = 0.0) -> gt.SampledFrame:
    """A coframe of independent random values, with random holes."""
    rng = np.random.default_rng(seed)
    mask = rng.random((24, 29)) < missing
    return gt.SampledFrame(AXES, rng.normal(size=(2, 2, 24, 29)), order, mask=mask)


def polygon(seed: int) -> gt.Loop:
    """A star of five to seven corners at random distances."""
    rng = np.random.default_rng(seed)
    corners = rng.integers(5, 8)
    angle = 2 * np.pi * (np.arange(corners) + rng.random()) / corners
    away = rng.uniform(0.2, 0.9, corners)
    return gt.Loop.polygon(np.stack([1 + away * np.cos(angle), 0.25 + away * np.sin(angle)], 1))


@pytest.mark.parametrize("order", [2, 4, 6])
def test_straight_lines_have_only_rounding_errors(order):
    """b of polygons is the proved integral of the interpolant within the quadrature error."""
    for seed in range(6):
        b = rough(order, seed).burgers(polygon(seed))
        truth = np.array(gt.prove(b).values, dtype=float)
        missed = np.abs(b.vector - truth).max()
        assert missed <= b.systematic["quadrature"]
        # Thousands of terms near one, each rounded.
        assert b.systematic["quadrature"] < 1e3 * np.finfo(float).eps


@pytest.mark.parametrize("order", [2, 8])
def test_curves_are_right_within_the_quadrature_error(order):
    """Circles and ellipses cross lines of nodes at any angle, touch them, or just pass them."""
    x, y = AXES[0][12], AXES[1][14]
    step = AXES[0][1] - AXES[0][0]
    radii = (6 * step, 6 * step * (1 + 1e-6), 6 * step * (1 + 1e-4))
    loops = [gt.Loop.circle([float(x), float(y)], r) for r in radii]
    loops.append(gt.Loop.ellipse([1.03, 0.27], (0.71, 0.4), ((1, 0.2), (0, 1))))
    for seed, loop in enumerate(loops):
        b = rough(order, seed).burgers(loop)
        truth = np.array(gt.prove(b).values, dtype=float)
        missed = np.abs(b.vector - truth).max()
        assert missed <= b.systematic["quadrature"] < 1e-3 * b.systematic["interpolation"]


def test_sides_along_lines_of_nodes():
    """A rectangle on lines of nodes sums the trapezoids of its edges."""
    grid = rough(2, 3)
    low, high = (3, 20), (15, 4)
    corners = [(AXES[0][i], AXES[1][j]) for i, j in (low, (15, 20), high, (3, 4))]
    b = grid.burgers(gt.Loop.polygon(corners))
    survey = grid.burgers_map((12, 16))
    assert b.vector == pytest.approx(survey.vectors[:, 3, 4])
    assert b.systematic["quadrature"] < 1e-3 * b.systematic["interpolation"]


def test_the_smallest_loops():
    """A loop within one cell, and one with corners at nodes, have the integral of the values."""
    flat = gt.SampledFrame(AXES, np.ones((1, 2, 24, 29)), 2)
    step = AXES[0][1]
    for size in (step / 50, step, 7 * step):
        b = flat.burgers(gt.Loop.polygon([(1.0, 0.0), (1.0 + size, 0.0), (1.0, size)]))
        assert abs(b.vector[0]) <= b.error < ROUNDING


# Sums of a hundred terms near one.
ROUNDING = 1e2 * np.finfo(float).eps


def test_edges_near_holes_are_right():
    """Polygons beside random holes have the proved integral of the lower orders used there."""
    compared = 0
    for seed in range(40):
        grid = rough(4, seed, 0.02)
        try:
            b = grid.burgers(polygon(seed))
        except GridError:
            continue
        if b.detour is None:
            truth = np.array(gt.prove(b).values, dtype=float)
            assert np.abs(b.vector - truth).max() <= b.systematic["quadrature"]
            compared += 1
    assert compared > 3
