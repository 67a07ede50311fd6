"""Crystals: lattice, labels, torsion and dislocation lines of atoms."""

# The tests pass what users pass, including wrong types.
# pyright: reportArgumentType=false

import json
import tracemalloc
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from geomtorsion.errors import CrystalError
from geomtorsion.materials.crystals import LATTICES, Crystal
from geomtorsion.materials.crystals.reports import inserted_atoms
from tests.materials.crystals.synthetic import (
    block,
    interstitial_loop,
    quadrupole,
    twisted,
    with_line,
)
from tests.real import real

TRUTH = "crystal/truth.json"
NAMES = (
    "w_perfect",
    "cu_perfect",
    "w_vac1pct",
    "w_noise05",
    "cu_noise08",
    "w_screw111",
    "w_screw111_relax",
    "w_edge100",
    "w_screw_quadrupole_relax",
    "cu_edge110",
    "cu_edge110_relax",
    "al_edge_dipole",
    "al_edge_dipole_relax",
    "w_tilt_gb",
)


def atoms_of(name):
    """Positions, cell and periodicity of a shared file."""
    path = real(f"crystal/{name}.xyz")
    ase_io = pytest.importorskip("ase.io")
    found = ase_io.read(path)
    return found.get_positions(), found.cell.array, found.pbc.tolist()


# In quick runs, relaxed files replace their unrelaxed versions, and the noisiest file the others.
SLOW_NAMES = ("w_perfect", "w_noise05", "w_screw111", "cu_edge110", "w_vac1pct")


@pytest.mark.parametrize(
    "name", [pytest.param(x, marks=pytest.mark.slow) if x in SLOW_NAMES else x for x in NAMES]
)
def test_shared_files_give_their_lines(name):
    """Number, family, length and |b| of the lines agree with the construction."""
    truth = json.loads(real(TRUTH).read_text())[name]
    crystal = Crystal(*atoms_of(name))
    assert crystal.lattice == truth["structure"]
    # The mean lattice constant changes in a strained or noisy cell.
    assert crystal.constant == pytest.approx(truth["a"], rel=0.01)
    net = crystal.dislocations()
    assert len(net.lines) == truth["nlines"]
    assert net.node_rule() == ()
    if truth["nlines"]:
        total = sum(line.length for line in net.lines)
        assert total == pytest.approx(truth["length"], rel=0.03)
        size = sorted(abs(Fraction(x)) for x in truth["b_lattice"])
        for line in net.lines:
            assert sorted(map(abs, line.burgers_lattice)) == size
            assert line.kind == "periodic"
            assert np.linalg.norm(np.array(line.burgers, float)) == pytest.approx(
                np.linalg.norm(truth["b_cart"]), rel=0.01
            )
    if name == "al_edge_dipole":
        assert net.nye == pytest.approx(np.zeros((3, 3)), abs=1e-9)


def test_torsion_has_no_boundary_in_cores_either():
    """d d = 0 on each tetrahedron, cores included."""
    crystal = Crystal(*atoms_of("w_screw111"), lattice="bcc")
    torsion = crystal.torsion
    mesh = torsion.mesh
    values = dict(zip(map(tuple, np.sort(mesh.faces[0], axis=1)), torsion.values, strict=True))
    assert len(values) == len(mesh.faces[0])
    assert torsion.values.any()
    edge_of = {pair: k for k, pair in enumerate([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])}
    total = np.zeros((len(mesh.corners), 3), dtype=int)
    for corner in range(4):
        face = [k for k in range(4) if k != corner]
        a, b, c = ((face[0], face[1]), (face[0], face[2]), (face[1], face[2]))
        rows = np.sort(mesh.edges[2][:, [edge_of[a], edge_of[b], edge_of[c]]], axis=1)
        total += (-1) ** corner * np.array([values[tuple(row)] for row in rows])
    assert not total.any()


def test_a_prismatic_loop_is_one_closed_line():
    """The loop is one closed line, and its Nye tensor is zero."""
    net = Crystal(*atoms_of("w_vac_loop111")).dislocations()
    (line,) = net.lines
    assert line.is_closed
    assert line.family == "1/2<1 1 1>"
    assert net.nye == pytest.approx(np.zeros((3, 3)), abs=1e-9)


