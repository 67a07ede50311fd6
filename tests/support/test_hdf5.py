"""HDF5: damaged files, files that refer to others and files that declare too much are refused."""

import numpy as np
import pytest

from geomtorsion.errors import FileFormatError, LimitError
from geomtorsion.materials.readers import open_source
from geomtorsion.support.hdf5 import check_hdf5

h5py = pytest.importorskip("h5py")


def whole(path):
    """A valid file with a group and a data set in it."""
    with h5py.File(path, "w") as file:
        file["group/numbers"] = np.arange(50.0)
    return path


def test_a_whole_file_lists_its_names(tmp_path):
    """The check of a valid file returns the names at its top; links within the file are allowed."""
    path = whole(tmp_path / "a.h5")
    with h5py.File(path, "a") as file:
        file["again"] = h5py.SoftLink("/group/numbers")
    assert check_hdf5(path, h5py) == ["again", "group"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda file: file.__setitem__("group/x", h5py.ExternalLink("/etc/hosts", "/x")),
            "group/x: expected data in this file, got a link to /etc/hosts",
        ),
        (
            lambda file: file.create_dataset("x", (9,), "f8", external=[("b", 0, 72)]),
            "x: expected data in this file, got a reference",
        ),
        (
            lambda file: file.create_virtual_dataset("x", virtual_layout("other.h5")),
            "x: expected data in this file, got a reference",
        ),
    ],
)
def test_references_to_other_files_are_refused(tmp_path, change, message):
    """A reference to another file is refused at each position in a file."""
    path = whole(tmp_path / "a.h5")
    with h5py.File(path, "a") as file:
        change(file)
    with pytest.raises(FileFormatError, match=f"a.h5: {message}"):
        check_hdf5(path, h5py)


def virtual_layout(name):
    """Layout of a data set whose data are in another file."""
    layout = h5py.VirtualLayout(shape=(9,), dtype="f8")
    layout[...] = h5py.VirtualSource(name, "x", shape=(9,))
    return layout


def test_sizes_that_cannot_be(tmp_path):
    """A data set is refused if it declares more than its stored bytes could unpack to."""
    path = whole(tmp_path / "a.h5")
    with h5py.File(path, "a") as file:
        file.create_dataset("group/huge", shape=(10**6, 10**6), dtype="f8", chunks=(100, 100))
    with pytest.raises(LimitError, match="group/huge would take 8,000,000,000,000 bytes"):
        check_hdf5(path, h5py)


@pytest.mark.parametrize("name", ["a.h5", "a.hdf5", "a.nc"])
def test_damage_is_refused_by_every_reader(tmp_path, name):
    """A file with one changed byte is refused by its name; the check itself refuses ten or more."""
    if name != "a.nc":
        pytest.importorskip("h5py")
    content = whole(tmp_path / "whole.h5").read_bytes()
    refused = 0
    for place in range(0, len(content), 23):
        spoilt = bytearray(content)
        spoilt[place] ^= 0xFF
        (tmp_path / name).write_bytes(spoilt)
        with pytest.raises((FileFormatError, LimitError), match=name):
            open_source(tmp_path / name)
        try:
            check_hdf5(tmp_path / name, h5py)
        except FileFormatError:
            refused += 1
    assert refused >= 10
