"""Phases: coframe, strain and rotation of images with known fields."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportPossiblyUnboundVariable=false

from functools import cache

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import GridError, ImageError
from tests.materials.images.atoms import crystal, edge_strain_xx

made = cache(crystal)


@pytest.mark.parametrize("size", [256, 512])
def test_the_edge_field_of_one_nanometre_is_found_to_a_percent(size):
    """b from whole numbers and from the integral of the field; strain against the closed form."""
    image = crystal(size, "square", 10.0, turned=0.0)
    picture = gt.LatticeImage(image.values, step=0.1, unit="nm")
    phases = picture.phases()
    centre = 0.1 * np.array(image.centre)
    found = phases.burgers(gt.Loop.circle(centre, 0.03 * size))
    assert found.vector == pytest.approx([-1, 0], abs=0.01)
    assert abs(found.vector - [-1, 0]).max() <= found.error
    # Without whole numbers: the trapezoid rule for e along the same circuit.
    line = phases.coframe[:, :, *found.pixels.T]
    steps = 0.1 * np.diff(found.pixels, axis=0).T
    whole = np.einsum("imk,mk->i", (line[:, :, 1:] + line[:, :, :-1]) / 2, steps)
    assert whole @ phases.lattice == pytest.approx([-1, 0], abs=0.01)
    x, y = (axis - c for axis, c in zip(picture.axes, centre, strict=True))
    x, y = np.meshgrid(x, y, indexing="ij")
    ring = (np.hypot(x, y) > 0.015 * size) & (np.hypot(x, y) < 0.04 * size)
    expected = edge_strain_xx(x, y, 1.0)[ring]
    # The closed form uses positions in the perfect crystal, so the difference falls as b / r.
    rest = phases.strain[0, 0][ring] - expected
    assert np.sqrt((rest**2).mean()) < 0.1 * 256 / size * np.sqrt((expected**2).mean())


def strained(beta: np.ndarray, size: int = 200) -> gt.LatticeImage:
    """A square lattice with a spacing of 8 pixels and a constant distortion."""
    y, x = np.mgrid[size - 1 : -1 : -1, 0:size]
    X = np.einsum("ab,b...->a...", np.eye(2) - beta, np.array([x, y]))
    return gt.LatticeImage(np.cos(2 * np.pi * X[0] / 8) + np.cos(2 * np.pi * X[1] / 8))


def test_a_constant_strain_and_rotation_are_seen_everywhere():
    """Distortion relative to the spots of the perfect lattice is constant, with the right signs."""
    beta = np.array([[0.02, -0.03], [0.01, -0.01]])
    phases = strained(beta).phases([[1 / 8, 0], [0, 1 / 8]])
    keep = slice(2 * phases.margin, -2 * phases.margin)
    inside = phases.distortion[:, :, keep, keep]
    assert abs(inside - beta[:, :, None, None]).max() < 2e-3
    assert abs(inside.mean(axis=(2, 3)) - beta).max() < 1e-4
    assert phases.rotation[keep, keep].mean() == pytest.approx(0.02, abs=1e-4)
    assert phases.strain[:, :, keep, keep].mean(axis=(2, 3)) == pytest.approx(
        (beta + beta.T) / 2, abs=1e-4
    )


def test_a_lattice_turned_to_the_left_has_a_positive_rotation():
    """On the screen rows run from the top, and angles are anticlockwise."""
    angle = 0.03
    turned = crystal(200, "square", 8.0, angle, dislocated=False)
    phases = gt.LatticeImage(turned.values).phases([[1 / 8, 0], [0, 1 / 8]])
    assert np.nanmedian(phases.rotation) == pytest.approx(angle, abs=1e-3)


def test_coframe_agrees_with_the_sampled_frame():
    """e is in lattice coordinates or in lengths; a perfect lattice has no torsion."""
    phases = strained(np.zeros((2, 2))).phases()
    frame = phases.sampled()
    assert frame.coframe.mean(axis=(2, 3)) == pytest.approx(np.eye(2) / 8, abs=2e-5)
    lengths = phases.sampled(order=2, lengths=True)
    assert lengths.coframe.mean(axis=(2, 3)) == pytest.approx(np.eye(2), abs=1e-4)
    loop = gt.Loop.circle([100, 100], 60)
    assert abs(frame.burgers(loop).vector).max() < 1e-4
    assert frame.axes[0][0] == phases.margin


def test_a_core_is_a_hole_of_the_sampled_frame():
    """The hole is at the dislocation, and the loop around it has the Burgers vector."""
    image = made(256, "square")
    phases = gt.LatticeImage(image.values, 0.1, "nm").phases()
    frame = phases.sampled()
    (hole,) = frame.holes
    middle = phases.margin + np.mean([hole.low, hole.high], axis=0)
    assert np.hypot(*(middle - image.centre)) < 2
    found = frame.burgers(frame.loop_around(hole, margin=60))
    whole = -np.rint(image.vectors @ image.b)
    # The found spots may be another basis than the given vectors.
    whole = np.rint(phases.spots * 0.1 @ np.linalg.inv(image.vectors)) @ whole
    assert found.vector == pytest.approx(whole, abs=2e-3)
    density = frame.burgers_map(60).vectors
    assert np.nanmin(abs(density - whole[:, None, None]).max(axis=0)) < 2e-3
    assert np.isnan(phases.coframe[:, :, phases.holes]).all()
    assert np.isfinite(phases.coframe[:, :, ~phases.holes]).all()


@pytest.mark.parametrize("order", [3, "4", 4.5, -2, None])
def test_invalid_orders_are_refused(order):
    """`sampled` accepts the same orders as all grids."""
    phases = strained(np.zeros((2, 2))).phases()
    with pytest.raises(GridError, match="order"):
        phases.sampled(order)


def test_margins_that_leave_nothing_are_refused():
    """The error suggests a finer resolution."""
    phases = gt.LatticeImage(made(256, "square").values).phases(resolution=64)
    with pytest.raises(GridError, match="Choose a finer resolution than 64 px"):
        phases.sampled()


def test_reported_noise_is_the_scatter_of_the_waves():
    """The reported noise is the scatter over seeds, in the middle and at the border."""
    y, x = np.mgrid[199:-1:-1, 0:200]
    waves = np.cos(2 * np.pi * x / 8) + np.cos(2 * np.pi * y / 7)
    spots = [[1 / 8, 0], [0, 1 / 7]]
    every = []
    for seed in range(30):
        noise = 0.5 * np.random.default_rng(seed).normal(size=x.shape)
        phases = gt.LatticeImage(waves + noise).phases(spots, resolution=6)
        every.append(phases.waves)
    scatter = np.std(every, axis=0)
    for cut in (np.s_[:, 60:140, 60:140], np.s_[:, 60:140, :2]):
        measured = np.sqrt((scatter[cut] ** 2).mean())
        assert phases.noise[cut].mean() == pytest.approx(measured, rel=0.15)


def test_resolution_is_one_spacing_and_grows_with_noise():
    """The default is one lattice spacing, more under noise; a given resolution is kept."""
    image = made(256, "square")
    clean, noisy = (gt.LatticeImage(image.noisy(level, 0)).phases() for level in (0, 1))
    assert clean.resolution == pytest.approx(8, rel=0.01)
    assert 8 < noisy.resolution < 20
    assert gt.LatticeImage(image.values).phases(resolution=5).resolution == 5


@pytest.mark.slow
def test_a_megapixel():
    """Spots, phases, coframe and a circuit of a large image; benchmarks measure the time."""
    image = made(512, "square")
    picture = gt.LatticeImage(np.kron(np.ones((2, 2)), image.values))
    phases = picture.phases()
    assert np.isfinite(phases.coframe).any()
    phases.burgers(gt.Loop.circle([256, 256], 100))
    assert phases.waves.shape == (2, 1024, 1024)


def test_equal_calls_give_equal_bits():
    """Two calls on the same image give equal arrays."""
    values = made(256, "square").noisy(1, 0)
    one, two = (gt.LatticeImage(values).phases() for _ in range(2))
    assert (one.waves == two.waves).all()
    assert one.noise.tobytes() == two.noise.tobytes()


@pytest.mark.parametrize(
    ("spots", "match"),
    [
        ([[0.7, 0], [0, 0.1]], "at most 0.5 per px"),
        ([[0, 0], [0, 0.1]], "expected 6 periods across the image or more, got 0"),
        ([[0.02, 0], [0, 0.02]], "got 5.12: the spot is too close to the origin"),
        ([[0.1, 0], [0.2, 0]], "got both in one direction"),
        ([[0.1, 0]], r"expected shape \(2, 2\)"),
        ([[0.1, "x"], [0, 1]], "expected an array of real numbers"),
        ([[0.1, np.nan], [0, 1]], "is not finite"),
    ],
)
def test_invalid_spots_are_refused(spots, match):
    """The error states the allowed spots."""
    image = gt.LatticeImage(made(256, "square").values)
    with pytest.raises(ImageError, match=match):
        image.phases(spots)


@pytest.mark.parametrize("resolution", [0, -3, 0.1, 100, np.inf, "8"])
def test_invalid_resolutions_are_refused(resolution):
    """A resolution that is not positive, finer than a pixel or as large as the image is refused."""
    with pytest.raises(ImageError, match="resolution"):
        gt.LatticeImage(made(256, "square").values).phases(resolution=resolution)


@pytest.mark.parametrize("lengths", [False, True])
def test_sigma_of_a_sampled_frame_is_the_scatter_of_its_values(lengths):
    """sigma of a component is its scatter over seeds; circuits scatter less than their noise."""
    y, x = np.mgrid[159:-1:-1, 0:160]
    waves = np.cos(2 * np.pi * x / 8) + np.cos(2 * np.pi * (y / 7 + x / 60))
    spots = np.array([[1 / 8, 0], [1 / 60, 1 / 7]]) / 0.1
    every, told, sums, noise = [], [], [], []
    for seed in range(20):
        grey = waves + 0.4 * np.random.default_rng(seed).normal(size=x.shape)
        frame = gt.LatticeImage(grey, 0.1, "nm").phases(spots, 0.6).sampled(lengths=lengths)
        every.append(frame.coframe)
        told.append(frame.sigma)
        b = frame.burgers(gt.Loop.polygon([[4, 4], [11, 4], [11, 11], [4, 11]]))
        sums.append(b.vector)
        noise.append(b.sigmas)
    scatter = np.sqrt(np.var(every, axis=0).mean(axis=(2, 3)))
    assert np.sqrt(np.mean(np.square(told), axis=(0, 3, 4))) == pytest.approx(scatter, rel=0.15)
    assert (np.std(sums, axis=0) < np.mean(noise, axis=0)).all()
