"""Curvature: bent crystals of known dislocation density, on both kinds of grids, with noise."""

import numpy as np
import pytest

from geomtorsion.errors import OrientationError
from geomtorsion.loops import Loop
from geomtorsion.materials.maps import OrientationMap, Phase
from geomtorsion.materials.maps.curvature import curvature_of
from geomtorsion.rigid.attitude import product, quaternion_from_rotation_vector
from tests.real import real

RATE, STEP = 3e-3, 0.5
STEEL = Phase("steel", "m-3m", (2.87, 2.87, 2.87))
BASE = quaternion_from_rotation_vector([0.3, -0.7, 0.4])


def bent(kappa: np.ndarray, shift: float = 0.0, shape=(9, 11), noise: float = 0.0):
    """A map that rotates by kappa_ij x_j (small angles), starting from a general orientation."""
    rows, columns = np.indices(shape)
    x = STEP * (columns + shift * (rows % 2)) - 2.0
    y = STEP * rows - 2.0
    theta = np.stack([x, y], axis=-1) @ kappa.T
    theta = theta + noise * np.random.default_rng(0).normal(size=theta.shape)
    q = product(quaternion_from_rotation_vector(theta), np.broadcast_to(BASE, (*shape, 4)))
    return OrientationMap(
        q, np.ones(shape, dtype=int), {1: STEEL}, (STEP, STEP), shift,
        sigma=float(np.degrees(noise)),
    )  # fmt: skip


@pytest.mark.parametrize("shift", [0.0, 0.5, -0.5])
@pytest.mark.parametrize("component", range(6))
def test_a_bent_crystal(component: int, shift: float):
    """Each component of the curvature is found at all inner pixels, with its Nye tensor."""
    kappa = np.zeros((3, 2))
    kappa.ravel()[component] = RATE
    made = bent(kappa, shift)
    inner = made.curvature.tensor[1:-1, 1:-1]
    assert inner == pytest.approx(np.broadcast_to(kappa, inner.shape), abs=1e-9)
    full = np.zeros((3, 3))
    full[:, :2] = kappa
    alpha = full.T - np.trace(full) * np.eye(3)
    nye = made.curvature.nye[4, 5]
    known = np.array([[0, 1, 1], [1, 0, 1], [0, 0, 1]], dtype=bool)
    assert nye[known] == pytest.approx(alpha[known], abs=1e-9)
    assert np.isnan(nye[~known]).all()
    density, floor = made.gnd_density(0.25e-3)
    assert density[4, 5] == pytest.approx(RATE / 0.25e-3, rel=1e-6)
    assert (floor[1:-1, 1:-1] == 0).all()
    assert np.isfinite(density).all()


def test_quaternions_of_either_sign_are_one_orientation():
    """q and -q are the same rotation: a map of mixed signs has the curvature of the map."""
    made = bent(np.array([[0, RATE], [RATE, 0], [RATE, RATE]]))
    mixed = made.quaternions * np.random.default_rng(1).choice([-1, 1], size=(9, 11, 1))
    grain = np.zeros((9, 11), dtype=int)
    found = [
        curvature_of(q, grain, (STEP, STEP), 0.0, 0.1, "um").tensor
        for q in (made.quaternions, mixed)
    ]
    assert found[1] == pytest.approx(found[0], abs=1e-12)
    assert np.abs(found[0]).max() == pytest.approx(RATE, rel=0.01)


def test_the_density_of_a_known_bend():
    """About y along x by 0.02 degrees per um, b = 0.25 nm: 1.396 per um^2, unseen by `frame`."""
    made = bent(np.array([[0, 0], [np.radians(0.02), 0], [0, 0]]))
    density, _ = made.gnd_density(0.25e-3)
    assert density == pytest.approx(np.full(density.shape, 1.396), abs=5e-4)
    assert made.frame(0).gnd_density(0.25e-3)[0].max() < 1e-2


def test_the_nye_tensor_agrees_with_the_coframe():
    """For lines across the map, curvature and the curl of the coframe agree to first order."""
    kappa = 1e-3 * np.array([[1.0, -2.0], [0.5, 3.0], [4.0, -1.5]])
    made = bent(kappa)
    crystal = made.frame(0).nye[:, 0, 5, 4]
    rotation = made.coframe[4, 5]
    third = np.cross(rotation[:, 0], rotation[:, 1])
    specimen = np.column_stack([rotation, third]).T @ crystal
    assert made.curvature.nye[4, 5, :, 2] == pytest.approx(specimen, rel=2e-2, abs=1e-5)


def test_a_straight_crystal_reaches_the_noise_level():
    """The root mean square of the density of a straight crystal is the reported floor."""
    made = bent(np.zeros((3, 2)), shape=(40, 50), noise=1e-3)
    density, floor = made.gnd_density(0.25e-3)
    inner = (slice(1, -1), slice(1, -1))
    rms = np.sqrt((density[inner] ** 2).mean())
    assert rms == pytest.approx(floor[inner].mean(), rel=0.05)
    assert floor[0, 0] > 1.9 * floor[5, 5]


