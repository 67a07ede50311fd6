"""sources: one digest of all that the site is made from, so that nobody builds the same one twice.

    python examples/site/extensions/sources.py [--versions]

With --versions those of the installed packages count, too, and that of Python.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterator
from importlib.metadata import distributions
from pathlib import Path

ROOT = Path(__file__).parents[3]
FOLDERS = ("geomtorsion", "examples")
FILES = ("README.md", "CHANGELOG.md", "LICENSE", "pyproject.toml")


def files() -> Iterator[Path]:
    """Every file that a page may be made from."""
    for folder in FOLDERS:
        yield from (path for path in (ROOT / folder).rglob("*") if path.is_file())
    yield from (ROOT / name for name in FILES)


def digest(*, versions: bool = False) -> str:
    """The digest: of names and contents, in a fixed order."""
    found = hashlib.sha256()
    for path in sorted(files()):
        if path.suffix != ".pyc":
            found.update(f"{path.relative_to(ROOT).as_posix()}\n".encode() + path.read_bytes())
    if versions:
        installed = sorted({f"{one.name}=={one.version}" for one in distributions()})
        found.update("\n".join([sys.version, *installed]).encode())
    return found.hexdigest()


if __name__ == "__main__":
    print(digest(versions="--versions" in sys.argv[1:]))
