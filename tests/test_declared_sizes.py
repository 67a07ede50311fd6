"""Declared sizes: a file that declares more than it holds is refused before memory is allocated."""

from __future__ import annotations

import base64
import gzip
import json
import struct
import sys
import time
import tracemalloc
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from geomtorsion.errors import AllowanceError, FileFormatError, GeomtorsionError, LimitError
from geomtorsion.materials.crystals.atom_files import atom_frames
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.large_arrays import LargeArray, opened
from geomtorsion.materials.images import LatticeImage
from geomtorsion.materials.lines import DislocationNetwork
from geomtorsion.materials.maps import OrientationMap
from geomtorsion.ode import ODE, RungeKutta, SavedSolution, solve
from geomtorsion.support.files import read_toml, read_toml_text
from geomtorsion.support.workers import Bounds, work_within
from geomtorsion.teaching.exercises import grading
from geomtorsion.teaching.exercises.examiner import Examiner

# Bytes that a refusal may take, besides some hundred for each byte of a file that is read.
MOST = 50_000_000
POSCAR = "x\n1.0\n4 0 0\n0 4 0\n0 0 4\n"
XYZ = '2\nLattice="4 0 0 0 4 0 0 0 4" {}\nFe 0 0 0\nFe 1 1 1\n'
DATA = (
    "t\n\n{} atoms\n1 atom types\n0 4 xlo xhi\n0 4 ylo yhi\n0 4 zlo zhi\n\nAtoms # atomic\n\n"
    "1 1 0 0 0\n2 1 1 1 1\n"
)
VTK = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 1000 1000 1000\n"
PARADIS = (
    "numFileSegments = 1\nminCoordinates = [\n0\n0\n0\n]\nmaxCoordinates = [\n9\n9\n9\n]\n"
    "nodeCount = {}\n{}nodalData =\n{}"
)
ARMS = "".join(f"0,{k} 1 1 1 20000 0\n" + f"0,{1 - k} 1 0 0\n 0 0 1\n" * 20000 for k in (0, 1))
PHASE = "# Phase 1\n# MaterialName Fe\n# Symmetry 43\n# LatticeConstants 3 3 3 90 90 90\n"
PHASES = "".join(PHASE.replace("Phase 1", f"Phase {k}") for k in range(1, 300))
PIXEL = "0 0 0 0 0 1 1 1\n"
GRID = (
    "# GRID: SqrGrid\n# XSTEP: 1\n# YSTEP: 1\n# NCOLS_ODD: {0}\n# NCOLS_EVEN: {0}\n# NROWS: {0}\n"
)


def atoms(path: Path) -> object:
    """All frames of a file of atoms."""
    return list(atom_frames(path, "vasp-xdatcar" if path.name == "XDATCAR" else None))


def tiff(*, compression: int, strip: bytes, samples: int = 1, tile: int = 0) -> bytes:
    """A TIFF file of 64 x 64 pixels with one strip, or with one tile of the given side."""
    where = [(322, 4, tile), (323, 4, tile), (324, 4, 8), (325, 4, len(strip))]
    if not tile:
        where = [(273, 4, 8), (278, 4, 64), (279, 4, len(strip))]
    tags = sorted([
        (256, 4, 64), (257, 4, 64), (258, 3, 8), (259, 3, compression), (262, 3, 1),
        (277, 3, samples), (284, 3, 1), *where,
    ])  # fmt: skip
    rows = b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags)
    head = b"II*\0" + struct.pack("<I", 8 + len(strip)) + strip
    return head + struct.pack("<H", len(tags)) + rows + bytes(4)


