"""Files of another kind: messages name the kind by its content, and the remedy."""

import io
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import FileFormatError
from geomtorsion.support.file_kinds import KINDS


def workbook() -> bytes:
    """The beginning of an Excel workbook."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w") as archive:
        archive.writestr("[Content_Types].xml", "x" * 50)
        archive.writestr("xl/workbook.xml", "y")
    return target.getvalue()


# Name of the file, its content, words about its kind, words about what to do.
FILES = [
    ("a.dump", b"---\ncreator: LAMMPS\ntimestep: 0\nnatoms: 4\n", "in YAML", "dump 1 all custom"),
    ("a.yaml", b"creator: LAMMPS\ntimestep: 0\n", "in YAML", "dump 1 all custom"),
    ("b.dump", struct.pack("<q", -10) + b"DUMPCUSTOM" + bytes(90), "binary LAMMPS", "binary2txt"),
    ("c.bin", struct.pack("<q", -8) + b"DUMPATOM" + bytes(90), "binary LAMMPS", "binary2txt"),
    ("d.restart", b"LammpS RestartT\0" + bytes(90), "a LAMMPS restart", "write_data"),
    ("log.lammps", b"LAMMPS (2 Aug 2023)\n  using 1 OpenMP thread\n", "a log of LAMMPS", "dump"),
    ("e.dcd", struct.pack("<i", 84) + b"CORD" + bytes(90), "DCD", "extended XYZ"),
    ("f.xtc", b"\x00\x00\x07\xcb" + bytes(90), "XTC", "extended XYZ"),
    ("g.trr", b"\x00\x00\x07\xc9" + bytes(90), "TRR", "extended XYZ"),
    ("h.csv", b"<!DOCTYPE html>\n<html><body>404</body></html>", "a web page", "Download"),
    ("i.csv", b"version https://git-lfs.github.com/spec/v1\noid sha256:1\n", "Git LFS", "lfs pull"),
    ("j.csv", workbook(), "an Excel workbook", "as .csv"),
    ("k.csv", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(90), "old Excel", "as .csv"),
    ("l.csv", "x,y,u,v\n1,2,3,4\n".encode("utf-16"), "UTF-16", "UTF-8"),
    ("m.csv", b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + bytes(90), "MATLAB", "writematrix"),
    ("n.csv", b"%PDF-1.7\n" + bytes(20), "a PDF", "Export"),
    ("o.csv", b"\x80\x04\x95\x10\0\0\0\0\0\0\0}", "a pickle", "not read"),
    ("p.txt", b"** made by hand\n*Heading\n*Node\n1, 0., 0., 0.\n", "Abaqus", "displacement"),
    ("q.odb", b"HKSRD100" + bytes(90), "database of Abaqus", "as a table"),
    ("r.data", b"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\n", "a LAMMPS dump", "crystals.read"),
]
READERS = {
    "atoms": gt.crystals.read,
    "lines": gt.DislocationNetwork.read,
    "a field": gt.SampledFrame.read,
    "a field at points": gt.ScatteredFrame.read,
    "a map": gt.OrientationMap.read,
    "an image": gt.LatticeImage.read,
}


@pytest.mark.parametrize(("name", "content", "kind", "remedy"), FILES, ids=[f[0] for f in FILES])
def test_each_reader_names_the_kind(tmp_path: Path, name, content, kind, remedy):
    """No reader reports its own format for a file of another kind."""
    path = tmp_path / name
    path.write_bytes(content)
    for holds, read in READERS.items():
        if holds == "atoms" and name == "r.data":
            continue
        with pytest.raises(FileFormatError) as caught:
            read(path)
        text = str(caught.value)
        assert text.startswith(f"{name}: expected a file that holds ")
        assert kind in text
        assert remedy in text


def test_own_files_keep_their_own_messages(tmp_path: Path):
    """A damaged file of the right kind is reported by its reader, with the line."""
    dump = tmp_path / "short.dump"
    dump.write_text("ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS pp pp pp\n"
                    "0 1\n0 1\n0 1\nITEM: ATOMS id type x y z\n1 1 0 0 0\n")  # fmt: skip
    with pytest.raises(FileFormatError, match=r"line 10: the frame ends after 1 of 3 atoms"):
        gt.crystals.read(dump)
    table = tmp_path / "table.csv"
    table.write_text("a,b\n1,2\n")
    with pytest.raises(FileFormatError, match="column"):
        gt.SampledFrame.read(table)
    named = tmp_path / "map.ctf"
    named.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(90))
    with pytest.raises(FileFormatError, match=r"got an HDF5 file. Rename it"):
        gt.OrientationMap.read(named)


def test_each_kind_has_a_remedy():
    """Names have an article; remedies are sentences."""
    assert len({one.name for one in KINDS}) == len(KINDS)
    for one in KINDS:
        assert one.remedy.endswith(".")
        assert one.marks or one.pattern


HEAD = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\n"
ATOMS = ["ITEM: ATOMS id type x y z", "1 1 0 0 0", "2 1 3 0 0", "3 1 0 3 0"]


@pytest.mark.parametrize(
    ("rows", "line"),
    [
        (["# made by hand", *HEAD.splitlines(), *ATOMS], 1),
        ([*HEAD.splitlines(), ATOMS[0], "# first", *ATOMS[1:]], 10),
        ([*HEAD.splitlines(), *ATOMS[:2], "  # second", *ATOMS[2:]], 11),
        ([*HEAD.splitlines(), *ATOMS[:3], "#", ATOMS[3]], 12),
        ([*HEAD.splitlines(), *ATOMS, "# the end"], 13),
    ],
)
def test_a_comment_in_a_dump_is_named(tmp_path: Path, rows, line):
    """The message names the line of the comment, wherever it is."""
    path = tmp_path / "a.dump"
    path.write_text("\n".join(rows) + "\n")
    with pytest.raises(
        FileFormatError, match=rf"line {line}: .*got the comment '#.*remove the line"
    ):
        gt.crystals.read(path)


@pytest.mark.parametrize("end", [".vtk", ".vtu", ".msh", ".xdmf", ".xmf"])
def test_meshes_of_other_programs(tmp_path: Path, end):
    """The displacement of a screw-like jump at the points of a mesh, in each format of meshio."""
    meshio = pytest.importorskip("meshio")
    axis = np.linspace(-1, 1, 9)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(81)])
    number = np.arange(81).reshape(9, 9)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], -1)
    u = np.column_stack([0.01 * x.ravel(), -0.02 * y.ravel(), np.zeros(81)])
    path = tmp_path / f"mesh{end}"
    mesh = meshio.Mesh(points, [("quad", quads.reshape(-1, 4))], point_data={"displacement": u})
    kinds = {".msh": {"file_format": "gmsh"}, ".xmf": {"file_format": "xdmf"}}
    mesh.write(path, **kinds.get(end, {}))
    field = gt.ScatteredFrame.read(path)
    assert len(field.points) == 81
    grid = gt.SampledFrame.read(path)
    np.testing.assert_allclose(grid.coframe[0, 0], 1.01, atol=1e-6)
    np.testing.assert_allclose(grid.coframe[1, 1], 0.98, atol=1e-6)


def test_a_mesh_without_values(tmp_path: Path):
    """An input file of Abaqus has a mesh only; XDMF reads arrays beside it only."""
    pytest.importorskip("meshio")
    path = tmp_path / "job.inp"
    path.write_text("*Heading\n*Node\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 1., 0.\n"
                    "*Element, type=CPS3\n1, 1, 2, 3\n")  # fmt: skip
    with pytest.raises(
        FileFormatError, match=r"input file of Abaqus. It has a mesh, but no values"
    ):
        gt.ScatteredFrame.read(path)
    away = tmp_path / "away.xdmf"
    away.write_text('<Xdmf Version="3.0"><Domain><DataItem Format="HDF">/etc/a.h5:/data0'
                    "</DataItem></Domain></Xdmf>")  # fmt: skip
    with pytest.raises(
        FileFormatError, match=r"expected arrays in a file beside it, got '/etc/a.h5'"
    ):
        gt.ScatteredFrame.read(away)


@pytest.mark.parametrize(
    "u",
    [
        lambda x, y: np.array([0.01 * x + 1, 0 * y]),
        lambda x, y: np.array([0.01 * x, 0.02 * y]),
        lambda x, y: np.array([1e-3 * (x + y) + 5, 0 * x]),
        lambda x, y: np.array([0.01 * x + 1, 0.01 * y - 1e6]),
        lambda x, y: np.array([(x + 0.3) - x, 0 * x]),
        lambda x, y: np.array([0 * x, 0 * y]),
        lambda x, y: np.array([np.round(0.01 * x, 9), 0 * y]),
    ],
)
@pytest.mark.parametrize("nodes", [11, 40, 101])
def test_rounding_is_not_a_jump(u, nodes):
    """Uniform strain has no unusual steps: differences of rounding are below the floor."""
    axis = np.linspace(-3, 3, nodes)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    field = gt.SampledFrame.from_displacement([axis, axis], u(x, y))
    assert field.source == "a displacement; jumps: none"


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("d.csv", "x,y,u,v\n0,0,1,2\n", "a table of columns. Read a field by SampledFrame.read"),
        ("d.txt", "x\ty\n-1.5\t2\n", "a table of columns"),
        ("a.xyz", "1\ncopper\nCu 0 0 0\n", "an XYZ file of atoms. Read it by crystals.read"),
        ("m.ctf", "Channel Text File\n", "OrientationMap.read"),
    ],
)
def test_a_reader_of_tetrads_names_the_one_of_data(tmp_path: Path, name, content, words):
    """`gt.read` takes tetrad files, and names the reader of measured data."""
    (tmp_path / name).write_text(content)
    with pytest.raises(FileFormatError, match=words):
        gt.read(tmp_path / name)
