"""Map points: x and y decide against a wrong header; tables, ASTAR, Channel 5 and .h5oina."""

# The tests pass what users pass, including wrong types.
# pyright: reportArgumentType=false

import gzip
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError, LimitError
from geomtorsion.materials.maps import OrientationMap
from geomtorsion.materials.maps.map_formats import read_map_file
from tests.materials.maps.synthetic import bent
from tests.materials.maps.test_map_files import ang, ctf, replaced, write

ANGLES = bent((6, 7), 0.5)
HEAD = 13


def without(lines: list[str], *numbers: int, head: int = HEAD) -> list[str]:
    """The lines of a file without some points."""
    return [line for k, line in enumerate(lines) if k - head not in numbers]


def of_points(found, gaps=()):
    """Check that a map has the angles in all pixels except some."""
    known = np.ones(found.phase.shape, dtype=bool)
    known.ravel()[list(gaps)] = False
    assert (found.phase > 0).tolist() == known.tolist()
    assert np.degrees(found.euler[known]) == pytest.approx(ANGLES[known], abs=1e-6)


@pytest.mark.parametrize("gaps", [(0,), (8, 9, 20), (41,), (3, 41), (0, 7, 14, 15, 16, 17, 18)])
@pytest.mark.parametrize("make", [ang, ctf])
def test_omitted_points_have_no_orientation(tmp_path: Path, gaps, make):
    """Omitted points are pixels without an orientation; a file that ends early is refused."""
    head = HEAD if make is ang else 15
    path = write(tmp_path, without(make(ANGLES), *gaps, head=head), f"a.{make.__name__}")
    if gaps == (41,):
        with pytest.raises(FileFormatError, match="got 41 before the file ends. It is truncated"):
            read_map_file(path)
        return
    found = read_map_file(path)
    of_points(found, gaps)
    assert found.steps == pytest.approx((0.5, 0.5))
    assert OrientationMap.read(path, sigma=0.1).grains.count == 1


