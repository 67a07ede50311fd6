"""Stresses against closed forms: screws, edges, a wall, loops, the core of the gauge theory."""

import numpy as np
import pytest
import scipy

from geomtorsion import Box, DislocationNetwork, ElasticConstants, LineArrays, Loop, stresses

MU, NU = 1.3, 0.3
ISOTROPIC = ElasticConstants.isotropic(MU, NU)
COPPER = ElasticConstants.cubic(168.4, 121.4, 75.4, unit="GPa")


def pairs_of_rows(b, length: float, apart: float) -> DislocationNetwork:
    """A line along z at the origin and its opposite in the middle of the cell, all periodic."""
    box = Box.of_bounds([0, 0, 0], [length, apart, 1.0])
    places = [[0, 0, 0], [length / 2, 0, 0]]
    lines = LineArrays(places, [[0, 0], [1, 1]], [b, [-x for x in b]], box, images=[[0, 0, 1]] * 2)
    return DislocationNetwork.of_arrays(lines)


def summed(row, x: float, length: float) -> np.ndarray:
    """The stress of rows at 0 and opposite rows at half the length, with their images."""
    cells = length * np.arange(-8, 9)
    return np.sum([row(x - j) - row(x - length / 2 - j) for j in cells], axis=0)


def screws(x: float, y: float, b: float, mu: float, apart: float) -> np.ndarray:
    """sigma_xz, sigma_yz of a row of screws along y: mu b x / (2 pi r^2) summed over the row."""
    one, two = 2 * np.pi * x / apart, 2 * np.pi * y / apart
    below = np.cosh(one) - np.cos(two)
    return mu * b / (2 * apart) * np.array([-np.sin(two), np.sinh(one)]) / below


def edges(x: float, y: float, b: float, apart: float) -> np.ndarray:
    """sigma_xx, sigma_yy, sigma_xy of a wall of edges, b along x [Hirth, Lothe 1982, ch. 19]."""
    one, two = 2 * np.pi * x / apart, 2 * np.pi * y / apart
    below, size = np.cosh(one) - np.cos(two), MU * b / (2 * apart * (1 - NU))
    return size / below**2 * np.array([
        -np.sin(two) * (below + one * np.sinh(one)),
        -np.sin(two) * (below - one * np.sinh(one)),
        one * (np.cosh(one) * np.cos(two) - 1),
    ])  # fmt: skip


@pytest.mark.parametrize("constants", [ISOTROPIC, COPPER], ids=["isotropic", "copper"])
def test_rows_of_screws(constants):
    """Screws along a cube axis have the stress of the shear modulus c44, in any cubic crystal."""
    length, apart, b = 2.0, 1.0, 0.25
    net = pairs_of_rows((0, 0, b), length, apart)
    found = stresses(net, constants, shape=(128, 64, 1), core=0.035, convention="Hirth-Lothe")
    mu = constants.tensor[0, 2, 0, 2]
    points = np.array([[0.3, 0.2, 0.1], [0.25, 0.0, 0.7], [1.3, 0.4, 0.0], [0.8, 0.5, 0.5]])
    for (x, y, _), sigma in zip(points, found.at(points).T, strict=True):
        wanted = summed(lambda x, y=y: screws(x, y, b, mu, apart), x, length)
        # The cell has no mean stress; the rows have half of that between them.
        wanted = wanted - [0, mu * b / (2 * apart)]
        np.testing.assert_allclose([sigma[0, 2], sigma[1, 2]], wanted, rtol=0, atol=1e-8 * mu * b)
    rest = found.stress.copy()
    rest[[0, 1, 2, 2], [2, 2, 0, 1]] = 0
    assert np.abs(rest).max() < 1e-12 * found.largest


def test_near_a_screw():
    """Close to one screw its own stress remains: mu b / (2 pi r), in circles around it."""
    net = pairs_of_rows((0, 0, 1.0), 1.0, 1.0)
    found = stresses(net, ISOTROPIC, shape=256, core=0.008, convention="Hirth-Lothe")
    r, angle = 0.06, np.linspace(0, 2 * np.pi, 12, endpoint=False)
    ring = np.array([r * np.cos(angle), r * np.sin(angle), 0 * angle]).T
    sigma = found.at(ring)
    around = sigma[1, 2] * np.cos(angle) - sigma[0, 2] * np.sin(angle)
    assert around.mean() == pytest.approx(MU / (2 * np.pi * r), rel=1e-9)
    outward = sigma[0, 2] * np.cos(angle) + sigma[1, 2] * np.sin(angle)
    assert np.abs(outward).max() < 0.03 * around.mean()


