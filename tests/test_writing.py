"""Writing: each function that writes or reads a file refuses an invalid name in the same words."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion import scenes
from geomtorsion.errors import ArgumentError, FileFormatError, ImageError
from geomtorsion.loops.loop_files import read_loops
from geomtorsion.materials.readers import open_source
from geomtorsion.pictures.report import write_report
from geomtorsion.spaces.files import read_file
from geomtorsion.teaching.exercises import export
from geomtorsion.teaching.exercises.grading import read_submission
from geomtorsion.teaching.exercises.sheets import write_sheet
from tests.materials.lines.synthetic_networks import rings


@cache
def things() -> dict[str, Any]:
    """Objects to save, by name."""
    scene = scenes.load("straight_line")
    return {
        "solution": gt.solve(gt.ODE.of({"x": "-x"}, [1]), 1.0),
        "grid": gt.SampledFrame([np.arange(6.0)] * 2, np.ones((1, 2, 6, 6))),
        "network": gt.DislocationNetwork.of_arrays(rings(2, 1)),
        "scene": scene,
        "result": scene.run(),
    }


def saved(name: str) -> Callable[[Any], object]:
    """A function that saves one of the objects."""

    def save(path: object) -> object:
        return things()[name].save(path)

    return save


# Kind of file: the function that writes it.
FILES: dict[str, Callable[[Any], object]] = {
    "solution": saved("solution"),
    "sampled frame": saved("grid"),
    "network": saved("network"),
    "result of a scene": saved("result"),
    "scene": lambda path: scenes.write_file(things()["scene"], path),
}
FOLDERS: dict[str, Callable[[Any], object]] = {
    "report": lambda path: write_report(gt.spaces.load("s2"), path, pictures=False),
    "sheet": lambda path: write_sheet("3", path),
    "export": lambda path: export("nbgrader", path, ["3.2"]),
}
READERS: dict[str, Callable[[Any], object]] = {
    "solution": gt.SavedSolution.load,
    "sampled frame": gt.SampledFrame.read,
    "network": gt.DislocationNetwork.read,
    "result of a scene": scenes.SceneResult.load,
    "scene": scenes.read_file,
    "map": gt.OrientationMap.read,
    "image": gt.LatticeImage.read,
    "measured": open_source,
    "space": read_file,
    "loops": lambda path: read_loops(gt.spaces.load("s2").frame, path),
    "answers": read_submission,
}
NOT_NAMES = (None, 3, ["a.npz"], b"a.npz")


@pytest.mark.parametrize("given", NOT_NAMES, ids=repr)
@pytest.mark.parametrize("what", dict.fromkeys([*FILES, *FOLDERS, *READERS]))
def test_what_is_no_name(what: str, given: object):
    """A value that is not a file name is refused as an argument, by writers and readers."""
    for table in (FILES, FOLDERS, READERS):
        if what in table:
            with pytest.raises((ArgumentError, ImageError), match="expected the name of a file"):
                table[what](given)


@pytest.mark.parametrize("what", FILES)
def test_places_where_no_file_can_be(tmp_path: Path, what: str):
    """A missing folder, a folder, a path through a file and an invalid name are refused."""
    (tmp_path / "folder.npz").mkdir()
    (tmp_path / "file").write_text("")
    for place, reason in {
        tmp_path / "nowhere" / "a.npz": "No such file or directory",
        tmp_path / "folder.npz": "Is a directory",
        tmp_path / "file" / "a.npz": "Not a directory",
        "a" * 5000 + ".npz": "File name too long",
    }.items():
        with pytest.raises(
            FileFormatError, match=f"the file cannot be written: {reason}. Name a file"
        ):
            FILES[what](place)
    for place in ("", ".", "a\0.npz"):
        with pytest.raises(FileFormatError, match="this is not the name of a file"):
            FILES[what](place)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder.npz"]


@pytest.mark.parametrize("what", FOLDERS)
def test_places_where_no_folder_can_be(tmp_path: Path, what: str):
    """A new folder is created, but not within a file."""
    (tmp_path / "file").write_text("")
    with pytest.raises(FileFormatError, match="cannot be written: Not a directory. Name another"):
        FOLDERS[what](tmp_path / "file" / "a")
    FOLDERS[what](tmp_path / "new" / "folder")
    assert any((tmp_path / "new" / "folder").iterdir())
