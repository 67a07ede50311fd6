"""Formats: saved grids read back, and broken files are refused with line and reason."""

import subprocess
import sys
import tomllib
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import netcdf_file

from geomtorsion.errors import FileFormatError, GridError, LimitError, MissingExtraError
from geomtorsion.loops import Loop
from geomtorsion.materials.fields import SampledFrame
from geomtorsion.materials.fields.contents import module
from geomtorsion.support.checks import LARGEST_ARRAYS

AXES = [np.linspace(0, 1.1, 12), np.linspace(3, 2, 9)]
X, Y = np.meshgrid(*AXES, indexing="ij")
VALUES = np.array([[1 + X / 3, Y**2 / 7], [np.sin(X), 1 + np.cos(Y)]])
MASK = np.hypot(X - 0.5, Y - 2.5) < 0.2
NEEDS = {".h5": "h5py", ".hdf5": "h5py", ".vtk": "meshio", ".vtu": "meshio"}
ENDS = [".npz", ".nc", ".csv", *NEEDS]


def full() -> SampledFrame:
    return SampledFrame(
        AXES,
        VALUES,
        mask=MASK,
        sigma=np.abs(VALUES) / 9,
        periodic="x",
        unit="µm",
        vector_unit="a µm",
        source="a test <&> more",
    )


@pytest.mark.parametrize("end", ENDS)
def test_saved_fields_read_back(tmp_path, end):
    """Values, holes, noise, periods and units read back, and the file has the given name."""
    if end in NEEDS:
        pytest.importorskip(NEEDS[end])
    path, grid = tmp_path / f"a.b{end}", full()
    grid.save(path)
    assert [file.name for file in tmp_path.iterdir()] == [f"a.b{end}"]
    again = SampledFrame.read(path)
    # Tables do not store the direction of an axis, which then increases.
    turned = (slice(None),) * 3 + (slice(None, None, -1),) if again.axes[1][0] < 2.5 else ...
    assert np.array_equal(again.coframe, grid.coframe[turned], equal_nan=True)
    known = np.isfinite(grid.coframe)
    assert (again.sigma == grid.sigma[turned])[known[turned]].all()
    assert again.names == ("x", "y")
    assert (again.mask == grid.mask[turned[2:] if turned is not ... else ...]).all()
    assert again.periodic == (True, False)
    assert (again.unit, again.vector_unit, again.source) == ("µm", "a µm", "a test <&> more")


@pytest.mark.parametrize("by_node", [False, True])
@pytest.mark.parametrize("end", ENDS)
def test_covariances_come_back(tmp_path, end, by_node):
    """Covariances read back, or from tables only the standard deviations."""
    if end in NEEDS:
        pytest.importorskip(NEEDS[end])
    root = np.random.default_rng(0).normal(size=(4, 4))
    table = np.multiply.outer(root @ root.T, np.ones((12, 9))) if by_node else root @ root.T
    grid = SampledFrame(AXES, VALUES, covariance=table, unit="nm")
    grid.save(tmp_path / f"a{end}")
    again = SampledFrame.read(tmp_path / f"a{end}")
    known = sorted(again.sigma.ravel()) == pytest.approx(sorted(grid.sigma.ravel()))
    assert known
    if end in (".csv", ".vtk", ".vtu"):
        assert again.covariance is None
    else:
        assert np.array_equal(again.covariance, grid.covariance)
        assert again.unit == "nm"


@pytest.mark.parametrize("end", ENDS)
def test_a_plain_grid_of_three_axes_comes_back(tmp_path, end):
    """A grid without noise and units, with three axes and one row, reads back."""
    if end in NEEDS:
        pytest.importorskip(NEEDS[end])
    axes = [np.arange(6.0), np.arange(7.0) / 3, np.arange(6.0) - 2]
    values = np.random.default_rng(0).random((1, 3, 6, 7, 6))
    SampledFrame(axes, values, names=("u", "v", "w")).save(tmp_path / f"g{end}")
    again = SampledFrame.read(tmp_path / f"g{end}")
    assert (again.coframe == values).all()
    assert (again.names, again.sigma, again.unit) == (("u", "v", "w"), None, "")