def test_the_sign_follows_the_conventions():
    """b = closed integral of e is minus the closed integral of du."""
    truth = json.loads(real(TRUTH).read_text())["cu_edge110"]
    (line,) = Crystal(*atoms_of("cu_edge110")).dislocations().lines
    along = np.sign(line.image[2])
    b = along * np.array(line.burgers, float)
    assert b == pytest.approx(-np.array(truth["b_cart"]), abs=0.01)
    assert b == pytest.approx(np.array(truth["dxa"]["segs"][0]["b_spatial"]), abs=0.01)


ROOT3 = 3**0.5
LINES = (
    ("bcc", (0.5, 0.5, 0.5), "1/2<1 1 1>"),
    ("bcc", (0.5, -0.5, 0.5), "1/2<1 1 1>"),
    ("bcc", (1, 0, 0), "<1 0 0>"),
    ("bcc", (0, 0, 1), "<1 0 0>"),
    ("fcc", (0.5, 0.5, 0), "1/2<1 1 0>"),
    ("fcc", (0.5, 0, 0.5), "1/2<1 1 0>"),
    ("fcc", (0, -0.5, 0.5), "1/2<1 1 0>"),
    ("hcp", (1, 0, 0), "1/3<1 1 -2 0>"),
    ("hcp", (0.5, ROOT3 / 2, 0), "1/3<1 1 -2 0>"),
    ("hcp", (0, 0, (8 / 3) ** 0.5), "<0 0 0 1>"),
    ("diamond", (0.5, 0, 0.5), "1/2<1 1 0>"),
    ("diamond", (0.5, 0.5, 0), "1/2<1 1 0>"),
    ("hexagonal diamond", (0, 0, (8 / 3) ** 0.5), "<0 0 0 1>"),
)
SIZES = {"hcp": (14, 8, 4), "diamond": (9, 9, 3), "hexagonal diamond": (12, 7, 3)}
# One edge or mixed line and one screw per lattice; the other cases use other axes.
SHARP_LINES = (0, 3, 5, 8, 9, 10, 12)


def line_of(lattice, burgers):
    """A synthetic crystal with one line, and its cell."""
    margin = 0.3 if lattice.endswith("diamond") else 0.45
    return with_line(lattice, burgers, SIZES.get(lattice, (12, 12, 4)), margin)


@pytest.mark.parametrize(
    ("lattice", "burgers", "family"),
    [pytest.param(*x, marks=() if k in SHARP_LINES else pytest.mark.slow, id=str(k))
     for k, x in enumerate(LINES)],
)  # fmt: skip
def test_synthetic_lines_come_out_as_they_were_put_in(lattice, burgers, family):
    """Edge, screw and mixed lines are found in each lattice: b is exact, with the sign of -du."""
    places, cell = line_of(lattice, burgers)
    crystal = Crystal(places, cell, (False, False, True), orient=np.eye(3), lattice=lattice)
    (line,) = crystal.dislocations().lines
    assert (line.family, line.kind) == (family, "periodic")
    assert line.length == pytest.approx(cell[2], rel=0.01)
    b = np.sign(line.image[2]) * np.array(line.burgers, float) / crystal.constant
    # c/a of hexagonal lattices is estimated from strained neighbours.
    hexagonal = LATTICES[lattice].is_hexagonal
    assert b == pytest.approx(-np.array(burgers), abs=1e-5 if hexagonal else 1e-9)
    assert Crystal(places, cell, (False, False, True)).lattice == lattice


@pytest.mark.parametrize(("which", "noise"), [(LINES[0], 0.08), (LINES[3], 0.05), (LINES[6], 0)])
def test_laws_hold_whatever_is_done_to_the_specimen(which, noise):
    """Rotation, shift, permutation, wrapping, doubling and noise keep the line and its b."""
    check_laws(noise, 7, which)


