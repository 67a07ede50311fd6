"""The built site: build/site if it belongs to these sources, otherwise a new build."""

import subprocess
import sys
from pathlib import Path

import pytest

SITE = Path(__file__).parents[2] / "examples" / "site"
sys.path.append(str(SITE / "extensions"))


@pytest.fixture(scope="session")
def built(tmp_path_factory) -> Path:
    """The folder with the pages; the build fails on any warning, as the README's command does."""
    for name in ("myst_nb", "sphinx_copybutton"):
        pytest.importorskip(name, reason="the extra docs is not installed")
    import sources  # on the path that is added above

    kept = SITE.parents[1] / "build" / "site"
    note = kept / "sources.txt"
    if note.is_file() and note.read_text("utf-8") == sources.digest():
        return kept
    folder = tmp_path_factory.mktemp("site")
    command = ["-m", "sphinx", "-q", "-W", "-j", "auto", str(SITE), str(folder)]
    done = subprocess.run([sys.executable, *command], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder
