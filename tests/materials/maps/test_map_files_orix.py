"""Orix files: a map written by orix, where installed; the error where it is not."""

import sys

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError, MissingExtraError
from geomtorsion.materials.maps import OrientationMap
from tests.materials.maps.synthetic import bent
from tests.materials.maps.test_map_files import ang, write


def test_without_orix(tmp_path, monkeypatch):
    """The message names the extra and the other formats."""
    monkeypatch.setitem(sys.modules, "orix.io", None)
    with pytest.raises(MissingExtraError, match=r"geomtorsion\[ebsd\].*\.ctf or \.ang"):
        OrientationMap.read(tmp_path / "a.h5")


@pytest.mark.filterwarnings("ignore")
def test_both_readers_agree(tmp_path):
    """An .ang file read by orix, written as HDF5 and read back agrees with our own reader."""
    orix = pytest.importorskip("orix.io")
    path = write(tmp_path, ang(bent((12, 14), 0.1)), "a.ang")
    orix.save(str(tmp_path / "a.h5"), orix.load(str(path)))
    ours, theirs = (OrientationMap.read(tmp_path / name, sigma=0) for name in ("a.ang", "a.h5"))
    assert theirs.steps == pytest.approx(ours.steps)
    (phase,) = theirs.phases.values()
    assert (phase.laue, phase.lengths) == ("m-3m", (3.52, 3.52, 3.52))
    squares = ours.burgers_map(5), theirs.burgers_map(5)
    assert squares[0].arrows == pytest.approx(squares[1].arrows, abs=1e-7)
    assert np.nanmax(squares[0].per_area) > 1e-3
    (tmp_path / "b.h5").write_bytes(b"nothing")
    with pytest.raises(
        FileFormatError, match=r"b\.h5: the file cannot be read: it is truncated or not an HDF5"
    ):
        OrientationMap.read(tmp_path / "b.h5")


@pytest.mark.filterwarnings("ignore")
def test_lengths_are_read_in_their_unit(tmp_path):
    """A map with steps in nm is a thousand times smaller than a map in um."""
    orix = pytest.importorskip("orix.io")
    path = write(tmp_path, ang(bent((12, 14), 0.1)), "a.ang")
    xmap = orix.load(str(path))
    xmap.scan_unit = "nm"
    orix.save(str(tmp_path / "a.h5"), xmap)
    read = OrientationMap.read(tmp_path / "a.h5", sigma=0)
    assert (read.unit, read.steps) == ("um", pytest.approx((5e-4, 5e-4)))
    with pytest.raises(FileFormatError, match=r"laue: expected numbers of phases .*, got 7"):
        OrientationMap.read(tmp_path / "a.h5", laue={7: "m-3m"})


def changed(path, name, values):
    """Replace one data set in an orix file."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "a") as file:
        given = values(file[name][()]) if callable(values) else values
        del file[name]
        file[name] = given


def by_columns(path):
    """Sort the points of an orix file by columns."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "a") as file:
        data = file["crystal_map/data"]
        order = np.lexsort((data["y"], data["x"]))
        for name in list(data):
            values = data[name][()][order]
            del data[name]
            data[name] = values


DATA = "crystal_map/data/"


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (by_columns, r"a\.h5: point 2: expected x = 0\.5 from steps of 0\.5, got 0\. Sort"),
        (lambda path: changed(path, DATA + "phi1", np.degrees), "Angles are quite high"),
        (
            lambda path: changed(path, "crystal_map/header/scan_unit", np.bytes_(["px"])),
            "expected steps in angstrom or nm .*, got steps in 'px'. Set steps and scan_unit",
        ),
        (
            lambda path: changed(path, "manufacturer", np.bytes_(["no"])),
            r"cannot read \(it has no reader for this manufacturer, .* Its groups are crystal_map",
        ),
    ],
)
def test_maps_that_would_be_read_wrongly(tmp_path, change, message):
    """Points in another order, angles in degrees, steps without a length and other files fail."""
    orix = pytest.importorskip("orix.io")
    path = write(tmp_path, ang(bent((12, 14), 0.1)), "a.ang")
    orix.save(str(tmp_path / "a.h5"), orix.load(str(path)))
    OrientationMap.read(tmp_path / "a.h5", sigma=0)
    change(tmp_path / "a.h5")
    with pytest.raises(FileFormatError, match=message):
        OrientationMap.read(tmp_path / "a.h5", sigma=0)
