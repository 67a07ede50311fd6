"""Blocked: the same lines whatever the size of blocks, from any source, and after a kill."""

import subprocess
import sys
import tracemalloc
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from geomtorsion.errors import CheckpointError, CrystalError, FileFormatError, GridError
from geomtorsion.materials.crystals import Crystal, atom_slabs, blocked_crystal
from geomtorsion.materials.crystals.blocked import forget_blocks
from tests.materials.crystals.polycrystals import bicrystal, polycrystal, turned
from tests.materials.crystals.synthetic import block, quadrupole, with_line

ROOT = Path(__file__).parents[3]
HEIGHT = (8 / 3) ** 0.5
OPEN = (False, False, True)


def bits(net):
    """Everything that lines are, to the last bit."""
    return [
        (line.burgers, line.burgers_lattice, line.length, line.kind, line.path.tobytes())
        for line in net.lines
    ]


def screws(lattice="bcc", seed=0, noise=0.03):
    """Four screws in a periodic cell, atoms in any order, and the cell."""
    repeats = {"bcc": (12, 12, 5), "fcc": (10, 10, 4), "hcp": (10, 6, 5)}[lattice]
    b = (0, 0, HEIGHT if lattice == "hcp" else 1)
    places, cell = quadrupole(lattice, repeats, b)
    rng = np.random.default_rng(seed)
    places = places + noise * rng.normal(size=places.shape)
    return places[rng.permutation(len(places))], cell


@pytest.mark.parametrize(
    ("lattice", "size", "oblique"),
    [("fcc", 7.3, True),
     # Of bcc a killed run and two workers give four blocks, below.
     pytest.param("bcc", 6.5, False, marks=pytest.mark.slow),
     # In blocks of hcp stand its partials, too, in test_stacking.py.
     pytest.param("hcp", 5.9, True, marks=pytest.mark.slow)],
)  # fmt: skip
def test_blocks_give_the_same_bits(tmp_path_factory, lattice, size, oblique):
    """Four blocks with an edge, two in a cell without right angles, and themselves in every image.

    In fcc partials, too: what belongs to two sublattices and to stacking faults.
    """
    check_bits(tmp_path_factory, lattice, size, 0, oblique)


@pytest.mark.slow
@pytest.mark.parametrize("lattice", ["bcc", "fcc", "hcp"])
@given(size=st.floats(4.5, 20), seed=st.integers(0, 2**32 - 1), oblique=st.booleans())
@settings(max_examples=5, deadline=None)
def test_any_block_size_gives_the_same_bits(tmp_path_factory, lattice, size, seed, oblique):
    """However a crystal is cut, in any cell of it."""
    check_bits(tmp_path_factory, lattice, size, seed, oblique)


def check_bits(tmp_path_factory, lattice, size, seed, oblique):
    """Frame and lines are those of the crystal in memory."""
    places, cell = screws(lattice, seed)
    vectors = np.diag(cell)
    if oblique:
        vectors[2] += vectors[0]
    whole = Crystal(places, vectors)
    cut = blocked_crystal(places, tmp_path_factory.mktemp("blocks"), vectors, size)
    assert cut.count == len(places)
    assert (cut.lattice, cut.constant, cut.share) == (whole.lattice, whole.constant, whole.share)
    assert np.array_equal(cut.orient, whole.orient)
    lines = whole.dislocations()
    assert len(lines.lines) == 4
    assert bits(cut.dislocations()) == bits(lines)
    if lattice == "fcc":
        assert bits(cut.dislocations(partials=True)) == bits(whole.dislocations(partials=True))


@pytest.mark.slow
@given(size=st.floats(5, 40), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=5, deadline=None)
def test_any_open_and_turned_cells(tmp_path_factory, size, seed):
    """However it is cut and turned."""
    check_turned(tmp_path_factory.mktemp("blocks"), size, seed)


def test_open_and_turned_cells(tmp_path):
    """A line in a crystal that is open across it, rotated as it likes, wrapped or not."""
    check_turned(tmp_path, 7.3, 11)


