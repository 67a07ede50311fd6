"""Image files: TIFF and PNG files read back unchanged; damaged files raise our own errors."""

# The tests pass what users pass, including wrong types, and read optional values.
# pyright: reportAttributeAccessIssue=false

import builtins
import pickle
import struct
import sys
import types
import zlib

import numpy as np
import pytest

import geomtorsion as gt
from geomtorsion.errors import FileFormatError, ImageError, LimitError, MissingExtraError
from tests.materials.images.atoms import crystal

tifffile = pytest.importorskip("tifffile")
PIL = pytest.importorskip("PIL.Image")

GREY = (np.add.outer(7 * np.arange(40), np.arange(50)) % 251).astype(np.uint8)


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "int16", "float32", "float64"])
@pytest.mark.parametrize("suffix", [".tif", ".TIFF"])
def test_tiff_comes_back(tmp_path, dtype, suffix):
    """Checked for each bit depth that microscopes write."""
    path = tmp_path / f"image{suffix}"
    tifffile.imwrite(path, GREY.astype(dtype))
    assert (gt.LatticeImage.read(path).values == GREY).all()


def test_pages_of_a_tiff_are_chosen(tmp_path):
    """The default is the first page; a page beyond the last is refused."""
    path = tmp_path / "stack.tif"
    tifffile.imwrite(path, np.stack([GREY, GREY[::-1]]), photometric="minisblack")
    assert (gt.LatticeImage.read(path, page=1).values == GREY[::-1]).all()
    with pytest.raises(FileFormatError, match="page: expected a number below 2, .* got 2"):
        gt.LatticeImage.read(path, page=2)


@pytest.mark.parametrize("dtype", ["uint8", "uint16"])
def test_png_comes_back(tmp_path, dtype):
    """Checked for eight and sixteen bits."""
    path = tmp_path / "image.png"
    scale = 1 if dtype == "uint8" else 256
    PIL.fromarray((GREY.astype(int) * scale).astype(dtype)).save(path)
    assert (gt.LatticeImage.read(path, 0.1, "nm").values == GREY.astype(int) * scale).all()


def test_colours_become_grey(tmp_path):
    """Grey is the mean of three channels; opacity is ignored."""
    colours = np.stack([GREY, GREY, np.zeros_like(GREY), np.full_like(GREY, 9)], axis=2)
    PIL.fromarray(colours).save(tmp_path / "image.png")
    found = gt.LatticeImage.read(tmp_path / "image.png").values
    assert found == pytest.approx(2 / 3 * GREY)


