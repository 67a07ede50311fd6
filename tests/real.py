"""Real: measured files beside the project, which does not contain them."""

from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "shared" / "data"


def real(name: str) -> Path:
    """Path of a measured file in that folder; the test is skipped if the file is missing."""
    path = FOLDER / name
    if not path.is_file():
        pytest.skip(f"{name} is not here")
    return path