def check_turned(folder, size, seed):
    """Lines in blocks are those of the crystal in memory."""
    places, cell = with_line("fcc", (0.5, 0.5, 0), (10, 10, 5), 0.45)
    vectors = np.diag(cell)
    rng = np.random.default_rng(seed)
    turn = Rotation.random(random_state=int(seed)).as_matrix()
    wound = rng.integers(-1, 2, (len(places), 1)) * vectors[2]
    given_as = (places + wound) @ turn.T, vectors @ turn.T, (False, False, True)
    whole = Crystal(*given_as).dislocations()
    cut = blocked_crystal(given_as[0], folder, given_as[1], size, given_as[2])
    assert [line.family for line in whole.lines] == ["1/2<1 1 0>"]
    assert bits(cut.dislocations()) == bits(whole)


@pytest.mark.parametrize(
    "size",
    [pytest.param(3.0, marks=pytest.mark.slow), 5.0, pytest.param(100.0, marks=pytest.mark.slow)],
)
def test_without_a_cell_blocks_are_as_wide_as_asked(tmp_path, size):
    """An open crystal needs no cell: as many blocks as its atoms fill, and the same lines."""
    places, _ = line()
    expected = bits(Crystal(places).dislocations())
    assert [kind for *_, kind, _ in expected] == ["surface"]
    cut = blocked_crystal(places, tmp_path, None, size)
    assert len(cut.atoms.blocks) == len(np.unique(np.floor(places / size), axis=0))
    assert bits(cut.dislocations()) == expected


@pytest.mark.parametrize(
    "axes", [pytest.param((False, False, False), marks=pytest.mark.slow), (True, True, False)]
)
def test_sparse_blocks_are_what_they_are_in_memory(tmp_path, axes):
    """A gas above the surface, and corners in blocks of their own: neighbours are looked for as far
    as they are, in the same images, and nobody is told to repeat a cell."""
    places, cell = block("fcc", (5, 5, 4))
    gas = np.random.default_rng(0).uniform([0, 0, 7], [5, 5, 40], (12, 3))
    both = np.concatenate([places + 0.01, gas])
    vectors = [*cell[:2], 60] if axes[0] else None
    whole = Crystal(both, vectors, axes, orient=np.eye(3))
    for size in (4.0, 11.0):
        folder = tmp_path / str(size)
        cut = blocked_crystal(both, folder, vectors, size, axes, orient=np.eye(3))
        assert (cut.constant, cut.share) == (whole.constant, whole.share)
        assert bits(cut.dislocations()) == bits(whole.dislocations()) == []


def long_crystal(lattice, length, noise, seed=1):
    """A screw along an open bar of crystal, with noise as part of the neighbour distance."""
    places, cell = with_line(lattice, (0, 0, 1), (5, 5, length))
    nearest = {"fcc": 0.5**0.5, "bcc": 0.75**0.5}[lattice]
    rng = np.random.default_rng(seed)
    return places + noise * nearest * rng.normal(size=places.shape), cell


@pytest.mark.parametrize(
    ("lattice", "length", "noise", "sizes"),
    [("bcc", 27, 0.1, (9,)),
     # What goes through many blocks stands above, under noise.
     pytest.param("bcc", 44, 0, (11,), marks=pytest.mark.slow),
     pytest.param("bcc", 36, 0.1, (12,), marks=pytest.mark.slow),
     pytest.param("bcc", 36, 0.1, (13,), marks=pytest.mark.slow),
     pytest.param("bcc", 60, 0, (11,), marks=pytest.mark.slow),
     pytest.param("fcc", 30, 0.1, (10,), marks=pytest.mark.slow),
     pytest.param("bcc", 30, 0.12, (8,), marks=pytest.mark.slow),
     pytest.param("fcc", 24, 0.12, (8,), marks=pytest.mark.slow)],
)  # fmt: skip
def test_cores_are_relaxed_block_by_block(tmp_path, lattice, length, noise, sizes):
    """Under noise of 10 % every atom needs tetrahedra and cores lie everywhere, some across faces
    of blocks; that of the line goes through all of them, further than any block sees."""
    places, cell = long_crystal(lattice, length, noise)
    given_as = {"lattice": lattice, "orient": np.eye(3)}
    expected = bits(Crystal(places, cell, OPEN, **given_as).dislocations())
    assert [kind for *_, kind, _ in expected] == ["periodic"]
    for size in sizes:
        cut = blocked_crystal(places, tmp_path / str(size), cell, size, OPEN, **given_as)
        assert len(cut.atoms.blocks) >= 2
        assert bits(cut.dislocations()) == expected


