"""Writing: each function that writes or reads a file refuses an invalid name in the same words."""

from __future__ import annotations

import ast
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, partial
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
from geomtorsion.pictures.scene_film import write_film
from geomtorsion.pictures.style import new_figure, save
from geomtorsion.spaces.tetrad_files import read_file
from geomtorsion.teaching.exercises import export
from geomtorsion.teaching.exercises.grading import grade, read_submission
from geomtorsion.teaching.exercises.sheets import write_sheet
from geomtorsion.teaching.lab import export as lab_pages
from tests.materials.lines.synthetic_networks import rings
from tests.source import FILES as SOURCES
from tests.source import PACKAGE, tree_of


@cache
def things() -> dict[str, Any]:
    """Objects to save, by name."""
    scene = scenes.load("straight_line")
    return {
        "solution": gt.solve(gt.ODE.of({"x": "-x"}, [1]), 1.0),
        "grid": gt.SampledFrame([np.arange(6.0)] * 2, np.ones((1, 2, 6, 6))),
        "network": gt.DislocationNetwork.of_arrays(rings(2, 1)),
        "Nye field": gt.NyeField(
            np.zeros((3, 3, 4, 4, 4)), gt.Box.of_bounds([0] * 3, [4] * 3), "um"
        ),
        "scene": scene,
        "result": scene.run(),
    }


def saved(name: str) -> Callable[[Any], object]:
    """A function that saves one of the objects."""
    return lambda path: things()[name].save(path)  # noqa: PLW0108 (made only when called)


# Kind of file: the function that writes it.
FILES: dict[str, Callable[[Any], object]] = {
    "solution": saved("solution"),
    "sampled frame": saved("grid"),
    "network": saved("network"),
    "Nye field": saved("Nye field"),
    "result of a scene": saved("result"),
    "scene": lambda path: scenes.write_file(things()["scene"], path),
}
FOLDERS: dict[str, Callable[[Any], object]] = {
    "report": lambda path: write_report(gt.spaces.load("s2"), path, pictures=False),
    "sheet": lambda path: write_sheet("3", path),
    "export": lambda path: export("nbgrader", path, ["3.2"]),
    "Moodle export": lambda path: export("stack", path, ["3.2"]),
    "pages": lab_pages.write_pages,
}
READERS: dict[str, Callable[[Any], object]] = {
    "solution": gt.SavedSolution.load,
    "sampled frame": gt.SampledFrame.read,
    "network": gt.DislocationNetwork.read,
    "Nye field": gt.NyeField.read,
    "result of a scene": scenes.SceneResult.load,
    "scene": scenes.read_file,
    "map": gt.OrientationMap.read,
    "image": gt.LatticeImage.read,
    "measured": open_source,
    "space": read_file,
    "loops": lambda path: read_loops(gt.spaces.load("s2").frame, path),
    "answers": read_submission,
}
GRIDS = ("npz", "csv", "vtk", "vtu", "h5", "nc")
NOT_NAMES = (None, 3, ["a.npz"], b"a.npz")


@pytest.fixture(autouse=True)
def few_pages(monkeypatch: pytest.MonkeyPatch):
    """Two pages instead of all, which take a minute to compute."""
    texts = {"index.html": "index " * 5000, "loops.html": "loops " * 5000}
    monkeypatch.setattr(lab_pages, "pages", lambda *_: texts)


@pytest.mark.parametrize("given", NOT_NAMES, ids=repr)
@pytest.mark.parametrize("what", dict.fromkeys([*FILES, *FOLDERS, *READERS]))
def test_anything_but_a_name_is_refused(what: str, given: object):
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


@contextmanager
def full_disk(room: int) -> Iterator[None]:
    """No file may grow beyond this number of bytes: the system fails as on a full disk."""
    resource = pytest.importorskip("resource")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def files_in(folder: Path) -> dict[str, bytes]:
    """Name -> bytes of all files below a folder, hidden ones too."""
    return {str(x.relative_to(folder)): x.read_bytes() for x in folder.rglob("*") if x.is_file()}


def check_full_disk(write: Callable[[Any], object], target: Path, folder: Path) -> None:
    """A write that fails half-way leaves the files as they were: absent, or their old bytes."""
    write(target)
    whole = files_in(folder)
    assert whole
    for old in ({}, dict.fromkeys(whole, b"old")):
        for name in whole:
            (folder / name).unlink(missing_ok=True)
            if old:
                (folder / name).write_bytes(old[name])
        half = max(map(len, whole.values())) // 2
        with full_disk(half), pytest.raises(FileFormatError, match="Free space on this disk"):
            write(target)
        assert files_in(folder) == old
    write(target)
    assert set(files_in(folder)) == set(whole)


@pytest.mark.parametrize("what", FILES)
def test_a_full_disk_leaves_no_half_file(tmp_path: Path, what: str):
    """A file gets its name only when all of its bytes are on the disk."""
    check_full_disk(FILES[what], tmp_path / "a.npz", tmp_path)


@pytest.mark.parametrize("what", FOLDERS)
def test_a_full_disk_leaves_no_half_export(tmp_path: Path, what: str):
    """Files of an export get their names together, when all of them are on the disk."""
    check_full_disk(FOLDERS[what], tmp_path, tmp_path)


