"""Orientation map: tilt walls, variants, grains, circuits, and measured maps."""

import numpy as np
import pytest
from scipy.ndimage import correlate
from scipy.spatial.transform import Rotation

from geomtorsion.errors import OrientationError
from geomtorsion.loops import Loop
from geomtorsion.materials.maps import (
    LAUE_GROUPS,
    Circuit,
    OrientationMap,
    Phase,
    laue_group,
)
from tests.materials.maps.synthetic import NICKEL, bent, bunge, euler, noisy_wall, wall
from tests.materials.maps.test_map_files import ctf, write
from tests.real import real
from tests.rounding import ROUNDED


@pytest.mark.parametrize("degrees", [1, 5, 15])
def test_a_tilt_wall(degrees):
    """b / L = 2 sin(theta / 2), normal to the wall (Frank 1950), to rounding."""
    found = wall(degrees, (33, 40), 0.5, threshold=20, sigma=0).burgers(
        Circuit.rectangle((0, 10), 32, 20)
    )
    assert found.magnitude / 16 == pytest.approx(2 * np.sin(np.radians(degrees / 2)), rel=1e-12)
    # The lattice turns from x to y: b = L (e_y(right) - e_y(left)) points along +x.
    assert found.vector[0] > 0
    assert abs(found.vector[1:]).max() < 1e-12


def test_the_sense_of_b():
    """The side that is turned ahead has one more line: a count by hand of the integral of R dl."""
    angles = np.zeros((2, 2, 3))
    angles[:, 1, 0] = 2.0
    found = OrientationMap.from_euler(angles, 1.0, "-1", sigma=0).burgers(Circuit.square((0, 0), 1))
    g = bunge(angles)
    by_hand = (g[0, 0] + g[0, 1])[:, 0] + (g[0, 1] + g[1, 1])[:, 1]
    by_hand = by_hand - (g[1, 1] + g[1, 0])[:, 0] - (g[1, 0] + g[0, 0])[:, 1]
    assert found.vector == pytest.approx(by_hand / 2, abs=ROUNDED)


def test_noise_of_a_wall():
    """Noise of 0.5 degrees per axis and pixel leaves 1e-3 of b / L over 16 um, as reported."""
    shape, step, errors, told = (321, 12), 0.05, [], []
    for seed in range(60):
        angles = noisy_wall(5.0, shape, 0.5, seed)
        crystal = OrientationMap.from_euler(angles, step, "m-3m", threshold=20)
        found = crystal.burgers(Circuit.rectangle((0, 3), 320, 5))
        errors.append(found.vector - [16 * 2 * np.sin(np.radians(2.5)), 0, 0])
        told.append(found.noise)
    assert np.std(errors, axis=0)[0] / 16 < 1e-3
    scatter = np.sqrt((np.array(errors) ** 2).sum(axis=1).mean())
    assert np.mean(told) == pytest.approx(scatter, rel=0.2)
    assert np.std(told) < 0.1 * np.mean(told)


@pytest.mark.parametrize("name", LAUE_GROUPS)
def test_variants_do_not_matter(name):
    """With a random variant in each pixel, b in specimen axes is the same."""
    angles = bent((12, 14), 0.3)
    plain = OrientationMap.from_euler(angles, 1.0, "-1", sigma=0)
    group = laue_group(name)
    variants = Rotation.from_quat(np.roll(group.quaternions, -1, axis=1))
    chosen = np.random.default_rng(7).integers(len(variants), size=12 * 14)
    turned = Rotation.from_euler("ZXZ", angles.reshape(-1, 3), degrees=True) * variants[chosen]
    mixed = OrientationMap.from_euler(euler(turned, (12, 14)), 1.0, name, sigma=0)
    assert mixed.grains.count == 1
    circuit = Circuit.square((2, 3), 7)
    one, other = plain.burgers(circuit), mixed.burgers(circuit)
    assert other.specimen == pytest.approx(one.specimen, abs=1e-12)
    images = Rotation.from_quat(np.roll(group.quaternions, -1, axis=1)).apply(one.vector)
    assert abs(images - other.vector).max(axis=1).min() < 1e-12
    assert one.magnitude > 1e-3


