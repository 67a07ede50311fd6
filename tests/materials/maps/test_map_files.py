"""Map files: written maps read back; damaged maps are refused with their line and a remedy."""

from typing import Any

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError
from geomtorsion.materials.maps import OrientationMap
from geomtorsion.materials.maps.map_formats import read_map_file
from tests.materials.maps.synthetic import bent
from tests.real import real

ANGLES = bent((4, 5), 0.5)


def ctf(angles=ANGLES, step=0.5, laue=11, phase=1, mark="."):
    """The lines of a .ctf file."""
    rows, columns = angles.shape[:2]
    lines = [
        "Channel Text File", "Prj\tmade up", "Author\t", "JobMode\tGrid", f"XCells\t{columns}",
        f"YCells\t{rows}", f"XStep\t{step}", f"YStep\t{step}", "AcqE1\t0", "AcqE2\t0", "AcqE3\t0",
        "Euler angles refer to Sample Coordinate system (CS0)!\tMag\t450", "Phases\t1",
        f"3.52;3.52;3.52\t90;90;90\tNickel\t{laue}\t225\t\t\tsomewhere",
        "Phase\tX\tY\tBands\tError\tEuler1\tEuler2\tEuler3\tMAD\tBC\tBS",
    ]  # fmt: skip
    for r in range(rows):
        for c in range(columns):
            numbers = "\t".join(f"{x:.12f}" for x in angles[r, c])
            lines.append(f"{phase}\t{c * step:.4f}\t{r * step:.4f}\t8\t0\t{numbers}\t0.2\t200\t248")
    return [lines[0], *(line.replace(".", mark) for line in lines[1:])]


def ang(angles=ANGLES, step=0.5, grid="SqrGrid", symmetry="43", phase=1, even=None):
    """The lines of an .ang file; every second row may have another number of columns."""
    rows, columns = angles.shape[:2]
    even = columns if even is None else even
    height = step * np.sqrt(3) / 2 if grid == "HexGrid" else step
    lines = [
        "# TEM_PIXperUM          1.000000", "# Phase 1", "# MaterialName    Nickel",
        f"# Symmetry              {symmetry}", "# LatticeConstants      3.52 3.52 3.52 90 90 90",
        "# NumberFamilies        0", f"# GRID: {grid}", f"# XSTEP: {step}", f"# YSTEP: {height}",
        f"# NCOLS_ODD: {columns}", f"# NCOLS_EVEN: {even}", f"# NROWS: {rows}", "#",
    ]  # fmt: skip
    for r in range(rows):
        for c in range(even if r % 2 else columns):
            x = step * (c + (0.5 * (r % 2) if grid == "HexGrid" else 0))
            numbers = " ".join(f"{v:.12f}" for v in np.radians(angles[r, c]))
            lines.append(f"  {numbers} {x:.5f} {r * height:.5f} 30.1 0.8 {phase} 1 0.9")
    return lines


def write(folder, lines, name):
    path = folder / name
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


@pytest.mark.parametrize(
    ("lines", "name"), [(ctf(), "a.ctf"), (ang(), "a.ang"), (ctf(mark=","), "a.CTF")]
)
def test_written_maps_read_back(tmp_path, lines, name):
    """Angles, steps, phase and lattice read back, with decimal points and with commas."""
    found = read_map_file(write(tmp_path, lines, name))
    assert np.degrees(found.euler) == pytest.approx(ANGLES, abs=1e-9)
    assert found.steps == (0.5, 0.5)
    assert (found.phase == 1).all()
    assert found.phases[1].laue == "m-3m"
    assert found.phases[1].lengths == (3.52, 3.52, 3.52)


def test_latin_letters_in_a_header(tmp_path):
    """Instruments write names in old encodings."""
    path = tmp_path / "a.ctf"
    path.write_bytes(
        "\n".join(ctf()).replace("made up", "Stahl f\u00fcr \u00c5se").encode("latin-1")
    )
    assert read_map_file(path).euler.shape == (4, 5, 3)


