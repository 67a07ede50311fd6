"""Microscope files, read by rosettasciio, and strain relative to a reference region."""

import struct
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import FileFormatError, GeomtorsionError, ImageError, MissingExtraError

# The reader of .mrc leaves its file open.
pytestmark = pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning"
)

Y, X = np.mgrid[63:-1:-1, 0:80]
IMAGE = (1000 * (np.cos(2 * np.pi * X / 8) + np.cos(2 * np.pi * Y / 6))).astype("<f4")
ENDS = (".dm3", ".dm4", ".emd", ".mrc", ".ser", ".hspy")


def mrc(images: np.ndarray, count: int | None = None) -> bytes:
    """An .mrc file of floats, with a header of 1024 bytes."""
    pages, rows, columns = images.shape
    head = struct.pack("<4i", columns, rows, pages if count is None else count, 2)
    return head.ljust(1024, b"\0") + images.tobytes()


def ser(image: np.ndarray, columns: int | None = None) -> bytes:
    """A .ser file of one image; TIA writes its rows from the bottom."""
    rows, wide = image.shape
    head = struct.pack("<hhhiiii", 0x4949, 0x0197, 0x0210, 0x4122, 0x4152, 1, 1)
    axis = struct.pack("<iddi", 1, 0.0, 1.0, 0) + struct.pack("<i", 6) + b"Number"
    axis += struct.pack("<i", 0)
    first = len(head) + 8 + len(axis)
    data = struct.pack("<ddiddi", 0.0, 1e-10, 0, 0.0, 1e-10, 0)
    data += struct.pack("<hii", 7, wide if columns is None else columns, rows)
    data += image[::-1].tobytes()
    offsets = struct.pack("<ii", first + 8, first + 8 + len(data))
    tag = struct.pack("<hhi", 0x4152, 0, 0)
    return head + struct.pack("<ii", first, 1) + axis + offsets + data + tag


def dm3(image: np.ndarray, columns: int | None = None) -> bytes:
    """A .dm3 file of one image: groups of tags with little-endian numbers."""
    rows, wide = image.shape

    def tag(name: str, kinds: list[int], content: bytes) -> bytes:
        head = b"\x15" + struct.pack(">h", len(name)) + name.encode() + b"%%%%"
        return head + struct.pack(f">i{len(kinds)}i", len(kinds), *kinds) + content

    def group(name: str, *tags: bytes) -> bytes:
        head = b"\x14" + struct.pack(">h", len(name)) + name.encode()
        return head + struct.pack(">bbi", 1, 0, len(tags)) + b"".join(tags)

    def long(name: str, value: int) -> bytes:
        return tag(name, [3], struct.pack("<i", value))

    def axis() -> bytes:
        unit = "nm".encode("utf-16-le")
        return group(
            "", tag("Origin", [6], struct.pack("<f", 0)), tag("Scale", [6], struct.pack("<f", 0.1)),
            tag("Units", [20, 4, 2], unit),
        )  # fmt: skip

    data = group(
        "ImageData",
        group("Calibrations", group("Dimension", axis(), axis())),
        tag("Data", [20, 6, rows * wide], image.tobytes()),
        long("DataType", 2),
        group("Dimensions", long("", wide if columns is None else columns), long("", rows)),
        long("PixelDepth", 4),
    )
    one = group("", data, group("ImageTags"), tag("Name", [20, 4, 1], "a".encode("utf-16-le")))
    body = struct.pack(">bbi", 1, 0, 1) + group("ImageList", one)
    return struct.pack(">3i", 3, len(body), 1) + body + bytes(8)


def hspy(path: Path, image: np.ndarray) -> None:
    """Write a file as hyperspy saves a signal."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        file.attrs["file_format"], file.attrs["file_format_version"] = "HyperSpy", "3.3"
        group = file.create_group("Experiments/a")
        group.create_dataset("data", data=image, chunks=True)
        for k, (name, size) in enumerate(zip("yx", image.shape, strict=True)):
            axis = group.create_group(f"axis-{k}")
            axis.attrs.update({
                "name": name, "size": size, "offset": 0.0, "scale": 1.0, "units": "nm",
                "navigate": False, "_type": "UniformDataAxis", "is_binned": False,
            })  # fmt: skip
        for name in ("metadata", "original_metadata", "learning_results"):
            group.create_group(name)


def emd(path: Path, image: np.ndarray) -> None:
    """Write an image in the Berkeley version of the EMD format."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        file.attrs["version_major"], file.attrs["version_minor"] = 0, 2
        group = file.create_group("signals/image")
        group.attrs["emd_group_type"] = 1
        group["data"] = image
        for k, size in enumerate(image.shape, 1):
            group[f"dim{k}"] = np.arange(size, dtype=float)
            group[f"dim{k}"].attrs["name"] = "yx"[k - 1]
            group[f"dim{k}"].attrs["units"] = "nm"


MADE: dict[str, Callable[[Path], object]] = {
    "a.mrc": lambda path: path.write_bytes(mrc(IMAGE[None])),
    "a.ser": lambda path: path.write_bytes(ser(IMAGE)),
    "a.dm3": lambda path: path.write_bytes(dm3(IMAGE)),
    "a.hspy": lambda path: hspy(path, IMAGE),
    "a.emd": lambda path: emd(path, IMAGE),
}


