"""Errors of stresses: noise of the data, their grid, and the crystal outside of a map."""

from pathlib import Path

import numpy as np
import pytest

from geomtorsion import (
    Box,
    DislocationNetwork,
    ElasticConstants,
    LineArrays,
    NyeField,
    SampledFrame,
    stresses,
)
from geomtorsion.errors import GridError, NetworkError
from geomtorsion.materials.elasticity import StressErrors
from tests.chosen import few

STEEL = ElasticConstants.isotropic(80.0, 0.3, unit="GPa")
NODES = 26
# The components of plane strain in their order.
PLANE = [0, 1, 0], [0, 1, 1]
OPEN = Box.of_bounds([0, 0, 0], [16, 16, 1], (False, False, True))


def lines_along_z(places, vectors) -> DislocationNetwork:
    """Straight lines along z in a periodic cell that is 16 units wide."""
    count = len(places)
    box = Box.of_bounds([-7, -7, 0], [9, 9, 1])
    lines = LineArrays(
        np.column_stack([places, np.zeros(count)]), [[k, k] for k in range(count)], vectors, box,
        images=[[0, 0, 1]] * count,
    )  # fmt: skip
    return DislocationNetwork.of_arrays(lines)


# Two edges, and all their images in the crystal outside of the map.
EDGES = lines_along_z([[0.8, 1.2], [1.7, 1.4]], [[2e-3, 0, 0], [-2e-3, 0, 0]])
TRUTH = stresses(EDGES, STEEL, shape=160, core=0.2)
FIRST = 70  # the node at x = y = 0
WINDOW = slice(FIRST, FIRST + NODES)
AXES = [axis[WINDOW] for axis in TRUTH.frame.axes]
INSIDE = TRUTH.stress[:, :, WINDOW, WINDOW, 0]


def measured(sigma: float, seed: int = 0, given: object = None) -> SampledFrame:
    """A map of the two edges with noise."""
    beta = TRUTH.distortion[:, :, WINDOW, WINDOW, 0]
    noise = sigma * np.random.default_rng(seed).normal(size=beta.shape)
    return SampledFrame.from_distortion(AXES, -(beta + noise), unit="um", sigma=given or sigma)


def coverage(field: NyeField) -> np.ndarray:
    """Shares of stress components within one error and within two."""
    found = stresses(field, STEEL)
    part = (*PLANE, slice(NODES), slice(NODES), 0)
    error = found.errors.total[part]
    away = np.abs(found.stress[part] - INSIDE[PLANE])
    return np.array([(away <= error).mean(), (away <= 2 * error).mean()])


@pytest.mark.parametrize("sigma", few(2, [1e-6, 5e-6, 2e-5, 1e-4, 5e-4, 2e-3]))
def test_errors_hold_for_two_edges(sigma):
    """One error covers 68 percent of the stresses, and two errors cover 95 percent."""
    shares = np.mean(
        [coverage(NyeField.of_frame(measured(sigma, k)).padded(26).balanced()) for k in (0, 1)],
        axis=0,
    )
    # Errors of the grid and of the outside are upper estimates; noise scatters the shares.
    assert shares[0] > 0.6
    assert shares[1] > 0.93
    if sigma >= 1e-4:
        assert shares[0] < 0.76


def test_more_noise_is_a_larger_error():
    """Errors grow in proportion to a noise that dominates, and do not depend on a small one."""
    errors = [
        stresses(NyeField.of_frame(measured(0.0, given=s)).padded(26).balanced(), STEEL).errors
        for s in (1e-6, 1e-3, 1.0)
    ]
    ratio = np.nanmax(errors[2].noise) / np.nanmax(errors[1].noise)
    assert ratio == pytest.approx(1000, rel=1e-6)
    assert np.nanmax(errors[0].noise) < 0.3 * np.nanmax(errors[0].total)
    assert np.isnan(errors[0].total[..., NODES:, :, :]).all()
    assert np.isfinite(errors[0].total[..., :NODES, :NODES, :]).all()


def test_more_crystal_around_the_map_is_a_smaller_error():
    """The error of the outside falls with the square of the padding, as the true error."""
    frame = measured(0.0, given=1e-9)
    true, estimate = [], []
    for nodes in (26, 60):
        found = stresses(NyeField.of_frame(frame).padded(nodes).balanced(), STEEL)
        part = (*PLANE, slice(NODES), slice(NODES), 0)
        true.append(np.sqrt(((found.stress[part] - INSIDE[PLANE]) ** 2).mean()))
        estimate.append(np.sqrt((found.errors.total[part] ** 2).mean()))
    assert true[1] < true[0] / 2
    assert all(t < 1.3 * e < 3 * t for t, e in zip(true, estimate, strict=True))


