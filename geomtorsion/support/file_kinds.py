"""File kinds: what a file is, by its first bytes, for readers that expected another one."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar, cast

from geomtorsion.errors import FileFormatError
from geomtorsion.support import checks
from geomtorsion.support.files import BOUNDS, ending, opened

Read = TypeVar("Read", bound=Callable[..., object])


@dataclass(frozen=True)
class FileKind:
    """A kind of file that programs of this field write.

    name: with its article, for "got ...". remedy: one or two sentences about what to do with it.
    marks: possible first bytes. pattern: of the beginning of the file; one of both is enough.
    readers: what readers of this package take from such a file, such as "atoms". ends: endings of
    the names of such files; none for any.
    """

    name: str
    remedy: str
    marks: tuple[bytes, ...] = ()
    pattern: re.Pattern[bytes] | None = None
    readers: tuple[str, ...] = ()
    ends: tuple[str, ...] = ()

    def fits(self, start: bytes) -> bool:
        """Whether a file with this beginning is of this kind."""
        if self.marks and start.startswith(self.marks):
            return True
        return self.pattern is not None and bool(self.pattern.search(start))


_AS_DUMP = "Write a text dump in LAMMPS: dump 1 all custom 100 a.dump id type x y z."
_AS_FRAMES = "Convert it to extended XYZ, for example by ase.io or MDAnalysis."
_AS_GRID = "Save the field as .npz: SampledFrame(axes, coframe).save('field.npz')."
_NEVER = "It may run Python and is not read. Save the arrays by numpy.savez."
# To add a kind, add a line. The first that fits decides.
KINDS = (
    FileKind("a LAMMPS dump in YAML", _AS_DUMP,
             pattern=re.compile(rb"^(---\s*)?creator:\s*LAMMPS")),
    FileKind("a binary LAMMPS dump", "Convert it by binary2txt of LAMMPS, or write a text dump.",
             pattern=re.compile(rb"^.{0,16}DUMP(ATOM|CUSTOM)", re.DOTALL)),
    FileKind("a LAMMPS restart", "Write a data file in LAMMPS: read_restart a; write_data a.data.",
             (b"LammpS RestartT",)),
    FileKind("a log of LAMMPS", "It has no positions. " + _AS_DUMP,
             pattern=re.compile(rb"^LAMMPS \([0-9]")),
    FileKind("a DCD trajectory", _AS_FRAMES, pattern=re.compile(rb"^.{4}(.{4})?CORD", re.DOTALL)),
    FileKind("an XTC trajectory of Gromacs", _AS_FRAMES,
             (b"\x00\x00\x07\xcb", b"\x00\x00\x07\xe5")),
    FileKind("a TRR trajectory of Gromacs", _AS_FRAMES, (b"\x00\x00\x07\xc9",)),
    FileKind("a file of dislocation lines of OVITO", "Read it by DislocationNetwork.read, or use "
             "`geomtorsion network`.", (b"CA_FILE_VERSION",), readers=("lines",), ends=(".ca",)),
    FileKind("a network of dislocation lines (ParaDiS)", "Read it by DislocationNetwork.read, or "
             "use `geomtorsion network`.",
             pattern=re.compile(rb"^\s*(#[^\n]*\n\s*)*dataFileVersion"), readers=("lines",)),
    FileKind("a LAMMPS dump", "Read it by crystals.read, or use `geomtorsion crystal`.",
             pattern=re.compile(rb"^\s*ITEM: "), readers=("atoms",)),
    FileKind("an XYZ file of atoms", "Read it by crystals.read, or use `geomtorsion crystal`.",
             pattern=re.compile(rb"^\s*\d+\s*\n[^\n]*\n\s*[A-Z][a-z]?\d?\s+[-+\d.]"),
             readers=("atoms",)),
    FileKind("a mesh of Gmsh", "Read it by ScatteredFrame.read with the ending .msh.",
             (b"$MeshFormat",), readers=("a field",)),
    FileKind("an input file of Abaqus", "It has a mesh, but no values. Export the displacement at "
             "the nodes as .vtu or as a table x,y,z,u,v,w.",
             pattern=re.compile(rb"^\s*(\*\*[^\n]*\n\s*)*\*(heading|part|node)\b", re.IGNORECASE)),
    FileKind("an output database of Abaqus", "Export the displacement at the nodes as a table "
             "x,y,z,u,v,w.", (b"HKSRD",)),
    FileKind("a VTK file", "Read it by SampledFrame.read or ScatteredFrame.read with the ending "
             ".vtk or .vtu.", (b"# vtk DataFile",),
             re.compile(rb"^\s*(<\?xml[^>]*>\s*)?<VTKFile"), readers=("a field",)),
    FileKind("an XDMF file", "Read it by ScatteredFrame.read with the ending .xdmf.",
             pattern=re.compile(rb"<Xdmf\b"), readers=("a field",)),
    FileKind("a web page", "Download the file itself; a browser or a server has sent a page.",
             pattern=re.compile(rb"^\s*(<!--.*?-->\s*)?<(!doctype html|html)\b",
                                re.IGNORECASE | re.DOTALL)),
    FileKind("a pointer of Git LFS", "Fetch the file itself: git lfs pull.",
             (b"version https://git-lfs",)),
    FileKind("an old Excel workbook", "Save the sheet as .csv.", (b"\xd0\xcf\x11\xe0",)),
    FileKind("an Excel workbook", "Save the sheet as .csv.",
             pattern=re.compile(rb"^PK\x03\x04.{26}(\[Content_Types\]|_rels/|xl/|docProps/)",
                                re.DOTALL)),
    FileKind("a ZIP archive", "Unpack it first.",
             pattern=re.compile(rb"^PK\x03\x04.{26}(?!.{1,80}\.npy)", re.DOTALL)),
    FileKind("a tar archive", "Unpack it first: tar xf.",
             pattern=re.compile(rb"^.{257}ustar", re.DOTALL)),
    FileKind("a NumPy archive", _AS_GRID, (b"PK\x03\x04",), readers=("a field", "atoms")),
    FileKind("an array of NumPy", "Give the array itself, or rename the file to .npy.",
             (b"\x93NUMPY",), readers=("an image", "atoms", "a field")),
    FileKind("an HDF5 file", "Rename it to .h5 if it has a field or a map.",
             (b"\x89HDF\r\n\x1a\n",), readers=("a field", "a map", "an image", "atoms"),
             ends=(".h5", ".hdf5", ".h5oina", ".oh5", ".h5ebsd", ".dream3d", ".nc", ".cdf",
                   ".netcdf", ".emd", ".hspy")),
    FileKind("a NetCDF file", "Rename it to .nc.", (b"CDF\x01", b"CDF\x02", b"CDF\x05"),
             readers=("a field", "atoms")),
    FileKind("a MATLAB file", "Save the arrays in MATLAB as .csv by writematrix, or by "
             "scipy.io.loadmat and numpy.savez.", (b"MATLAB 5.0 MAT-file",)),
    FileKind("a pickle of Python", _NEVER,
             pattern=re.compile(rb"^\x80[\x02-\x05].", re.DOTALL)),
    FileKind("a PDF", "Export the table as .csv.", (b"%PDF-",)),
    FileKind("an image", "Images of a lattice are read by LatticeImage.read.",
             (b"\x89PNG", b"II*\x00", b"MM\x00*", b"\xff\xd8\xff", b"GIF8"), readers=("an image",)),
    FileKind("an EBSD map (Channel text file)", "Read it by OrientationMap.read with the ending "
             ".ctf.", (b"Channel Text File",), readers=("a map",), ends=(".ctf",)),
    FileKind("an EBSD map (EDAX .ang)", "Read it by OrientationMap.read with the ending .ang.",
             pattern=re.compile(rb"^# (TEM_PIXperUM|HEADER: Start)"),
             readers=("a map",), ends=(".ang", ".txt")),
    FileKind("a table of columns", "Read a field by SampledFrame.read or ScatteredFrame.read, and "
             "a map by OrientationMap.read.",
             pattern=re.compile(rb'^["\w .()/-]+([,;\t]["\w .()/-]+)+\r?\n\s*["+-]?[\d.]'),
             readers=("a field", "a map")),
    FileKind("text in UTF-16", "Save the file as UTF-8.", (b"\xff\xfe", b"\xfe\xff")),
)  # fmt: skip


def kind_of(start: bytes) -> FileKind | None:
    """The kind of a file with this beginning; None if it may be anything.

    Examples
    --------
    >>> kind_of(b"---\\ncreator: LAMMPS\\ntimestep: 0").name
    'a LAMMPS dump in YAML'
    >>> kind_of(b"x,y,u,v") is None
    True
    """
    return next((one for one in KINDS if one.fits(start)), None)


@contextmanager
def other_kinds(path: Path, expected: str) -> Iterator[None]:
    """Errors of a reader name the kind of a file that holds something else.

    expected: content that the reader takes, as in `FileKind.readers`.
    """
    try:
        yield
    except FileFormatError as error:
        kind = _kind_in(path)
        if kind is None or kind.name in str(error):
            raise
        is_named = not kind.ends or ending(path) in kind.ends
        if is_named and any(x in expected for x in kind.readers):
            raise
        raise FileFormatError(
            f"{path.name}: expected a file that holds {expected}, got {kind.name}. {kind.remedy}"
        ) from None


def naming_other_kinds(expected: str) -> Callable[[Read], Read]:
    """A decorator for readers of a path, whose errors name other kinds as in `other_kinds`."""

    def decorate(read: Read) -> Read:
        @functools.wraps(read)
        def reading(path: str | Path, *args: object, **options: object) -> object:
            with other_kinds(checks.file_name(path), expected):
                return read(path, *args, **options)

        return cast(Read, reading)

    return decorate


def _kind_in(path: Path) -> FileKind | None:
    """The kind of a file; None if it cannot be opened."""
    try:
        with opened(path) as file:
            return kind_of(file.read(BOUNDS.beginning))
    except (FileFormatError, OSError):
        return None