def peak(places, cell, folder, size):
    """Most memory that arrays take while lines are found in blocks, bytes."""
    np.save(folder.with_suffix(".npy"), places)
    tracemalloc.start()
    cut = blocked_crystal(
        folder.with_suffix(".npy"), folder, cell, size, lattice="bcc", orient=np.eye(3)
    )
    assert cut.dislocations().lines == ()
    found = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return found


def test_memory_under_noise_is_that_of_a_block(tmp_path):
    """Twice as many atoms need tetrahedra, but not more at once."""
    found = []
    # In longer crystals what is done at once in parts hides what grows with the number of atoms:
    # here one block for all atoms takes 1.26 times as much.
    for length in (8, 16):
        places, cell = block("bcc", (4, 4, length))
        noise = 0.1 * 0.75**0.5 * np.random.default_rng(0).normal(size=places.shape)
        found.append(peak(places + noise, cell, tmp_path / str(length), 4))
    assert found[1] < 1.1 * found[0]


def test_vacancies_are_counted_once_on_the_faces_of_blocks(tmp_path):
    """A cell of blocks of whole lattice constants, vacancies at their corners and a loop."""
    places, cell = block("bcc", (12, 12, 8))
    disc = np.hypot(*(places[:, :2] - [6.1, 6.2]).T) < 3.4
    gone = disc & (np.abs(places[:, 2] - 6.2) < 0.3)
    sheet = places.copy()
    # Both sides close the gap that a layer of (001) leaves: b = a/2 needs two layers.
    gone |= disc & (np.abs(places[:, 2] - 6.7) < 0.3)
    depth = np.where(places[:, 2] < 6.4, 1, -1) * np.exp(-np.abs(places[:, 2] - 6.4) / 2)
    sheet[:, 2] += 0.5 * depth * disc
    corners = [(x, y, z) for x in (0, 6) for y in (0, 3) for z in (0, 3)]
    for corner in corners:
        gone |= (places == corner).all(axis=1)
    kept = sheet[~gone]
    whole = Crystal(kept, cell, lattice="bcc", orient=np.eye(3))
    cut = blocked_crystal(kept, tmp_path, cell, 6, lattice="bcc", orient=np.eye(3))
    (line,) = whole.dislocations().lines
    assert line.is_closed
    assert bits(cut.dislocations()) == bits(whole.dislocations())


def line():
    """A screw in a crystal that is open across it, which has fewer atoms about it, and the cell."""
    return with_line("bcc", (0, 0, 1), (8, 8, 4))


@cache
def lines_in_memory():
    """The lines of that crystal, which is looked at as a whole once."""
    places, cell = line()
    return bits(Crystal(places, cell, OPEN).dislocations())


def sources(folder, places):
    """The same atoms in every way in which they may come."""
    np.save(folder / "atoms.npy", places)
    np.savez(folder / "atoms.npz", positions=places)
    np.savez_compressed(folder / "packed.npz", positions=places.astype(">f8"))
    np.save(folder / "one.npy", places[:300])
    np.save(folder / "two.npy", places[300:])
    return {
        "mapped": np.load(folder / "atoms.npy", mmap_mode="r"),
        "npy": folder / "atoms.npy",
        "npz": str(folder / "atoms.npz"),
        "packed": folder / "packed.npz",
        "files": [folder / "one.npy", str(folder / "two.npy")],
        "arrays": [places[:7], places[7:]],
        "rows": places.tolist(),
        "slabs": lambda: iter(np.array_split(places, 9)),
    }


def test_atoms_come_from_files_lists_and_functions(tmp_path):
    """Every source gives the atoms of the array, in their order."""
    places, _ = line()
    for name, source in sources(tmp_path, places).items():
        read = np.concatenate(list(atom_slabs.AtomSlabs(source)))
        assert np.array_equal(read, places), name


FEW_AND_ALL = [("packed", "slabs"), pytest.param((), marks=pytest.mark.slow)]


