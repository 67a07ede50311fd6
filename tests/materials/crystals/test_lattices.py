"""Lattices: the decoder returns the nearest lattice vector, with opposite labels for v and -v. A
crystal has the lattice that most atoms fit; if none fits, the error names the known lattices."""

# b of a line is a tuple of numbers, exact or floating.
# pyright: reportArgumentType=false

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals import LATTICES, Crystal
from geomtorsion.materials.crystals.lattices import lattice_named
from geomtorsion.materials.lines import DislocationNetwork
from tests.materials.crystals.synthetic import block, quadrupole, stacked

OPEN = (False, False, False)
ROWS = arrays(float, (5, 3), elements=st.floats(-9, 9))


@pytest.mark.parametrize("name", LATTICES)
@given(values=ROWS)
def test_the_label_is_nearest(name, values):
    """No other nearby lattice vector is nearer."""
    lattice = LATTICES[name]
    found = lattice.decode(values)
    around = np.stack(np.meshgrid(*[range(-4, 5)] * 3), axis=-1).reshape(-1, 3)
    every = around @ lattice.translations
    apart = (((values[:, None] - found[:, None] - every) * lattice.units) ** 2).sum(axis=2)
    own = (((values - found) * lattice.units) ** 2).sum(axis=1)
    assert (own <= apart.min(axis=1) + 1e-12).all()
    whole = found @ np.linalg.inv(lattice.translations)
    assert whole == pytest.approx(np.rint(whole), abs=1e-9)


@pytest.mark.parametrize("name", LATTICES)
@given(values=arrays(float, (5, 3), elements=st.integers(-9, 9).map(lambda n: n / 2)))
def test_labels_are_odd_in_ties_too(name, values):
    """label(ji) = -label(ij), also for points equally far from several lattice vectors."""
    lattice = LATTICES[name]
    shift = np.array([1, -1, 0, 1, -1])
    assert (lattice.decode(-values) == -lattice.decode(values)).all()
    assert (lattice.decode(-values, -shift) == -lattice.decode(values, shift)).all()


def test_neighbours_and_volumes_agree_with_textbooks():
    """Number and distance of nearest neighbours, and atoms per cell, agree with textbooks."""
    nearest = {
        "fcc": (12, 0.5**0.5),
        "bcc": (8, 0.75**0.5),
        "hcp": (12, 1),
        "diamond": (4, 3**0.5 / 4),
        "hexagonal diamond": (4, 0.375**0.5),
    }
    for name, (count, distance) in nearest.items():
        lattice = LATTICES[name]
        for vectors in lattice.neighbours:
            sizes = np.linalg.norm(vectors * lattice.units, axis=1)
            assert sizes[:count] == pytest.approx(distance)
            assert (sizes[count:] > 1.1 * distance).all()
    per_cell = {name: 1 / LATTICES[name].atom_volume for name in ("fcc", "bcc", "diamond")}
    assert per_cell == pytest.approx({"fcc": 4, "bcc": 2, "diamond": 8})
    assert LATTICES["hcp"].atom_volume == pytest.approx(0.5**0.5)
    assert LATTICES["hexagonal diamond"].atom_volume == pytest.approx(0.5**0.5 / 2)


@pytest.mark.parametrize("name", LATTICES)
def test_neighbours_of_each_kind_are_all_near_sites(name):
    """By hand: the nearest sites around one site of each kind, and the kinds in `decode`."""
    lattice = LATTICES[name]
    around = np.stack(np.meshgrid(*[range(-3, 4)] * 3), axis=-1).reshape(-1, 3)
    net = around @ lattice.translations
    every = np.concatenate([net + place for place in lattice.offsets])
    kinds = np.repeat(np.arange(len(lattice.offsets)), len(net))
    for kind, vectors in enumerate(lattice.neighbours):
        steps = every - lattice.offsets[kind]
        near = np.linalg.norm(steps * lattice.units, axis=1).argsort()[1 : lattice.shells + 1]
        assert {tuple(v) for v in steps[near].tolist()} == {tuple(v) for v in vectors.tolist()}
        shift = lattice.shift(np.full(len(near), kind), kinds[near])
        assert (lattice.decode(steps[near] + 0.05, shift) == steps[near]).all()