@pytest.mark.parametrize("kind", GRIDS)
def test_a_full_disk_leaves_no_half_grid(tmp_path: Path, kind: str):
    """The same in each format of a sampled frame, also where another library writes."""
    check_full_disk(things()["grid"].save, tmp_path / f"a.{kind}", tmp_path)


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_a_full_disk_leaves_no_half_figure(tmp_path: Path, kind: str):
    """The same for figures."""
    figure = new_figure(3, 2)
    figure.add_subplot().plot([0, 1])
    check_full_disk(lambda path: save(figure, path), tmp_path / f"a.{kind}", tmp_path)


@pytest.mark.parametrize("kind", ["gif", "mp4"])
def test_a_full_disk_leaves_no_half_animation(tmp_path: Path, kind: str):
    """The same for animations, which another program may write."""
    if kind == "mp4" and not shutil.which("ffmpeg"):
        pytest.skip("needs ffmpeg")
    turns = np.tile(np.eye(3), (4, 1, 1))
    film = partial(write_film, times=np.arange(4.0), matrices=turns, seconds=0.2)
    check_full_disk(film, tmp_path / f"a.{kind}", tmp_path)


@pytest.mark.parametrize("table", ["marks.csv", "marks.json"])
def test_a_full_disk_leaves_no_half_marks(tmp_path: Path, table: str):
    """The table of marks is whole or as it was before."""
    answers, made = tmp_path / "answers", tmp_path / "made"
    answers.mkdir()
    (answers / "ada.toml").write_text('[answers]\n"3.2" = "cot(phi2)"\n', "utf-8")
    check_full_disk(lambda path: grade(answers, path), made / table, made)


# Files of the package that write to a path which their caller got from `written`, or to a
# temporary file that they delete.
WRITE_ELSEWHERE = {
    "support/files.py", "materials/fields/grid_files.py", "materials/fields/tables.py",
    "support/npz.py", "teaching/lab/uploads.py",
}  # fmt: skip


# Calls that write a file: methods of a path, and functions with the file as first argument.
OF_A_PATH = ("write_text", "write_bytes", "mkdir", "touch")
OF_A_FILE = ("savefig", "to_netcdf", "save", "savez", "savez_compressed", "savetxt")
WRITING_MODE = re.compile(r"[wax]b?t?\+?|r\+b?|rb\+")


def _mode(call: ast.Call) -> bool:
    """Whether a call opens for writing."""
    values = [*call.args, *(one.value for one in call.keywords if one.arg == "mode")]
    return any(
        isinstance(value, ast.Constant)
        and isinstance(value.value, str)
        and WRITING_MODE.fullmatch(value.value)
        for value in values
    )


def written_to(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """Name and line of each file that a text writes; the name is empty where it is none."""
    for call in ast.walk(tree):
        if not isinstance(call, ast.Call):
            continue
        name = getattr(call.func, "attr", getattr(call.func, "id", ""))
        receiver = getattr(call.func, "value", None)
        is_method = receiver is not None
        if is_method and (name in OF_A_PATH or (name == "open" and _mode(call))):
            yield getattr(receiver, "id", ""), call.lineno
        elif (name in ("open", "File", "ZipFile") and _mode(call)) or (
            name in OF_A_FILE
            and (getattr(receiver, "id", "") == "np" or name in ("savefig", "to_netcdf"))
        ):
            yield getattr(call.args[0], "id", ""), call.lineno


def names_of_files(tree: ast.AST) -> set[str]:
    """Names of what `written` gives in a text, and of the streams that are opened there."""
    pairs = [
        (item.context_expr, item.optional_vars)
        for block in ast.walk(tree)
        if isinstance(block, ast.With)
        for item in block.items
        if isinstance(item.context_expr, ast.Call) and isinstance(item.optional_vars, ast.Name)
    ]
    made = {"written", "enter_context"}
    names = {name.id for call, name in pairs if getattr(call.func, "id", "") in made}
    streams = {
        name.id
        for call, name in pairs
        if getattr(getattr(call.func, "value", None), "id", "") in names
    }
    texts = {
        target.id
        for part in ast.walk(tree)
        if isinstance(part, ast.Assign) and isinstance(part.value, ast.Call)
        if getattr(part.value.func, "id", "") in ("StringIO", "BytesIO")
        for target in part.targets
        if isinstance(target, ast.Name)
    }
    return names | streams | texts


def test_files_are_written_by_one_mechanism():
    """Outputs are written to what `support.files.written` gives: whole, or as they were before."""
    calls, strangers, needed = 0, [], set()
    for path in SOURCES:
        tree, where = tree_of(path), path.relative_to(PACKAGE).as_posix()
        names = names_of_files(tree)
        for name, line in written_to(tree):
            calls += 1
            if name not in names:
                needed.add(where)
                if where not in WRITE_ELSEWHERE:
                    strangers.append(f"{where}:{line}")
    assert not strangers
    assert calls > 10
    assert needed == set(WRITE_ELSEWHERE)


@pytest.mark.parametrize(
    "line",
    [
        "path.write_text('a')", "solution.plot().savefig(paths[1])", "open(path, 'w')",
        "path.open('wb')", "folder.mkdir(parents=True)", "np.savez(path, x=1)",
    ],
)  # fmt: skip
def test_another_way_to_write_would_be_found(line):
    """The check above can fail: it reports each of these lines."""
    tree = ast.parse(line)
    assert [name in names_of_files(tree) for name, _ in written_to(tree)] == [False]
    assert not list(written_to(ast.parse("path.open(); open(path, 'rb'); path.read_text()")))
