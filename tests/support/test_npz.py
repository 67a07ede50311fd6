"""NPZ: arrays read as they were written; a damaged file raises one kind of error."""

import json
import random
import zipfile

import numpy as np
import pytest

from geomtorsion.errors import CheckpointError, FileFormatError
from geomtorsion.support.npz import TEXT_FORM, ArrayForm, json_in, read_npz, text_of

FORMS = {
    "times": ArrayForm(("m",), "f"),
    "states": ArrayForm(("m", "n"), "fiu"),
    "about": TEXT_FORM,
    "value *": ArrayForm(("m",), "fiu"),
    "more": ArrayForm(optional=True),
}


@pytest.fixture
def saved(tmp_path):
    """A file with an array of each kind."""
    path = tmp_path / "run.npz"
    arrays = {"value a": np.arange(3), "value b": np.ones(3)}
    states = np.asfortranarray(np.arange(6.0).reshape(3, 2))
    np.savez_compressed(path, times=np.zeros(3), states=states, about=np.array("{}"), **arrays)
    return path


def test_arrays_come_back(saved):
    """Values, shapes, types and text read as they were written."""
    found = read_npz(saved, FORMS)
    assert set(found) == {"times", "states", "about", "value a", "value b"}
    assert found["states"].tolist() == [[0, 1], [2, 3], [4, 5]]
    assert found["value a"].dtype == np.arange(3).dtype
    assert text_of(found["about"]) == "{}"
    found["times"][0] = 1  # the arrays are writable


def test_zeros_pack_a_thousandfold(tmp_path):
    """The densest packing of zlib is read: a million zeros take less than nine kilobytes."""
    file = tmp_path / "a.npz"
    np.savez_compressed(file, x=np.zeros(10**6))
    assert file.stat().st_size < 9000
    assert not read_npz(file, {"x": ArrayForm(("m",), "f")})["x"].any()


@pytest.mark.parametrize("dtype", [">f8", "<f4", ">i2", "<u8", "|b1", "<U5"])
def test_byte_orders(tmp_path, dtype):
    """Numbers of either byte order and any size are read in the native byte order."""
    values = np.array([1, 0, 1]).astype(dtype)
    np.savez(tmp_path / "a.npz", x=values)
    found = read_npz(tmp_path / "a.npz", {"x": ArrayForm((3,), "fiubU")})["x"]
    assert (found == values).all()
    assert found.dtype.isnative


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({}, "times is not a file in the archive"),
        ({"times": np.zeros((2, 2))}, r"times: expected shape \(any\), got \(2, 2\)|times"),
        ({"times": np.array(["a"])}, "times holds <U1"),
        ({"times": np.array([{}], dtype=object)}, "times has a header|times holds"),
        ({"times": np.zeros(3), "states": np.zeros((4, 2))}, r"states: expected shape \(3, "),
        ({"times": np.zeros(3, dtype=[("a", "f8")])}, "times holds .*which does not fit"),
    ],
)
def test_wrong_arrays(tmp_path, arrays, words):
    """A missing array or a wrong shape or type is refused; the message names the array."""
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(FileFormatError, match=f"a.npz: .*({words})"):
        read_npz(tmp_path / "a.npz", FORMS)
    message = "no {path}: {reason}"
    with pytest.raises(CheckpointError, match=r"^no .*a.npz: "):
        read_npz(tmp_path / "a.npz", FORMS, error=CheckpointError, message=message)


def declared(path, count, content):
    """Write an array whose header declares a count of numbers."""
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({count},), }}".encode()
    begin = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("times.npy", begin + header + content)


def test_declared_sizes_take_no_memory(tmp_path):
    """A header that declares a terabyte is refused before memory is allocated."""
    for count in (10**11, 10**8):
        declared(tmp_path / "a.npz", count, bytes(80))
        with pytest.raises(FileFormatError, match=f"would take {8 * count:,} bytes"):
            read_npz(tmp_path / "a.npz", {"times": ArrayForm()})
    declared(tmp_path / "a.npz", 9, bytes(80))
    with pytest.raises(FileFormatError, match="times holds more numbers than"):
        read_npz(tmp_path / "a.npz", {"times": ArrayForm()})
    np.savez(tmp_path / "b.npz", times=np.zeros(1000))
    with pytest.raises(FileFormatError, match="would take 8,000 bytes"):
        read_npz(tmp_path / "b.npz", {"times": ArrayForm()}, largest=7999)
    assert len(read_npz(tmp_path / "b.npz", {"times": ArrayForm()}, largest=8000)["times"]) == 1000


def test_a_text_takes_no_gigabyte(tmp_path):
    """A text longer than the limit of texts is refused by its header."""
    file = tmp_path / "a.npz"
    np.savez_compressed(file, about=np.array("x" * 10_000_001))
    with pytest.raises(FileFormatError, match="about would take 40,000,004 bytes"):
        read_npz(file, {"about": TEXT_FORM})


def test_any_further_axes(tmp_path):
    """Dots in a form allow any further axes; the axes before the dots are compared."""
    forms = {"times": ArrayForm(("m",)), "value *": ArrayForm(("m", ...))}
    np.savez(tmp_path / "a.npz", **{"times": np.zeros(3), "value a": np.zeros((3, 2, 5))})
    assert read_npz(tmp_path / "a.npz", forms)["value a"].shape == (3, 2, 5)
    for wrong in (np.zeros((2, 3)), np.zeros(())):
        np.savez(tmp_path / "b.npz", **{"times": np.zeros(3), "value a": wrong})
        with pytest.raises(FileFormatError, match=r"value a: expected shape \(3, \.\.\.\), got"):
            read_npz(tmp_path / "b.npz", forms)


def test_json_inside_an_array():
    """An error in JSON within an array has the class and the message of its file."""
    known = {"path": "a.npz", "error": CheckpointError, "message": "no {path}: {reason}!"}
    form = {"steps": range(10), "how": frozenset({"a", "b"})}
    good = {"steps": 3, "how": "a"}
    assert json_in({"about": np.array(json.dumps(good))}, "about", form, **known) == good
    for text, words in [
        ("{", "about: line 1, column 2: expected JSON, got an error: .*"),
        ("[" * 10**5, "about: lists are nested too deeply to be read"),
        ('{"steps": 10}', "about: steps: expected a whole number from 0 to 9, got 10"),
        ('{"steps": true}', "about: steps: expected a whole number from 0 to 9, got True"),
        ('{"steps": 1, "how": "c"}', "about: how: expected one of a, b, got 'c'"),
        ('{"steps": 1, "how": ["a"]}', "about: how: expected one of a, b, got .*"),
    ]:
        with pytest.raises(CheckpointError, match=f"^no a.npz: {words}[!?]"):
            json_in({"about": np.array(text)}, "about", form, **known)


def test_damaged_files(saved, tmp_path):
    """A file with bytes changed, removed or doubled at random is read or refused with one error."""
    whole = saved.read_bytes()
    draw = random.Random(5)
    path = tmp_path / "damaged.npz"
    refused = 0
    for _ in range(400):
        data = bytearray(whole)
        for _ in range(draw.choice((1, 1, 3))):
            place = draw.randrange(len(data))
            kind = draw.randrange(3)
            if kind == 0:
                data[place] = draw.randrange(256)
            elif kind == 1:
                del data[place : place + draw.randrange(1, 30)]
            else:
                data[place:place] = data[: draw.randrange(1, 30)]
        path.write_bytes(data)
        try:
            read_npz(path, FORMS)
        except FileFormatError as error:
            refused += "damaged.npz" in str(error)
    assert refused > 200