def test_ends_that_are_not_known(tmp_path):
    """An unknown suffix is refused; a name without a suffix becomes .npz."""
    with pytest.raises(GridError, match=r"expected a name ending in \.npz or \.nc .*got '\.doc'"):
        full().save(tmp_path / "a.doc")
    full().save(tmp_path / "plain")
    assert (tmp_path / "plain.npz").is_file()


HEAD = "# unit: nm\nx,y,beta_0_0,beta_0_1\n"
ROWS = "".join(f"{x},{y},{x * y / 9},\n" if x == y == 2 else f"{x},{y},{x * y / 9},{y}\n"
               for x in range(6) for y in range(6) if (x, y) != (4, 3))  # fmt: skip


def test_a_table_by_hand(tmp_path):
    """A distortion with rows in any order; a missing number and a missing row are two holes."""
    path = tmp_path / "t.csv"
    lines = ROWS.splitlines()
    path.write_text(HEAD + "\n".join(lines[::-1]) + "\n")
    grid = SampledFrame.read(path)
    assert grid.unit == "nm"
    assert np.argwhere(grid.mask).tolist() == [[2, 2], [4, 3]]
    assert grid.coframe[0, 0, 5, 3] == 1 + 15 / 9


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a header such as"),
        ("# unit: nm\n", "a header such as"),
        ("x,y\n1,2\n", "line 1: expected different names of columns"),
        ("x,y,e_0_0,beta_0_0\n1,2,3,4\n", "line 1: expected different names of columns"),
        ("x,x,e_0_0\n1,2,3\n", "line 1: expected different names of columns"),
        ("x,e_0_0,e_0_1\n1,2,3\n", "line 1: expected different names of columns"),
        (HEAD, "expected nodes below the header, got none"),
        (HEAD + ROWS + "5,5,1\n", "line 38: expected 4 columns, got 3"),
        (HEAD + ROWS.replace("2,3,", "2,three,"), "line 18: .* in column 2, got 'three'"),
        (
            HEAD + ROWS + "0,0,1,1\n",
            "expected each node once, got the same node in line 3 and line 38",
        ),
        (HEAD + ROWS + "0.5,0,1,1\n", "not on a regular grid: axis x: expected equal steps"),
        (HEAD + ROWS.replace("1,5,", "1,,"), "line 14: expected a finite coordinate y, got nan"),
        (HEAD.replace("beta_0_0", "beta_1_0") + ROWS, "expected a column beta_0_0, got none"),
        (HEAD.replace("# unit", "# periodic") + ROWS, "periodic: expected a known name, got 'nm'"),
        ("x,y,e_0_0,e_0_1\n" + ROWS.replace("5,5,", "5,5,1e999"), "line|infinite|finite"),
    ],
)
def test_invalid_tables_are_refused(tmp_path, text, message):
    """Each fault has its own message, with the line if there is one."""
    path = tmp_path / "t.csv"
    path.write_text(text)
    with pytest.raises(FileFormatError, match=message):
        SampledFrame.read(path)