def test_walls_add_no_curvature():
    """Neighbours across a wall do not count; a pixel without any neighbour has no density."""
    angles = np.zeros((5, 6, 3))
    angles[:, 3:, 0] = 20.0
    angles[2, 1] = np.nan
    made = OrientationMap.from_euler(angles, 1.0, "m-3m", sigma=0)
    density, _ = made.gnd_density(1e-3)
    known = np.isfinite(angles[..., 0])
    # Beside the gap, these two pixels have no neighbour along x: a surface and the wall.
    known[2, [0, 2]] = False
    assert (density[known] == 0).all()
    assert np.isnan(density[~known]).all()
    with pytest.raises(OrientationError, match="burgers"):
        made.gnd_density(-1)


def test_real_maps():
    """Grains print as one line; the silicon wafer is hardly bent."""
    made = OrientationMap.read(real("ebsd/si_wafer.ctf"))
    density, floor = made.gnd_density(0.384e-3)
    assert np.nanmedian(density) < 2 * np.nanmedian(floor)
    assert repr(made.grains).count("\n") == 0
    assert "grains in 1,680 of 1,680 pixels" in repr(made.grains)
    steel = OrientationMap.read(real("ebsd/sdss_ferrite_austenite.ang"))
    assert len(repr(steel.grains)) < 100


def sheared(shift: float, shape: tuple[int, int], noise: float = 0.0) -> OrientationMap:
    """A crystal with a curved bend: the same field on square and hexagonal grids."""
    rows, columns = np.indices(shape)
    x, y = STEP * (columns + shift * (rows % 2)), STEP * rows
    wave = 2e-3 * np.sin(x / 4) * np.cos(y / 5)
    theta = np.stack([wave, 1e-3 * x * y / 20, 2e-3 * np.cos(x / 5 + y / 4)], axis=-1)
    theta = theta + noise * np.random.default_rng(3).normal(size=theta.shape)
    q = product(quaternion_from_rotation_vector(theta), np.broadcast_to(BASE, (*shape, 4)))
    return OrientationMap(
        q, np.ones(shape, dtype=int), {1: STEEL}, (STEP, STEP), shift,
        sigma=float(np.degrees(noise)),
    )  # fmt: skip


@pytest.mark.parametrize("shift", [0.5, -0.5])
def test_a_hexagonal_map_agrees_with_a_square_map(shift: float):
    """Nye tensor and density of one field, at the pixels of even rows that both grids have."""
    square, hexagonal = (sheared(one, (25, 30)) for one in (0.0, shift))
    inner = (slice(2, -2, 2), slice(2, -2))
    one, two = (made.curvature.nye[inner] for made in (square, hexagonal))
    known = np.isfinite(one)
    assert (np.isfinite(two) == known).all()
    size = np.abs(one[known]).max()
    assert two[known] == pytest.approx(one[known], abs=0.02 * size)
    densities = [made.gnd_density(0.25e-3)[0][inner] for made in (square, hexagonal)]
    assert densities[1] == pytest.approx(densities[0], abs=0.02 * densities[0].max())


@pytest.mark.parametrize("shift", [0.5, -0.5])
def test_the_frame_of_a_hexagonal_grain(shift: float):
    """Nye tensor and circuits of the interpolated frame agree with a square map of one field."""
    square, hexagonal = (sheared(one, (25, 32)) for one in (0.0, shift))
    frames = square.frame(0, 4), hexagonal.frame(0, 4)
    assert frames[1].axes[0][0] == STEP * (1 + shift / 2)
    loop = Loop.circle([7.5, 6], 3.3)
    one, two = (frame.burgers(loop) for frame in frames)
    assert np.abs(one.vector).max() > 100 * (one.error + two.error)
    assert np.abs(one.vector - two.vector).max() < 3 * (one.error + two.error)
    one, two = (frame.nye[:, 0, 3:-3, 12] for frame in frames)
    places = [frame.axes[0][3:-3] for frame in frames]
    for row, expected in zip(two, one, strict=True):
        between = np.interp(places[1], places[0], expected)
        assert row[:-3] == pytest.approx(between[:-3], abs=0.02 * np.abs(one).max())


def test_noise_of_hexagonal_maps_is_the_reported_floor():
    """The root mean square of the density of a straight crystal, as on square grids."""
    made = bent(np.zeros((3, 2)), 0.5, shape=(40, 50), noise=1e-3)
    density, floor = made.gnd_density(0.25e-3)
    inner = (slice(1, -1), slice(1, -1))
    rms = np.sqrt((density[inner] ** 2).mean())
    assert rms == pytest.approx(floor[inner].mean(), rel=0.05)
    b = made.frame(0).burgers(Loop.circle([12, 10], 6))
    assert np.abs(b.vector).max() < 4 * b.noise