def test_points_that_were_not_indexed(tmp_path):
    """They have phase 0 in .ctf, and 4 pi or a confidence of -1 in .ang."""
    lines = ctf()
    lines[-1] = "0" + lines[-1][1:]
    assert read_map_file(write(tmp_path, lines, "a.ctf")).phase[-1].tolist() == [1, 1, 1, 1, 0]
    lines = ang()
    lines[-1] = "12.56637 12.56637 12.56637 2.0 1.5 0 -1 0 1 1"
    lines[-2] = lines[-2].replace(" 0.8 ", " -1 ")
    assert read_map_file(write(tmp_path, lines, "a.ang")).phase[-1].tolist() == [1, 1, 1, 0, 0]


def test_one_phase_may_be_numbered_zero(tmp_path):
    """EDAX writes 0 in the phase column of a map with a single phase."""
    assert (read_map_file(write(tmp_path, ang(phase=0), "a.ang")).phase == 1).all()


def test_hexagonal_grids(tmp_path):
    """Every second row begins half a step later and may be shorter by one."""
    found = read_map_file(write(tmp_path, ang(grid="HexGrid", even=4), "a.ang"))
    assert found.shift == 0.5
    assert found.phase.tolist() == [[1] * 5, [1] * 4 + [0], [1] * 5, [1] * 4 + [0]]
    assert np.degrees(found.euler[1, 3]) == pytest.approx(ANGLES[1, 3])


def replaced(lines, old, new):
    assert any(old in line for line in lines)
    return [line.replace(old, new) for line in lines]


# The third point of the second row, in line 23.
POINT = "1\t1.0000\t0.5000"
BAD = {
    "truncated.ctf": (ctf()[:-3], "line 32: expected 20 points in 4 rows .* got 17"),
    "headless.ctf": (ctf()[:6], "column names.*truncated"),
    "other.ctf": (["a,b", "1,2"], "line 1: expected 'Channel Text File', got 'a,b'"),
    "longer.ctf": ([*ctf(), ctf()[-1]], "one point at each position, got line 35 and"),
    "columns.ctf": (replaced(ctf(), "Euler2", "Other"), "line 15: expected a column Euler2"),
    "short.ctf": ([*ctf()[:20], "1\t2\t3", *ctf()[21:]], "line 21: expected 11 columns, got 3"),
    "words.ctf": (replaced(ctf(), POINT, "1\tx\t0.5"), "line 23: .* in column 2, got 'x'"),
    "infinite.ctf": (
        replaced(ctf(), POINT, "1\tinf\t0.5"), "line 23: .* in column 2, got 'inf'"
    ),
    "mixed.ctf": (
        replaced(ctf(), POINT, "1\t1.3000\t0.5000"),
        "line 23: expected X = 1.5 from steps of 0.5, got 1.3",
    ),
    "cells.ctf": (
        replaced(ctf(), "XCells\t5", "XCells\t1e99"), "line 5: XCells: expected a whole number"
    ),
    "phase.ctf": (
        replaced(ctf(), POINT, "3\t1.0000\t0.5000"),
        r"line 23: expected a phase .* \(1 \(Nickel\)\) .* got 3",
    ),
    "laue.ctf": (ctf(laue=44), r"line 14: phase 1 \(Nickel\): its symmetry is not known. Give it"),
    "lattice.ctf": (
        replaced(ctf(), "90;90;90", "90;90"),
        "line 14: phase 1: expected three lengths .* got 3 and 2",
    ),
    "flat.ctf": (replaced(ctf(), "90;90;90", "90;90;190"), "line 14: .*between 0 and 180"),
    "truncated.ang": (ang()[:-3], "line 30: expected 20 points in 4 rows .* got 17"),
    "phases.ang": (
        replaced(ang(), "LatticeConstants", "Lattice"), "expected a phase in the header, got none"
    ),
    "few.ang": ([*ang()[:13], *("1 2 3" for _ in range(20))], "line 14: expected five .* got 3"),
    "nothing.ang": ([], "line 1: expected a header .* got no header"),
    "symmetry.ang": (ang(symmetry="99"), 'line 4: .*laue={1: "m-3m"}'),
    "unknown.ang": (ang(phase=2), r"line 14: expected a phase .* \(1 \(Nickel\)\) .* got 2"),
    "map.xyz": (ctf(), "Read it by OrientationMap.read with the ending .ctf"),
    "map.foo": (["1 2 3"], "to end in one of .ctf, .ang.* got '.foo'"),
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(BAD))
def test_damaged_files_are_refused(tmp_path, name):
    """Each message names the file, the line and the remedy."""
    lines, message = BAD[name]
    with pytest.raises(FileFormatError, match=message) as caught:
        read_map_file(write(tmp_path, lines, name))
    assert str(caught.value).startswith(name)