def test_noise_of_a_periodic_map_is_exact():
    """White noise of one component in a periodic cell: the sum over all waves, in closed form.

    For a screw distortion beta_zx = eps in an isotropic crystal the relaxed distortion of a wave k
    is eps (1 - k_x^2 / k^2, - k_x k_y / k^2), so that sigma_xz = mu eps k_y^2 / k^2.
    """
    n = 16
    axes = [np.arange(float(n))] * 2
    coframe = np.zeros((3, 2, n, n))
    coframe[0, 0] = coframe[1, 1] = 1.0
    sigma = np.zeros((3, 2))
    sigma[2, 0] = 1e-3
    found = stresses(SampledFrame(axes, coframe, periodic=True, sigma=sigma), STEEL)
    waves = np.fft.fftfreq(n, 1 / n)
    kx, ky = np.meshgrid(*[waves] * 2, indexing="ij")
    used = (np.abs(kx) < n / 2) & (np.abs(ky) < n / 2) & (kx**2 + ky**2 > 0)
    share = np.where(used, ky**2 / np.where(used, kx**2 + ky**2, 1), 0)
    wanted = 80.0 * 1e-3 * np.sqrt((share**2).mean())
    noise = found.errors.noise[0, 2]
    # The mean square over all nodes of 32 fields has some 8,000 terms.
    assert np.sqrt((noise**2).mean()) == pytest.approx(wanted, rel=0.03)
    # Each node has the spread 1 / sqrt(64).
    assert np.abs(noise / wanted - 1).max() < 0.6


def test_noise_of_a_nye_field():
    """sigma of alpha itself: as one error estimates it, so scatter stresses of noisy fields."""
    box = Box.of_bounds([0, 0, 0], [4, 4, 4])
    fields = np.random.default_rng(3).normal(size=(40, 3, 3, 8, 8, 8)) * 1e-3
    fields -= fields.mean(axis=(3, 4, 5), keepdims=True)
    scatter = np.sqrt(
        np.mean([stresses(NyeField(x, box), STEEL).stress ** 2 for x in fields], axis=0)
    )
    found = stresses(NyeField(np.zeros((3, 3, 8, 8, 8)), box, sigma=1e-3), STEEL)
    ratio = np.sqrt((found.errors.noise**2).mean() / (scatter**2).mean())
    assert ratio == pytest.approx(1, abs=0.05)
    assert found.energy_error > 0


def test_correlated_components():
    """Two columns with equal noise: their covariance counts, not only the variances."""
    frame = measured(0.0, given=1e-4)
    n = frame.coframe.shape[0] * 2
    covariance = np.full((n, n), 0.0)
    np.fill_diagonal(covariance, 1e-8)
    alone = SampledFrame(AXES, frame.coframe[:, :2], covariance=covariance, unit="um")
    joined = SampledFrame(AXES, frame.coframe[:, :2], covariance=covariance * 0 + 1e-8, unit="um")
    wanted, found = (
        stresses(NyeField.of_frame(f).padded(8).balanced(), STEEL).errors.noise
        for f in (alone, joined)
    )
    again = stresses(
        NyeField.of_frame(SampledFrame(AXES, frame.coframe[:, :2], sigma=1e-4, unit="um"))
        .padded(8).balanced(), STEEL,
    ).errors.noise  # fmt: skip
    np.testing.assert_array_equal(wanted, again)
    assert not np.allclose(found, wanted, rtol=0.1, equal_nan=True)


def test_without_noise_and_border_the_error_is_of_the_grid():
    """Lines and perfect crystals have no noise; a perfect crystal has no error."""
    errors = stresses(EDGES, STEEL, shape=32).errors
    assert not errors.noise.any()
    assert not errors.outside.any()
    perfect = stresses(NyeField(np.zeros((3, 3, 8, 8, 1)), OPEN).padded(4), STEEL)
    assert (perfect.error, perfect.energy_error) == (0.0, 0.0)
    assert isinstance(perfect.errors, StressErrors)


