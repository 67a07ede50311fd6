"""The Python of browsers is newer than those that most have: tests of what is exact pass on it."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from geomtorsion.errors import PackageError
from geomtorsion.lab.live import packages

ROOT = Path(__file__).parents[3]
# Seconds for one part of the suite, on a loaded machine.
PATIENCE = 3000


@pytest.fixture(scope="module")
def places(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Folders with Pyodide and with its packages; they are fetched, or were."""
    core, site, wheels = (tmp_path_factory.mktemp(name) for name in ("core", "site", "wheels"))
    if shutil.which("node") is None:
        pytest.skip("node is not installed")
    try:
        found = packages.fetched(packages.default_cache())
    except PackageError as error:
        pytest.skip(str(error))
    for name, content in packages.core_files(found["pyodide"]).items():
        (core / name).write_bytes(content)
    abi = "cp" + packages.PYTHON.replace(".", "")
    command = [
        sys.executable, "-m", "pip", "download", "--quiet", "--only-binary=:all:",
        "--platform", packages.PLATFORM, "--python-version", packages.PYTHON,
        "--implementation", "cp", "--abi", abi, "--dest", str(wheels),
        "pytest", "hypothesis", "networkx",
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(done.stderr[-500:])
    kept = [found[wheel.name] for wheel in packages.WHEELS]
    for wheel in [*wheels.glob("*.whl"), *kept]:
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(site)
    return core, site


@pytest.mark.slow
@pytest.mark.parametrize(("part", "least"), [("geometry", 400), ("action", 150)])
def test_a_part_of_the_suite(places: tuple[Path, Path], part: str, least: int):
    """Nothing fails but for want of numpy, threads or processes, and most needs none of them."""
    core, site = places
    script = Path(__file__).with_name("suite.mjs")
    # The stack that programs get is larger than what node takes of it by itself.
    command = ["node", "--stack-size=6000", str(script), str(core), str(ROOT), str(site)]
    done = subprocess.run(
        [*command, f"tests/{part}"], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert done.returncode == 0, done.stdout[-5000:] + done.stderr[-2000:]
    passed = re.search(r"(\d+) passed", done.stdout)
    assert passed is not None
    assert int(passed[1]) >= least
