"""packages: what runs in the browser besides geomtorsion itself, fetched once and checked.

The packages are asked for by the ordinary clients of two registries, npm and pip, lie in a folder
of the user from then on, and are used only if they are, byte for byte, those that were tested.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tarfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from geomtorsion.errors import PackageError

Progress = Callable[[str], object]
# Seconds that a client may take for one package: 10 MB over a slow line.
PATIENCE = 600.0
# What a browser's Python is called by pip.
PLATFORM, PYTHON = "pyemscripten_2026_0_wasm32", "3.14"


@dataclass(frozen=True)
class Package:
    """One file of a registry.

    name, version: what is asked for. file: what it is called there. sha256: its digest.
    registry: "npm" or "pip". used_for: what it does in the browser.
    """

    name: str
    version: str
    file: str
    sha256: str
    registry: str
    used_for: str

    def command(self, folder: Path) -> list[str]:
        """The command line of a client that puts the file into a folder."""
        if self.registry == "npm":
            npm = shutil.which("npm") or "npm"
            return [npm, "pack", f"{self.name}@{self.version}", "--pack-destination", str(folder)]
        abi = "cp" + PYTHON.replace(".", "")
        return [
            sys.executable, "-m", "pip", "download", "--quiet", "--no-deps",
            "--only-binary=:all:", "--platform", PLATFORM, "--python-version", PYTHON,
            "--implementation", "cp", "--abi", abi, "--dest", str(folder),
            f"{self.name}=={self.version}",
        ]  # fmt: skip


# Everything by its digest, so that each export is what was tested.
CORE = Package(
    "pyodide", "314.0.7", "pyodide-314.0.7.tgz",
    "66b7949e5a0cba2250b586d7e368bf12fb482800748d182c4618254b685ffaa0", "npm",
    "Python itself, built for browsers",
)  # fmt: skip
WHEELS = (
    Package(
        "python-flint", "0.9.0", "python_flint-0.9.0-cp314-cp314-pyemscripten_2026_0_wasm32.whl",
        "b31f5c00e0e36040ab58d00b3025156e20869b990d776e4bf90f870b1ee11ad3", "pip",
        "exact polynomials and fractions",
    ),
    Package(
        "mpmath", "1.3.0", "mpmath-1.3.0-py3-none-any.whl",
        "a0b2b9fe80bbcd81a6647ff13108738cfb482d481d826cc0e02f5b35e5c88d2c", "pip",
        "numbers of many digits",
    ),
    Package(
        "sympy", "1.14.0", "sympy-1.14.0-py3-none-any.whl",
        "e091cc3e99d2141a0ba2847328f5479b05d94a6635cb96148ccb3f34671bd8f5", "pip",
        "expressions",
    ),
)  # fmt: skip
# What the registries have no build of: the page says what does not work without it.
MISSING = ("numpy", "scipy")
# Files of the core that a page needs; the others are for editors and for consoles.
CORE_FILES = (
    "pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip", "pyodide-lock.json",
)  # fmt: skip


def default_cache(
    environment: Mapping[str, str] | None = None, platform: str = sys.platform
) -> Path:
    """Where a user's programs keep what they can fetch again.

    Examples
    --------
    >>> default_cache({"XDG_CACHE_HOME": "/tmp/kept"}, "linux").as_posix()
    '/tmp/kept/geomtorsion'
    """
    given = os.environ if environment is None else environment
    if platform == "win32" and given.get("LOCALAPPDATA"):
        return Path(given["LOCALAPPDATA"]) / "geomtorsion" / "cache"
    if platform == "darwin":
        return Path.home() / "Library" / "Caches" / "geomtorsion"
    kept = given.get("XDG_CACHE_HOME")
    return (Path(kept) if kept else Path.home() / ".cache") / "geomtorsion"


def fetched(
    cache: Path,
    progress: Progress = lambda _: None,
    packages: Sequence[Package] = (CORE, *WHEELS),
) -> dict[str, Path]:
    """The file of each package, by its name; what is not in the cache is fetched into it.

    Raises
    ------
    PackageError
        A package can be had neither from the cache nor from its registry, or is another one.
    """
    cache.mkdir(parents=True, exist_ok=True)
    found = {}
    for package in packages:
        path = cache / package.file
        if not path.is_file() or digest(path) != package.sha256:
            progress(f"{package.name} {package.version}")
            _fetch(package, cache)
        found[package.name] = path
    return found


def digest(path: Path) -> str:
    """The SHA-256 of a file, in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def core_files(archive: Path) -> dict[str, bytes]:
    """The files of Python for browsers, out of the archive of npm.

    Raises
    ------
    PackageError
        One of them is not there.
    """
    found = {}
    with tarfile.open(archive, "r:gz") as members:
        for name in CORE_FILES:
            try:
                member = members.extractfile(f"package/{name}")
            except KeyError:
                member = None
            if member is None:
                raise PackageError(
                    f"{archive.name}: package/{name} was needed, but is not in the archive. Delete "
                    "the file and export again."
                )
            found[name] = member.read()
    return found


def _fetch(package: Package, cache: Path) -> None:
    """Let a client put the file of a package into the cache, and look whether it is the right one.

    The file takes its place only when it is whole.
    """
    folder = cache / f"fetching-{package.name}-{os.getpid()}"
    folder.mkdir(exist_ok=True)
    try:
        said = _run(package.command(folder))
        path = folder / package.file
        if said or not path.is_file():
            raise PackageError(
                f"{package.name} {package.version} ({package.used_for}) is needed, but "
                f"{package.registry} did not bring it: {said or 'no file came'}. Connect to the "
                f"network, or put {package.file} into {cache}."
            )
        if digest(path) != package.sha256:
            raise PackageError(
                f"{package.file}: the file with SHA-256 {package.sha256} was needed, "
                f"{digest(path)} came. Fetch it from a registry that you trust, and put it into "
                f"{cache}."
            )
        path.replace(cache / package.file)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _run(command: Sequence[str]) -> str:
    """Run a client; what went wrong, in its last words, or nothing."""
    try:
        done = subprocess.run(
            command, capture_output=True, timeout=PATIENCE, check=False, text=True, errors="replace"
        )
    except FileNotFoundError:
        return f"{Path(command[0]).name} is not installed"
    except subprocess.TimeoutExpired:
        return f"it took longer than {PATIENCE:g} s"
    if done.returncode == 0:
        return ""
    lines = [line for line in done.stderr.splitlines() if line.strip()]
    return (lines[-1] if lines else f"it ended with {done.returncode}")[:200]