def test_a_loop_is_the_sum_of_its_cells():
    """b of squares, other shapes and the whole map is the sum over their cells, to 1e-12."""
    crystal = OrientationMap.from_euler(bent((40, 50), 0.05), 0.5, "m-3m", sigma=0)
    cells = crystal.burgers_map(1).vectors.T
    for n in (2, 7, 39):
        squares = crystal.burgers_map(n).vectors.T
        sums = sum(
            cells[i : i + squares.shape[0], j : j + squares.shape[1]]
            for i in range(n)
            for j in range(n)
        )
        assert abs(squares - sums).max() < 1e-12
        assert crystal.burgers(Circuit.square((0, 0), n)).vector == pytest.approx(
            squares[0, 0], abs=1e-12
        )
    inside = np.random.default_rng(1).random((39, 49)) < 0.5
    found = crystal.burgers(Circuit.of_cells(inside))
    assert found.vector == pytest.approx(cells[inside].sum(axis=0), abs=1e-12)
    assert found.area == pytest.approx(inside.sum() / 4)


def test_density_of_a_bent_crystal():
    """Bending kappa about z along x: b per area is kappa along x (Nye 1953)."""
    angles = np.zeros((5, 101, 3))
    angles[..., 0] = 0.01 * np.arange(101)
    crystal = OrientationMap.from_euler(angles, 0.1, "m-3m", sigma=0)
    found = crystal.burgers_map(4)
    assert found.per_area == pytest.approx(np.radians(0.1), rel=1e-6)
    assert found.arrows is not None
    assert found.arrows[:, 50, 0] / found.area == pytest.approx([np.radians(0.1), 0], abs=1e-5)


def test_sign_of_the_weighted_burgers_vector():
    """The stencil with which MTEX sums around a pixel, rewritten in specimen axes: the same sign.

    Wheeler et al. (2009), as in weightedBurgersVec with its integral method.
    """
    angles = bent((9, 9), 0.2)
    g = bunge(angles)
    half = 2
    along = np.zeros((2 * half + 1, 2 * half + 1))
    along[:, 0], along[:, -1] = -1, 1
    along[[0, -1], :] /= 2
    total = np.stack(
        [
            correlate(g[..., i, 1], along, mode="nearest")
            - correlate(g[..., i, 0], along.T, mode="nearest")
            for i in range(3)
        ],
        axis=-1,
    )
    crystal = OrientationMap.from_euler(angles, 1.0, "-1", sigma=0)
    assert crystal.burgers_map(4).vectors[:, 2, 2] == pytest.approx(total[4, 4], abs=1e-13)


def test_the_cochain_closes_as_circuits_do():
    """The steps form a cochain: a chain around a circuit has the circuit's Burgers vector."""
    crystal = OrientationMap.from_euler(bent((6, 7), 0.2), 1.0, "m-3m", sigma=0)
    ring = [(1, 1), (1, 2), (1, 3), (2, 3), (3, 3), (3, 2), (3, 1), (2, 1)]
    found = crystal.cochain.around([7 * r + c for r, c in ring])
    assert found.vector == pytest.approx(
        crystal.burgers(Circuit.square((1, 1), 2)).vector, abs=ROUNDED
    )


def two_grains():
    """A boundary of 30 degrees between columns 4 and 5, and a hole at (2, 2)."""
    angles = np.zeros((8, 10, 3))
    angles[:, 5:, 0] = 30
    angles[2, 2] = np.nan
    return OrientationMap.from_euler(angles, 1.0, "m-3m", sigma=0)


def test_boundaries_are_not_crossed():
    """The message names pixels and grains, and the remedy."""
    crystal = two_grains()
    assert crystal.grains.count == 2
    assert crystal.grain[2, 2] == -1
    with pytest.raises(
        OrientationError, match=r"\(3, 4\) is in grain 0, \(3, 5\) in grain 1.*threshold"
    ):
        crystal.burgers(Circuit.square((3, 3), 3))
    with pytest.raises(OrientationError, match=r"pixel \(2, 2\) has no orientation"):
        crystal.burgers(Circuit.square((2, 1), 2))
    # A circuit around the hole is accepted.
    assert crystal.burgers(Circuit.square((1, 1), 2)).magnitude < 1e-12
    clean = crystal.burgers_map(2).known.T
    assert clean.shape == (6, 8)
    assert not clean[:, 3:5].any()
    assert clean[:, 5:].all()
    hit = [(0, 1), (0, 2), (1, 2), (2, 2), (2, 1), (2, 0), (1, 0), (0, 0)]
    assert not any(clean[r, c] for r, c in hit)
    assert clean[1, 1]