def test_a_wall_of_edges():
    """All components of a wall of edge dislocations, in the limit of a narrow core."""
    length, apart, b = 6.0, 1.0, 1.0
    net = pairs_of_rows((b, 0, 0), length, apart)
    points = np.array([[0.375, 0.1, 0], [0.5, 0.15625, 0], [0.75, 0.4, 0]])
    values = [
        stresses(net, ISOTROPIC, shape=(768, 128, 1), core=core, convention="Hirth-Lothe").at(
            points
        )
        for core in (0.04, 0.04 / np.sqrt(2))
    ]
    # Outside the core a Gaussian changes a biharmonic field by a multiple of its width squared.
    limit = 2 * values[1] - values[0]
    for (x, y, _), sigma in zip(points, limit.T, strict=True):
        wanted = summed(lambda x, y=y: edges(x, y, b, apart), x, length)
        found = [sigma[0, 0], sigma[1, 1], sigma[0, 1]]
        np.testing.assert_allclose(found, wanted, rtol=0, atol=2e-9 * MU)
        assert sigma[2, 2] == pytest.approx(NU * (sigma[0, 0] + sigma[1, 1]), abs=1e-12)


def test_mises_stress_of_a_wall():
    """sqrt of half the squared differences of normal stresses and thrice the squared shears."""
    found = stresses(pairs_of_rows((1, 0, 0), 2.0, 1.0), ISOTROPIC, shape=(32, 16, 1))
    one, two, three = (found.stress[k, k] for k in range(3))
    shears = found.stress[0, 1] ** 2 + found.stress[1, 2] ** 2 + found.stress[0, 2] ** 2
    squares = ((one - two) ** 2 + (two - three) ** 2 + (three - one) ** 2) / 2 + 3 * shears
    np.testing.assert_allclose(found.mises, np.sqrt(squares), rtol=1e-9)
    assert np.abs(one + two + three).max() > 0.1 * found.largest


def test_half_plane_is_compressed():
    """b along x and the sense z in Hirth-Lothe: the extra half plane at y > 0 is compressed."""
    net = pairs_of_rows((1, 0, 0), 2.0, 2.0)
    found = stresses(net, ISOTROPIC, shape=64, convention="Hirth-Lothe")
    above, below = found.at([[0, 0.2, 0], [0, -0.2, 0]])[0, 0]
    assert above < 0 < below
    reversed_sign = stresses(net, ISOTROPIC, shape=64)
    np.testing.assert_array_equal(reversed_sign.stress, -found.stress)
    assert reversed_sign.energy == found.energy
    np.testing.assert_array_equal(reversed_sign.forces, found.forces)


def test_an_inserted_plane_is_compressed():
    """b . area is the inserted volume: the crystal presses on an inserted disc, pulls at a gap."""
    for b, sign in ((0.1, -1), (-0.1, 1)):
        net = polygon(0.25, (0, 0, b))
        assert np.sign(net.lines[0].burgers[2] * net.arrays.steps[0, 1]) == np.sign(b)
        middle = stresses(net, COPPER, shape=16).at([[0.5, 0.5, 0.5]])[..., 0]
        assert sign * middle[2, 2] > 5 * abs(middle[0, 1])


def polygon(radius: float, b, sides: int = 12) -> DislocationNetwork:
    """A regular polygon with the length of a circle, normal to z, in a unit cell."""
    angle = 2 * np.pi * np.arange(sides) / sides
    r = radius * np.pi / sides / np.sin(np.pi / sides)
    corners = np.array([0.5 + r * np.cos(angle), 0.5 + r * np.sin(angle), 0 * angle + 0.5]).T
    around = np.stack([np.arange(sides), (np.arange(sides) + 1) % sides], axis=1)
    box = Box.of_bounds([0, 0, 0], [1, 1, 1])
    return DislocationNetwork.of_arrays(LineArrays(corners, around, [b] * sides, box))


@pytest.mark.parametrize(
    ("b", "size"),
    [((0, 0, 1), 1 / (2 * (1 - NU))), ((1, 0, 0), (2 - NU) / (4 * (1 - NU)))],
    ids=["prismatic", "glide"],
)
def test_energy_of_loops(b, size):
    """W = size mu b^2 R (ln(R/w) + constant) [Hirth, Lothe 1982, (6-51), (6-52)].

    By its units W depends on ln(R/w); a change of the core w at one R leaves images as they are.
    A Gaussian core adds w^2 and w^2 ln w, which four cores separate.
    """
    radius, cores = 0.25, 0.032 * np.sqrt(2) ** np.arange(4)
    net = polygon(radius, b, sides=64)
    energies = [stresses(net, ISOTROPIC, shape=64, core=core).energy for core in cores]
    w = cores / radius
    columns = np.array([-np.log(w), w**0, w**2, w**2 * np.log(w)]).T
    found = np.linalg.solve(columns, energies)[0]
    assert found == pytest.approx(size * MU * radius, rel=1e-2)


