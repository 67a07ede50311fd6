"""LAMMPS and XYZ files of real programs: dumps, data files, species by number, packed files."""

# The tests pass what users pass, including wrong types.
# pyright: reportArgumentType=false

import bz2
import gzip
import json
import sys
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError, LimitError, MissingExtraError
from geomtorsion.materials.crystals import Crystal, read, read_all
from geomtorsion.materials.lines import DislocationNetwork
from tests.cli.running import run

SITES = np.array([
    np.add(cell, site)
    for cell in product(range(4), repeat=3)
    for site in ((0, 0, 0), (0, 0.5, 0.5), (0.5, 0, 0.5), (0.5, 0.5, 0))
]) * 3.6  # fmt: skip
SIZE = 4 * 3.6
# Type 1 is fcc and type 2 fills its octahedral holes (rock salt): each sublattice is a crystal.
SALT = np.concatenate([SITES, SITES + np.array([1.8, 0, 0])])
KINDS = np.repeat([1, 2], len(SITES))


def rows_of(form: str, places: np.ndarray = SITES, kinds: np.ndarray | None = None) -> str:
    """Rows of atoms in reverse order; {k} {t} {x} {y} {z} become number, type and position."""
    types = np.ones(len(places), dtype=int) if kinds is None else kinds
    made = [
        form.format(k=k + 1, t=types[k], x=x, y=y, z=z)
        for k, (x, y, z) in enumerate(places.tolist())
    ]
    return "\n".join(reversed(made))


def dump(
    columns: str, form: str, head: str = "", box: str = " pp pp pp", places: np.ndarray = SITES
) -> str:
    """A frame of a dump."""
    sides = f"0 {SIZE}\n" * 3
    return (
        f"{head}ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{len(places)}\nITEM: BOX BOUNDS{box}\n"
        f"{sides}ITEM: ATOMS {columns}\n{rows_of(form, places)}\n"
    )


HEADS = "ITEM: UNITS\nmetal\nITEM: TIME\n0.5\n"
DUMPS = {
    "plain": dump("id type x y z", "{k} {t} {x} {y} {z}"),
    "units and time": dump("id type x y z", "{k} {t} {x} {y} {z}", HEADS),
    "no type": dump("id x y z", "{k} {x} {y} {z}"),
    "no id": dump("type x y z", "{t} {x} {y} {z}"),
    "no flags": dump("id type x y z", "{k} {t} {x} {y} {z}", box=""),
    "trailing blanks": dump("id type x y z ", "{k} {t} {x} {y} {z} "),
    "element": dump("id element xu yu zu", "{k} Cu {x} {y} {z}"),
    "labels": dump("id type x y z", "{k} Cu {x} {y} {z}"),
    "typelabel": dump("id type typelabel x y z", "{k} {t} Cu {x} {y} {z}"),
    "velocities": dump("id type x y z vx vy vz", "{k} {t} {x} {y} {z} 0 1 2"),
    "scaled": dump("id type xs ys zs", "{k} {t} {x} {y} {z}", places=SITES / SIZE),
    "scaled, unwrapped": dump("id xsu ysu zsu", "{k} {x} {y} {z}", places=SITES / SIZE + 1),
}


@pytest.mark.parametrize("name", DUMPS)
@pytest.mark.parametrize("frames", [1, 2])
def test_dumps(name: str, frames: int, tmp_path: Path):
    """Each variant that LAMMPS writes gives the crystal in each frame, without ase."""
    path = tmp_path / "dump.100"
    path.write_text(DUMPS[name] * frames)
    found = list(read_all(path))
    assert len(found) == frames
    for crystal in found:
        assert (crystal.lattice, crystal.count, crystal.share) == ("fcc", 256, 1.0)
        assert crystal.constant == pytest.approx(3.6, rel=1e-6)
        assert crystal.periodic.all()
    if "id" in name or name == "no id":
        return
    assert found[0].positions[:3] % SIZE == pytest.approx(SITES[:3], abs=1e-9)


