"""Silence: beside our message about a damaged file, no library prints one of its own."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.test_declared_sizes import tiff

CIF = (
    "data_x\n_cell_length_a 4\n_cell_length_b 4\n_cell_length_c 4\n_cell_angle_alpha 90\n"
    "_cell_angle_beta 90\n_cell_angle_gamma 90\n_symmetry_space_group_name_H-M 'F m -3 m'\n"
    "_space_group_crystal_system weird\nloop_\n_atom_site_label\n_atom_site_fract_x\n"
    "_atom_site_fract_y\n_atom_site_fract_z\nFe1 0 0 0\n"
)


def far_page() -> bytes:
    """A TIFF file whose first page is beyond its end."""
    content = bytearray(tiff(compression=1, strip=bytes(4096)))
    content[4:6] = b"\xff\xff"
    return bytes(content)


def no_tags() -> bytes:
    """A TIFF file with tags of unknown types."""
    content = bytearray(tiff(compression=1, strip=bytes(4096)))
    content[-30:-10] = b"\xff" * 20
    return bytes(content)


def error_lines(*arguments: str) -> list[str]:
    """Lines on standard error of a command, a process of its own, which is refused."""
    done = subprocess.run(
        [sys.executable, "-W", "default", "-m", "geomtorsion", *arguments],
        capture_output=True, text=True, timeout=100, check=False,
        cwd=Path(__file__).parents[2],
    )  # fmt: skip
    assert done.returncode == 2
    return done.stderr.splitlines()


@pytest.mark.parametrize(
    ("command", "name", "content", "library"),
    [
        ("map", "far.tif", far_page(), "tifffile"),
        ("map", "tags.tif", no_tags(), "tifffile"),
        ("crystal", "a.cif", CIF.encode(), "ase"),
    ],
)
def test_readers_of_files_are_silent(command, name, content, library, tmp_path):
    """Standard error holds our message and its page, nothing else."""
    pytest.importorskip(library)
    (tmp_path / name).write_bytes(content)
    message, page = error_lines(command, str(tmp_path / name))
    assert message.startswith("geomtorsion: ")
    assert page.startswith("(More on this")


@pytest.mark.parametrize("workers", ["1", "2"])
def test_damaged_chunks_are_silent(workers, tmp_path):
    """After the refusal of damaged Zarr chunks no task of asyncio is printed."""
    zarr = pytest.importorskip("zarr")
    array = zarr.create_array(
        str(tmp_path / "a.zarr"), shape=(2, 2, 120, 120), chunks=(2, 2, 10, 10), dtype="f8"
    )
    array[:] = np.random.default_rng(0).normal(size=array.shape) + np.eye(2)[:, :, None, None]
    for number, chunk in enumerate(sorted((tmp_path / "a.zarr/c").rglob("*"))):
        if chunk.is_file() and number % 3 == 0:
            chunk.write_bytes(b"garbage" * 10)
    out = ("-o", str(tmp_path / "out"), "--workers", workers)
    message, page = error_lines("map", str(tmp_path / "a.zarr"), *out)
    assert message.startswith("geomtorsion: ")
    assert page.startswith("(More on this")
