"""Atom files: formats read through ase, damaged files, and refused formats."""

# The tests pass what users pass, including wrong types.
# pyright: reportArgumentType=false

import pickle
from pathlib import Path

import numpy as np
import pytest

from geomtorsion.errors import ArgumentError, FileFormatError, GeomtorsionError
from geomtorsion.materials.crystals import read, read_all
from geomtorsion.materials.crystals.atom_files import FORMATS, atom_frames

ase_build = pytest.importorskip("ase.build")
ase_io = pytest.importorskip("ase.io")


def copper(shake: float = 0.0):
    """A small crystal of copper; shake: standard deviation of random shifts of the atoms."""
    atoms = ase_build.bulk("Cu", "fcc", a=3.6, cubic=True) * (4, 4, 4)
    atoms.positions += shake * np.random.default_rng(3).normal(size=atoms.positions.shape)
    return atoms


DUMP = """ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
{count}
ITEM: BOX BOUNDS pp pp pp
1.5 15.9
0 14.4
0 14.4
ITEM: ATOMS id type x y z
{rows}
"""


def dump(atoms) -> str:
    """A frame as LAMMPS writes it."""
    rows = [f"{k} 1 {x} {y} {z}" for k, (x, y, z) in enumerate(atoms.positions.tolist(), 1)]
    return DUMP.format(count=len(rows), rows="\n".join(reversed(rows)))


@pytest.mark.parametrize(
    "name", ["a.xyz", "POSCAR", "a.cfg", "a.cif", "a.xsf", "a.gro", "a.pdb", "b.lmp", "a.nc"]
)
def test_what_ase_writes_is_read(tmp_path: Path, name: str):
    """Each format gives the same crystal, and its species where the format has symbols."""
    if name == "a.nc":
        pytest.importorskip("netCDF4")
    form = {"b.lmp": "lammps-data", "a.nc": "netcdftrajectory"}.get(name)
    ase_io.write(tmp_path / name, copper(), format=form)
    crystal = read(tmp_path / name)
    assert (crystal.lattice, len(crystal.positions)) == ("fcc", 256)
    assert crystal.constant == pytest.approx(3.6, rel=2e-4)
    assert crystal.periodic.all()
    assert crystal.share == 1.0
    if name != "b.lmp":
        assert set(crystal.species or ()) == {"Cu"}


def test_a_lammps_dump_of_several_frames(tmp_path: Path):
    """Frames come in order, with atoms sorted by id and one common lattice frame."""
    texts = [dump(copper(shake)) for shake in (0.0, 0.05, 0.08)]
    path = tmp_path / "run.dump"
    path.write_text("".join(texts))
    found = list(read_all(path))
    assert [len(one.positions) for one in found] == [256] * 3
    assert found[0].positions[:4] == pytest.approx(copper().positions[:4])
    assert {one.lattice for one in found} == {"fcc"}
    assert all(np.array_equal(one.orient, found[0].orient) for one in found)
    assert len({one.constant for one in found}) == 1
    assert read(path, frame=2).positions == pytest.approx(found[2].positions)
    with pytest.raises(FileFormatError, match="frame: expected a number from 0 to 2, got 3"):
        read(path, frame=3)
    # The name gives no hint, so the reader recognises the format by its first lines.
    path.rename(tmp_path / "run.0")
    assert len(list(atom_frames(tmp_path / "run.0"))) == 3


@pytest.mark.parametrize("name", ["a.traj", "a.json", "a.db", "a.pckl", "a.py", "a.gpw"])
def test_formats_that_may_run_something_are_refused(tmp_path: Path, name: str):
    """Such files are refused before their content is interpreted: no unpickling, no code is run."""
    marker = tmp_path / "ran"

    class Payload:
        def __reduce__(self):
            return (Path.touch, (marker,))

    path = tmp_path / name
    if name.endswith((".traj", ".json")):
        ase_io.write(path, copper())
    elif name.endswith(".py"):
        path.write_text(f"open({str(marker)!r}, 'w')\natoms = 1\n")
    else:
        path.write_bytes(pickle.dumps(Payload()))
    with pytest.raises(FileFormatError, match=r"(not read|unknown format)"):
        read(path)
    assert not marker.exists()
    with pytest.raises(FileFormatError, match=r"form: expected one of|a pickle of Python"):
        read(path, form="traj")


def text_of(tmp_path: Path) -> list[str]:
    """The lines of an extended XYZ file."""
    ase_io.write(tmp_path / "good.xyz", copper())
    return (tmp_path / "good.xyz").read_text().splitlines()