@pytest.mark.parametrize("general", [False, True])
def test_a_tilted_dump(general: bool, tmp_path: Path):
    """The bounds of a tilted box enclose it; scaled positions are fractions of its edges."""
    cell = np.array([[SIZE, 0, 0], [3.6, SIZE, 0], [-3.6, 3.6, SIZE]])
    shares = SITES @ np.linalg.inv(cell) % 1.0
    box = f" xy xz yz pp pp pp\n-3.6 {SIZE + 3.6} 3.6\n0 {SIZE + 3.6} -3.6\n0 {SIZE} 3.6"
    if general:
        box = " abc origin pp pp pp\n" + "\n".join(f"{a} {b} {c} 0" for a, b, c in cell.tolist())
    text = dump("id type xs ys zs", "{k} {t} {x} {y} {z}", box=box, places=shares)
    path = tmp_path / "tilted.dump"
    path.write_text(text.replace(f"0 {SIZE}\n" * 3, ""))
    crystal = read(path)
    assert crystal.cell == pytest.approx(cell)
    assert (crystal.lattice, crystal.share) == ("fcc", 1.0)


HEAD = "made\n\n{count} atoms\n{types} atom types\n0 {s} xlo xhi\n0 {s} ylo yhi\n0 {s} zlo zhi\n"
# Style -> one row of it; image flags or a comment may follow.
STYLES = {
    "atomic": "{k} {t} {x} {y} {z}",
    "charge": "{k} {t} 0.5 {x} {y} {z}",
    "molecular": "{k} 7 {t} {x} {y} {z}",
    "full": "{k} 7 {t} -0.5 {x} {y} {z}",
    "sphere": "{k} {t} 1.0 2.0 {x} {y} {z}",
    "dipole": "{k} {t} 0 {x} {y} {z} 0.6 0 0.8",
    "spin": "{k} {t} {x} {y} {z} 0.6 0 0.8 2",
}


def data(form: str, style: str = "", extra: str = "") -> str:
    """A data file."""
    head = HEAD.format(count=len(SITES), types=1, s=SIZE)
    return f"{head}{extra}\nAtoms{style}\n\n{rows_of(form)}\n\nVelocities\n\n1 0 0 0\n"


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("flags", ["", " 0 0 -1", " # Cu"])
@pytest.mark.parametrize("named", [True, False])
def test_data_files(style: str, flags: str, named: bool, tmp_path: Path):
    """Each named style is read, and the usual ones are recognised by their columns, whatever the
    file's name; for other styles the error states what to write."""
    path = tmp_path / "copper.data"
    path.write_text(data(STYLES[style] + flags, f" # {style}" if named else ""))
    if not named and style in ("sphere", "dipole", "spin"):
        with pytest.raises(FileFormatError, match=r"expected the style of the atoms \(Atoms # "):
            read(path)
        return
    crystal = read(path)
    assert (crystal.lattice, crystal.count, crystal.share) == ("fcc", 256, 1.0)
    assert crystal.positions[:5] == pytest.approx(SITES[:5])


def test_labels_of_types(tmp_path: Path):
    """Species are the labels of the types if the file has labels."""
    for extra in ("\nMasses\n\n1 63.546 # Cu\n", "\nAtom Type Labels\n\n1 Cu\n", ""):
        path = tmp_path / "data.copper"
        path.write_text(data(STYLES["atomic"], "", extra))
        assert set(read(path).species or ()) == {"Cu" if extra else "1"}


XYZ = {
    "dump xyz": "Atoms. Timestep: 0",
    "OVITO": f'Lattice="{SIZE} 0 0 0 {SIZE} 0 0 0 {SIZE}" Properties=species:S:1:pos:R:3',
    "braces": f"Lattice={{{SIZE} 0 0 0 {SIZE} 0 0 0 {SIZE}}} pbc=[T, T, F]",
    "origin": f'Origin="1 1 1" Lattice="{SIZE} 0 0 0 {SIZE} 0 0 0 {SIZE}" pbc="1 1 1" t=0.5',
}


@pytest.mark.parametrize("name", XYZ)
def test_species_by_number(name: str, tmp_path: Path):
    """LAMMPS and OVITO write types as numbers; `species` selects a sublattice by such a number."""
    path = tmp_path / "a.xyz"
    path.write_text(f"{len(SALT)}\n{XYZ[name]}\n{rows_of('{t} {x} {y} {z}', SALT, KINDS)}\n")
    crystal = read(path, species=2)
    assert (crystal.lattice, crystal.count) == ("fcc", 256)
    assert crystal.periodic.tolist() == {
        "dump xyz": [False] * 3, "braces": [True, True, False],
    }.get(name, [True] * 3)  # fmt: skip
    assert set(crystal.species or ()) == {"2"}
    for wrong, words in (
        (3, r"\(1, 2\), got '3'"),
        ([], "expected symbols"),
        (1.5, "expected a list"),
    ):
        with pytest.raises(FileFormatError, match=words):
            read(path, species=wrong)