def test_energy_of_a_small_loop():
    """A prismatic loop: the integral of its waves over all space, and images of order R^4.

    W = mu b^2 / (1 - nu) int (k_r / k)^4 |2 pi R J1(k_r R) / k_r|^2 exp(-k^2 w^2) d^3k / (2 pi)^3.
    """
    core = 0.04

    def single_loop(radius):
        def wave(across, along):
            k2 = across**2 + along**2
            disc = 2 * np.pi * radius * scipy.special.j1(across * radius) / across
            return across * across**4 / k2**2 * disc**2 * np.exp(-k2 * core**2) * 2

        most = 7 / core
        whole = scipy.integrate.dblquad(wave, 0, most, 1e-9, most, epsrel=1e-7)[0]
        return MU / (1 - NU) * whole / (2 * np.pi) ** 2

    rest = [
        stresses(polygon(r, (0, 0, 1), 64), ISOTROPIC, shape=50, core=core).energy - single_loop(r)
        for r in (0.08, 0.12)
    ]
    assert abs(rest[0]) < 0.01 * single_loop(0.08)
    assert rest[1] / rest[0] == pytest.approx(1.5**4, rel=0.15)


def test_core_of_the_gauge_theory():
    """The gauge theory takes mu b K1(r/l) / (2 pi l) off the stress of a screw [Lazar 2003]."""
    net, length = pairs_of_rows((0, 0, 1.0), 1.0, 1.0), 0.05
    radii = np.array([0.05, 0.1, 0.15])
    points = np.array([radii, 0 * radii, 0 * radii]).T
    parts = []
    for core in (0.008, 0.008 / np.sqrt(2)):
        options = {"shape": 384, "core": core, "convention": "Hirth-Lothe"}
        one, two = (stresses(net, ISOTROPIC, gauge=x, **options).at(points) for x in (0, length))
        parts.append((one - two)[1, 2])
    others = scipy.special.k1((0.5 - radii) / length) - scipy.special.k1((0.5 + radii) / length)
    wanted = MU / (2 * np.pi * length) * (scipy.special.k1(radii / length) + others)
    # The Gaussian that spreads the lines changes the result by a multiple of its width squared.
    np.testing.assert_allclose(2 * parts[1] - parts[0], wanted, rtol=3e-4)


def test_hexagonal_screw_along_c():
    """A screw along the axis of a hexagonal crystal has the stress of the modulus c44."""
    zinc = ElasticConstants.hexagonal(165, 31.1, 50, 61.8, 39.6)
    net = pairs_of_rows((0, 0, 1.0), 2.0, 1.0)
    found = stresses(net, zinc, shape=64)
    wanted = stresses(net, ElasticConstants.isotropic(39.6, 0.1), shape=64)
    np.testing.assert_allclose(found.stress, wanted.stress, rtol=0, atol=1e-12 * found.largest)


def test_cubic_constants_without_anisotropy_are_isotropic():
    """Cubic constants with c11 - c12 = 2 c44 give the isotropic stress, whatever the axes."""
    c12 = 2 * MU * NU / (1 - 2 * NU)
    rng = np.random.default_rng(0)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    cubic = ElasticConstants.cubic(c12 + 2 * MU, c12, MU).rotated(turn)
    one, two = (stresses(polygon(0.2, (1, 0, 1)), c, shape=24) for c in (cubic, ISOTROPIC))
    np.testing.assert_allclose(one.stress, two.stress, rtol=0, atol=1e-12 * two.largest)
    near = ElasticConstants.cubic(c12 + 2 * MU, c12, MU * 1.001)
    shifted = stresses(polygon(0.2, (1, 0, 1)), near, shape=24)
    assert 1e-4 < np.abs(shifted.stress - two.stress).max() / two.largest < 1e-2


def test_a_quarter_turn_of_everything():
    """Turning lines and crystal by 90 degrees turns the stress: no axis is special."""
    turn = np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0]])
    rng = np.random.default_rng(1)
    matrix = np.eye(6) * 3 + (lambda m: (m + m.T) / 10)(rng.normal(size=(6, 6)))
    constants = ElasticConstants(matrix)
    corners = np.array([[0.2, 0.3, 0.1], [0.6, 0.3, 0.4], [0.5, 0.7, 0.5]])
    around, b = [[0, 1], [1, 2], [2, 0]], np.array([0.3, -0.2, 0.5])
    box = Box.of_bounds([0, 0, 0], [1, 1, 1])
    one = DislocationNetwork.of_arrays(LineArrays(corners, around, [b] * 3, box))
    two = DislocationNetwork.of_arrays(LineArrays(corners @ turn.T, around, [turn @ b] * 3, box))
    points = rng.uniform(size=(5, 3))
    here = stresses(one, constants, shape=20).at(points)
    there = stresses(two, constants.rotated(turn), shape=20).at(points @ turn.T)
    np.testing.assert_allclose(there, np.einsum("ia,jb,abn->ijn", turn, turn, here), atol=1e-11)