@pytest.mark.parametrize(
    ("line", "new", "message"),
    [
        (1, "many", "line 1: expected the number of atoms"),
        (1, "300", "line 258: the file ends after 256 of 300 atoms"),
        (1, "99999999999999", "the file ends after 256"),
        (1, "200", "line 203: expected the number of atoms"),
        (1, "255", "line 258: expected the number of atoms of a frame, got 'Cu"),
        (7, "Cu 1.0 2.0", "line 7: expected 4 columns, got [30]"),
        (7, "Cu 1.0 2.0 x3", "line 7: expected a number in column 4"),
        (7, "", "line 7: expected 4 columns, got [30]"),
        (2, 'Lattice="1 2 3" Properties=species:S:1:pos:R:3', "line 2: Lattice: expected nine"),
        (2, 'Properties=species:S:1:pos:R:3 pbc="T T T"', "expected edge 1 of the cell, along"),
        (9, "Cu nan 0 0", r"frame 0: positions\[6, 0\] = nan"),
    ],
)  # fmt: skip
def test_damage_is_named_by_its_line(tmp_path: Path, line: int, new: str, message: str):
    """Wrong counts, short rows, words for numbers, boxes without edges and NaN are refused."""
    rows = text_of(tmp_path)
    rows[line - 1] = new
    (tmp_path / "a.xyz").write_text("\n".join(rows) + "\n")
    with pytest.raises(GeomtorsionError, match=message):
        list(read_all(tmp_path / "a.xyz"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("ITEM: TIMESTEP", "TIMESTEP", "line 1: expected ITEM: TIMESTEP"),
        ("ITEM: BOX", "ITEM: CUBE", "expected ITEM: BOX"),
        ("\n256\n", "\n99999999999\n", "ends after 256 of 99,999,999,999"),
        ("\n256\n", "\n-1\n", "line 4: expected the number of atoms"),
        (
            "\n256\n",
            "\n255\n",
            "line 265: expected ITEM: TIMESTEP after the 255 atoms that line 4 declares",
        ),
        ("\n7 1 ", "\n7 one ", "line 259: expected a number in column 2"),
    ],
)
def test_damaged_dumps_are_named(tmp_path: Path, old: str, new: str, message: str):
    """Damaged LAMMPS dumps are refused with the line and the reason."""
    text = dump(copper())
    assert old in text
    path = tmp_path / "a.dump"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(FileFormatError, match=message):
        read(path)


def test_missing_and_unknown_files_are_refused(tmp_path: Path):
    """A missing file, a folder, and empty, packed or unknown files are refused."""
    (tmp_path / "empty.xyz").write_text("")
    (tmp_path / "a.xyz.gz").write_bytes(b"\x1f\x8b")
    (tmp_path / "a.unknown").write_text("hello\n")
    for name, message in (
        ("none.xyz", "cannot be read"),
        (".", "not a regular file"),
        ("empty.xyz", "expected atoms, got none"),
        ("a.xyz.gz", "damaged or truncated"),
        ("a.unknown", "got a file of unknown format"),
    ):
        with pytest.raises(FileFormatError, match=message):
            read(tmp_path / name)
    with pytest.raises(ArgumentError, match="name of a file"):
        read(3)
    with pytest.raises(FileFormatError, match="frame: expected a whole number"):
        read(tmp_path / "empty.xyz", frame=-1)
    assert "extxyz" in FORMATS


def test_a_slab_needs_no_third_edge(tmp_path: Path):
    """Edges along directions without periodicity may be missing."""
    atoms = copper()
    atoms.cell[2] = 0
    atoms.pbc = (True, True, False)
    ase_io.write(tmp_path / "slab.xyz", atoms)
    crystal = read(tmp_path / "slab.xyz")
    assert crystal.periodic.tolist() == [True, True, False]
    assert crystal.dislocations().lines == ()


@pytest.mark.parametrize("name", ["a.xyz", "a.dump"])
def test_a_byte_order_mark_is_skipped(tmp_path: Path, name: str):
    """Files with a byte order mark are read, and one atom too many in them is still refused."""
    text = dump(copper()) if name == "a.dump" else "\n".join(text_of(tmp_path))
    path = tmp_path / name
    path.write_bytes(text.encode("utf-8-sig"))
    assert len(read(path).positions) == 256
    path.write_text(text.replace("256", "255", 1))
    with pytest.raises(
        FileFormatError, match=r"after the 255 atoms|line 258: expected the number of atoms"
    ):
        read(path)


def test_the_length_of_a_cfg_file_counts(tmp_path: Path):
    """Cells are in units of A, which ase ignores; an A that is not a positive length is refused."""
    path = tmp_path / "a.cfg"
    ase_io.write(path, copper())
    text = path.read_text()
    assert "A = 1.0 Angstrom" in text
    for length, times in (("3.5 Angstrom (basic length-scale)", 3.5), ("1e-1", 0.1)):
        path.write_text(text.replace("A = 1.0 Angstrom", f"A = {length}"))
        found = read(path)
        assert found.constant == pytest.approx(3.6 * times, rel=1e-6)
        assert found.cell == pytest.approx(4 * 3.6 * times * np.eye(3))
    for length in ("0 Angstrom", "nan", "one", ""):
        path.write_text(text.replace("A = 1.0 Angstrom", f"A = {length}"))
        with pytest.raises(
            FileFormatError,
            match=r"line [0-9]+: A: expected (a length above 0|a finite number|1 number)",
        ):
            read(path)