def test_an_unknown_lattice_is_refused():
    """The message names the known lattices."""
    with pytest.raises(CrystalError, match="expected one of fcc, bcc, hcp, diamond, hex"):
        lattice_named("sc")


def cubic(basis, repeats, constant=1.0):
    """Atoms of a cubic cell with a basis, and the edges of the repeated cell."""
    cells = np.stack(np.meshgrid(*map(np.arange, repeats), indexing="ij"), axis=-1)
    places = (cells.reshape(-1, 1, 3) + np.array(basis)).reshape(-1, 3)
    return constant * places, constant * np.array(repeats, dtype=float)


def screws(places, cell, burgers):
    """Two opposite screws along z, with the fields of their nearest images, and the cell."""
    moved = places.copy()
    for share, sign in ((0.25, 1), (0.75, -1)):
        for m in range(-3, 4):
            for n in range(-3, 4):
                centre = np.array([share + m + 0.0131, 0.5077 + n]) * cell[:2]
                x, y = (places[:, :2] - centre).T
                moved[:, 2] += sign * burgers * np.arctan2(y, x) / (2 * np.pi)
    return moved, cell


def turned_cubic():
    """Simple cubic with z along [1 1 0], and the edges of its cell."""
    axes = np.array([[1, -1, 0], [0, 0, 1], [1, 1, 0]]) / np.sqrt([2, 1, 2])[:, None]
    sites, _ = cubic([[0, 0, 0]], (44, 44, 44))
    places, cell = (sites - 22) @ axes.T, np.sqrt([2, 1, 2]) * [12, 16, 3]
    return places[((places > -1e-6) & (places < cell - 1e-6)).all(axis=1)], cell


SIMPLE = [[0, 0, 0]]
PEROVSKITE = [[0, 0, 0], [0.5, 0.5, 0.5], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]]
A15 = [
    *([0, 0, 0], [0.5, 0.5, 0.5], [0.25, 0.5, 0], [0.75, 0.5, 0]),
    *([0, 0.25, 0.5], [0, 0.75, 0.5], [0.5, 0, 0.25], [0.5, 0, 0.75]),
]
FLUORITE = [
    *([0, 0, 0], [0, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0]),
    *([x, y, z] for x in (0.25, 0.75) for y in (0.25, 0.75) for z in (0.25, 0.75)),
]
OTHERS = {
    "simple cubic": lambda: cubic(SIMPLE, (8, 8, 8)),
    "simple cubic with two screws": lambda: screws(*cubic(SIMPLE, (14, 14, 4)), 1),
    "rock salt with two screws": lambda: screws(*cubic(SIMPLE, (16, 16, 4)), 2),
    "rock salt with two screws along [1 1 0]": lambda: screws(*turned_cubic(), 2**0.5),
    "perovskite": lambda: cubic(PEROVSKITE, (6, 6, 6)),
    "A15": lambda: cubic(A15, (6, 6, 6)),
    "fluorite": lambda: cubic(FLUORITE, (5, 5, 5)),
}


@pytest.mark.parametrize("name", OTHERS)
def test_other_lattices_are_refused(name):
    """The message names the known lattices."""
    places, cell = OTHERS[name]()
    with pytest.raises(CrystalError, match=", ".join(LATTICES)):
        _ = Crystal(places, cell).lattice


def noisy(places, cell, share):
    """Atoms with Gaussian noise, a share of the distance of neighbours, and their cell."""
    nearest = np.sort(np.linalg.norm(places - places[0], axis=1))[1]
    noise = np.random.default_rng(1).normal(0, share * nearest, places.shape)
    return places + noise, cell


@pytest.mark.parametrize(
    ("name", "noise"), [("simple cubic", 0.12), ("simple cubic", 0.15), ("perovskite", 0.15)]
)
def test_a_lattice_that_hardly_an_atom_fits_is_refused(name, noise):
    """Noise makes another lattice look like a shipped one: the message names the share of atoms
    that fit, and neither lattice nor lines are returned."""
    places, cell = OTHERS[name]()
    crystal = Crystal(*noisy(places, cell, noise))
    for question in (lambda: crystal.lattice, crystal.dislocations, lambda: crystal.share):
        with pytest.raises(CrystalError, match=r"only 0\.\d% (of the atoms fit|have the neigh)"):
            question()