@pytest.mark.slow
@given(
    noise=st.floats(0, 0.08),
    seed=st.integers(0, 2**32 - 1),
    which=st.sampled_from(LINES[:7]),
)
@settings(max_examples=12, deadline=None)
def test_laws_hold_in_any_specimen(noise, seed, which):
    """The same laws hold for random lines, noise and rotations."""
    check_laws(noise, seed, which)


def check_laws(noise, seed, which):
    """The known line is found after each of these changes to the atoms."""
    lattice, burgers, family = which
    places, cell = line_of(lattice, burgers)
    rng = np.random.default_rng(seed)
    vectors = np.diag(cell).astype(float)
    nearest = LATTICES[lattice].nearest
    places = places + rng.normal(size=places.shape) * noise * nearest
    twice = np.concatenate([places, places + vectors[2]])
    vectors[2] *= 2
    order = rng.permutation(len(twice))
    turn = Rotation.random(random_state=int(seed)).as_matrix()
    wound = rng.integers(-2, 3, len(twice))[:, None] * vectors[2]
    moved = ((twice + wound)[order] + rng.normal(size=3)) @ turn.T
    crystal = Crystal(moved, vectors @ turn.T, (False, False, True))
    assert crystal.lattice == lattice
    net = crystal.dislocations()
    (line,) = net.lines
    assert (line.family, line.kind) == (family, "periodic")
    assert line.length == pytest.approx(2 * cell[2], rel=0.03)
    assert net.node_rule() == ()
    along = np.sign(line.image[2]) * np.array(line.burgers, float) @ turn
    assert along == pytest.approx(-np.array(burgers), abs=0.03)


# Quick runs cover the most noise, and the least noise once; tests/hard has four screws and no line.
NOISY = [
    (name, noise)
    if (name, noise) in (("screw", 4), ("screw", 12), ("edge", 12))
    else pytest.param(name, noise, marks=pytest.mark.slow)
    for name in ("screw", "edge", "quadrupole", "perfect")
    for noise in (4, 8, 12)
]


@pytest.mark.parametrize("seeds", [range(1), pytest.param(range(1, 3), marks=pytest.mark.slow)])
@pytest.mark.parametrize(("name", "percent"), NOISY)
def test_noise_adds_no_line_and_takes_none(name, percent, seeds):
    """Gaussian noise on each coordinate, in percent of the neighbour distance, adds no line."""
    if name == "quadrupole":
        places, cell = quadrupole("bcc", (12, 12, 4), (0, 0, 1))
        periodic, count = (True, True, True), 4
    elif name == "perfect":
        places, cell = block("bcc", (8, 8, 8))
        periodic, count = (True, True, True), 0
    else:
        places, cell = line_of("bcc", (0.5, 0.5, 0.5) if name == "screw" else (1, 0, 0))
        periodic, count = (False, False, True), 1
    for seed in seeds:
        noise = np.random.default_rng(seed).normal(size=places.shape)
        moved = places + percent / 100 * LATTICES["bcc"].nearest * noise
        lines = Crystal(moved, cell, periodic).dislocations().lines
        assert [line.kind for line in lines] == ["periodic"] * count


def test_a_prismatic_loop_encloses_the_vacancies_that_were_put_in():
    """b . A over the volume of an atom is the number of missing atoms, within 1 %."""
    places, cell, periodic = atoms_of("w_vac_loop111")
    crystal = Crystal(places, cell, periodic)
    (line,) = crystal.dislocations().lines
    volume = crystal.frame.lattice.atom_volume * crystal.constant**3
    perfect = round(abs(np.linalg.det(cell)) / (3.1652**3 / 2))
    enclosed = np.array(line.burgers, float) @ line.area / volume
    assert enclosed == pytest.approx(len(places) - perfect, rel=0.01)
    truth = json.loads(real(TRUTH).read_text())["w_vac_loop111"]
    assert line.length == pytest.approx(truth["length"], rel=0.03)


