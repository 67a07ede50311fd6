"""sources: one digest of all sources of the site, so that an unchanged site is not built twice.

    python examples/site/extensions/sources.py [--versions]

With --versions the digest also depends on the versions of Python and the installed packages.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterable, Iterator
from importlib.metadata import distributions
from pathlib import Path

ROOT = Path(__file__).parents[3]
SITE = ROOT / "examples" / "site"
# Written while the site is built: pages of examples, and pages of classes.
MADE = SITE / "gallery" / "pages"
CLASSES = SITE / "api" / "pages"
FOLDERS = ("geomtorsion", "examples")
FILES = ("README.md", "CHANGELOG.md", "LICENSE", "pyproject.toml")


def files() -> Iterator[Path]:
    """Every file that a page may be made from."""
    for folder in FOLDERS:
        for path in (ROOT / folder).rglob("*"):
            written = {MADE, CLASSES} & set(path.parents)
            if path.is_file() and path.suffix != ".pyc" and not written:
                yield path
    yield from (ROOT / name for name in FILES)


def scripts() -> Iterator[Path]:
    """The only files on which the examples depend."""
    return (path for path in files() if path.suffix == ".py" and SITE not in path.parents)


def digest(given: Iterable[Path] | None = None, *, versions: bool = False) -> str:
    """The digest of some files, or of all: of names and contents, in a fixed order."""
    found = hashlib.sha256()
    for path in sorted(files() if given is None else given):
        found.update(f"{path.relative_to(ROOT).as_posix()}\n".encode() + path.read_bytes())
    if versions:
        installed = sorted({f"{one.name}=={one.version}" for one in distributions()})
        found.update("\n".join([sys.version, *installed]).encode())
    return found.hexdigest()


if __name__ == "__main__":
    print(digest(versions="--versions" in sys.argv[1:]))