SHEET = [(x * 2.46, y * 2.46 * 3**0.5, 0.0) for x in (0, 1, 2, 3) for y in (0, 1)]
GRAPHENE = np.concatenate([
    np.add(SHEET, np.multiply(site, (2.46, 2.46 * 3**0.5, 1)))
    for site in ((0, 0, 0), (0.5, 0.5, 0), (0, 1 / 3, 0), (0.5, 5 / 6, 0))
])  # fmt: skip


@pytest.mark.parametrize(
    ("places", "cell", "periodic"),
    [
        (GRAPHENE, [9.84, 8.52, 20], (True, True, False)),
        (GRAPHENE, [9.84, 8.52, 20], OPEN),
        (GRAPHENE, None, OPEN),
        (GRAPHENE[:, [2, 0, 1]] + 7, [20, 9.84, 8.52], (False, True, True)),
    ],
    ids=["sheet", "open", "no cell", "turned"],
)
def test_a_sheet_is_a_plane_crystal(places, cell, periodic):
    """Graphene is a honeycomb with a = 2.46 and no dislocation, whatever is periodic."""
    sheet = Crystal(places, cell, periodic)
    assert sheet.lattice == "honeycomb"
    assert sheet.constant == pytest.approx(2.46, rel=1e-3)
    assert not sheet.dislocations()


@pytest.mark.parametrize(
    ("places", "cell", "periodic"),
    [
        (np.arange(90).reshape(30, 3) * [1.0, 0, 0], [90, 9, 9], (True, False, False)),
        (np.ones((30, 3)), None, OPEN),
    ],
    ids=["line", "point"],
)
def test_a_line_or_a_point_is_refused(places, cell, periodic):
    """Atoms on a line or at one place have no lattice."""
    with pytest.raises(CrystalError, match="in one plane or on one line"):
        _ = Crystal(places, cell, periodic).lattice


def test_a_dense_lattice_is_refused_as_a_sparse_one():
    """Fluorite occupies each site of diamond and others between them, so diamond is refused."""
    with pytest.raises(CrystalError, match=r"expected a crystal \(diamond\)"):
        _ = Crystal(*OTHERS["fluorite"](), lattice="diamond").share


@pytest.mark.parametrize(
    ("ratio", "height"), [((8 / 3) ** 0.5, 3 / 8), (5.19 / 3.19, 0.377)], ids=["ideal", "GaN"]
)
def test_screws_of_hexagonal_diamond(ratio, height):
    """Wurtzite with screws along c has the right lattice, c/a, and b = c."""
    places, cell = block("hcp", (16, 9, 2))
    both = np.concatenate([places, places + np.array([0, 0, height * (8 / 3) ** 0.5])])
    size = 3.19 * np.array([1, 1, ratio / (8 / 3) ** 0.5])
    crystal = Crystal(*screws(both * size, cell * size, 3.19 * ratio))
    assert crystal.lattice == "hexagonal diamond"
    assert crystal.frame.lattice.ratio == pytest.approx(ratio, rel=1e-3)
    lines = crystal.dislocations().lines
    assert [line.family for line in lines] == ["<0 0 0 1>"] * 2
    for line in lines:
        assert np.linalg.norm(line.burgers) == pytest.approx(3.19 * ratio, rel=1e-3)


def test_screws_of_hexagonal_diamond_in_its_plane():
    """Two screws along a have b = 1/3<1 1 -2 0>."""
    places, cell = block("hexagonal diamond", (3, 8, 9))
    order = [1, 2, 0]
    places, cell = places[:, order], cell[order]
    crystal = Crystal(*screws(places, cell, 1.0))
    lines = crystal.dislocations().lines
    assert [line.family for line in lines] == ["1/3<1 1 -2 0>"] * 2