@pytest.mark.parametrize("name", MADE)
def test_images_of_microscopes(tmp_path: Path, name: str):
    """Pixels are unchanged, rows start at the top, and the lattice is found."""
    pytest.importorskip("rsciio")
    path = tmp_path / name
    MADE[name](path)
    found = gt.LatticeImage.read(path, 0.05, "nm")
    assert np.array_equal(found.values, IMAGE)
    assert sorted(np.hypot(*found.phases().lattice.T).round(2)) == [0.3, 0.4]
    with pytest.raises(FileFormatError, match="page: expected a number below 1, .* got 1"):
        gt.LatticeImage.read(path, page=1)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(GeomtorsionError, match=r"truncated|complete"):
        gt.LatticeImage.read(path)


def test_pages_of_a_stack(tmp_path: Path):
    """Pages count the images of a stack."""
    pytest.importorskip("rsciio")
    path = tmp_path / "stack.mrc"
    path.write_bytes(mrc(np.stack([IMAGE, IMAGE[::-1]])))
    assert np.array_equal(gt.LatticeImage.read(path, page=1).values, IMAGE[::-1])


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.mrc", mrc(IMAGE[None], 2_000_000_000)),
        ("b.mrc", b"MRC"),
        ("a.ser", ser(IMAGE, 2_000_000_000)),
        ("b.ser", b"II"),
        ("a.dm3", dm3(IMAGE, 2_000_000_000)),
        ("b.dm3", b"\0\0\0\3"),
        ("a.dm4", b"not an image at all"),
        ("a.emd", b"nothing"),
        ("a.hspy", b""),
    ],
)
def test_misleading_headers_are_refused(tmp_path: Path, name: str, content: bytes):
    """Headers that declare too many pixels, and files of other kinds, raise our own errors."""
    pytest.importorskip("rsciio")
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(GeomtorsionError, match=name.replace(".", r"\.")):
        gt.LatticeImage.read(path)


@pytest.mark.parametrize("end", ENDS)
def test_without_the_library(tmp_path: Path, end: str, monkeypatch: pytest.MonkeyPatch):
    """The message names the package and its extra."""
    for name in ("rsciio", *(f"rsciio.{x}" for x in "digitalmicrograph mrc tia emd hspy".split())):
        monkeypatch.setitem(sys.modules, name, None)
    path = tmp_path / f"a{end}"
    path.write_bytes(b"x")
    with pytest.raises(MissingExtraError, match=r"requires rosettasciio.*geomtorsion\[files\]"):
        gt.LatticeImage.read(path)


def stepped(strain: float = 0.02, turn: float = 0.0, noise: float = 0.0) -> gt.LatticeImage:
    """A lattice whose right half is stretched along x and sheared."""
    y, x = np.mgrid[159:-1:-1, 0:320].astype(float)
    right = np.maximum(x - 160, 0)
    u = right * strain / (1 + strain)
    v = right * turn
    values = np.cos(2 * np.pi * (x - u) / 8) + np.cos(2 * np.pi * (y - v) / 8)
    values += noise * np.random.default_rng(0).normal(size=x.shape)
    return gt.LatticeImage(values, 0.05, "nm")


LEFT = ((1.0, 6.5), (1.0, 6.9))


@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_strain_from_a_region(noise: float):
    """A strain step of 2 % reads 0 and 0.0196 (per deformed length), not half on each side."""
    image = stepped(noise=noise)
    before, after = image.phases(), image.phases(reference=LEFT)
    left, right = (slice(30, 130), slice(30, 130)), (slice(190, 290), slice(30, 130))
    means = [[np.nanmean(p.strain[0, 0][part]) for part in (left, right)] for p in (before, after)]
    assert means[0][0] == pytest.approx(-0.01, abs=1.5e-3)
    assert means[1] == pytest.approx([0.0, 1 - 1 / 1.02], abs=2e-4 if not noise else 1e-3)
    assert np.hypot(*after.lattice.T) == pytest.approx([0.4, 0.4], rel=1e-3)
    assert np.nanmean(after.strain[1, 1][right]) == pytest.approx(0, abs=1e-3)


def test_shear_and_rotation_from_a_region():
    """Shear and rotation are relative to the region as well; a mask also selects a region."""
    image = stepped(0.0, 0.03)
    mask = np.zeros((320, 160), dtype=bool)
    mask[20:130, 20:138] = True
    one, other = image.phases(reference=LEFT), image.phases(reference=mask)
    part = (slice(190, 290), slice(30, 130))
    for phases in (one, other):
        assert np.nanmean(phases.distortion[1, 0][part]) == pytest.approx(0.03, abs=3e-4)
        assert np.nanmean(phases.rotation[part]) == pytest.approx(0.015, abs=3e-4)
    assert one.residues.any() == image.phases().residues.any()


@pytest.mark.parametrize(
    ("region", "words"),
    [
        (((-1, 3), (1, 3)), "within 0 to 15.95 and 7.95 nm"),
        (((1, 99), (1, 3)), "within 0 to"),
        (((3, 1), (1, 3)), "wider than the resolution"),
        (((1, 1.01), (1, 3)), "wider than the resolution"),
        ((1, 2), r"shape \(2, 2\)"),
        (np.ones((160, 320), dtype=bool), r"expected truth values of shape \(320, 160\)"),
        (np.zeros((320, 160), dtype=bool), "got only holes"),
    ],
)
def test_invalid_regions_are_refused(region, words: str):
    """A region outside the image, too narrow, of another shape or empty is refused."""
    with pytest.raises(ImageError, match=words):
        stepped().phases(reference=region)