def test_forces_on_lines_in_a_measured_field():
    """The force of one edge on another: sigma_xx b of Hirth and Lothe, (3-43), within the error."""
    alpha = np.zeros((3, 3, 32, 32, 1))
    alpha[0, 2, 16, 16] = 0.01
    box = Box.of_bounds([0, 0, 0], [32, 32, 1], (False, False, True))
    field = NyeField(alpha, box, "nm", sigma=2e-5).padded(32).balanced()
    found = stresses(field, STEEL, core=1.0)
    heights = np.array([-8.0, -6.0, 6.0, 8.0])
    places = [[16, 16 + y, 0] for y in heights]
    net = DislocationNetwork.of_arrays(
        LineArrays(places, [[k, k] for k in range(4)], [[1, 0, 0]] * 4, box, images=[[0, 0, 1]] * 4)
    )
    force, error = found.forces_on(net)
    wanted = 80 * 0.01 / (2 * np.pi * 0.7) / heights
    assert (np.abs(force[:, 1] - wanted) < 2 * error[:, 1]).all()
    assert (error[:, 1] < np.abs(wanted) / 5).all()
    np.testing.assert_allclose(force[:, 0], 0, atol=1e-9)
    # A point is sharper than a line with a core, and noisier.
    assert (found.errors_at(places).total[0, 0] > error[:, 1]).all()
    # Beyond the map nothing is known.
    outside = DislocationNetwork.of_arrays(
        LineArrays([[40, 16, 0]], [[0, 0]], [[1, 0, 0]], box, images=[[0, 0, 1]])
    )
    assert np.isnan(found.forces_on(outside)[1]).all()
    # A network acts on itself as `forces` reports.
    own = stresses(EDGES, STEEL, shape=32)
    np.testing.assert_array_equal(own.forces_on(EDGES)[0], own.forces)


def test_sigma_is_saved(tmp_path: Path):
    """A file holds the noise of each value."""
    field = NyeField.of_frame(measured(1e-4))
    field.save(tmp_path / "nye.npz")
    again = NyeField.read(tmp_path / "nye.npz")
    assert again.sigma is not None
    np.testing.assert_array_equal(again.sigma, field.sigma)
    assert stresses(again.padded(8).balanced(), STEEL).errors.noise[0, 0, 3, 3, 0] > 0


def test_equal_calls_give_equal_errors():
    """The random fields come from a fixed seed."""
    field = NyeField.of_frame(measured(1e-4)).padded(8).balanced()
    one, two = (stresses(field, STEEL).errors.total for _ in range(2))
    np.testing.assert_array_equal(one, two)


def test_incompatibility_and_gnd_density_cover_their_noise():
    """Shares of values within one and two errors, for a distortion without defects."""
    axes = [np.linspace(0, 1, 30)] * 2
    rng = np.random.default_rng(1)
    shares, inside = [], []
    for sigma in (1e-6, 1e-4, 1e-2):
        frame = SampledFrame.from_distortion(axes, sigma * rng.normal(size=(2, 2, 30, 30)),
                                             sigma=sigma)  # fmt: skip
        eta = frame.incompatibility
        shares.append([(np.abs(eta.values) <= k * eta.error).mean() for k in (1, 2)])
        density, floor = frame.gnd_density(1e-3)
        # rho of noise has the root mean square of its floor.
        inside.append(np.sqrt((density**2).mean() / (floor**2).mean()))
    # The error of the grid adds to the noise where two orders differ by chance.
    assert (np.array(shares) > [0.65, 0.93]).all()
    np.testing.assert_allclose(inside, 1, atol=0.1)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: NyeField(np.zeros((3, 3, 8, 8, 1)), OPEN, sigma=-1.0), GridError, "sigma"),
        (lambda: NyeField(np.zeros((3, 3, 8, 8, 1)), OPEN, sigma=np.nan), GridError, "sigma"),
        (lambda: NyeField(np.zeros((3, 3, 8, 8, 1)), OPEN, sigma=np.ones(2)), GridError, "shape"),
        (lambda: TRUTH.errors_at([[0, 0]]), GridError, "points"),
        (lambda: TRUTH.forces_on(DislocationNetwork.of_arrays(LineArrays(
            [[0, 0, 0], [1, 0, 0]], [[0, 1], [1, 0]], [[1, 0]] * 2))), NetworkError, "got 2"),
    ],
)  # fmt: skip
def test_refusals(call, error, words):
    """Noise that is not a standard deviation, and lines or points of another dimension."""
    with pytest.raises(error, match=words):
        call()