@cache
def bomb(size: int = 300_000_000) -> bytes:
    """Many zeros packed into few bytes."""
    packer, part = zlib.compressobj(9), bytes(10**7)
    return b"".join(packer.compress(part) for _ in range(size // 10**7)) + packer.flush()


def diagonal(count: int) -> str:
    """A table whose nodes are only on the diagonal of a cube."""
    names = ",".join(f"e_{i}_{mu}" for i in range(3) for mu in range(3))
    return f"x,y,z,{names}\n" + "".join(f"{k},{k},{k}{',1' * 9}\n" for k in range(count))


CASES: list[tuple[str, str | bytes | Callable[[], bytes], Callable[[Path], object], str]] = [
    ("columns.xyz", XYZ.format("Properties=species:S:1:pos:R:1000000000"), atoms, "4 columns"),
    ("quoted.xyz", XYZ.format("Properties='species:S:1:a:I:300000000'"), atoms, "4 columns"),
    ("count.xyz", "1000000000\nx\nFe 0 0 0\n", atoms, "ends after 1"),
    ("rows.xyz", "3000\nx\n" + "".join(f"Fe {'1 ' * k}\n" for k in range(3000)), atoms, "line 2"),
    ("a.lmp", DATA.format("2 atoms\n1000000000"), atoms, "got 2 rows"),
    ("wide.tif", tiff(compression=1, strip=bytes(64), tile=60000), LatticeImage.read, "GB"),
    ("samples.tif", tiff(compression=1, strip=bytes(64), samples=60000), LatticeImage.read, "grey"),
    ("far.csv", diagonal(290), SampledFrame.read, "290 x 290 x 290 nodes"),
    ("a.data", PARADIS.format(10**9, "", "0,0 1 1 1 0 0\n"), DislocationNetwork.read, "the end"),
    (
        "head.data",
        PARADIS.format(1, "x = [\n" + "1\n" * 100_000, ""),
        DislocationNetwork.read,
        "expected ] after x, got the end of the file",
    ),
    ("arms.data", PARADIS.format(2, "", ARMS), DislocationNetwork.read, "at most 100 arms"),
    ("a.ang", PHASES + GRID.format(2) + PIXEL, OrientationMap.read, "at most 255 phases"),
    ("b.ang", PHASE + GRID.format(10**9) + PIXEL, OrientationMap.read, "NCOLS_ODD"),
    ("deep.json", "[" * 100_000, DislocationNetwork.read, "nested too deeply"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "content", "read", "words"), CASES, ids=[x[0] for x in CASES])
def test_declared_sizes_are_bounded(
    name: str,
    content: str | bytes | Callable[[], bytes],
    read: Callable[[Path], object],
    words: str,
    tmp_path: Path,
):
    """Each file is refused with our own message before memory is allocated for what it declares."""
    if name.endswith((".xyz", ".lmp")):
        pytest.importorskip("ase")
    if name.endswith(".tif"):
        pytest.importorskip("tifffile")
    path = tmp_path / name
    given = content() if callable(content) else content
    path.write_bytes(given.encode() if isinstance(given, str) else given)
    with peak() as most, pytest.raises((FileFormatError, LimitError), match=words):
        read(path)
    assert most[0] < MOST + 200 * path.stat().st_size


@contextmanager
def peak() -> Iterator[list[int]]:
    """A list that gets the largest number of bytes that were allocated at once in the block."""
    most: list[int] = []
    tracemalloc.start()
    try:
        yield most
    finally:
        most.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()


TEXTS = {
    "a.lmp.gz": atoms,
    "a.dump.gz": atoms,
    "a.xyz.gz": atoms,
    "a.poscar.gz": atoms,
    "a.cfg.gz": atoms,
    "network.json.gz": DislocationNetwork.read,
    "network.data.gz": DislocationNetwork.read,
    "a.ctf.gz": OrientationMap.read,
    "a.ang.gz": OrientationMap.read,
    "a.csv.gz": SampledFrame.read,
    "a.txt.gz": SampledFrame.read,
    "a.toml.gz": read_toml,
}
HEADS = {
    "a.dump.gz": "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n50000000\nITEM: BOX BOUNDS\n"
    "ITEM: ATOMS x\n",
    "a.xyz.gz": "50000000\nx\nFe 0 0 0\n",
    "a.lmp.gz": "LAMMPS data file\n\n",
    "network.data.gz": "dataFileVersion = 4\n",
    "a.ctf.gz": "Channel Text File\n",
    "a.ang.gz": PHASE,
    "a.txt.gz": "x y u v\n",
    "a.poscar.gz": POSCAR,
}


@pytest.mark.parametrize("name", TEXTS)
def test_packed_text_is_counted_while_it_is_unpacked(name: str, tmp_path: Path):
    """Some kilobytes that unpack to a hundred megabytes of lines are refused early."""
    if TEXTS[name] is atoms:
        pytest.importorskip("ase")
    read, path = TEXTS[name], tmp_path / name
    path.write_bytes(gzip.compress(HEADS.get(name, "").encode() + b"1\n" * 50_000_000))
    with peak() as most, pytest.raises(LimitError, match="when it is unpacked, got more"):
        read(path)
    # The limit is 200 MB, of which a packed file may use any part.
    assert most[0] < 5 * MOST


def test_comments_of_a_data_file_take_no_memory(tmp_path: Path):
    """Lines without words are skipped while the rows of a LAMMPS file are read."""
    text = DATA.format(2)
    path = tmp_path / "a.data.gz"
    path.write_bytes(
        gzip.compress(text.replace("\n1 1 0", "\n" + "#\n" * 1_500_000 + "1 1 0").encode())
    )
    with peak() as most:
        [frame] = atom_frames(path, "lammps-data")
    assert len(frame.positions) == 2
    # The text takes one byte for each character, and four while it is divided into lines.
    assert most[0] < 30_000_000


def packed_vtu(path: Path) -> None:
    """Many arrays that name one packed block, far larger than the file."""
    packed = bomb(20_000_000)
    head = struct.pack("<4I", 1, 32768, 32768, len(packed))
    appended = base64.b64encode(head).decode() + base64.b64encode(packed).decode()
    arrays = "".join(
        f'<DataArray type="Float64" Name="e_{k}" format="appended" offset="0"/>' for k in range(99)
    )
    path.write_text(
        '<VTKFile type="UnstructuredGrid" compressor="vtkZLibDataCompressor" '
        'header_type="UInt32" byte_order="LittleEndian"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="4" NumberOfCells="0"><PointData>{arrays}</PointData></Piece>'
        f'</UnstructuredGrid><AppendedData encoding="base64">_{appended}</AppendedData></VTKFile>'
    )


def packed_zarr(packing: str) -> Callable[[Path], None]:
    """A Zarr array of 2592 bytes whose only chunk unpacks to 300 MB."""

    def write(path: Path) -> None:
        zarr, numcodecs = pytest.importorskip("zarr"), pytest.importorskip("numcodecs")
        packer = getattr(numcodecs, packing)()
        made = zarr.create_array(
            str(path), shape=(2, 2, 9, 9), chunks=(2, 2, 9, 9), dtype="f8", zarr_format=2,
            compressors=packer,
        )  # fmt: skip
        made[:] = np.eye(2)[:, :, None, None] * np.ones((9, 9))
        assert opened(str(path))[:].sum() == 2 * 81
        (path / "0.0.0.0").write_bytes(packer.encode(bytes(300_000_000)))

    return write


def packed_hdf5(path: Path) -> None:
    """A field whose only chunk unpacks to 300 MB."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        file["axis_x"] = file["axis_y"] = np.arange(9.0)
        data = file.create_dataset(
            "coframe", (2, 2, 9, 9), chunks=(2, 2, 9, 9), compression="gzip", dtype="f8"
        )
        data.id.write_direct_chunk((0, 0, 0, 0), bomb())


def packed_tiff(tile: int) -> Callable[[Path], object]:
    """An image whose only strip or tile unpacks to 300 MB."""
    return lambda path: path.write_bytes(tiff(compression=8, strip=bomb(), tile=tile))


def text(content: str) -> Callable[[Path], object]:
    """A function that writes a text."""
    return lambda path: path.write_text(content)


def whole(path: Path) -> object:
    """All values of a field that is read in parts."""
    return LargeArray.of(path).read((0, 0), (9, 9))


# Name of a file -> its writer, its reader, and the library of its format.
BOMBS: dict[str, tuple[Callable[[Path], object], Callable[[Path], object], str]] = {
    "a.vtu": (packed_vtu, SampledFrame.read, "meshio"),
    "a.vtk": (text(VTK + "ORIGIN 0 0 0\nSPACING 1 1 1\n"), SampledFrame.read, "meshio"),
    "a.poscar": (text(f"{POSCAR}Fe\n1000000000\nDirect\n0 0 0\n"), atoms, "ase"),
    "XDATCAR": (text(f"{POSCAR}H9999999999\n1\nDirect configuration= 1\n0 0 0\n"), atoms, "ase"),
    "a.cfg": (text("Number of particles = 1000000000\nA = 1\n"), atoms, "ase"),
    "a.h5": (packed_hdf5, SampledFrame.read, "h5py"),
    "strip.tif": (packed_tiff(0), LatticeImage.read, "tifffile"),
    "tile.tif": (packed_tiff(64), LatticeImage.read, "tifffile"),
    "gzip.zarr": (packed_zarr("GZip"), whole, "zarr"),
    "zstd.zarr": (packed_zarr("Zstd"), whole, "zarr"),
}


@pytest.mark.skipif(sys.platform != "linux", reason="these workers are forks")
@pytest.mark.parametrize("name", BOMBS)
def test_a_worker_with_limits_survives_a_bomb(name: str, tmp_path: Path):
    """A library that unpacks a bomb fails, or a worker ends at its limit: this process lives."""
    write, read, library = BOMBS[name]
    pytest.importorskip(library)
    write(tmp_path / name)

    def work(begun: Callable[[], None]) -> None:
        begun()
        with suppress(GeomtorsionError):
            read(tmp_path / name)
            sys.exit(0)
        sys.exit(2)

    with suppress(AllowanceError):
        assert work_within(Bounds(seconds=60, megabytes=150), work, 2) == 2


@pytest.mark.parametrize(("kind", "words"), [("deep", "50 deep"), ("chunk", "no larger")])
def test_hdf5(kind: str, words: str, tmp_path: Path):
    """Deep groups and a chunk larger than its data are refused."""
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        group = file
        for _ in range(300 if kind == "deep" else 0):
            group = group.create_group("g")
        side = 7000 if kind == "chunk" else 9
        file.create_dataset(
            "coframe", (2, 2, 9, 9), chunks=(2, 2, side, side), maxshape=(2, 2, None, None),
            compression="gzip", dtype="f8",
        )  # fmt: skip
    with pytest.raises(LimitError, match=words):
        SampledFrame.read(path)


@pytest.mark.parametrize(
    "text",
    [
        ".".join("a" * 48_000) + " = 1",
        f"[{'.'.join('a' * 48_000)}]",
        f"x = {{ {'.'.join('a' * 48_000)} = 1 }}",
        ".".join(['"a"'] * 33) + " = 1",
    ],
    ids=["key", "table", "inline", "quoted"],
)
def test_dotted_keys(text: str):
    """Keys of very many parts are refused: 97 kB of them took 9.6 GB of memory."""
    with pytest.raises(LimitError, match="at most 32 parts"):
        read_toml_text(text, "a.toml")


def test_dots_in_texts_comments_and_numbers():
    """Texts, comments and numbers may contain any number of dots."""
    dots = ".".join("a" * 100)
    text = f'x = "{dots}"\ny = \'{dots}\'\nz = """\n{dots} = 1\n"""\n# {dots}\n'
    assert read_toml_text(text + ".".join("b" * 32) + " = 1.5", "a.toml").data["x"] == dots


@pytest.mark.parametrize("number", ["1e9999999", "1/0", "f0x1p9999999", "9" * 5000])
def test_numbers_of_saved_solutions(number: str, tmp_path: Path):
    """Numbers that would need very many digits are refused in a saved solution."""
    path = tmp_path / "a.npz"
    solve(ODE.of({"x": "-x"}, [1]), [0.1], 1e-6, RungeKutta()).save(path)
    arrays = dict(np.load(path))
    metadata = json.loads(str(arrays["metadata"]))
    metadata["problem"]["start"][0] = number
    arrays["metadata"] = np.array(json.dumps(metadata))
    np.savez(path, **arrays)
    with pytest.raises(FileFormatError, match="not a solution saved"):
        SavedSolution.load(path)


def test_one_file_does_not_end_the_marking(tmp_path: Path):
    """A file that exceeds a limit is reported as not graded; the other files are graded."""
    good = 'seed = 1\n[answers]\n"3.2" = "1/tan(phi2)"\n'
    (tmp_path / "ada.toml").write_text(good)
    (tmp_path / "eve.toml").write_text(".".join("a" * 48_000) + " = 1\n")
    rows = {row["file"]: row for row in grading.grade(tmp_path, tmp_path / "marks.csv").rows}
    assert rows["eve.toml"]["status"] == grading.REFUSED
    assert "at most 32 parts" in rows["eve.toml"]["remarks"]
    assert rows["ada.toml"]["status"] == grading.GRADED


def asleep(_request: object) -> None:
    """An examiner process that never answers."""
    time.sleep(60)


def test_a_file_that_is_not_read_in_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A file that is not read in time is refused; the student's row states the reason."""
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[1]))
    monkeypatch.setattr(grading, "SECONDS", 0.1)
    busy = Examiner(function=f"{__name__}:asleep")
    monkeypatch.setattr(grading, "Examiner", lambda *_: busy)
    (tmp_path / "eve.toml").write_text("seed = 1\n")
    (row,) = grading.grade(tmp_path, tmp_path / "marks.csv", ["3.2"]).rows
    assert row["status"] == grading.REFUSED
    assert "eve.toml could not be read: it took longer than 0.1 s" in row["remarks"]
