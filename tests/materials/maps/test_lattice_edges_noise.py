"""Noise: the estimate against known noise, with walls and anisotropy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from geomtorsion.materials.maps import Circuit, OrientationMap
from tests.materials.maps.synthetic import bent, euler


def test_the_covariance_is_found():
    """Anisotropic, correlated noise on a bent crystal with a wall is estimated within 10 %."""
    shape = (120, 120)
    put_in = np.array([[4.0, 1.5, 0], [1.5, 2.0, -0.5], [0, -0.5, 9.0]]) * 1e-6
    rng = np.random.default_rng(3)
    turns = rng.multivariate_normal(np.zeros(3), put_in, shape[0] * shape[1])
    wall = np.zeros((*shape, 3))
    wall[:, 60:, 2] = 3.0
    crystal = Rotation.from_rotvec(wall.reshape(-1, 3), degrees=True)
    crystal = crystal * Rotation.from_euler("ZXZ", bent(shape, 0.02).reshape(-1, 3), degrees=True)
    angles = euler(Rotation.from_rotvec(turns) * crystal, shape)
    found = OrientationMap.from_euler(angles, 1.0, "m-3m").noise[1]
    assert found == pytest.approx(put_in, abs=0.1 * np.sqrt(np.outer(*[np.diag(put_in)] * 2)).max())
    assert np.diag(found) == pytest.approx(np.diag(put_in), rel=0.1)


def test_a_perfect_map_has_no_noise():
    """An even bend has no noise."""
    found = OrientationMap.from_euler(bent((20, 20), 0.05), 1.0, "m-3m").noise[1]
    assert np.sqrt(found.trace()) < 1e-9


def test_given_noise():
    """One number, or three, in degrees."""
    angles = np.zeros((3, 3, 3))
    one = OrientationMap.from_euler(angles, 1.0, "m-3m", sigma=0.5).noise[1]
    assert one == pytest.approx(np.eye(3) * np.radians(0.5) ** 2)
    three = OrientationMap.from_euler(angles, 1.0, "m-3m", sigma=(1, 2, 3)).noise[1]
    assert np.sqrt(np.diag(three)) == pytest.approx(np.radians([1, 2, 3]))


def test_reported_covariance_is_the_scatter():
    """200 seeds of anisotropic noise: each component of b scatters as its reported covariance."""
    shape, found = (9, 9), []
    rng = np.random.default_rng(11)
    for _ in range(200):
        turns = rng.normal(0, np.radians([0.1, 0.2, 0.4]), (81, 3))
        angles = euler(Rotation.from_rotvec(turns), shape)
        crystal = OrientationMap.from_euler(angles, 1.0, "-1", sigma=(0.1, 0.2, 0.4))
        found.append(crystal.burgers(Circuit.square((1, 1), 6)).specimen)
    quiet = OrientationMap.from_euler(np.zeros((*shape, 3)), 1.0, "-1", sigma=(0.1, 0.2, 0.4))
    told = quiet.burgers(Circuit.square((1, 1), 6)).covariance
    assert np.sqrt(np.diag(told)) == pytest.approx(np.std(found, axis=0), rel=0.2)
    assert np.sqrt(told[2, 2]) < 0.7 * np.sqrt(told[0, 0])