WRONG = {
    "rows": lambda lines: replaced(lines, "NROWS: 6", "NROWS: 5"),
    "columns": lambda lines: replaced(lines, ": 7", ": 6"),
    "swapped": lambda lines: replaced(replaced(lines, ": 7", ": x"), "NROWS: 6", "NROWS: 7"),
    "step": lambda lines: replaced(lines, "STEP: 0.5", "STEP: 0.25"),
    "no step": lambda lines: replaced(lines, "XSTEP: 0.5", "XSTEP: 0"),
    "no header": lambda lines: replaced(lines, "NROWS", "ROWS"),
    "grid": lambda lines: replaced(lines, "SqrGrid", "HexGrid"),
    "columns first": lambda lines: [
        *lines[:HEAD], *(lines[HEAD + 7 * r + c] for c in range(7) for r in range(6)),
    ],
    "shuffled": lambda lines: [
        *lines[:HEAD], *(lines[HEAD + k] for k in np.random.default_rng(0).permutation(42)),
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_x_and_y_decide(tmp_path: Path, name: str):
    """x and y decide if counts, steps, grid or order in the header are wrong or missing."""
    lines = [line.replace(": x", ": 6") for line in WRONG[name](ang(ANGLES))]
    found = read_map_file(write(tmp_path, lines, "a.ang"))
    of_points(found)
    assert found.steps == pytest.approx((0.5, 0.5))
    assert found.shift == 0


def test_a_step_that_is_rounded_in_the_header(tmp_path: Path):
    """Over many columns the points give a more exact step; if both fit, the header's is used."""
    angles = bent((3, 200), 0.1)
    for written, expected in ((0.3, 0.303), (0.303, 0.303)):
        lines = ang(angles, step=0.303)
        lines = [re.sub(r"STEP: .*", f"STEP: {written}", line) for line in lines]
        found = read_map_file(write(tmp_path, lines, "a.ang"))
        assert found.phase.shape == (3, 200)
        assert found.steps == pytest.approx((expected, expected), rel=1e-6)


@pytest.mark.parametrize("even", [6, 7, 8])
@pytest.mark.parametrize("gaps", [(), (0,), (7, 20), (5, 6)])
def test_hexagonal_grids_with_omitted_points(tmp_path: Path, even: int, gaps):
    """The x coordinates show which rows are shifted."""
    wide = bent((6, 8), 0.5)
    whole = ang(wide[:, :7] if even < 8 else wide, grid="HexGrid", even=even)
    if even == 8:
        # The first row is shorter: the second begins half a step before it.
        rows = [whole[HEAD + 8 * r : HEAD + 8 * (r + 1)] for r in range(6)]
        rows = [row if r % 2 else row[:7] for r, row in enumerate(rows)]
        moved = [
            re.sub(r"^((?:\s*\S+){3})\s+(\S+)", lambda m: f"{m[1]} {float(m[2]) - 0.5:.5f}", line)
            if r % 2 else line
            for r, row in enumerate(rows) for line in row
        ]  # fmt: skip
        whole = replaced([*whole[:HEAD], *moved], "NCOLS_ODD: 8", "NCOLS_ODD: 7")
    full = read_map_file(write(tmp_path, whole, "whole.ang"))
    found = read_map_file(write(tmp_path, without(whole, *gaps), "a.ang"))
    assert found.shift == full.shift == (-0.5 if even == 8 else 0.5)
    assert found.steps == pytest.approx(full.steps)
    assert found.phase.shape == full.phase.shape
    assert int((full.phase > 0).sum() - (found.phase > 0).sum()) == len(gaps)
    known = found.phase > 0
    assert found.euler[known] == pytest.approx(full.euler[known])


def astar(columns: int, phases: int = 1, angles=ANGLES) -> list[str]:
    """The lines of an ASTAR file, with phases without numbers and lengths in nm."""
    phase = [
        "# MaterialName      cu", "# Formula", "# Symmetry          43",
        "# LatticeConstants  3.610  3.610  3.610  90.000  90.000  90.000", "# NumberFamilies    0",
    ]  # fmt: skip
    lines = ["# File created from ACOM RES results", "#", *(phases * phase)]
    rows, wide = angles.shape[:2]
    lines += [
        "# GRID: SqrGrid#", "# XSTEP: 5.000000", "# YSTEP: 5.000000", f"# NCOLS_ODD: {wide}",
        f"# NCOLS_EVEN: {wide}", f"# NROWS: {rows}", "#",
    ]  # fmt: skip
    for r in range(rows):
        for c in range(wide):
            numbers = "  ".join(f"{v:.9f}" for v in np.radians(angles[r, c]))
            more = ["321.5", "0.42", str((r + c) % phases), "42"]
            more = more if columns == 9 else [*more[:2], more[3]][: columns - 5]
            lines.append(f"  {numbers}  {5.0 * c:.3f}  {5.0 * r:.3f}  {'  '.join(more)}")
    return lines


@pytest.mark.parametrize(("columns", "phases"), [(5, 1), (6, 1), (7, 1), (8, 1), (9, 1), (9, 2)])
def test_files_of_astar(tmp_path: Path, columns: int, phases: int):
    """Without a phase column all points have the only phase; steps in nm become um."""
    found = read_map_file(write(tmp_path, astar(columns, phases), "a.ang"))
    of_points(found)
    assert found.steps == pytest.approx((0.005, 0.005))
    assert sorted(set(found.phase.ravel().tolist())) == list(range(1, phases + 1))
    assert found.phases[phases].lengths == (3.61, 3.61, 3.61)


def table(
    head: str = "phi1 Phi phi2 phase x y", split: str = " ", factor: float = 1.0, phase: str = "1"
) -> list[str]:
    """A text table with columns in the order of its names."""
    rows = [head]
    for (r, c), numbers in zip(np.ndindex(6, 7), factor * ANGLES.reshape(-1, 3), strict=True):
        values = [*(f"{v:.9f}" for v in numbers), phase, f"{0.5 * c:.4f}", f"{0.5 * r:.4f}"]
        rows.append(split.join(values))
    return rows


TABLES = {
    "a.txt": table(),
    "mtex.txt": table("# phi1 Phi phi2 phase x y"),
    "tabs.txt": table("Phi1\tPHI\tPhi2\tPhase\tX\tY", "\t"),
    "commas.csv": table("phi1,Phi,phi2,phase,x,y", ","),
    "spaces.csv": table("phi1, Phi, phi2, phase, x, y", ", "),
    "semicolons.txt": table("Euler1;Euler2;Euler3;Phase;X;Y", ";"),
    "units.txt": table("phi1 (deg),Phi (deg),phi2 (deg),phase,x (um),y (um)", ","),
    "blanks.txt": table("phi1 [deg] Phi [deg] phi2 [deg] phase x [um] y [um]"),
    "radians.txt": table("phi1(rad) Phi(rad) phi2(rad) phase x y", factor=np.pi / 180),
    "comments.txt": ["% exported", "% by a program", *table("% phi1 Phi phi2 phase x y")],
}


@pytest.mark.parametrize("name", TABLES)
def test_text_tables(tmp_path: Path, name: str):
    """Columns are found by their names, with any separator between them, also in packed files."""
    path = write(tmp_path, TABLES[name], name)
    of_points(read_map_file(path, {0: "m-3m"}))
    with pytest.raises(FileFormatError, match=r"phase 1 .*its symmetry is not known. Give it"):
        read_map_file(path)
    packed = tmp_path / f"{name}.gz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    of_points(read_map_file(packed, {1: "m-3m"}))


def test_gaps_and_phases_of_tables(tmp_path: Path):
    """nan, phase 0 and omitted rows are gaps; a table without phases has one phase."""
    rows = table()
    rows[4] = "nan nan nan 1 1.5 0.0"
    rows[6] = rows[6].replace(" 1 ", " 0 ")
    del rows[20]
    of_points(read_map_file(write(tmp_path, rows, "a.txt"), {1: "m-3m"}), (3, 5, 19))
    alone = [" ".join(np.delete(row.split(), 3)) for row in table()]
    of_points(read_map_file(write(tmp_path, alone, "b.txt"), {0: "m-3m"}))


def channel5(
    folder: Path, change: Callable[[str], str] = str, fields: tuple[int, ...] = (3, 4, 5, 6, 7, 8),
    phase: int = 1,
) -> Path:  # fmt: skip
    """A .cpr file with its .crc file."""
    kinds = {6: "<f4", 7: "u1", 8: "u1", 10: "u1", 12: "<f4", 40: "<f4", 1: "<f4", 2: "<f4"}
    names = {3: "a", 4: "b", 5: "c", 1: "x", 2: "y"}
    kind = np.dtype([
        ("phase", "u1"), *((names.get(k, f"f{k}"), kinds.get(k, "<f4")) for k in fields),
    ])  # fmt: skip
    rows = np.zeros(42, dtype=kind)
    rows["phase"] = phase
    for k, name in enumerate("abc"):
        if name in (rows.dtype.names or ()):
            rows[name] = np.radians(ANGLES[..., k]).ravel()
    text = (
        "[General]\nVersion=5.0\n\n[Job]\nMagnification=500\nxCells=7\nyCells=6\n"
        "GridDistX=0.5\nGridDistY=0.5\n\n[Fields]\n"
        f"Count={len(fields)}\n"
        + "".join(f"Field{n}={k}\n" for n, k in enumerate(fields, 1))
        + "\n[Phases]\nCount=1\n\n[Phase1]\nStructureName=Nickel\na=3.57\nb=3.57\nc=3.57\n"
        "alpha=90\nbeta=90\ngamma=90\nLaueGroup=11\nSpaceGroup=225\n"
    )
    (folder / "map.cpr").write_text(change(text))
    (folder / "map.crc").write_bytes(rows.tobytes())
    return folder / "map.cpr"


@pytest.mark.parametrize("fields", [(3, 4, 5), (3, 4, 5, 6, 7, 8, 10, 12), (40, 7, 5, 4, 3)])
def test_channel_5(tmp_path: Path, fields):
    """Either file may be given; the text lists the order of the fields."""
    path = channel5(tmp_path, fields=fields)
    for end in (".cpr", ".crc"):
        found = read_map_file(path.with_suffix(end))
        assert (found.phase == 1).all()
        assert np.degrees(found.euler) == pytest.approx(ANGLES, abs=1e-4)
        assert found.steps == (0.5, 0.5)
        assert (found.phases[1].laue, found.phases[1].lengths) == ("m-3m", (3.57, 3.57, 3.57))
        assert found.phases[1].horizontal == "y"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("xCells=7", "xCells=8", r"map\.crc: expected 48 points of 19 bytes.*got 798 bytes"),
        ("xCells=7", "xCells=999999999", "expected 5,999,999,994 points"),
        ("xCells=7", "xCells=many", "job. xcells: expected a whole number, got 'many'"),
        ("Field1=3", "Field1=6", "expected each of phi1, Phi and phi2 once"),
        ("Count=6", "Count=600", "count: expected a whole number below 256, got 600"),
        ("LaueGroup=11", "LaueGroup=44", "its symmetry is not known"),
        ("GridDistX=0.5", "GridDistX=0", "steps GridDistX and GridDistY above 0"),
        ("xCells=7\nyCells=6", "NoOfPoints=42", "got 42 points without a grid"),
        ("[Phases]\nCount=1", "[Phases]\nCount=0", "count: expected 1 or more, got 0"),
    ],
)
def test_refusals_of_channel_5(tmp_path: Path, old: str, new: str, words: str):
    """The declared sizes are compared with the file before the data are read."""
    with pytest.raises(FileFormatError, match=words):
        read_map_file(channel5(tmp_path, lambda text: text.replace(old, new)))


