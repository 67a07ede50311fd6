"""Displacement tables: CSV with x, y, u, v, texts of DaVis and Tecplot, and refused tables."""

import gzip
from pathlib import Path

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError, GridError, LimitError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.readers import open_source

X, Y = (axis.ravel() for axis in np.meshgrid(np.arange(9) * 0.5, np.arange(7) * 0.5))
U, V = 0.01 * X + 0.002 * Y**2, -0.02 * X * Y


def rows(split: str = ",", mark: str = ".", order: int = 1) -> list[str]:
    """One row per node, x fastest; DaVis begins with the largest y."""
    picked = sorted(range(len(X)), key=lambda k: (order * Y[k], X[k]))
    return [
        split.join(f"{v:.9f}".replace(".", mark) for v in (X[k], Y[k], U[k], V[k])) for k in picked
    ]


DAVIS = '#DaVis 8.4.0 2D-vector 16 7 9 "position" "mm" "position" "mm" "displacement" "mm"'
TECPLOT = ['TITLE = "B00001"', 'VARIABLES = "x", "y", "Vx", "Vy"', 'ZONE T="F", I=9, J=7, F=POINT']
TABLES = {
    "a.csv": ["x,y,u,v", *rows()],
    "named.csv": ["# made", "x, y, Ux, Uy", *rows(", ")],
    "units.csv": ["x (mm),y (mm),u (mm),v (mm)", *rows()],
    "semicolons.csv": ["x;y;u;v", *rows(";", ",")],
    "b.txt": ["x y u v", *rows(" ")],
    "blanks.txt": ["x [mm] y [mm] u [mm] v [mm]", *rows("  ")],
    "davis.txt": [DAVIS, *rows("\t", ",", -1)],
    "old.txt": ['#DaVis 7.2.2.273 2D-vector 16 7 9 "" "" "" ""', *rows("\t", ".", -1)],
    "tecplot.dat": [*TECPLOT, *rows(" ")],
}


def written(folder: Path, name: str, lines: list[str]) -> Path:
    path = folder / name
    content = ("\n".join(lines) + "\n").encode()
    path.write_bytes(gzip.compress(content) if name.endswith(".gz") else content)
    return path


@pytest.mark.parametrize("name", TABLES)
def test_displacements(tmp_path: Path, name: str):
    """The values at the nodes are the same for any row order, separator and decimal mark."""
    for path in (
        written(tmp_path, name, TABLES[name]), written(tmp_path, f"{name}.gz", TABLES[name]),
    ):  # fmt: skip
        field = SampledFrame.read(path)
        assert [len(axis) for axis in field.axes] == [9, 7]
        found = field.displacement
        assert found is not None
        assert found.values[0] == pytest.approx(U.reshape(7, 9).T, abs=1e-8)
        assert found.values[1] == pytest.approx(V.reshape(7, 9).T, abs=1e-8)
        assert field.coframe[0, 0] == pytest.approx(np.full((9, 7), 1.01), abs=1e-6)
        has_unit = "mm" in TABLES[name][0]
        assert (field.unit == "mm") == has_unit
        source = open_source(path, sigma=1e-4)
        assert isinstance(source, SampledFrame)
        assert source.burgers(Loop.circle([2, 1.5], 1)).magnitude == pytest.approx(0, abs=1e-9)


def test_omitted_rows_are_holes(tmp_path: Path):
    """Omitted rows and missing numbers are holes."""
    lines = TABLES["a.csv"].copy()
    lines[10] = lines[10].rsplit(",", 1)[0] + ","
    del lines[30]
    field = SampledFrame.read(written(tmp_path, "a.csv", lines))
    assert int(np.isnan(field.coframe[0, 0]).sum()) >= 2
    assert field.displacement is not None
    assert int(np.isnan(field.displacement.values).any(axis=0).sum()) == 2


FAR = ["x,y,u,v", *(f"{k * 7919 + k % 3},{k * 6007 + k % 2},0,0" for k in range(300))]
REFUSED = {
    "short.csv": ([*TABLES["a.csv"][:5], "1,2"], "line 6: expected 4 columns, got 2"),
    "words.csv": ([*TABLES["a.csv"][:5], "1,2,x,3"], "line 6: .* in column 3, got 'x'"),
    "none.csv": (["x,y,u,v"], "expected nodes below the header, got none"),
    "names.txt": (["a b c d", "1 2 3 4"], "expected a row of names such as x, y, u, v"),
    "wide.txt": ([DAVIS, "1 2 3 4 5"], "expected a row of names such as x, y, u, v"),
    "twice.csv": ([*TABLES["a.csv"], TABLES["a.csv"][1]], "expected each node once"),
    "random.csv": (FAR, "are not on a regular grid"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refusals(tmp_path: Path, name: str):
    """The message names the line, the expected content, and the remedy."""
    lines, words = REFUSED[name]
    with pytest.raises(FileFormatError, match=words):
        SampledFrame.read(written(tmp_path, name, lines))


def test_few_nodes_far_apart(tmp_path: Path):
    """A diagonal of 4,000 nodes would need a grid of 16 million."""
    lines = ["x,y,u,v", *(f"{k},{k},0,0" for k in range(4000))]
    with pytest.raises(LimitError, match="expected a grid of at most"):
        SampledFrame.read(written(tmp_path, "far.csv", lines))


def test_such_files_are_read_only(tmp_path: Path):
    """The message names a format for writing."""
    field = SampledFrame.read(written(tmp_path, "a.csv", TABLES["a.csv"]))
    with pytest.raises(GridError, match=r"read-only. Save the data as .npz or .csv"):
        field.save(tmp_path / "a.txt")


@pytest.mark.parametrize("word", ["1_8", "١", "0x10"])
def test_words_that_python_reads_as_numbers_are_refused(tmp_path, word):
    """Numbers that only Python accepts are refused."""
    path = tmp_path / "field.csv"
    rows = [f"{x},{y},0.1,{word if (x, y) == (2, 3) else 0}" for y in range(6) for x in range(6)]
    path.write_text("x,y,u,v\n" + "\n".join(rows), "utf-8")
    with pytest.raises(FileFormatError, match="line 22: expected a number in column"):
        SampledFrame.read(path)