def test_a_user_may_give_the_symmetry(tmp_path):
    """A given symmetry is used if the file has none."""
    path = write(tmp_path, ctf(laue=44), "a.ctf")
    assert OrientationMap.read(path, laue={1: "m-3m"}).phases[1].laue == "m-3m"


def test_a_group_of_every_phase(tmp_path):
    """0, which is not a phase number, gives the group of all phases without their own entry."""
    path = write(tmp_path, ctf(laue=44), "a.ctf")
    assert OrientationMap.read(path, laue={0: "mmm"}).phases[1].laue == "mmm"
    assert OrientationMap.read(path, laue={0: "mmm", 1: "m-3m"}).phases[1].laue == "m-3m"


def test_groups_of_phases_that_are_not_there(tmp_path):
    """A given symmetry for an absent phase is refused, not ignored."""
    path = write(tmp_path, ctf(), "a.ctf")
    given: list[Any] = [{2: "6/mmm"}, {"1": "6/mmm"}]
    for laue in given:
        with pytest.raises(
            FileFormatError, match="expected numbers of phases in the file .1., got"
        ):
            read_map_file(path, laue)
    word: Any = "6/mmm"
    with pytest.raises(FileFormatError, match="laue: .*'6/mmm'"):
        OrientationMap.read(path, laue=word)


def test_commas_behind_a_point_without_an_orientation(tmp_path):
    """Such points have plain zeros, also in files with decimal commas."""
    lines = ctf(mark=",")
    start = next(k for k, row in enumerate(lines) if row.startswith("Phase\t")) + 1
    lines[start] = "\t".join(["0"] * 11)
    found = read_map_file(write(tmp_path, lines, "a.ctf"))
    assert found.phase.ravel().tolist() == [0] + [1] * (found.phase.size - 1)
    assert np.degrees(found.euler[1:]) == pytest.approx(ANGLES[1:], abs=1e-9)


def test_real_files():
    """Sizes, phases and steps agree with the headers."""
    silicon = read_map_file(real("ebsd/si_wafer.ctf"))
    assert silicon.phase.shape == (35, 48)
    assert silicon.steps == (2.0, 2.0)
    assert (silicon.phase == 2).all()
    steel = read_map_file(real("ebsd/sdss_ferrite_austenite.ang"))
    assert steel.phase.shape == (100, 117)
    assert [phase.name[:7] for phase in steel.phases.values()] == ["austeni", "ferrite"]
    assert np.bincount(steel.phase.ravel()).tolist() == [0, 5657, 6043]


@pytest.mark.parametrize("name", ["a.ang", "a.ctf"])
def test_angles_of_another_unit_are_refused(tmp_path, name):
    """Angles above two turns are refused; they would pass for points without an orientation."""
    made, much, unit = (ang, 57.3, "radians") if name == "a.ang" else (ctf, 1e3, "degrees")
    angles = ANGLES + 1.0
    angles[1, 2] = 7.0, 3.0, 355.0
    assert read_map_file(write(tmp_path, made(angles), name)).phase.all()
    with pytest.raises(
        FileFormatError, match=rf"{name}: line [0-9]+: expected Euler angles in {unit}"
    ):
        read_map_file(write(tmp_path, made(much * angles), name))


def test_letters_that_break_lines_elsewhere(tmp_path):
    """A Windows ellipsis in a name and the line ends of all systems are read; numbers that only
    Python accepts are refused."""
    text = "\n".join(ctf()).replace("Nickel", "Ni\x85 and more") + "\n"
    path = tmp_path / "a.ctf"
    for end in ("\n", "\r\n", "\r"):
        path.write_bytes(text.replace("\n", end).encode("latin-1"))
        assert read_map_file(path).phases[1].name == "Ni\x85 and more"
    path.write_text(text.replace("XStep\t0.5", "XStep\t0_5"))
    with pytest.raises(FileFormatError, match="line 7: XStep: expected a finite number, got '0_5'"):
        read_map_file(path)
    path.write_text(text.replace("\t11\t225", "\t11.7\t225"))
    with pytest.raises(FileFormatError, match="its symmetry is not known"):
        read_map_file(path)
