"""Geometry of sampled frames: curvature and torsion on a grid, with errors, and closed forms."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import GeomtorsionError

wrong: Any = gt.SampledFrame


def nodes(*axes: np.ndarray) -> list[np.ndarray]:
    """Coordinates of all nodes, one array for each axis."""
    return list(np.meshgrid(*axes, indexing="ij"))


def sphere(n: int, **options: Any) -> gt.SampledFrame:
    """The metric of the unit sphere on n nodes of latitude."""
    theta = np.linspace(0.6, 2.4, n)
    sine = np.sin(theta)[:, None] ** 2 * np.ones(9)
    one, zero = np.ones((n, 9)), np.zeros((n, 9))
    axes = [theta, np.linspace(0, 1, 9)]
    return gt.SampledFrame.from_metric(axes, np.array([[one, zero], [zero, sine]]), **options)


def misses(frame: gt.SampledFrame, name: str, truth: np.ndarray | float) -> np.ndarray:
    """Distances from the truth, all within the errors."""
    found = frame.quantity(name)
    away = np.abs(found.values - truth)
    assert (np.isnan(found.values) | (away <= found.error)).all()
    assert not np.isnan(found.values).all()
    return away


def test_flat_space_has_no_curvature():
    """A constant coframe has curvature and torsion zero, without any error."""
    coframe = np.diag([2.0, 3.0, 0.1])[:, :, None, None, None] * np.ones((9, 9, 9))
    flat = gt.SampledFrame([np.arange(9.0)] * 3, coframe)
    for name in ("riemann", "ricci", "scalar_curvature", "christoffel", "torsion"):
        found = flat.quantity(name)
        assert not found.values.any()
        assert not found.error.any()


@pytest.mark.parametrize("order", [2, 4, 6])
def test_the_curvature_of_a_sphere_converges(order: int):
    """R = 2 within the error at all nodes; inside it converges with the order of differences."""
    worst = []
    for n in (41, 81):
        away = misses(sphere(n, order=order), "scalar_curvature", 2)
        worst.append(away[n // 4 : -n // 4].max())
    assert order - 0.5 < np.log2(worst[0] / worst[1]) < order + 1


def kerr_schild(n: int) -> tuple[gt.SampledFrame, np.ndarray]:
    """The metric of Schwarzschild in Kerr-Schild coordinates through the horizon, and r."""
    axes = [np.linspace(0, 1, 9), *[np.linspace(1, 1.4, n)] * 3]
    _, x, y, z = nodes(*axes)
    r = np.sqrt(x**2 + y**2 + z**2)
    ray = np.array([np.ones_like(r), x / r, y / r, z / r])
    eta = np.diag([-1.0, 1, 1, 1])[:, :, None, None, None, None]
    metric = eta + 2 / r * ray[:, None] * ray[None]
    return gt.SampledFrame.from_metric(axes, metric, names=("t", "x", "y", "z")), r


def test_a_black_hole_across_its_horizon():
    """Where g_tt changes its sign: Ricci vanishes and the Kretschmann scalar is 48/r^6."""
    hole, r = kerr_schild(9)
    assert hole.signature == "-+++"
    assert r.min() < 2 < r.max()
    misses(hole, "ricci", 0)
    away = misses(hole, "kretschmann", 48 / r**6)
    assert away.max() < 0.05 * (48 / r**6).max()


def test_null_coordinates():
    """The metric 2 F du dv has no squares, and R = -(2/F) d_u d_v log F; here F = exp(u v)."""
    axes = [np.linspace(-0.5, 0.5, 15)] * 2
    u, v = nodes(*axes)
    factor, zero = np.exp(u * v), np.zeros_like(u)
    frame = gt.SampledFrame.from_metric(axes, np.array([[zero, factor], [factor, zero]]))
    assert frame.signature == "-+"
    misses(frame, "scalar_curvature", -2 / factor)
    misses(frame, "metric", np.array([[zero, factor], [factor, zero]]))


def test_the_signs_of_rows_may_be_in_another_order():
    """With the requested order the metric is the same."""
    axes = [np.arange(9.0)] * 2
    metric = np.array([[-4.0, 0], [0, 9]])[:, :, None, None] * np.ones((9, 9))
    frame = gt.SampledFrame.from_metric(axes, metric, signature="+-")
    assert frame.coframe[:, :, 0, 0].tolist() == [[0, 3], [2, 0]]
    misses(frame, "metric", metric)


def test_torsion_and_connection_of_a_coframe():
    """Exact tensors of a frame of formulas, sampled, agree with tensors of its samples."""
    frame = gt.Frame("x y", [["1 + x*y/4", "y/5"], ["x**2/3", "exp(x/4)"]])
    axes = [np.linspace(-1, 1, 13)] * 2
    sampled = gt.SampledFrame.from_frame(frame, axes)
    x, y = nodes(*axes)
    for name in ("torsion_T", "cartan_connection", "christoffel", "scalar_curvature"):
        exact = frame.quantity(name)
        truth = np.empty((2,) * len(exact.slots) + x.shape)
        for place in np.ndindex(x.shape):
            truth[(..., *place)] = exact.at({"x": x[place], "y": y[place]})
        misses(sampled, name, truth)


def test_holes_and_periods():
    """Near holes and across a period (odd and even) values are unknown or within the errors."""
    for n in (24, 25):
        phi = np.arange(n) * 2 * np.pi / n
        axes = [np.linspace(1, 2, 15), phi]
        r, angle = nodes(*axes)
        bump = 1 + 0.1 * np.cos(angle)
        zero = np.zeros_like(r)
        metric = np.array([[bump**2, zero], [zero, (r * bump) ** 2]])
        # R of exp(2 w) times a flat metric: -2 exp(-2 w) Laplace w, w = log(bump).
        second = -0.1 * np.cos(angle) / bump - (0.1 * np.sin(angle) / bump) ** 2
        truth = -2 / bump**2 * second / r**2
        mask = (np.abs(r - 1.5) < 0.1) & (np.abs(angle - 3) < 0.5)
        frame = gt.SampledFrame.from_metric(axes, metric, periodic=(False, True), mask=mask)
        assert mask.sum() > 3
        found = frame.quantity("scalar_curvature")
        assert np.isnan(found.values[mask]).all()
        assert np.isnan(found.values).sum() < 3 * mask.sum()
        misses(frame, "scalar_curvature", truth)


def test_units_follow_the_derivatives():
    """The curvature of a map in km is per square km."""
    assert sphere(21, unit="km").quantity("scalar_curvature").unit == "1/km^2"
    assert sphere(21, unit="km").quantity("metric").unit == ""


@pytest.mark.parametrize("ending", [".npz", ".csv"])
def test_files_keep_the_signature(tmp_path: Path, ending: str):
    """A saved frame of a Lorentzian metric reads back with its signature."""
    axes = [np.arange(9.0)] * 2
    metric = np.array([[-4.0, 0], [0, 9]])[:, :, None, None] * np.ones((9, 9))
    frame = gt.SampledFrame.from_metric(axes, metric)
    frame.save(tmp_path / f"a{ending}")
    assert gt.SampledFrame.read(tmp_path / f"a{ending}").signature == "-+"


LINES = [np.arange(9.0)] * 2
ONES = np.ones((9, 9))
UNIT = np.eye(2)[:, :, None, None] * ONES
X = np.arange(9.0)[:, None] * np.ones(9) - 4
REFUSALS = [
    (lambda: gt.SampledFrame(LINES, UNIT[:1]).quantity("ricci"), "as many rows as axes"),
    (lambda: gt.SampledFrame(LINES, UNIT).quantity("richi"), "ricci"),
    (lambda: gt.SampledFrame(LINES, UNIT, mask=ONES * np.arange(9) % 3 > 0).quantity("ricci"),
     "known neighbours"),
    (lambda: gt.SampledFrame(LINES, UNIT, signature="-++"), "expected 2 signs"),
    (lambda: gt.SampledFrame(LINES, UNIT, signature="ab"), "expected 2 signs"),
    (lambda: wrong(LINES, UNIT, signature=3), "signature"),
    (lambda: gt.SampledFrame.from_metric(LINES, UNIT, signature="-+"), "the signs of the metric"),
    (lambda: gt.SampledFrame.from_metric(LINES, UNIT * X), "degenerate"),
    (lambda: gt.SampledFrame.from_metric(LINES, np.array([[ONES, X], [0 * X, ONES]])), "symmetric"),
    (lambda: gt.SampledFrame.from_metric(LINES, UNIT[0]), "expected shape"),
    (lambda: gt.SampledFrame.from_metric(LINES, UNIT * np.nan), "at some nodes"),
    (lambda: gt.SampledFrame.from_displacement(LINES, UNIT[0]).quantity("ricci"), "displacement"),
    (lambda: gt.SampledFrame(LINES, np.array([[X, ONES], [0 * X, ONES]])).quantity("ricci"),
     "at node"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "words"), REFUSALS)
def test_refusals(call: Any, words: str):
    """The message of each wrong call names the expected value."""
    with pytest.raises(GeomtorsionError, match=words):
        call()
