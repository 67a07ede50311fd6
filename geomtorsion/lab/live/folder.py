"""folder: the page without a server, as files that any static host serves."""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Mapping
from html import escape
from io import BytesIO
from os import PathLike
from pathlib import Path

from geomtorsion import checks
from geomtorsion.files import written
from geomtorsion.lab import views
from geomtorsion.lab.live import packages
from geomtorsion.lab.live.guides import LIVE, UNAVAILABLE, note
from geomtorsion.lab.live.packages import Progress
from geomtorsion.lab.live.tabs import TASKS
from geomtorsion.lab.settings import PAGE
from geomtorsion.lab.tasks import BROKEN, task, too_long
from geomtorsion.pictures.formula import font_face

# The browser is told to load nothing from anywhere else; compiled code is Python itself.
POLICY = (
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; "
    "connect-src 'self'; style-src 'unsafe-inline'; img-src data:; font-src data:; "
    "base-uri 'none'; form-action 'none'"
)
HERE = Path(__file__).parent
PACKAGE = HERE.parents[1]
# Parts of geomtorsion for which a browser has no use.
UNUSED = ("cli", "__main__.py")
# All files of one zip are of one date, so that equal files give equal folders.
DATE = (2020, 1, 1, 0, 0, 0)
# What is imported at the start, in steps that move the bar: what is said, and the code.
IMPORTS = (
    ("starting exact arithmetic",
     "from geomtorsion.lab.live.absent import stand_in\nstand_in()\nimport flint"),
    ("starting algebra", "import sympy"),
    ("starting geometry", "from geomtorsion.lab.live.browser import answer, warm\nwarm()"),
)  # fmt: skip


def write_live(
    directory: str | PathLike[str],
    progress: Progress = lambda _: None,
    cache: str | PathLike[str] | None = None,
) -> tuple[Path, ...]:
    """Write the page that works without a server; give the paths of its files, the index first.

    Everything is in the folder: Python for browsers, its packages, geomtorsion itself. What comes
    from registries is fetched once into the cache; nothing is written before everything is there.

    Parameters
    ----------
    cache
        Folder for what is fetched; default: that of the user.

    Raises
    ------
    PackageError
        A package is not in the cache, and cannot be fetched.
    """
    directory = checks.file_name(directory, "directory")
    kept = packages.default_cache() if cache is None else checks.file_name(cache, "cache")
    made = files(packages.fetched(kept, progress))
    paths = []
    with written(directory, is_folder=True) as target:
        for name, content in made.items():
            path = target / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
            paths.append(path)
    return tuple(paths)


def files(found: Mapping[str, Path]) -> dict[str, bytes]:
    """File name -> content, the index first; found: the packages by name."""
    wheels = {found[wheel.name].name: found[wheel.name].read_bytes() for wheel in packages.WHEELS}
    core = packages.core_files(found[packages.CORE.name])
    own = zipped(PACKAGE)
    mark = hashlib.sha256(own + "".join(wheel.sha256 for wheel in packages.WHEELS).encode())
    # A folder with another content has another name: what is kept under a name never changes.
    folder = f"wheels-{mark.hexdigest()[:12]}"
    archives = {f"{folder}/{name}": content for name, content in wheels.items()}
    archives[f"{folder}/geomtorsion.zip"] = own
    sizes = sum(map(len, archives.values())) + sum(len(core[name]) for name in packages.CORE_FILES)
    scripts = {
        "live.js": script("live.js") + views.copying(),
        "worker.js": script("worker.js"),
        "service.js": script("service.js").replace("@DIGEST@", mark.hexdigest()[:12]),
    }
    return {
        "index.html": page(configuration(list(archives), sizes)).encode(),
        **{name: text.encode() for name, text in scripts.items()},
        **{f"pyodide/{name}": content for name, content in core.items()},
        **archives,
    }


def script(name: str) -> str:
    """A script that lies beside this file."""
    return (HERE / name).read_text("utf-8")


def zipped(package: Path) -> bytes:
    """This package as a zip, without what a browser has no use for."""
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(package.rglob("*")):
            inside = path.relative_to(package)
            if path.is_file() and inside.parts[0] not in UNUSED and "__pycache__" not in path.parts:
                entry = zipfile.ZipInfo(f"geomtorsion/{inside.as_posix()}", DATE)
                entry.compress_type = zipfile.ZIP_DEFLATED
                archive.writestr(entry, path.read_bytes())
    return buffer.getvalue()


def configuration(archives: list[str], size: int) -> dict[str, object]:
    """What the scripts of the page need to know.

    bytes: of everything that is fetched. archives: what is unpacked, and where. imports: steps of
    the start. seconds: how long a request of a tab may take. The rest: limits and messages.
    """
    site = f"/lib/python{packages.PYTHON}/site-packages"
    return {
        "bytes": size,
        "archives": [
            {"file": name, "format": "wheel"}
            if name.endswith(".whl")
            else {"file": name, "format": "zip", "into": site}
            for name in archives
        ],
        "imports": IMPORTS,
        "seconds": {tab: sum(task(name).seconds for name in names) for tab, names in TASKS.items()},
        "pause": PAGE.pause,
        "address": PAGE.address,
        "stopped": too_long("@"),
        "broken": BROKEN,
        "unstarted": "the page could not start Python in this browser; load it again, or use "
        "another browser",
        "from_disk": "browsers start nothing from a disk: serve this folder, as "
        "`python -m http.server` does, and open the address that it says",
    }


def page(config: Mapping[str, object]) -> str:
    """The page itself."""
    buttons, panels = [], []
    for k, tab in enumerate((*TASKS, *UNAVAILABLE)):
        chosen = "true" if k == 0 else "false"
        buttons.append(
            f'<button type="button" role="tab" id="tab{k}" aria-controls="panel{k}" '
            f'aria-selected="{chosen}" tabindex="{0 if k == 0 else -1}">{escape(tab)}</button>'
        )
        panels.append(
            f'<section role="tabpanel" id="panel{k}" aria-labelledby="tab{k}"'
            f"{'' if k == 0 else ' hidden'}>{panel(tab)}</section>"
        )
    # A "<" in a script of data could end it.
    data = json.dumps(config).replace("<", "\\u003c")
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        '<title>Torsion lab</title><link rel="icon" href="data:,">'
        f"<style>{font_face()}{views.style()}{script('live.css')}</style></head>\n"
        f'<body><main class="lab"><h1>Torsion lab</h1>{note()}'
        '<p id="starting" role="status"><progress max="1" value="0"></progress>'
        "<span>starting</span></p>"
        f'<div role="tablist" aria-label="Parts of the lab">{"".join(buttons)}</div>'
        f"{''.join(panels)}</main>"
        f'<script type="application/json" id="config">{data}</script>'
        '<script type="module" src="live.js"></script></body></html>\n'
    )


def panel(tab: str) -> str:
    """A tab as it is before anything is computed: what it is for, and places for the rest."""
    if tab in UNAVAILABLE:
        return f'<p class="guide">{escape(UNAVAILABLE[tab])}</p>'
    guide = LIVE[tab]
    return (
        f'<p class="guide">{escape(guide.seen)}</p>'
        f'<p class="guide"><strong>Try:</strong> {escape(guide.tried)}</p>'
        f'<div data-tab="{escape(tab)}"><form></form>'
        '<div data-part="problem"></div><div data-part="result"></div></div>'
    )