def test_species_on_the_command_line(tmp_path: Path):
    """`--species` selects a sublattice as in Python and refuses a species that the file lacks."""
    path = tmp_path / "salt.data"
    text = HEAD.format(count=512, types=2, s=SIZE)
    path.write_text(f"{text}\nAtoms # charge\n\n{rows_of('{k} {t} 1 {x} {y} {z}', SALT, KINDS)}\n")
    shown = run("crystal", str(path), "--species", "1", "--format", "json")
    (frame,) = json.loads(shown.stdout)["frames"]
    assert (frame["atoms"], frame["lattice"], frame["lines"]) == (256, "fcc", [])
    assert "expected species of the file (1, 2), got 'U'" in run(
        "crystal", str(path), "--species", "U", code=2
    ).stderr.replace("\n", " ").replace("  ", " ")


@pytest.mark.parametrize("pack", [gzip.compress, bz2.compress])
def test_packed_files(pack, tmp_path: Path):
    """Packed atoms and networks are unpacked while reading; damage and bombs are refused."""
    end = {gzip.compress: ".gz", bz2.compress: ".bz2"}[pack]
    for name, text in (
        ("a.dump", DUMPS["plain"]),
        ("a.data", data(STYLES["atomic"])),
        ("a.xyz", f"256\n{XYZ['OVITO']}\n{rows_of('{t} {x} {y} {z}')}\n"),
    ):
        path = tmp_path / f"{name}{end}"
        path.write_bytes(pack(text.encode()))
        assert read(path).share == 1.0
        path.write_bytes(pack(text.encode())[:-20])
        with pytest.raises(FileFormatError, match="damaged or truncated"):
            read(path)
    lines = (
        "minCoordinates = [\n0\n0\n0\n]\nmaxCoordinates = [\n9\n9\n9\n]\nnodeCount = 2\n"
        "nodalData =\n0,0 1 1 1 1 0\n0,1 0 0 1\n1 1 0\n0,1 2 1 1 1 0\n0,0 0 0 -1\n1 1 0\n"
    )
    for name in ("net.data", "net"):
        path = tmp_path / f"{name}{end}"
        path.write_bytes(pack(lines.encode()))
        assert len(DislocationNetwork.read(path).lines) == 1
    bomb = tmp_path / f"bomb.xyz{end}"
    bomb.write_bytes(pack(b"1\n" + b"x" * 300_000_000))
    with pytest.raises(LimitError, match="expected at most .* bytes when it is unpacked"):
        list(read_all(bomb, form="xyz"))