@pytest.mark.parametrize("names", FEW_AND_ALL, ids=["few", "all"])
def test_atoms_from_anywhere_have_the_same_lines(tmp_path, names):
    """Those of the array."""
    places, cell = line()
    expected = lines_in_memory()
    every = sources(tmp_path, places)
    for name in names or every:
        source = every[name]
        cut = blocked_crystal(source, tmp_path / f"of-{name}", cell, 20, OPEN)
        assert bits(cut.dislocations()) == expected, name


def test_atoms_come_from_zarr(tmp_path):
    """An array, and a group with one called positions."""
    zarr = pytest.importorskip("zarr")
    places, cell = line()
    zarr.save_array(str(tmp_path / "atoms.zarr"), places)
    zarr.save_group(str(tmp_path / "group.zarr"), positions=places)
    expected = lines_in_memory()
    for name in ("atoms", "group"):
        cut = blocked_crystal(tmp_path / f"{name}.zarr", tmp_path / f"of-{name}", cell, 20, OPEN)
        assert bits(cut.dislocations()) == expected


KILLED = """
import os, signal, sys
import numpy as np
from geomtorsion.materials.crystals import blocked_crystal
from geomtorsion.materials.crystals.blocked import BlockedCrystal
made, calls = BlockedCrystal.compute, []
def dying(self, block):
    made(self, block)
    calls.append(block)
    if len(calls) == 3:
        os.kill(os.getpid(), signal.SIGKILL)
BlockedCrystal.compute = dying
blocked_crystal(sys.argv[1], sys.argv[2], [8, 8, 4], 4, (False, False, True))
"""


def test_a_killed_run_goes_on(tmp_path):
    """SIGKILL after three blocks: they are taken as they are, and the lines are the same."""
    places, cell = line()
    file, folder = tmp_path / "atoms.npy", tmp_path / "blocks"
    np.save(file, places)
    done = subprocess.run(
        [sys.executable, "-c", KILLED, str(file), str(folder)], cwd=ROOT, timeout=300, check=False
    )
    assert done.returncode == -9
    kept = {path: path.stat().st_mtime_ns for path in folder.glob("*-open.npy")}
    assert len(kept) == 3
    slabs = {path: path.stat().st_mtime_ns for path in folder.glob("slab-*")}
    found = blocked_crystal(file, folder, cell, 4, OPEN)
    assert len(found.done) == len(found.atoms.blocks) == 4
    assert {path: path.stat().st_mtime_ns for path in (*kept, *slabs)} == kept | slabs
    assert bits(found.dislocations()) == lines_in_memory()


def test_workers_give_the_same(tmp_path):
    """Two processes."""
    places, cell = line()
    np.save(tmp_path / "atoms.npy", places)
    found = blocked_crystal(tmp_path / "atoms.npy", tmp_path / "two", cell, 4, OPEN, workers=2)
    assert bits(found.dislocations()) == lines_in_memory()


def test_damage_is_done_again_or_told(tmp_path):
    """A block that was cut is computed again; sorted atoms that are gone are told."""
    places, cell = line()
    found = blocked_crystal(places, tmp_path, cell, 4, OPEN)
    expected = bits(found.dislocations())
    cut = next(iter(tmp_path.glob("block-*-open.npy")))
    cut.write_bytes(cut.read_bytes()[:-3])
    with pytest.raises(CheckpointError, match="1 of 4 blocks are missing"):
        found.dislocations()
    again = blocked_crystal(places, tmp_path, cell, 4, OPEN)
    assert bits(again.dislocations()) == expected
    with pytest.raises(CheckpointError, match="blocks of another run: block differ"):
        blocked_crystal(places, tmp_path, cell, 5, OPEN)
    next(iter(tmp_path.glob("slab-*-places.npy"))).unlink()
    with pytest.raises(CheckpointError, match="missing or damaged"):
        blocked_crystal(places, tmp_path, cell, 4, OPEN).dislocations()