def test_a_wall_within_a_grain_is_a_boundary():
    """A step above the threshold is not crossed, even if its pixels are joined elsewhere."""
    angles = np.zeros((40, 40, 3))
    rows, columns = np.indices((40, 40))
    # A wall that grows from zero by 0.5 degrees per row.
    angles[..., 0] = np.where(columns < 20, 0, np.minimum(rows * 0.5, 15))
    crystal = OrientationMap.from_euler(angles, 1.0, "-1", sigma=0)
    assert crystal.grains.count == 1
    with pytest.raises(
        OrientationError, match=r"from \(30, 19\) to \(30, 20\) the lattice of grain 0"
    ):
        crystal.burgers(Circuit.square((30, 18), 4))


def test_phases_are_apart():
    """Pixels of two phases never join, even with equal orientations."""
    phase = np.ones((4, 6), dtype=int)
    phase[:, 3:] = 2
    q = np.zeros((4, 6, 4))
    q[..., 0] = 1
    crystal = OrientationMap(q, phase, {1: NICKEL, 2: Phase("other", "6/mmm")}, sigma=0)
    assert crystal.grains.count == 2
    assert crystal.burgers(Circuit.square((0, 3), 2)).phase.name == "other"


def test_circuits_of_loops():
    """A loop in coordinates becomes cells; its b is the bend times its area."""
    angles = np.zeros((60, 60, 3))
    angles[..., 0] = 0.01 * np.arange(60)
    crystal = OrientationMap.from_euler(angles, 0.5, "m-3m", sigma=0)
    circle = crystal.burgers(Loop.circle([15, 14], 8))
    assert circle.area == pytest.approx(np.pi * 64, rel=0.01)
    assert circle.magnitude == pytest.approx(np.radians(0.02) * circle.area, rel=1e-6)
    twice = crystal.burgers(Loop.circle([15, 14], 8).times(-2))
    assert twice.vector == pytest.approx(-2 * circle.vector)
    box = crystal.burgers(Loop.polygon([[1, 1], [4, 1], [4, 3], [1, 3]]))
    assert box.vector == pytest.approx(crystal.burgers(Circuit.rectangle((2, 2), 4, 6)).vector)
    with pytest.raises(OrientationError, match="leaves the map, which extends"):
        crystal.burgers(Loop.circle([15, 14], 20))
    with pytest.raises(OrientationError, match="expected a loop around the middle of a cell"):
        crystal.burgers(Loop.circle([15, 14], 0.1))


def test_hexagonal_grids():
    """A crystal on a hexagonal grid has the density of the same crystal on a square grid."""
    rows, columns = np.indices((30, 40))
    x = columns + 0.5 * (rows % 2)
    turns = np.zeros((30, 40, 3))
    turns[..., 2] = 0.02 * x
    q = np.roll(Rotation.from_rotvec(turns.reshape(-1, 3), degrees=True).as_quat(), 1, axis=1)
    crystal = OrientationMap(
        q.reshape(30, 40, 4), np.ones((30, 40)), {1: NICKEL}, (1.0, 0.75**0.5), 0.5, sigma=0
    )
    for n in (4, 5):
        assert crystal.burgers_map(n).per_area == pytest.approx(np.radians(0.02), rel=1e-5)
    circle = crystal.burgers(Loop.circle([20, 12], 7))
    assert circle.area == pytest.approx(np.pi * 49, rel=0.03)
    assert circle.magnitude == pytest.approx(np.radians(0.02) * circle.area, rel=1e-5)