@pytest.mark.parametrize("radius", [3, pytest.param(4, marks=pytest.mark.slow), 5])
def test_a_loop_encloses_the_interstitials_that_were_put_in(radius):
    """b . A over the volume of an atom is the signed number of inserted atoms, within 1 %."""
    places, cell, inserted = interstitial_loop(radius)
    crystal = Crystal(places, cell)
    (line,) = crystal.dislocations().lines
    assert (line.family, line.kind) == ("1/2<1 1 1>", "closed")
    assert inserted_atoms(line, crystal) == pytest.approx(inserted, rel=0.01)
    assert line.length == pytest.approx(2 * np.pi * radius, rel=0.03)


def test_bonds_are_an_integer_cochain():
    """Labels of given bonds equal the cochain's values and change sign with the bond's sense."""
    places, cell = block("fcc", (3, 3, 3))
    moved = places + np.random.default_rng(0).integers(-1, 2, places.shape) * cell
    crystal = Crystal(moved, cell)
    bonds = crystal.bonds
    assert bonds.is_whole
    pairs, images = bonds.complex.pairs, bonds.complex.images
    assert (crystal.labels(pairs, images) == bonds.values).all()
    assert (crystal.labels(pairs[:, ::-1], -images) == -bonds.values).all()
    assert (crystal.labels() == bonds.values).all()