@pytest.mark.parametrize("end", [e for e in ENDS if e != ".npz"])
def test_truncated_and_foreign_files(tmp_path, end):
    """Truncated or foreign files raise our own errors, or the rest is a valid grid."""
    if end in NEEDS:
        pytest.importorskip(NEEDS[end])
    path = tmp_path / f"a{end}"
    full().save(path)
    whole = path.read_bytes()
    rng = np.random.default_rng(4)
    junk = [b"", b"no", b"\x89HDF\r\n\x1a\n" + b"\0" * 90, b"CDF\x01" + b"\xff" * 80, b"<?xml"]
    cuts = [whole[: int(share * len(whole))] for share in (0.05, 0.3, 0.6, 0.9, 0.99)]
    spoilt = []
    for _ in range(25):
        data = bytearray(whole)
        data[int(rng.integers(len(data) // 3))] = int(rng.integers(256))
        spoilt.append(bytes(data))
    refused = 0
    for content in junk + cuts + spoilt:
        path.write_bytes(content)
        try:
            SampledFrame.read(path)
        except (FileFormatError, MissingExtraError):
            refused += 1
    assert refused >= len(junk) + 4


def test_links_in_hdf5_are_not_followed(tmp_path):
    """A data set that is a link, also into another file, is refused."""
    h5py = pytest.importorskip("h5py")
    full().save(tmp_path / "whole.h5")
    for name, link, message in (
        ("outside", h5py.ExternalLink("whole.h5", "/coframe"), "a link to whole.h5"),
        ("inside", h5py.SoftLink("/other"), "a link or a group"),
    ):
        path = tmp_path / f"{name}.h5"
        full().save(path)
        with h5py.File(path, "a") as file:
            file["other"] = file["coframe"][...]
            del file["coframe"]
            file["coframe"] = link
        with pytest.raises(FileFormatError, match=message):
            SampledFrame.read(path)


def test_a_missing_library_is_named(tmp_path):
    """Without h5py and meshio the message names the extra that installs them."""
    code = (
        "import sys; sys.modules['h5py'] = None; sys.modules['meshio'] = None\n"
        "import numpy as np, geomtorsion as gt\n"
        "grid = gt.SampledFrame([np.arange(6.0)] * 2, np.ones((1, 2, 6, 6)))\n"
        "for end in ('h5', 'vtk'):\n"
        "    try:\n        grid.save(sys.argv[1] + '/a.' + end)\n"
        "    except gt.errors.MissingExtraError as error:\n        print(error)\n"
    )
    run = [sys.executable, "-c", code, str(tmp_path)]
    said = subprocess.run(run, capture_output=True, text=True, check=True).stdout
    assert said.count("geomtorsion[files]") == 2


@pytest.mark.parametrize("name", ["h5py", "meshio", "zarr"])
def test_the_extra_that_is_named_brings_the_library(name, monkeypatch):
    """In pyproject.toml the named extra lists the library."""
    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text("utf-8"))
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(MissingExtraError) as caught:
        module(name, Path("a"))
    extra = str(caught.value).partition("geomtorsion[")[2].partition("]")[0]
    brought = project["project"]["optional-dependencies"][extra]
    assert any(x.startswith(name) for x in brought)


def marked(path, dtype, scale, **said):
    """A NetCDF file of torsion 1, in which one node has the fill value."""
    x, y = np.arange(7.0), np.arange(8.0) / 2
    values = np.array([[-np.tile(y, (7, 1)), np.tile(x[:, None], 8)]]) / 2 / scale
    values[0, 0, 3, 3] = -999
    with netcdf_file(path, "w") as data:
        for name, axis in (("x", x), ("y", y)):
            data.createDimension(name, len(axis))
            data.createVariable(name, "d", (name,))[:] = axis
            data.variables[name].units = "days since 2000-01-01"
        data.createVariable("grid_mapping", "i", ())[...] = 1
        data.createDimension("row", 1)
        data.createDimension("column", 2)
        made = data.createVariable("coframe", dtype, ("row", "column", "x", "y"))
        made[:] = values
        for name, value in said.items():
            setattr(made, name, value)


@pytest.mark.parametrize("reader", ["xarray", "scipy"])
@pytest.mark.parametrize("mark", ["_FillValue", "missing_value"])
@pytest.mark.parametrize(("dtype", "scale"), [("d", 1.0), ("h", 0.25)])
def test_marks_and_scales_of_netcdf_count(tmp_path, monkeypatch, reader, mark, dtype, scale):
    """With either library marks are holes, packed numbers are unpacked, and times are numbers."""
    if reader == "scipy":
        monkeypatch.setitem(sys.modules, "xarray", None)
    else:
        pytest.importorskip("xarray")
    path = tmp_path / "a.nc"
    said = {mark: np.array(-999, dtype=dtype)} | ({"scale_factor": scale} if scale != 1 else {})
    marked(path, dtype, scale, **said)
    found = SampledFrame.read(path)
    assert [hole.nodes.tolist() for hole in found.holes] == [[[3, 3]]]
    around = Loop.polygon([[1, 0.5], [5, 0.5], [5, 3], [1, 3]])
    assert found.burgers(around).vector == pytest.approx([10])


@pytest.mark.parametrize("end", ["npz", "h5", "nc"])
def test_a_mask_in_a_file_counts(tmp_path, end):
    """A node is masked by True, or by 1 in formats without truth values; 2 is refused."""
    axes = {"axis_x": np.arange(7.0), "axis_y": np.arange(8.0)}
    mask = np.zeros((7, 8), dtype=bool)
    mask[2, 3] = True
    path = tmp_path / f"a.{end}"
    for given in (mask, mask.astype(np.int8), 2 * mask.astype(np.int8)):
        if end == "npz":
            every: dict[str, Any] = {"coframe": np.ones((1, 2, 7, 8)), "mask": given, **axes}
            np.savez(path, **every)
        elif end == "h5":
            h5py = pytest.importorskip("h5py")
            with h5py.File(path, "w") as file:
                every = {"coframe": np.ones((1, 2, 7, 8)), "mask": given, **axes}
                for name, values in every.items():
                    file[name] = values
        else:
            with netcdf_file(path, "w") as data:
                for name, length in (("x", 7), ("y", 8), ("row", 1), ("column", 2)):
                    data.createDimension(name, length)
                for name in "xy":
                    data.createVariable(name, "d", (name,))[:] = axes[f"axis_{name}"]
                data.createVariable("coframe", "d", ("row", "column", "x", "y"))[:] = 1.0
                data.createVariable("mask", "b", ("x", "y"))[:] = given
        if given.max() < 2:
            assert [hole.nodes.tolist() for hole in SampledFrame.read(path).holes] == [[[2, 3]]]
        else:
            with pytest.raises(
                FileFormatError, match="mask: expected 1 at unknown nodes and 0 elsewhere"
            ):
                SampledFrame.read(path)


def square(path, **more):
    """An HDF5 file of torsion 1 on 8 x 8 nodes with changed data sets, without `names`."""
    h5py = pytest.importorskip("h5py")
    x, y = np.meshgrid(np.arange(8.0), np.arange(8.0), indexing="ij")
    every = {"coframe": np.array([[-y, x]]) / 2, "axis_x": x[:, 0], "axis_y": y[0], **more}
    with h5py.File(path, "w") as file:
        for name, values in every.items():
            if values is not None:
                file[name] = values
    return h5py.File(path, "a")


@pytest.mark.parametrize("name", ["scale_factor", "add_offset", "_FillValue", "missing_value"])
def test_packed_numbers_of_hdf5_are_refused(tmp_path, name):
    """Attributes that only NetCDF defines are refused, not ignored; nan is accepted."""
    with square(tmp_path / "a.h5") as file:
        file["coframe"].attrs[name] = np.nan
    assert SampledFrame.read(tmp_path / "a.h5").coframe[0, 1, 7, 0] == 3.5
    with square(tmp_path / "a.h5") as file:
        file["coframe"].attrs[name] = 2.0
    with pytest.raises(
        FileFormatError,
        match=f"coframe: expected plain numbers, got {name}, which only NetCDF files define",
    ):
        SampledFrame.read(tmp_path / "a.h5")


def test_texts_of_hdf5_may_be_bytes_and_lists(tmp_path):
    """Names, periods and units may be bytes or lists; numbers are refused."""
    with square(tmp_path / "a.h5") as file:
        file.attrs.update(unit=np.bytes_(b"nm"), names=["x", "y"], periodic=np.bytes_([b"y"]))
    found = SampledFrame.read(tmp_path / "a.h5")
    assert (found.unit, found.names, found.periodic) == ("nm", ("x", "y"), (False, True))
    with square(tmp_path / "a.h5") as file:
        file.attrs["unit"] = 3
    with pytest.raises(FileFormatError, match="unit: expected text"):
        SampledFrame.read(tmp_path / "a.h5")


def test_axes_of_hdf5_have_an_order(tmp_path):
    """`names` gives the order; without it only x, y, ... are accepted, not phi and r."""
    lines = {"axis_x": None, "axis_y": None, "axis_r": np.arange(8.0), "axis_phi": np.arange(8.0)}
    with square(tmp_path / "a.h5", **lines) as file:
        file.attrs["names"] = "r phi"
    assert SampledFrame.read(tmp_path / "a.h5").names == ("r", "phi")
    square(tmp_path / "a.h5", **lines).close()
    with pytest.raises(
        FileFormatError, match="names: expected the order of the axes phi, r, got none"
    ):
        SampledFrame.read(tmp_path / "a.h5")


def test_data_sets_of_hdf5_that_hold_nothing(tmp_path):
    """Empty and partly written data sets are refused, not read as zeros."""
    h5py = pytest.importorskip("h5py")
    square(tmp_path / "a.h5", coframe=h5py.Empty("f8")).close()
    with pytest.raises(FileFormatError, match="coframe: expected real numbers, got nothing"):
        SampledFrame.read(tmp_path / "a.h5")
    with square(tmp_path / "a.h5", coframe=None) as file:
        made = file.create_dataset("coframe", shape=(1, 2, 8, 8), dtype="f8", chunks=(1, 1, 8, 8))
        made[0, 0] = 1.0
    with pytest.raises(FileFormatError, match="coframe: expected 2 written parts, got 1"):
        SampledFrame.read(tmp_path / "a.h5")


def test_arrays_are_too_large_all_together(tmp_path):
    """Each array is within the limit, but the sum is not."""
    h5py = pytest.importorskip("h5py")
    third = LARGEST_ARRAYS // 8 // 3 + 1
    with square(tmp_path / "a.h5", axis_x=None, axis_y=None, coframe=None) as file:
        for name in ("axis_x", "axis_y", "coframe"):
            # One byte per entry, and packed: the file stays small.
            options = {"dtype": "i1", "chunks": (third,), "compression": "gzip"}
            file.create_dataset(name, shape=(third,), **options)
            file[name].id.write_direct_chunk((0,), zlib.compress(bytes(third)))
    assert h5py.is_hdf5(tmp_path / "a.h5")
    with pytest.raises(
        LimitError, match="expected at most 2,000,000,000 bytes of arrays, got 2,000,000,.* up to "
    ):
        SampledFrame.read(tmp_path / "a.h5")


@pytest.mark.parametrize("reader", ["xarray", "scipy"])
@pytest.mark.parametrize(
    ("name", "dimensions"),
    [
        ("coframe", ("column", "row", "x", "y")),
        ("sigma", ("row", "column", "y", "x")),
        ("mask", ("y", "x")),
    ],
)
def test_dimensions_of_netcdf_in_another_order(tmp_path, monkeypatch, reader, name, dimensions):
    """Dimensions of equal lengths in another order would be exchanged, so they are refused."""
    if reader == "scipy":
        monkeypatch.setitem(sys.modules, "xarray", None)
    else:
        pytest.importorskip("xarray")
    every = {"coframe": ("row", "column", "x", "y"), name: dimensions}
    with netcdf_file(tmp_path / "a.nc", "w") as data:
        for each, length in (("x", 8), ("y", 8), ("row", 2), ("column", 2)):
            data.createDimension(each, length)
        for each in "xy":
            data.createVariable(each, "d", (each,))[:] = np.arange(8.0)
        for each, along in every.items():
            data.createVariable(each, "d", along)[:] = 0.0
    with pytest.raises(FileFormatError, match=f"dimensions of {name} in the order row, column"):
        SampledFrame.read(tmp_path / "a.nc")


def test_links_in_netcdf_are_not_followed(tmp_path):
    """A NetCDF file of version 4 is an HDF5 file, so its links are refused as well."""
    h5py, xarray = pytest.importorskip("h5py"), pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    lines = {"x": np.arange(8.0), "y": np.arange(8.0)}
    values = {"coframe": (("row", "column", "x", "y"), np.ones((1, 2, 8, 8)))}
    xarray.Dataset(values, lines).to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    assert SampledFrame.read(tmp_path / "a.nc").coframe.shape == (1, 2, 8, 8)
    with h5py.File(tmp_path / "a.nc", "a") as file:
        file["other"] = h5py.ExternalLink("/etc/hostname", "/x")
    with pytest.raises(
        FileFormatError, match="other: expected data in this file, got a link to /etc/hostname"
    ):
        SampledFrame.read(tmp_path / "a.nc")


def test_two_marks_of_netcdf_are_not_passed_over(tmp_path, monkeypatch):
    """scipy compares with only one mark, so two marks are refused."""
    monkeypatch.setitem(sys.modules, "xarray", None)
    marked(tmp_path / "a.nc", "d", 1.0, missing_value=np.array([-999.0, -998.0]))
    with pytest.raises(
        FileFormatError, match="missing_value of coframe: expected one number, got 2"
    ):
        SampledFrame.read(tmp_path / "a.nc")