def test_one_of_two_files(tmp_path: Path):
    """The message names both files and the missing one."""
    path = channel5(tmp_path)
    path.with_suffix(".crc").unlink()
    with pytest.raises(FileFormatError, match=r"two files, map.cpr and map.crc, got no map.crc"):
        read_map_file(path)


def h5oina(path: Path, **changes: object) -> Path:
    """Write a file as AZtec does."""
    h5py = pytest.importorskip("h5py")
    row, column = np.divmod(np.arange(42), 7)
    euler = np.radians(ANGLES.reshape(-1, 3)).astype("f4")
    text = h5py.string_dtype()
    with h5py.File(path, "w") as file:
        file["Index"] = np.array(["1"], dtype=text)
        file["Format Version"] = np.array(["5.0"], dtype=text)
        data, header = (file.create_group(f"1/EBSD/{name}") for name in ("Data", "Header"))
        data["Phase"] = np.ones((42, 1), dtype="u1")
        data["Euler"] = euler
        data["X"] = (0.5 * column[:, None]).astype("f4")
        data["Y"] = (0.5 * row[:, None]).astype("f4")
        for name, value in (("X Cells", 7), ("Y Cells", 6), ("X Step", 0.5), ("Y Step", 0.5)):
            header[name] = np.array([[value]], dtype="i4" if "Cells" in name else "f4")
        phase = header.create_group("Phases/1")
        phase["Phase Name"] = np.array(["Nickel"], dtype=text)
        phase["Lattice Angles"] = np.full((1, 3), np.pi / 2, dtype="f4")
        phase["Lattice Dimensions"] = np.full((1, 3), 3.57, dtype="f4")
        phase["Laue Group"] = np.array([[11]], dtype="i4")
        for name, value in changes.items():
            key = name.replace("__", "/").replace("_", " ")
            if key in file:
                del file[key]
            if value is not None:
                file[key] = value
    return path


