"""Pixel sizes: step and unit come from the file where it states both."""

import struct
from pathlib import Path

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import ImageError
from geomtorsion.materials.readers import open_source
from tests.materials.images.test_image_files_microscopes import IMAGE, mrc

# The reader of .mrc leaves its file open.
pytestmark = pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning"
)
GREY = IMAGE.astype(np.float32)


def tiff(path: Path, **options: object) -> Path:
    """A TIFF file with metadata."""
    pytest.importorskip("tifffile").imwrite(path, GREY, **options)
    return path


def sized_mrc(path: Path, steps: tuple[float, float]) -> Path:
    """An MRC file whose cell gives pixels of these sizes in angstrom."""
    content = bytearray(mrc(IMAGE[None]))
    rows, columns = IMAGE.shape
    content[28:40] = struct.pack("<3i", columns, rows, 1)
    content[40:52] = struct.pack("<3f", columns * steps[0], rows * steps[1], 1.0)
    path.write_bytes(bytes(content))
    return path


@pytest.mark.parametrize(
    ("options", "step", "unit"),
    [
        ({"imagej": True, "resolution": (20, 20), "metadata": {"unit": "nm"}}, 0.05, "nm"),
        ({"imagej": True, "resolution": (4, 4), "metadata": {"unit": "micron"}}, 0.25, "um"),
        ({"imagej": True, "resolution": (5e6, 5e6), "metadata": {"unit": "cm"}}, 2e-6, "mm"),
        (
            {
                "ome": True,
                "metadata": {"axes": "YX", "PhysicalSizeX": 0.031, "PhysicalSizeY": 0.031,
                             "PhysicalSizeXUnit": "nm", "PhysicalSizeYUnit": "nm"},
            },
            0.031,
            "nm",
        ),
        (
            {"ome": True, "metadata": {"axes": "YX", "PhysicalSizeX": 2.5, "PhysicalSizeY": 2.5}},
            2.5,
            "um",
        ),
        ({"resolution": (4e8, 4e8), "resolutionunit": "CENTIMETER"}, 0.025, "nm"),
        ({"resolution": (72, 72), "resolutionunit": "INCH"}, 1.0, "px"),
        ({"resolution": (20, 20), "resolutionunit": "NONE"}, 1.0, "px"),
        ({"imagej": True, "resolution": (20, 20), "metadata": {"unit": "pixel"}}, 1.0, "px"),
        ({"imagej": True, "resolution": (20, 20), "metadata": {"unit": "1/nm"}}, 1.0, "px"),
        ({}, 1.0, "px"),
    ],
)  # fmt: skip
def test_the_size_of_a_pixel_in_tiff(tmp_path: Path, options: dict[str, object], step, unit):
    """ImageJ, OME and resolution tags count; print resolutions and pixels do not."""
    image = gt.LatticeImage.read(tiff(tmp_path / "a.tif", **options))
    assert image.step == pytest.approx(step)
    assert image.unit == unit
    assert ("pixel size unknown" in repr(image)) == (unit == "px")
    assert ("pixel size unknown" in image.phases().description[0]) == (unit == "px")
    given = gt.LatticeImage.read(tmp_path / "a.tif", 0.7, "pm")
    assert (given.step, given.unit) == (0.7, "pm")


def test_the_size_of_a_pixel_of_a_microscope(tmp_path: Path):
    """The cell of an MRC file is in angstrom; a file without one leaves the size unknown."""
    pytest.importorskip("rsciio")
    image = gt.LatticeImage.read(sized_mrc(tmp_path / "a.mrc", (0.4, 0.4)))
    assert image.step == pytest.approx(0.04)
    assert image.unit == "nm"
    assert sorted(np.hypot(*image.phases().lattice.T).round(2)) == [0.24, 0.32]
    (tmp_path / "b.mrc").write_bytes(mrc(IMAGE[None]))
    assert gt.LatticeImage.read(tmp_path / "b.mrc").unit == "px"


def test_the_command_uses_the_size_in_the_file(tmp_path: Path):
    """A source opened without `pixel` has the lengths of the file; `pixel` overrides them."""
    path = tiff(tmp_path / "a.tif", imagej=True, resolution=(20, 20), metadata={"unit": "nm"})
    assert open_source(path).unit == "nm"
    assert open_source(path, pixel=(3.0, "um")).unit == "um"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda path: gt.LatticeImage.read(sized_mrc(path / "a.mrc", (0.4, 0.5))),
            "expected square pixels, got 0.0[45] nm by 0.0[45] nm",
        ),
        (lambda path: gt.LatticeImage.read(tiff(path / "a.tif"), unit="nm"), "step: expected"),
    ],
)
def test_refused_sizes(tmp_path: Path, call, words):
    """Pixels that are not square, and a unit without a step, are refused."""
    pytest.importorskip("rsciio")
    with pytest.raises(ImageError, match=words):
        call(tmp_path)
    if (tmp_path / "a.mrc").exists():
        assert gt.LatticeImage.read(tmp_path / "a.mrc", 0.04, "nm").step == 0.04