def test_other_atoms_of_the_same_size_are_another_crystal(tmp_path, monkeypatch):
    """The next frame of a trajectory is refused, whether it comes as an array, a function or in
    the same file, and where it differs behind the first slab; the same atoms are taken up."""
    monkeypatch.setattr(atom_slabs, "SLAB", 500)
    places, cell = line()
    later = places + np.array([0.01, 0, 0])
    last = places.copy()
    last[-1] += 0.01
    file = tmp_path / "frame.npy"
    for k, (one, two) in enumerate(
        ((places, last), (lambda: iter([places]), lambda: iter([later])), (file, file))
    ):
        folder = tmp_path / f"of-{k}"
        np.save(file, places)
        blocked_crystal(one, folder, cell, 20, OPEN)
        assert blocked_crystal(one, folder, cell, 20, OPEN).count == len(places)
        np.save(file, later)
        with pytest.raises(CheckpointError, match="blocks of another run: digest differ"):
            blocked_crystal(two, folder, cell, 20, OPEN)


X, CELL = block("fcc", (8, 8, 8))
GAS = np.random.default_rng(0).uniform(0, 8, X.shape)
REFUSED = {
    "gas": (GAS, CELL, 4, CrystalError, "as in a liquid"),
    "twice": (np.r_[X, X[5:6]], CELL, 4, CrystalError, "atoms 5 and 2048 lie upon each other"),
    "nan": (np.where(X == 1, np.nan, X), CELL, 4, CrystalError, "is not finite"),
    "few": (X[:9], CELL, 4, CrystalError, "20 atoms or more"),
    "too few": (X[:30], None, 4, CrystalError, "30 atoms. Give more of the crystal"),
    "block": (X, CELL, 0, CrystalError, "block"),
    "narrow": (block("fcc", (8, 8, 2))[0], [8, 8, 2], 4, CrystalError, "edge 3 repeats after 2"),
    "shape": (X[:, :2], CELL, 4, CrystalError, r"\(atoms, 3\)"),
    "function": (lambda: None, CELL, 4, CrystalError, "a function that gives an iterator"),
    "used up": (iter([X]), CELL, 4, CrystalError, "Give a function"),
    "no file": ("gone.npy", CELL, 4, FileFormatError, "no such file"),
    "no npz": ("gone.npz", CELL, 4, FileFormatError, "no such file"),
    "text": ([["a", "b", "c"]], CELL, 4, FileFormatError, "no such file"),
    "words": (np.array([["a", "b", "c"]]), CELL, 4, GridError, "real numbers"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_bad_input_is_refused(tmp_path, name):
    """An error of the package says what was needed and what came."""
    source, cell, size, error, words = REFUSED[name]
    with pytest.raises(error, match=words):
        blocked_crystal(source, tmp_path, cell, size).dislocations()


def test_damaged_npz_files_are_told(tmp_path):
    """Cut, without positions, of another shape."""
    np.savez(tmp_path / "whole.npz", positions=X)
    content = (tmp_path / "whole.npz").read_bytes()
    (tmp_path / "cut.npz").write_bytes(content[: len(content) // 2])
    np.savez(tmp_path / "other.npz", places=X)
    np.savez(tmp_path / "flat.npz", positions=X[:, 0])
    for name in ("cut", "other", "flat"):
        with pytest.raises(FileFormatError, match=f"{name}.npz"):
            blocked_crystal(tmp_path / f"{name}.npz", tmp_path / name, CELL, 4)


def check_grains(folder, places, cell, sizes, axes=(True,) * 3, partials=False):
    """Grains, walls and lines of a polycrystal are those of the crystal in memory."""
    whole = Crystal(places, cell, axes)
    lines = whole.dislocations(partials)
    for size in sizes:
        cut = blocked_crystal(places, folder / str(size), cell, size, axes)
        assert len(cut.atoms.blocks) > 1
        assert not cut.is_single
        assert np.array_equal(cut.grains.number, whole.grains.number)
        assert list(map(repr, cut.grains.walls)) == list(map(repr, whole.grains.walls))
        assert (cut.lattice, cut.constant, cut.share) == (
            whole.lattice, whole.constant, whole.share
        )  # fmt: skip
        found = cut.dislocations(partials)
        assert bits(found) == bits(lines)
        assert [line.grain for line in found.lines] == [line.grain for line in lines.lines]
        assert found.node_rule() == lines.node_rule()
    return lines


SIGMA5 = turned(np.degrees(np.arctan2(3, 4)), (0, 0, 1))


# Grains, walls and lines in blocks, sharper: test_many_grains_in_blocks.
@pytest.mark.slow
@pytest.mark.parametrize("lattice", ["fcc", "bcc"])
def test_grains_in_blocks_are_those_in_memory(tmp_path, lattice):
    """A line in each half of a bicrystal, in blocks that cut the wall or the grains."""
    burgers = (0.5, 0.5, 0) if lattice == "fcc" else (1, 0, 0)
    places, _, size = bicrystal(lattice, SIGMA5, burgers, size=(10, 7, 3), both=True)
    # Faces of blocks at x = 0 and 10: the wall lies within a block, a line in the face of two.
    lines = check_grains(tmp_path, places + np.array([4, 0, 0]), [60, 60, size[2]], (10,), OPEN)
    assert sorted(line.grain or 0 for line in lines.lines) == [0, 1]
    assert {line.kind for line in lines.lines} == {"periodic"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("lattice", "degrees"), [("hcp", 37), ("fcc", 20), ("bcc", 20), ("diamond", 37)]
)
def test_any_lattice_has_grains_in_blocks(tmp_path, lattice, degrees):
    """Also where bonds of the other grain can still be read in the frame of the first."""
    turn = turned(degrees, (0, 0, 1))
    places, _, _ = bicrystal(lattice, turn, size=(7, 5, 4))
    check_grains(tmp_path, places, None, (6,), (False,) * 3)


def test_many_grains_in_blocks(tmp_path):
    """Of two lattices, periodic along x, with a line in one grain that ends at a wall."""
    turns = [turned(0, (0, 0, 1)), turned(30, (1, 2, 3)), turned(40, (-1, 1, 3))]
    seeds = np.array([[2, 2, 2], [6.5, 5.6, 2.5], [2.5, 6.5, 6.5]])
    places, _ = polycrystal(["fcc", "fcc", "bcc"], turns, seeds, 8.8, [1, 1, 0.8], (0.5, 0.5, 0))
    (line,) = check_grains(tmp_path, places, [8.8] * 3, (6,), (True, False, False)).lines
    assert (line.kind, line.grain) == ("wall", 0)


@pytest.mark.slow
def test_lines_end_at_walls_in_blocks(tmp_path):
    """From a free surface to the wall, which blocks cut."""
    places, _, _ = bicrystal("bcc", turned(30, (1, 2, 3)), (0, 0, 1), axis=2, size=(4, 4, 5))
    (line,) = check_grains(tmp_path, places, None, (5.5,), (False,) * 3).lines
    assert line.kind == "wall"


def test_noise_makes_no_grains_and_small_grains_are_found(tmp_path):
    """A turned cylinder in a periodic sheet is a grain; noise that turns single atoms is none."""
    places, cell = block("fcc", (10, 10, 4))
    noisy = places + 0.12 / 2**0.5 * np.random.default_rng(0).normal(size=places.shape)
    cut = blocked_crystal(noisy, tmp_path / "noise", cell, 30, OPEN)
    assert cut.is_single
    assert cut.dislocations().lines == ()
    places, cell = block("fcc", (16, 8, 4))
    inside = np.hypot(*(places - cell / 2)[:, :2].T) < 2.9
    middle = (places - cell / 2) @ turned(37, [0, 0, 1]).T + cell / 2
    both = np.concatenate([places[~inside], middle[inside]])
    assert inside.mean() < 0.25
    check_grains(tmp_path, both, cell, (8,), (True, True, False))


def test_damaged_grains_are_done_again(tmp_path):
    """A block of a grain that is gone is computed again, and the folder can be removed."""
    places, _, _ = bicrystal("bcc", SIGMA5, size=(6, 5, 4))
    found = blocked_crystal(places, tmp_path / "a", None, 7)
    expected = bits(found.dislocations())
    next((tmp_path / "a").glob("grain-1/block-*-open.npy")).unlink()
    with pytest.raises(CheckpointError, match="blocks are missing"):
        found.dislocations()
    assert bits(blocked_crystal(places, tmp_path / "a", None, 7).dislocations()) == expected
    forget_blocks(tmp_path / "a")
    assert not (tmp_path / "a").exists()
