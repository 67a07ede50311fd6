"""A teacher's own chapter on the page: served, exported, and chosen by nobody else."""

from __future__ import annotations

import shutil
from pathlib import Path

from typer.testing import CliRunner

from geomtorsion.cli.app import app
from geomtorsion.teaching.lab.export import exercises
from tests.teaching.lab.serving import served
from tests.teaching.lab.session import Session, run

EXAMPLE = Path(__file__).parents[3] / "examples" / "chapter"
TITLE = "8.2 A surface of circles"


def test_a_chapter_is_served_with_the_page():
    """The list has the teacher's exercises, and an answer to one is checked."""

    async def verdict(url: str) -> str:
        async with Session(url, "tab=Exercises&exercise=8.3") as session:
            await session.shown(TITLE)
            await session.shown("How large is a cell")
            await session.set(session.element("marimo-text", "determinant"), "r^3/r")
            await session.set(session.element("marimo-button", "Check"), 1)
            return (await session.shown('class="(right|wrong)"'))[1]

    with served("--chapter", str(EXAMPLE)) as url:
        assert run(verdict(url)) == "right"


def test_a_browser_cannot_choose_a_folder(tmp_path):
    """An address that names a folder runs no program of it."""
    folder = shutil.copytree(EXAMPLE, tmp_path / "own")
    (folder / "chapter.py").write_text("open('ran.txt', 'w').close()\n", "utf-8")

    async def listed(url: str) -> str:
        async with Session(url, f"tab=Exercises&exercise=8.3&chapter={folder}") as session:
            await session.shown("1.1 The legs")
            return "".join(session.outputs.values())

    with served() as url:
        assert TITLE not in run(listed(url))
    assert not Path("ran.txt").exists()


def test_a_mistake_is_reported_before_the_page_is_served(tmp_path):
    """The command ends with the file and the line."""
    (tmp_path / "chapter.toml").write_text("title = 'x'\n[a]\ntitel = 'y'\n", "utf-8")
    done = CliRunner().invoke(app, ["lab", "--chapter", str(tmp_path)])
    assert done.exit_code != 0
    assert "chapter.toml: line 2: " in done.output + str(done.exception)


def test_pages_without_a_server_have_the_chapter():
    """The exported exercises end with the teacher's, and their commands name the folder."""
    page = exercises("en", str(EXAMPLE))
    assert "8. Cones and cells" in page
    assert "exercises check 8.1 &quot;...&quot; --chapter chapter" in page
    assert page.count("--chapter") == 3