ZSTD = b"\x28\xb5\x2f\xfd\x04\x00"
NETWORK = "dataFileVersion = 4\nnodeCount = 1\nnodalData =\n0,0 1 1 1 0 0\n"
NO_BOX = data(STYLES["atomic"]).replace(f"0 {SIZE} ylo yhi\n", "")
BAD_BOX = data(STYLES["atomic"]).replace(f"0 {SIZE} ylo yhi", "0 wide ylo yhi")
MIXED = (
    data(STYLES["atomic"])
    .replace("\n256 1 ", "\n300 1 0 0 0\n256 1 ")
    .replace("\n100 1 ", "\n100 1 1 ")
)
BINARY = dump("id type ix iy iz", "{k} {t} 0 0 0")
SHORT = data(STYLES["atomic"]).replace("\n100 1 ", "\n100 ")
REFUSED = [
    ("a.dump.zst", ZSTD, "zstd -d a.dump.zst"),
    ("a.dump", dump("id vx vy vz", "{k} {x} {y} {z}"), "expected columns x y z .*got id vx vy vz"),
    ("b.dump", BINARY, r"dump 1 all custom 100 a\.dump id type x y z"),
    ("c.dump", "garbage\n", "expected ITEM: TIMESTEP, got 'garbage'.*--read-as"),
    ("d.dump", "ITEM: TIMESTEP\n0\nITEM: ENTRIES c\n1\n", "ITEM: NUMBER .*got TIMESTEP, ENTRIES"),
    ("net.data", NETWORK, "expected atoms, got a network of dislocation lines"),
    ("box.data", NO_BOX, "expected the box of the atoms .ylo yhi."),
    ("side.data", BAD_BOX, "line 6: ylo yhi: expected a finite number, got 'wide'"),
    ("mixed.data", MIXED, "expected 256 atoms, as this line declares, got 257 rows"),
    ("short.data", SHORT, "line 167: expected 5 columns, got"),
    ("odd.data", "hello\nworld\n", "form=... .--read-as."),
    ("style.data", data("{k} {t} {x} {y} {z}", " # charge"), "expected 6 or more columns"),
    ("word.data", data("{k} {t} {x} {y} {z}", " # smd"), "style of the atoms .*got 'smd'"),
    ("a.xyz", "1\nProperties=species:S:1\nCu\n", "expected pos:R:3"),
    ("b.xyz", "1\nx\nCu 1 2\n", "got rows of 3 columns"),
    ("c.xyz", '1\nLattice="1 0 0 0 1 0 0 0 1" pbc="yes"\nCu 1 2 3\n', "pbc: expected T or F"),
]


@pytest.mark.parametrize(("name", "content", "words"), REFUSED, ids=[x[0] for x in REFUSED])
def test_refusals(name: str, content: str | bytes, words: str, tmp_path: Path):
    """The message names the kind of file, the expected content, and what can read it."""
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(FileFormatError, match=words):
        read(path)


@pytest.mark.parametrize("distance", [0.2, 0.0])
def test_overlapping_atoms_are_reported(distance: float, tmp_path: Path):
    """Overlapping atoms do not stop the analysis: the lattice is found and the pair is reported."""
    twice = np.append(SITES, SITES[99:100] + np.array([distance, 0, 0]), axis=0)
    path = tmp_path / "a.dump"
    path.write_text(dump("id type x y z", "{k} {t} {x} {y} {z}", places=twice))
    crystal = read(path)
    assert (crystal.lattice, crystal.overlapping.tolist()) == ("fcc", [[99, 256]])
    assert crystal.share > 0.8
    assert crystal.dislocations().lines == ()
    shown = run("crystal", str(path))
    assert "1 pair of atoms overlap: 99 and 256" in shown.stdout
    (frame,) = json.loads(run("crystal", str(path), "--format", "json").stdout)["frames"]
    assert frame["overlapping"] == [[99, 256]]


def test_axes_are_those_nearest_the_file():
    """An aligned crystal has the axes of the file, a turned one the nearest of its 24 variants."""
    assert Crystal(SITES, [SIZE] * 3).orient == pytest.approx(np.eye(3), abs=1e-9)
    for angle in (10.0, 35.0, -44.0, 100.0):
        turn = np.radians(angle)
        matrix = np.array([
            [np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1],
        ])  # fmt: skip
        found = Crystal(SITES @ matrix.T, np.diag([SIZE] * 3) @ matrix.T).orient
        rest = np.degrees(np.arccos(min(1.0, (np.trace(found) - 1) / 2)))
        assert rest == pytest.approx(abs((angle + 45) % 90 - 45), abs=1e-5)


def test_without_ase(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """XYZ and LAMMPS files are read without ase; for other formats the error names the extra."""
    for name in ("ase", "ase.io", "ase.io.formats"):
        monkeypatch.setitem(sys.modules, name, None)
    for name, text in (
        ("a.lammpstrj", DUMPS["plain"]),
        ("a.data", data(STYLES["atomic"])),
        ("a.xyz", f"256\n{XYZ['OVITO']}\n{rows_of('{t} {x} {y} {z}')}\n"),
    ):
        path = tmp_path / name
        path.write_text(text)
        assert read(path).count == 256
    (tmp_path / "POSCAR").write_text("x\n1.0\n4 0 0\n0 4 0\n0 0 4\nFe\n1\nDirect\n0 0 0\n")
    with pytest.raises(MissingExtraError, match=r"geomtorsion\[crystals\]"):
        read(tmp_path / "POSCAR")