def curved(shape, shift, bend):
    """Rotations about a tilted axis, by an angle that grows with the third power."""
    rows, columns = np.indices(shape)
    height = 0.75**0.5 if shift else 1.0
    x, y = columns + shift * (rows % 2), height * rows
    angle = bend * (x**3 - 40 * x**2 + 5 * x * y + y**3 / 2)
    turns = angle[..., None] * np.array([0.36, 0.48, 0.8])
    q = np.roll(Rotation.from_rotvec(turns.reshape(-1, 3)).as_quat(), 1, axis=1)
    return q.reshape(*shape, 4), height


@pytest.mark.parametrize("shift", [0.0, 0.5, -0.5])
def test_the_error_of_trapezoids_is_reported(shift):
    """The reported error of trapezoids is their difference from Gauss quadrature, without noise."""
    q, height = curved((30, 40), shift, 1e-5)
    phases = {1: NICKEL}
    crystal = OrientationMap(q, np.ones((30, 40)), phases, (1.0, height), shift, sigma=0)
    for circuit in (Circuit.rectangle((4, 3), 12, 20), Circuit.rectangle((0, 0), 29, 10)):
        found = crystal.burgers(circuit)
        chain, _ = crystal._grid.chain(circuit)
        fine = found.vector * 0

        def turn(x, y):
            angle = 1e-5 * (x**3 - 40 * x**2 + 5 * x * y + y**3 / 2)
            axis = np.array([0.36, 0.48, 0.8])
            return Rotation.from_rotvec(angle[..., None] * axis).inv().as_matrix()

        places = [crystal._grid.places(pixels) for pixels in (chain.starts, chain.ends)]
        nodes, weights = np.polynomial.legendre.leggauss(4)
        for node, weight in zip((nodes + 1) / 2, weights / 2, strict=True):
            at = places[0] + node * (places[1] - places[0])
            e = turn(*at.T)[..., :2]
            each = np.einsum("kij,kj->ki", e, places[1] - places[0])
            fine = fine + weight * chain.times @ each
        away = np.linalg.norm(found.vector - fine)
        assert away > 1e-5
        assert found.systematic_error == pytest.approx(away, rel=0.1)
        assert found.error == found.systematic_error
    squares = crystal.burgers_map(12)
    one = crystal.burgers(Circuit.square((4, 3), 12))
    assert squares.systematic_error[3, 4] == pytest.approx(one.systematic_error, rel=1e-9)
    assert squares.errors[3, 4] == pytest.approx(one.error, rel=1e-9)
    assert np.isfinite(squares.systematic_error[squares.known]).all()


def test_noise_adds_nothing_to_the_trapezoid_error():
    """With given noise the trapezoid error is small, and both errors are reported separately."""
    rng = np.random.default_rng(2)
    turns = np.radians(0.3) * rng.standard_normal((900, 3))
    q = np.roll(Rotation.from_rotvec(turns).as_quat(), 1, axis=1).reshape(30, 30, 4)
    found = OrientationMap(q, np.ones((30, 30)), {1: NICKEL}, sigma=0.3).burgers_map(6)
    assert np.median(found.systematic_error) < 0.2 * found.noise[0, 0]
    assert found.errors == pytest.approx(np.hypot(found.noise, found.systematic_error))
    assert np.median(found.significance) == pytest.approx(np.sqrt(3), rel=0.2)


def test_edges_of_grains_add_no_error():
    """At grain edges the bend of one side serves for both, so the trapezoid error is unchanged."""
    q, _ = curved((12, 30), 0.0, 1e-5)
    split = Rotation.from_euler("ZXZ", [20, 20, 0], degrees=True) * Rotation.from_quat(
        np.roll(q[:, 15:].reshape(-1, 4), -1, axis=1)
    )
    two = q.copy()
    two[:, 15:] = np.roll(split.as_quat(), 1, axis=1).reshape(12, 15, 4)
    whole = OrientationMap(q, np.ones((12, 30)), {1: NICKEL}, sigma=0)
    halves = OrientationMap(two, np.ones((12, 30)), {1: NICKEL}, sigma=0)
    circuit = Circuit.rectangle((2, 2), 8, 12)
    error = whole.burgers(circuit).systematic_error
    assert halves.burgers(circuit).systematic_error == pytest.approx(error, rel=0.1)