@pytest.mark.parametrize("lattice", ["hcp", "hexagonal diamond"])
def test_hexagonal_lines_go_to_ovito(lattice, tmp_path):
    """Lines read back keep b and their lattice; a file that was read is written unchanged."""
    places, cell = quadrupole(lattice, (14, 8, 2), (0, 0, (8 / 3) ** 0.5))
    net = Crystal(places, cell).dislocations()
    net.save(tmp_path / "lines.ca")
    again = DislocationNetwork.read(tmp_path / "lines.ca")
    before, after = net.polylines, again.polylines
    assert len(before) == len(after) == 4
    for one, other in zip(before, after, strict=True):
        assert np.array(other.burgers, float) == pytest.approx(np.array(one.burgers, float))
        assert other.length == pytest.approx(one.length)
    again.save(tmp_path / "again.ca")
    for part in (rf"NAME {lattice}\n", "CLUSTER_STRUCTURE .*"):
        found = [re.search(part, (tmp_path / f).read_text()) for f in ("lines.ca", "again.ca")]
        assert found[0] is not None
        assert found[1] is not None
        assert found[0][0] == found[1][0]


def test_five_twins_of_fcc_are_fcc():
    """A decahedron, whose atoms fit fcc in five frames, is fcc with five grains."""
    cluster = pytest.importorskip("ase.cluster")
    places = cluster.Decahedron("Cu", 8, 6, 1, latticeconstant=3.6).positions
    crystal = Crystal(places, periodic=OPEN)
    assert (crystal.lattice, len(crystal.grains)) == ("fcc", 5)
    assert crystal.share > 0.5


@pytest.mark.parametrize("shells", [3, 4, 5])
def test_small_icosahedra_are_refused(shells):
    """Clusters of 55, 147 and 309 atoms: twenty twins without interior atoms."""
    cluster = pytest.importorskip("ase.cluster")
    places = cluster.Icosahedron("Cu", shells, latticeconstant=3.6).positions
    with pytest.raises(CrystalError, match="expected a crystal"):
        _ = Crystal(places, periodic=OPEN).lattice


@pytest.mark.parametrize(("length", "cutoff"), [(5, 2), (7, 3)])
def test_small_crystals_are_found(length, cutoff):
    """Cuboctahedra of 55 and 147 atoms, most of them at the surface, are fcc."""
    cluster = pytest.importorskip("ase.cluster")
    places = cluster.Octahedron("Cu", length, cutoff, latticeconstant=3.6).positions
    crystal = Crystal(places, periodic=OPEN)
    assert (crystal.lattice, len(crystal.grains)) == ("fcc", 1)
    assert crystal.constant == pytest.approx(3.6)


@pytest.mark.parametrize(
    ("layers", "lattice"), [("ABCABCABABCABCABC", "fcc"), ("ABABABABCACACACAC", "hcp")]
)
def test_faults_do_not_change_the_lattice(layers, lattice):
    """The lattice is the one of most layers."""
    places, cell = stacked(layers, ratio=(8 / 3) ** 0.5)
    crystal = Crystal(places, cell, (True, True, False))
    assert (crystal.lattice, len(crystal.grains)) == (lattice, 1)


@pytest.mark.parametrize("seed", range(8))
def test_a_gas_is_refused(seed):
    """Occupied neighbour sites can be chance: in a gas up to 14 % of the atoms fit hcp this way."""
    rng = np.random.default_rng(seed)
    sites = 7.2 * np.argwhere(np.ones((16, 16, 2)))
    crystal = Crystal(
        sites + rng.uniform(-2, 2, sites.shape), [200, 200, 14.4], [False, False, True]
    )
    with pytest.raises(CrystalError, match="of only"):
        _ = crystal.lattice


def test_diamond_under_noise_is_found():
    """Under noise of 12 % of the neighbour distance few atoms fit, but most sites are occupied."""
    cell = np.array([[0, 0, 0], [0, 2, 2], [2, 0, 2], [2, 2, 0]], dtype=float)
    cell = np.concatenate([cell, cell + 1]) * 5.43 / 4
    sites = (cell[None] + 5.43 * np.argwhere(np.ones((6, 6, 6)))[:, None]).reshape(-1, 3)
    noise = np.random.default_rng(1).normal(0, 0.12 * 5.43 * 3**0.5 / 4, sites.shape)
    assert Crystal(sites + noise, [6 * 5.43] * 3, [True] * 3).lattice == "diamond"