def test_equilibrium_and_torsion_to_rounding():
    """The force density vanishes, and the curl of the result is the torsion of the lines."""
    net = polygon(0.25, (0.02, 0.0, 0.01))
    found = stresses(net, COPPER, shape=32)
    k = [2 * np.pi * np.fft.fftfreq(32, 1 / 32)] * 2 + [2 * np.pi * np.fft.rfftfreq(32, 1 / 32)]
    for axis in k:
        axis[np.abs(axis) >= 32 * np.pi] = 0
    waves = np.array(np.meshgrid(*k, indexing="ij"))

    def derivatives(field):
        every = np.fft.rfftn(field, axes=(-3, -2, -1))
        return np.fft.irfftn(1j * waves * every[..., None, :, :, :], s=(32,) * 3, axes=(-3, -2, -1))

    slopes = derivatives(found.stress)
    force = np.einsum("ijj...->i...", slopes)
    assert np.abs(force).max() < 1e-12 * np.abs(slopes).max()
    epsilon = np.zeros((3, 3, 3))
    epsilon[[0, 1, 2], [1, 2, 0], [2, 0, 1]], epsilon[[0, 2, 1], [2, 1, 0], [1, 0, 2]] = 1, -1
    curl = np.einsum("kab,iba...->ik...", epsilon, derivatives(found.distortion))
    # In the sense SF/RH the coframe is 1 - beta.
    assert np.abs(found.nye + curl).max() < 1e-12 * np.abs(curl).max()
    assert found.nye.mean(axis=(2, 3, 4)) == pytest.approx(np.zeros((3, 3)), abs=1e-12)


def test_circuits_give_b_back():
    """Circuits in the relaxed coframe measure b of the lines that they enclose."""
    b = [0.02, 0.0, 0.01]
    corners = np.array([[0.3, 0.3, 0.5], [0.7, 0.3, 0.5], [0.7, 0.7, 0.5], [0.3, 0.7, 0.5]])
    box = Box.of_bounds([0, 0, 0], [1, 1, 1])
    sides = [[0, 1], [1, 2], [2, 3], [3, 0]]
    net = DislocationNetwork.of_arrays(LineArrays(corners, sides, [b] * 4, box))
    frame = stresses(net, COPPER, shape=48, core=0.03).frame
    for centre in ([0.5, 0.3, 0.5], [0.5, 0.7, 0.5], [0.1, 0.2, 0.3]):
        loop = Loop.circle(centre, 0.19, plane=(1, 2))
        assert frame.burgers(loop).vector == pytest.approx(net.burgers(loop).vector, abs=1e-7)


def test_forces_are_minus_the_slope_of_the_energy():
    """A side of a loop moved by dy changes the energy by -force times length times dy."""
    sides, box = [[0, 1], [1, 2], [2, 3], [3, 0]], Box.of_bounds([0, 0, 0], [1, 1, 1])

    def relaxed(y, gauge):
        corners = [[0.3, y, 0.5], [0.7, y, 0.5], [0.7, 0.7, 0.5], [0.3, 0.7, 0.5]]
        lines = LineArrays(corners, sides, [[0.1, 0.02, 0.05]] * 4, box)
        net = DislocationNetwork.of_arrays(lines)
        return stresses(net, COPPER, shape=36, gauge=gauge)

    for gauge in (0.0, 0.05):
        slope = (relaxed(0.301, gauge).energy - relaxed(0.299, gauge).energy) / 0.002
        force = relaxed(0.3, gauge).forces[0, 1] * 0.4
        assert force == pytest.approx(-slope, rel=1e-5)


def test_a_load_pushes_by_peach_and_koehler():
    """A uniform stress adds (sigma b) x t, and its own strain; inner stresses stay."""
    net = polygon(0.2, (0.0, 0.0, 0.1), sides=12)
    load = np.array([[0, 0, 0.3], [0, 0, 0.1], [0.3, 0.1, 0.7]])
    free = stresses(net, COPPER, shape=16, convention="Hirth-Lothe")
    loaded = stresses(net, COPPER, shape=16, convention="Hirth-Lothe", mean_stress=load)
    np.testing.assert_allclose(loaded.stress.mean(axis=(2, 3, 4)), load, atol=1e-12)
    tangent = net.arrays.steps / net.arrays.lengths[:, None]
    wanted = np.cross(load @ [0.0, 0.0, 0.1], tangent)
    np.testing.assert_allclose(loaded.forces - free.forces, wanted, atol=1e-12)
    strain = COPPER.strain(load)
    assert loaded.energy - free.energy == pytest.approx((load * strain).sum() / 2)