def test_h5oina(tmp_path: Path):
    """Files by the published specification are read with or without X and Y."""
    for changes in ({}, {"1__EBSD__Data__X": None, "1__EBSD__Data__Y": None}):
        found = read_map_file(h5oina(tmp_path / "a.h5oina", **changes))
        assert np.degrees(found.euler) == pytest.approx(ANGLES, abs=1e-4)
        assert (found.phase == 1).all()
        assert found.steps == pytest.approx((0.5, 0.5))
        phase = found.phases[1]
        assert (phase.name, phase.laue, phase.angles) == ("Nickel", "m-3m", (90, 90, 90))
        assert phase.horizontal == "y"
    outside = np.radians(ANGLES.reshape(-1, 3))
    outside[:3] = np.nan
    found = read_map_file(h5oina(tmp_path / "b.h5oina", **{"1__EBSD__Data__Euler": outside}))
    of_points(found, (0, 1, 2))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"1__EBSD": None}, "expected data sets phi1, Phi, phi2 or Euler"),
        ({"1__EBSD__Data__Euler": None}, "expected data sets phi1, Phi, phi2 or Euler"),
        ({"1__EBSD__Header__X_Cells": 70}, "expected angles and phase of 70 x 6 points"),
        ({"1__EBSD__Header__X_Cells": 2**30}, "expected angles and phase of 1073741824 x 6"),
        ({"1__EBSD__Header__Phases__1__Laue_Group": 44}, "its symmetry is not known"),
        ({"1__EBSD__Data__Phase": np.full(42, 3)}, r"expected a phase in the header \(1 .* got 3"),
    ],
)
def test_refusals_of_h5oina(tmp_path: Path, changes: dict[str, object], words: str):
    """Missing groups, wrong counts and undescribed phases are refused."""
    with pytest.raises(FileFormatError, match=words):
        read_map_file(h5oina(tmp_path / "a.h5oina", **changes))