def test_a_gro_file_that_is_cut_is_refused(tmp_path: Path):
    """A .gro file with a wrong atom count is refused; ase would read any last row as the cell."""
    path = tmp_path / "a.gro"
    ase_io.write(path, copper())
    rows = path.read_text().splitlines()
    assert len(read(path).positions) == int(rows[1]) == 256
    for some in (rows[:200], rows[:-1], [rows[0], "255", *rows[2:]], rows[:2], rows[:1], ["", "x"]):
        path.write_text("\n".join(some) + "\n")
        with pytest.raises(FileFormatError, match=r"a\.gro: line 2: expected the number of atoms"):
            read(path)


@pytest.mark.parametrize("odd", ["1_8", "1_8.5", "1_0e-1", "\N{FULLWIDTH DIGIT ONE}.8"])
@pytest.mark.parametrize("name", ["a.xyz", "a.dump", "POSCAR", "a.xsf", "b.lmp"])
def test_what_only_python_takes_for_a_number_is_refused(tmp_path: Path, name: str, odd: str):
    """Python and ase read 1_8 as 18; geomtorsion refuses it, but not in titles and comments."""
    path = tmp_path / name
    if name == "a.dump":
        path.write_text(dump(copper()))
    else:
        ase_io.write(path, copper(), format={"b.lmp": "lammps-data"}.get(name))
    rows = path.read_text().split("\n")
    if name in ("POSCAR", "b.lmp"):
        rows[0] = f"Cu {odd}"
        path.write_text("\n".join(rows))
        assert len(read(path).positions) == 256
    # The last number of the last row is a coordinate.
    last = max(k for k, row in enumerate(rows) if row.strip())
    rows[last] = rows[last].rstrip().rpartition(" ")[0] + f" {odd}"
    path.write_text("\n".join(rows))
    with pytest.raises(
        FileFormatError, match=rf"line {last + 1}: expected a number in [a-z]+ \w+, got '{odd}'"
    ):
        read(path)


def test_a_lammps_data_file_counts_its_atoms(tmp_path: Path):
    """Counts that differ from the rows are refused: ase drops surplus atoms without a message."""
    path = tmp_path / "a.lmp"
    ase_io.write(path, copper(), format="lammps-data")
    text = path.read_text()
    assert "256 atoms" in text
    for said in (255, 257):
        path.write_text(text.replace("256 atoms", f"{said} atoms"))
        with pytest.raises(FileFormatError, match=rf"line [0-9]+: expected {said} atoms.*256 row"):
            read(path)
    path.write_text(text.replace("256 atoms", ""))
    with pytest.raises(FileFormatError, match="a row such as 5 atoms, the box and a section Atoms"):
        read(path)
    more = "".join(f"{k} 0.0 0.0 0.0\n" for k in range(1, 257))
    path.write_text(f"{text.rstrip()}\n\nVelocities # metal\n\n{more}")
    assert len(read(path).positions) == 256


SITES = [[(x + k / 2) / 4 for x in site] for site in np.ndindex(4, 4, 4) for k in (0, 1)]
FRACTIONS = "\n".join("{} {} {}".format(*site) for site in SITES)
ROWS = [[12.8 * x for x in site] for site in SITES]
POSCAR = "W\n{scale}\n{edge} 0 0\n0 12.8 0\n0 0 12.8\nW\n128\nDirect\n" + FRACTIONS
CELLS = {
    "a.xyz": '128\nLattice="{edge} 0 0 0 12.8 0 0 0 12.8"\n'
    + "\n".join("W {} {} {}".format(*row) for row in ROWS),
    "a.dump": "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n128\nITEM: BOX BOUNDS pp pp pp\n0 {edge}\n"
    "0 12.8\n0 12.8\nITEM: ATOMS id type x y z\n"
    + "\n".join(f"{k} 1 {x} {y} {z}" for k, (x, y, z) in enumerate(ROWS)),
    "a.data": "W\n\n128 atoms\n1 atom types\n0 {edge} xlo xhi\n0 12.8 ylo yhi\n0 12.8 zlo zhi\n\n"
    "Atoms # atomic\n\n" + "\n".join(f"{k} 1 {x} {y} {z}" for k, (x, y, z) in enumerate(ROWS)),
    "POSCAR": POSCAR,
    "POSCAR scale": POSCAR,
}


@pytest.mark.parametrize("name", CELLS)
@pytest.mark.parametrize("edge", ["inf", "-inf", "nan", "1e308", "1e200", "1e-320", "1e-200", "0"])
def test_a_cell_outside_of_the_range_is_refused(tmp_path: Path, name: str, edge: str):
    """An edge or a scale that is not finite, too large or too small is refused by our own error."""
    path = tmp_path / name.split()[0]
    scale = name == "POSCAR scale"
    text = CELLS[name].replace("{scale}", edge if scale else "1")
    path.write_text(text.replace("{edge}", "1" if scale else edge))
    with pytest.raises(GeomtorsionError, match=name.split()[0]):
        _ = read(path).lattice