X, CELL = block("fcc", (5, 5, 5))
SITES = np.argwhere(np.ones((8, 8, 8)))
TURNED = Rotation.from_euler("z", 30, degrees=True).as_matrix()
GAS = np.random.default_rng(0).uniform(0, 5, X.shape)
REFUSED = {
    "gas": (lambda: Crystal(GAS, CELL), "as in a liquid"),
    "wrong lattice": (lambda: Crystal(X, CELL, lattice="bcc"), "expected fcc, which .*, got bcc,"),
    "unknown lattice": (lambda: Crystal(X, CELL, lattice="sc"), "one of fcc, bcc, hcp, diamond"),
    "all twice": (lambda: Crystal(np.r_[X, X], CELL), "atoms 0 and 500 at one position"),
    "simple cubic": (lambda: Crystal(SITES, [8] * 3), "in a lattice of another kind"),
    "on a line": (lambda: Crystal(np.arange(99)[:, None] * [1, 0, 0]), "plane or on one line"),
    "far away": (lambda: Crystal(np.r_[X, [[1e300] * 3]]), "expected numbers between"),
    "axes of others": (lambda: Crystal(X, CELL, orient=TURNED), "atoms are turned by 30 degrees"),
    "a cell too small": (lambda: Crystal(X, CELL / 2), "at one position, and 749 more"),
    "nan": (lambda: Crystal(np.where(X == 1, np.nan, X), CELL), "is not finite"),
    "few atoms": (lambda: Crystal(X[:5], CELL), "expected 20 or more atoms, .* got 5"),
    "no cell": (lambda: Crystal(X, np.zeros((3, 3))), "three edges that span a volume, got"),
    "wrong constant": (lambda: Crystal(X, CELL, lattice="fcc", constant=2), "about 1, .* got 2"),
    "no rotation": (lambda: Crystal(X, CELL, orient=np.ones((3, 3))), "expected a rotation, got"),
    "species": (lambda: Crystal(X, CELL, species=["Cu"]), "one for each of 500 atoms, got 1"),
    "periodic": (lambda: Crystal(X, CELL, (True, True)), "expected 3 truth values"),
    "periods": (lambda: Crystal(X, CELL, (np.ones(2), 1, 1)), "expected 3 truth values"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_bad_input_is_refused(name):
    """Each refusal is a CrystalError that names the expected and the given value."""
    make, words = REFUSED[name]
    with pytest.raises(CrystalError, match=words):
        make().dislocations()


@pytest.mark.parametrize("lattice", ["fcc", "bcc"])
def test_a_given_constant_may_differ_by_strain(lattice):
    """A constant 14 % off the estimate is accepted, a constant 16 % off is refused."""
    places, cell = block(lattice, (6, 6, 6))
    for share in (0.86, 1.14):
        crystal = Crystal(places, cell, constant=1 / share)
        assert (crystal.constant, crystal.lattice) == (1 / share, lattice)
    for share in (0.84, 1.16):
        with pytest.raises(CrystalError, match="constant: expected about 1, from .* got"):
            _ = Crystal(places, cell, constant=1 / share).constant


def test_unusual_specimens_are_accepted():
    """Left-handed cells, open boxes without a cell, two species and mixed phases are accepted."""
    assert Crystal(X * [1, 1, -1], np.diag(CELL * [1, 1, -1])).share == 1
    alloy = Crystal(X, CELL, species=["Cu", "Ni"] * 250)
    assert (alloy.lattice, alloy.share) == ("fcc", 1)
    assert Crystal(X).dislocations().lines == ()
    other, _ = block("bcc", (6, 6, 6))
    mixed = Crystal(np.concatenate([X, 0.8 * other + [6, 0, 0]]))
    assert 0.1 < mixed.share < 0.9


def test_atoms_far_from_all_others_change_nothing():
    """A single atom at a distance of 1e30 changes neither the lattice nor the lines."""
    crystal = Crystal(np.concatenate([X, [[1e30, 2, 2]]]))
    assert (crystal.lattice, crystal.constant) == ("fcc", pytest.approx(1))
    assert crystal.dislocations().lines == ()


def test_noise_leaves_the_lattice_where_hardly_an_atom_fits():
    """Under 12 % noise in diamond, the neighbours' mean positions still show the lattice."""
    places, cell = block("diamond", (5, 5, 5))
    noise = 0.12 * LATTICES["diamond"].nearest * np.random.default_rng(0).normal(size=places.shape)
    crystal = Crystal(places + noise, cell)
    assert (crystal.lattice, crystal.share < 0.1) == ("diamond", True)


def test_empty_layers_of_the_cell_take_no_memory():
    """The neighbour search depends on distances between atoms, not on the width of the cell."""
    tracemalloc.start()
    crystal = Crystal(X, [*CELL[:2], 1e6])
    assert (crystal.lattice, crystal.dislocations().lines) == ("fcc", ())
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 40e6


def test_a_crystal_may_turn_in_time_out_of_the_axes_that_it_began_with():
    """Each frame takes the crystal axes nearest the previous ones, so b along them is constant."""
    places, cell = line_of("bcc", (0.5, 0.5, 0.5))
    places, crystal, seen = places - places.mean(axis=0), None, []
    for degrees in (0, 12, 24, 36, 48):
        turn = Rotation.from_euler("z", degrees, degrees=True).as_matrix()
        later = Crystal(places @ turn.T, cell, (False, False, True))
        crystal = later if crystal is None else later.following(crystal)
        (line,) = crystal.dislocations().lines
        seen.append([np.sign(line.image[2]) * float(x) for x in line.burgers_lattice])
    assert seen == [seen[0]] * 5


@pytest.mark.parametrize("quarters", [pytest.param(0, marks=pytest.mark.slow), 1])
def test_a_net_of_screws_is_the_same_along_any_axes(quarters):
    """A twist wall is a square net of b = a/2 [1 1 0] and a/2 [1 -1 0]; no line in it splits."""
    places, cell = twisted(8, 3)
    orient = Rotation.from_euler("x", 90 * quarters, degrees=True).as_matrix()
    net = Crystal(places, cell, orient=orient).dislocations()
    assert [line.family for line in net.lines] == ["1/2<1 1 0>"] * 32
    # Both walls: the lines are spaced by (edge of the cell) / (2 sin(7.125 degrees) / b).
    assert sum(line.length for line in net.lines) == pytest.approx(92, rel=0.01)


def test_tetrahedra_take_whole_numbers_of_four_bytes():
    """Under noise each atom has about six tetrahedra; each one keeps 46 numbers, edges and faces
    included."""
    places, cell = block("bcc", (8, 8, 8))
    crystal = Crystal(places + 0.08 * np.random.default_rng(0).normal(size=places.shape), cell)
    _ = crystal.frame
    tracemalloc.start()
    mesh = crystal.mesh
    _ = mesh.edges, mesh.faces
    kept, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert 5 * len(places) < len(mesh.corners) < 7 * len(places)
    assert kept < 1.1 * 4 * 46 * len(mesh.corners)