FAR = [*table()[:3], "0 0 0 1 1e5 1e5", "0 0 0 1 1e5 0.5", "0 0 0 1 0.0 1e5", "0 0 0 1 0.5 0.5"]
RANDOM = [
    "phi1 Phi phi2 phase x y",
    *(f"1 2 3 1 {x:.6f} {y:.6f}" for x, y in np.random.default_rng(1).uniform(0, 9, (60, 2))),
]
INTERACTIVE = [
    line.replace("JobMode\tGrid", "JobMode\tInteractive")
    for line in ctf(ANGLES) if not line.startswith(("XC", "YC", "XS", "YS"))
]  # fmt: skip
REFUSED = {
    "a.ctf": (INTERACTIVE, "line 4: expected a map on a grid .*42 points without a grid .*Interac"),
    "random.txt": (RANDOM, "expected points on a grid, got 60 points without a grid"),
    "line.txt": (table()[:8], "two or more rows and columns, got 7 points with one Y"),
    "none.txt": (table()[:1], "expected points of a map, got none"),
    "short.txt": ([*table()[:5], "1 2 3", *table()[6:]], "line 6: expected 6 columns, got 3"),
    "names.txt": (table("a b c d e f"), "expected a row of names phi1, Phi, phi2, x, y"),
    "much.txt": (table(factor=1e4), "line [0-9]+: expected Euler angles .* in degrees"),
    "phase.txt": (table(phase="1.5"), "phase: expected whole numbers from 0 to 255, got 1.5"),
    "place.txt": ([*table()[:5], "1 2 3 1 x 0", *table()[6:]], "line 6: .* in column 5, got 'x'"),
    "hole.txt": ([*table()[:5], "1 2 3 1 nan 0", *table()[6:]], "line 6: expected numbers x and y"),
    "few.ang": (astar(7, 2), "the phase of each point in column 8, since the header has 2 phases"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refusals(tmp_path: Path, name: str):
    """The message names the fault, the expected content and the remedy."""
    lines, words = REFUSED[name]
    with pytest.raises(FileFormatError, match=words):
        read_map_file(write(tmp_path, lines, name), {} if name.endswith("g") else {0: "m-3m"})


def test_few_points_far_apart(tmp_path: Path):
    """Such points would need a grid of 4e10 pixels."""
    with pytest.raises(LimitError, match="expected a grid of at most"):
        read_map_file(write(tmp_path, FAR, "far.txt"), {0: "m-3m"})


def mtex(phase: int, mixed: bool) -> str:
    """A table as MTEX writes it: a tab after each field, or tabs and blanks mixed."""
    names = ["phi1", "Phi", "phi2", "phase", "bands", "x", "y"]
    lines = ["\t".join(names) + "\t"]
    if mixed:
        lines = ["  ".join(names[:3]) + "\t" + " \t".join(names[3:])]
    for y in range(4):
        for x in range(5):
            row = [f"{10 + x}", "20", "30", f"{phase}", "7", f"{x / 2}", f"{y / 2}"]
            lines.append(" \t".join(row) if mixed else "\t".join(row) + "\t")
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("mixed", [False, True])
@pytest.mark.parametrize("phase", [0, 1])
def test_tables_of_mtex(tmp_path: Path, phase: int, mixed: bool):
    """A tab after the last field, phase 0 everywhere, and tabs mixed with blanks are read."""
    path = tmp_path / "ebsd.txt"
    path.write_text(mtex(phase, mixed))
    crystal = OrientationMap.read(path, laue={1: "m-3m"})
    assert crystal.shape == (4, 5)
    assert (crystal.phase == 1).all()
    assert crystal.steps == (0.5, 0.5)
    angle = 2 * np.arccos(abs((crystal.quaternions[0, 0] * crystal.quaternions[0, 1]).sum()))
    assert np.degrees(angle) == pytest.approx(1.0)
