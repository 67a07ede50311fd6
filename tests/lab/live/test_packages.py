"""Packages: fetched once by npm and pip, checked, kept; told plainly where they cannot be had."""

from __future__ import annotations

import hashlib
import io
import subprocess
import sys
import tarfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from geomtorsion.errors import PackageError
from geomtorsion.lab.live import packages
from geomtorsion.lab.live.packages import CORE, WHEELS, core_files, default_cache, fetched

CONTENT = b"a wheel"
WHEEL = replace(WHEELS[0], sha256=hashlib.sha256(CONTENT).hexdigest())


class Client:
    """Stands where npm and pip are: writes a file where it is told to, and notes what was asked."""

    def __init__(self, content: bytes | None = CONTENT, code: int = 0, said: str = "") -> None:
        self.content, self.code, self.said = content, code, said
        self.commands: list[list[str]] = []

    def run(self, command: Sequence[str], **_: object) -> subprocess.CompletedProcess[str]:
        self.commands.append(list(command))
        if self.content is not None:
            places = ("--dest", "--pack-destination")
            folder = next(command[k + 1] for k, word in enumerate(command) if word in places)
            Path(folder, WHEEL.file).write_bytes(self.content)
        return subprocess.CompletedProcess(list(command), self.code, "", self.said)


@pytest.fixture
def client(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> Client:
    """A client instead of the real ones."""
    found = Client(*getattr(request, "param", ()))
    monkeypatch.setattr(packages.subprocess, "run", found.run)
    return found


def test_a_package_is_fetched_once(client: Client, tmp_path: Path):
    """The second time it comes from the cache, and no client is asked."""
    for _ in range(2):
        found = fetched(tmp_path / "cache", packages=[WHEEL])
        assert found[WHEEL.name].read_bytes() == CONTENT
    [command] = client.commands
    assert command[0] == sys.executable
    assert f"{WHEEL.name}=={WHEEL.version}" in command
    assert [path.name for path in (tmp_path / "cache").iterdir()] == [WHEEL.file]


def test_a_damaged_file_is_fetched_again(client: Client, tmp_path: Path):
    """What lies in the cache is looked at each time."""
    (tmp_path / WHEEL.file).write_bytes(b"half a wh")
    assert fetched(tmp_path, packages=[WHEEL])[WHEEL.name].read_bytes() == CONTENT
    assert len(client.commands) == 1


@pytest.mark.parametrize("client", [(b"another wheel",)], indirect=True)
def test_another_file_is_refused(client: Client, tmp_path: Path):
    """Whoever serves something else under this name gets nowhere."""
    with pytest.raises(PackageError, match="SHA-256 .* was needed"):
        fetched(tmp_path, packages=[WHEEL])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("client", "said"),
    [((None, 1, "line\nno network\n"), "no network"), ((None,), "no file came"),
     ((None, 3), "ended with 3")],
    indirect=["client"],
)  # fmt: skip
def test_what_cannot_be_had_is_told(client: Client, said: str, tmp_path: Path):
    """What was needed, what came, what to do; the cache stays as it was."""
    with pytest.raises(PackageError, match=said) as error:
        fetched(tmp_path, packages=[WHEEL])
    assert "Connect to the network, or put" in str(error.value)
    assert WHEEL.file in str(error.value)
    assert not list(tmp_path.iterdir())


def test_a_client_that_is_not_installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """npm comes with node, which not everybody has."""
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(PackageError, match="npm is not installed"):
        fetched(tmp_path / "cache", packages=[CORE])


def test_the_archive_of_npm_is_opened(tmp_path: Path):
    """The files that a page needs, and an error of our own where one is missing."""
    path = tmp_path / "core.tgz"
    with tarfile.open(path, "w:gz") as archive:
        for name in packages.CORE_FILES[:2]:
            entry = tarfile.TarInfo(f"package/{name}")
            entry.size = len(CONTENT)
            archive.addfile(entry, io.BytesIO(CONTENT))
    with pytest.raises(PackageError, match=packages.CORE_FILES[2]):
        core_files(path)


@pytest.mark.parametrize(
    ("platform", "environment", "end"),
    [("linux", {"XDG_CACHE_HOME": "/k"}, "/k/geomtorsion"), ("linux", {}, ".cache/geomtorsion"),
     ("darwin", {}, "Library/Caches/geomtorsion"),
     ("win32", {"LOCALAPPDATA": "/l"}, "/l/geomtorsion/cache")],
)  # fmt: skip
def test_where_files_are_kept(platform: str, environment: dict[str, str], end: str):
    """Where the programs of each system keep what they can fetch again."""
    assert default_cache(environment, platform).as_posix().endswith(end)


@pytest.mark.parametrize(("lasts", "known"), [(590, True), (610, False)])
def test_a_slow_network_has_ten_minutes(
    lasts: float, known: bool, client: Client, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    """Who waits longer is told how long it was."""

    def run(command: Sequence[str], **how: float) -> subprocess.CompletedProcess[str]:
        if lasts > how["timeout"]:
            raise subprocess.TimeoutExpired(command, how["timeout"])
        return client.run(command)

    monkeypatch.setattr(packages.subprocess, "run", run)
    if known:
        assert fetched(tmp_path, packages=[WHEEL])
    else:
        with pytest.raises(PackageError, match="took longer than 600 s"):
            fetched(tmp_path, packages=[WHEEL])
