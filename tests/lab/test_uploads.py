"""Files that are given to the page: recognised by content, read, or refused in a sentence."""

from __future__ import annotations

import io
import pickle
from pathlib import Path

import numpy as np
import pytest

from geomtorsion import SampledFrame
from geomtorsion.errors import FileFormatError, GeomtorsionError, LimitError
from geomtorsion.lab.settings import PAGE
from geomtorsion.lab.uploads import kind_of, read_map
from geomtorsion.orientations import OrientationMap
from tests.lab.maps import bomb, saved, twisted, wall_ctf


class Trap:
    """What runs when it is unpickled."""

    def __reduce__(self):
        return (pytest.fail, ("a file was unpickled",))


def objects() -> bytes:
    """An archive whose array holds pickled objects."""
    stream = io.BytesIO()
    np.savez(stream, axis_x=np.arange(5.0), axis_y=np.arange(5.0), coframe=np.array([Trap()]))
    return stream.getvalue()


@pytest.mark.parametrize("end", [".npz", ".csv"])
def test_a_sampled_frame_is_read_whatever_its_name(tmp_path: Path, end: str):
    """Both formats in which frames are saved, under the name of neither."""
    frame = twisted()
    content = saved(frame, tmp_path, end)
    assert kind_of(content) == end
    found = read_map(content, "photo.png")
    assert isinstance(found, SampledFrame)
    assert np.allclose(found.coframe, frame.coframe)
    assert found.sigma is not None
    assert found.unit == "um"


def test_an_orientation_map_is_read():
    """A .ctf file by its first line."""
    found = read_map(wall_ctf(), "table.csv")
    assert isinstance(found, OrientationMap)
    assert found.shape == (20, 24)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "empty"),
        (b"  \n\n", "empty"),
        (b"\x89PNG\r\n\x1a\n" + bytes(50), "picture"),
        (pickle.dumps(Trap()), "pickle"),
        (objects(), "map.npz"),
        (bomb(), "unpacks up to"),
        (b"PK\x03\x04" + bytes(40), "archive"),
        (bytes(range(256)) * 9, "neither"),
        (b"__import__('os').system('true')", "neither"),
        (b"x,y,e_0_0,e_0_1\n0,0,__import__('os'),1\n", "line 2"),
        (b"x,y,e_0_0,e_0_1\n0,0,1\n", "line 2"),
        (wall_ctf()[:3000], "truncated"),
        (wall_ctf().replace(b"Nickel\t11", b"Nickel\t99"), "line"),
        (wall_ctf()[:900].replace(b"XCells\t24", b"XCells\t9999999999"), "XCells"),
        (b"# HEADER\n 1 2 3 4 5 6 7 8\n", "map.npz"),
    ],
    ids=range(15),
)
def test_hostile_and_damaged_files_are_refused(content: bytes, said: str):
    """An error of our own that says what is wrong, and no path of this machine."""
    with pytest.raises(GeomtorsionError) as told:
        read_map(content, "map.npz")
    assert said in str(told.value)
    assert "given-map" not in str(told.value)
    assert "/tmp" not in str(told.value)


@pytest.mark.parametrize("end", [".npz", ".csv", ".ctf"])
def test_a_file_cut_anywhere_is_refused_or_read(tmp_path: Path, end: str):
    """Cut after any hundredth: a map that is complete, or an error of our own."""
    content = wall_ctf() if end == ".ctf" else saved(twisted((9, 8)), tmp_path, end)
    refused = 0
    for k in range(0, len(content), max(1, len(content) // 40)):
        try:
            read_map(content[:k], "map")
        except GeomtorsionError:
            refused += 1
    # A table of nodes is a table of fewer nodes, with holes, wherever a line ends.
    assert refused >= (20 if end != ".csv" else 5)


def test_a_map_with_too_many_nodes_is_refused():
    """One node more than the page takes; as many as it takes are read."""
    most = PAGE.nodes
    stream = io.BytesIO()
    for extra in (0, 1):
        stream = io.BytesIO()
        values = np.zeros((1, 2, most // 10 + extra, 10), np.float32)
        axes = {"axis_x": np.arange(most // 10 + extra), "axis_y": np.arange(10)}
        np.savez_compressed(stream, coframe=values, **axes)
        if extra:
            with pytest.raises(LimitError, match="the page takes up to"):
                read_map(stream.getvalue(), "map")
        else:
            assert read_map(stream.getvalue(), "map") is not None


def test_a_damaged_archive_says_so():
    """The last byte of an archive is missing."""
    with pytest.raises(FileFormatError, match="complete"):
        read_map(bomb()[:-30], "map")