def test_a_grain_as_a_sampled_frame():
    """Both have the same squares, and neither crosses the boundary."""
    angles = bent((12, 15), 0.1)
    angles[:, 9:, 0] += 30
    crystal = OrientationMap.from_euler(angles, 0.5, "m-3m", sigma=0)
    frame = crystal.frame(0)
    ours, theirs = crystal.burgers_map(4), frame.burgers_map(4)
    inside = ours.known & (crystal.grain[:-4, :-4].T == 0)
    assert inside[:5].all()
    assert theirs.vectors[:, inside] == pytest.approx(ours.vectors[:, inside], abs=1e-13)
    assert np.isnan(theirs.vectors[:, 5:8]).all()
    with pytest.raises(OrientationError, match="grain: expected a whole number from 0 to 1"):
        crystal.frame(2)


@pytest.mark.parametrize("shift", [0.5, -0.5])
def test_every_circuit_of_a_hexagonal_map(shift):
    """Noise and interpolation errors, from even and odd rows, agree with single circuits."""
    q, height = curved((12, 14), shift, 1e-5)
    crystal = OrientationMap(
        q, np.ones((12, 14)), {1: NICKEL}, (1.0, height), shift, sigma=(0.01, 0.05, 0.02)
    )
    found = crystal.burgers_map(3)
    for place in ((4, 6), (5, 6)):
        one = crystal.burgers(Circuit.square(place, 3))
        assert found.noise[place[::-1]] == pytest.approx(one.noise, rel=1e-12)
        assert found.significance[place[::-1]] == pytest.approx(one.significance, rel=1e-9)
        assert found.systematic_error[place[::-1]] == pytest.approx(one.systematic_error, rel=1e-9)


def test_where_a_hexagonal_map_begins_and_ends():
    """With shift -1/2 odd rows start and end before even rows; a shift of 1/4 is refused."""
    q, height = curved((12, 14), -0.5, 1e-5)
    crystal = OrientationMap(q, np.ones((12, 14)), {1: NICKEL}, (1.0, height), -0.5, sigma=0)
    assert len(crystal.circuit(Loop.polygon([[-0.4, 0], [3, 0], [3, 3], [-0.4, 3]])).starts) > 8
    with pytest.raises(OrientationError, match=r"from \(-0.5, 0\) to \(13, "):
        crystal.circuit(Loop.polygon([[10, 0], [13.4, 0], [13.4, 3], [10, 3]]))
    with pytest.raises(
        OrientationError, match="shift: expected 0, or 1/2 or -1/2 for hexagonal grids, got"
    ):
        OrientationMap(q, np.ones((12, 14)), {1: NICKEL}, (1.0, height), 0.25, sigma=0)


def test_parts_of_a_circuit_in_several_grains():
    """Crystals of different orientation have no common Burgers vector, even if no step crosses."""
    angles = bent((4, 8), 0.1)
    angles[:, 4:, 0] += 30
    crystal = OrientationMap.from_euler(angles, 1.0, NICKEL, sigma=0)
    with pytest.raises(
        OrientationError, match="expected a circuit in one grain, got parts in grains 0, 1"
    ):
        crystal.burgers(Circuit.of_cells([[1, 0, 0, 0, 0, 1]]))
    two = crystal.burgers(Circuit.of_cells([[1, 0, 1]]))
    one, other = (crystal.burgers(Circuit.square((0, k), 1)) for k in (0, 2))
    assert two.vector == pytest.approx(one.vector + other.vector, rel=1e-9)


def test_axes_of_the_angles(tmp_path):
    """The angles may refer to other axes than the map: e = g times the rotation between them."""
    angles = bent((5, 6), 0.3)
    path = write(tmp_path, ctf(angles), "a.ctf")
    turn = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    found = OrientationMap.read(path, axes=turn, sigma=0)
    assert found.coframe == pytest.approx((bunge(angles) @ turn)[..., :2], abs=1e-10)
    with pytest.raises(OrientationError, match="axes: "):
        OrientationMap.read(path, axes=np.eye(3) * 2)