def huge_png() -> bytes:
    """A PNG header that claims 100,000 by 100,000 pixels."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    size = struct.pack(">IIBBBBB", 100_000, 100_000, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", size) + chunk(b"IDAT", b"") + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("empty.tif", b""),
        ("text.png", b"not an image"),
        ("pickle.tif", pickle.dumps([1, 2])),
        ("array.tif", b"\x93NUMPY"),
        ("other.npy", b""),
        ("none", b""),
    ],
)
def test_files_that_are_not_images_are_refused(tmp_path, name, content):
    """A file with a wrong name or without image content is refused with its name."""
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match=name):
        gt.LatticeImage.read(path)


def test_a_file_that_claims_too_much_is_refused(tmp_path):
    """An image with a header of 100,000 by 100,000 pixels is refused."""
    path = tmp_path / "huge.png"
    path.write_bytes(huge_png())
    with pytest.raises((LimitError, FileFormatError), match="huge.png"):
        gt.LatticeImage.read(path)


@pytest.mark.parametrize("kind", ["tif", "png"])
def test_damaged_files_are_refused_or_read(tmp_path, kind):
    """Truncated or corrupted files raise only errors of this package."""
    whole = tmp_path / f"whole.{kind}"
    if kind == "tif":
        tifffile.imwrite(whole, GREY, compression="zlib")
    else:
        PIL.fromarray(GREY).save(whole)
    content = whole.read_bytes()
    rng = np.random.default_rng(0)
    refused = 0
    for k in range(60):
        damaged = bytearray(content)
        if k % 2:
            damaged = damaged[: rng.integers(len(content))]
        else:
            for place in rng.integers(len(content), size=8):
                damaged[place] = rng.integers(256)
        path = tmp_path / f"damaged.{kind}"
        path.write_bytes(damaged)
        try:
            gt.LatticeImage.read(path)
        except (FileFormatError, ImageError, LimitError):
            refused += 1
    assert refused > 30


def test_a_missing_file_and_a_missing_library_are_named(tmp_path, monkeypatch):
    """The error names the missing file, or the extra that installs the library."""
    with pytest.raises(FileFormatError, match="there is no such file"):
        gt.LatticeImage.read(tmp_path / "nothing.tif")
    path = tmp_path / "image.tif"
    tifffile.imwrite(path, GREY)
    monkeypatch.setitem(sys.modules, "tifffile", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'geomtorsion\[images\]'"):
        gt.LatticeImage.read(path)


@pytest.mark.parametrize("path", [3, None, b"image.tif"])
def test_anything_but_a_file_name_is_refused(path):
    """The error is our own and names the argument."""
    with pytest.raises(ImageError, match="path: expected the name of a file"):
        gt.LatticeImage.read(path)


class Axis(types.SimpleNamespace):
    """An axis of a signal."""


class Signal:
    """The part of a hyperspy signal that the package uses."""

    def __init__(self, data, *steps, navigation=0):
        self.data = data
        axes = tuple(Axis(scale=step, units="nm") for step in steps)
        self.axes_manager = Axis(signal_axes=axes, navigation_size=navigation)


def test_signals_bring_their_scale():
    """A signal keeps its scale; a signal that is not one image of square pixels is refused.

    `Signal` has the attributes of a hyperspy signal; a test below uses hyperspy itself.
    """
    image = gt.LatticeImage.of_signal(Signal(GREY, 0.05, 0.05))
    assert (image.step, image.unit, image.values.shape) == (0.05, "nm", GREY.shape)
    for signal, match in (
        (Signal(GREY, 0.05, 0.06), "expected square pixels"),
        (Signal(GREY, -0.05, 0.05), "axes that increase.*-0.05 and 0.05"),
        (Signal(GREY, 0.05, -0.05), "axes that increase"),
        (Signal(GREY, 0.05), "expected one image"),
        (Signal(GREY, 0.05, 0.05, navigation=3), "Choose one: signal.inav"),
    ):
        with pytest.raises(ImageError, match=match):
            gt.LatticeImage.of_signal(signal)


def test_signals_have_the_sign_of_a_known_dislocation():
    """b = - integral of du around an edge dislocation, known in closed form; lengths in nm."""
    image = crystal(256, "square")
    phases = gt.LatticeImage.of_signal(Signal(image.values, 0.05, 0.05)).phases()
    found = phases.burgers(gt.Loop.circle(0.05 * np.array(image.centre), 0.05 * 77))
    assert found.whole.tolist() == (-np.rint(phases.spots @ image.b * 0.05)).tolist() != [0, 0]
    assert np.abs(found.vector + 0.05 * image.b).max() < 0.02 * 0.05 * np.linalg.norm(image.b)


@pytest.mark.parametrize("given", [GREY, None, "signal", object(), Signal])
def test_anything_but_a_signal_is_refused(given):
    """Arrays, None, text, objects and a class instead of an instance are refused."""
    with pytest.raises(ImageError, match="expected a hyperspy signal"):
        gt.LatticeImage.of_signal(given)


def test_signals_with_odd_contents_are_refused():
    """Text instead of scales or pixels is refused."""
    with pytest.raises(ImageError, match="scale: expected a number"):
        gt.LatticeImage.of_signal(Signal(GREY, "x", "x"))
    with pytest.raises(ImageError, match="signal.data: expected an array of real numbers"):
        gt.LatticeImage.of_signal(Signal([["a"]], 1.0, 1.0))


def test_signals_of_hyperspy():
    """Real hyperspy signals keep their scale and unit, if hyperspy is installed."""
    signals = pytest.importorskip("hyperspy.signals")
    signal = signals.Signal2D(GREY.astype(float))
    assert gt.LatticeImage.of_signal(signal).unit == "px"
    for axis in signal.axes_manager.signal_axes:
        axis.scale, axis.units = 0.05, "nm"
    image = gt.LatticeImage.of_signal(signal)
    assert (image.step, image.unit) == (0.05, "nm")
    assert (image.values == GREY).all()
    with pytest.raises(ImageError, match="expected one image"):
        gt.LatticeImage.of_signal(signals.Signal2D(np.stack([GREY, GREY])))


@pytest.mark.parametrize("dtype", ["uint8", "int32", "float32", "float64"])
def test_arrays_come_back(tmp_path, dtype):
    """NPY files with one image or a stack are read."""
    np.save(tmp_path / "image.npy", GREY.astype(dtype))
    assert (gt.LatticeImage.read(tmp_path / "image.npy").values == GREY).all()
    np.save(tmp_path / "stack.npy", np.stack([GREY, GREY[::-1]]))
    assert (gt.LatticeImage.read(tmp_path / "stack.npy", page=1).values == GREY[::-1]).all()
    with pytest.raises(FileFormatError, match="page: expected a number below 2, .* got 2"):
        gt.LatticeImage.read(tmp_path / "stack.npy", page=2)


@pytest.mark.parametrize(
    "array", [np.array([{}]), np.array("text"), np.zeros(5), np.zeros((40, 40), complex)]
)
def test_arrays_that_are_not_images_are_refused(tmp_path, array):
    """Object arrays (which need unpickling), text, one row and complex numbers are refused."""
    np.save(tmp_path / "odd.npy", array)
    with pytest.raises(FileFormatError, match=r"odd\.npy"):
        gt.LatticeImage.read(tmp_path / "odd.npy")


def test_nothing_is_unpickled(tmp_path, monkeypatch):
    """The reader calls neither pickle nor eval."""
    path = tmp_path / "image.tif"
    tifffile.imwrite(path, GREY, description="__import__('os')")

    def never(*_):
        raise AssertionError("something was evaluated")

    for place, name in ((pickle, "loads"), (pickle, "load"), (builtins, "eval")):
        monkeypatch.setattr(place, name, never)
    assert (gt.LatticeImage.read(path).values == GREY).all()


def test_complex_colours_are_refused(tmp_path):
    """Complex colours are refused, so that no imaginary part is dropped silently."""
    path = tmp_path / "a.npy"
    np.save(path, np.ones((40, 40, 3)) * (1 + 1j))
    with pytest.raises(FileFormatError, match="expected grey values of shape .* got complex128"):
        gt.LatticeImage.read(path)


def test_colours_of_a_palette_become_grey(tmp_path):
    """The reader looks up grey values in the palette of a TIFF file, whose order is arbitrary."""
    order = np.random.default_rng(0).permutation(256)
    palette = np.repeat(order.astype(np.uint16)[None], 3, axis=0)
    path = tmp_path / "palette.tif"
    tifffile.imwrite(path, np.argsort(order)[GREY].astype(np.uint8),
                     photometric="palette", colormap=palette)  # fmt: skip
    assert (gt.LatticeImage.read(path).values == GREY).all()


@pytest.mark.parametrize("orientation", [1, 2, 6])
def test_images_that_are_to_be_mirrored_or_turned_are_refused(tmp_path, orientation):
    """Viewers treat orientation tags differently, and a mirror changes the sign of b."""
    said = PIL.Exif()
    said[274] = orientation
    PIL.fromarray(GREY).save(tmp_path / "a.png", exif=said)
    tifffile.imwrite(tmp_path / "a.tif", GREY, extratags=[(274, "H", 1, orientation, True)])
    for name in ("a.png", "a.tif"):
        if orientation == 1:
            assert (gt.LatticeImage.read(tmp_path / name).values == GREY).all()
        else:
            with pytest.raises(
                FileFormatError, match=f"{name}.*expected orientation 1, got {orientation}"
            ):
                gt.LatticeImage.read(tmp_path / name)