def test_silicon():
    """A wafer without dislocations: noise falls with the size, and sigma is its scatter."""
    wafer = OrientationMap.read(real("ebsd/si_wafer.ctf"))
    assert wafer.grains.count == 1
    published = {2: 3.4e-4, 4: 1.3e-4, 8: 5.5e-5, 16: 2.1e-5, 30: 1.7e-5}
    for size, expected in published.items():
        found = wafer.burgers_map(size)
        assert found.known.all()
        assert np.median(found.per_area) == pytest.approx(expected, rel=0.15)
    eight = wafer.burgers_map(8)
    assert np.median(eight.per_area) < 6e-5
    scatter = np.sqrt((eight.magnitude**2).mean())
    assert eight.noise == pytest.approx(scatter, rel=0.2)
    assert wafer.burgers(Circuit.square((3, 5), 8)).noise == pytest.approx(eight.noise[5, 3])


def test_steel():
    """144 grains at 3 degrees; the circuits of each large grain agree with single circuits."""
    steel = OrientationMap.read(real("ebsd/sdss_ferrite_austenite.ang"), threshold=3)
    assert steel.grains.count == 144
    found = steel.burgers_map(5)
    corners = steel.grain[:-5, :-5]
    sizes = np.bincount(steel.grain[steel.grain >= 0].ravel())
    large = np.flatnonzero(sizes >= 100)
    assert len(large) > 30
    done = 0
    for grain in large:
        for r, c in np.argwhere(found.known.T & (corners == grain)):
            b = steel.burgers(Circuit.square((r, c), 5))
            assert b.grain == grain
            assert b.vector == pytest.approx(found.vectors[:, c, r], abs=1e-11)
            done += 1
    assert done > 1000
    assert done > 0.9 * found.known.sum()
    # Circuits that the map marks as unknown raise an error with the reason.
    for r, c in np.argwhere(~found.known.T)[::200]:
        with pytest.raises(OrientationError, match="crosses a boundary"):
            steel.burgers(Circuit.square((r, c), 5))


BAD = {
    "quaternions: expected shape": {"quaternions": np.zeros((3, 3))},
    r"phase: expected shape \(3, 3\)": {"phase": np.ones((2, 2))},
    "phase: expected one of .1. for each pixel, got 7": {"phase": np.full((3, 3), 7)},
    "got 0 .no orientation. for all": {"phase": np.zeros((3, 3))},
    r"finite numbers, not all 0, got .* at pixel \(1, 2\)": {"hole": (1, 2)},
    "steps: expected a positive number": {"steps": (1.0, 0.0)},
    "threshold: expected a positive number": {"threshold": -1},
    "sigma: expected standard deviations of 0 or more, got -0.1": {"sigma": -0.1},
    "sigma: expected 3 numbers": {"sigma": [0.1, 0.2]},
    "unit: expected a known name, got 'inch'": {"unit": "inch"},
    "phase 1: expected a Phase": {"phases": {1: "m-3m"}},
}


@pytest.mark.parametrize("message", sorted(BAD))
def test_bad_maps_are_refused(message):
    """Each message names the expected and the given value."""
    q = np.zeros((3, 3, 4))
    q[..., 0] = 1
    more = dict(BAD[message])
    if "hole" in more:
        q[more.pop("hole")] = np.nan
    given = {"quaternions": q, "phase": np.ones((3, 3)), "phases": {1: NICKEL}} | more
    with pytest.raises(OrientationError, match=message):
        OrientationMap(**given)


def test_sizes_and_places_are_checked():
    """Circuits larger than the map or outside it, and maps too small for a noise estimate, fail."""
    crystal = two_grains()
    with pytest.raises(OrientationError, match="size: expected a whole number from 1 to 7"):
        crystal.burgers_map(8)
    with pytest.raises(OrientationError, match=r"the map of 8 x 10 pixels, got \(9, "):
        crystal.burgers(Circuit.square((6, 0), 3))
    with pytest.raises(OrientationError, match="sigma: expected 7 adjacent pixels"):
        OrientationMap.from_euler(np.zeros((3, 3, 3)), 1.0, "m-3m").burgers(
            Circuit.square((0, 0), 1)
        )
