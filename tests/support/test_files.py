"""Files: a file reads as it was written; a damaged file raises one kind of error."""

import tomllib

import pytest

from geomtorsion.errors import CheckpointError, FileFormatError, GeomtorsionError, LimitError
from geomtorsion.support.files import (
    Decimal,
    conforming,
    read_json_text,
    read_text,
    read_toml,
    read_toml_text,
)
from geomtorsion.support.npz import ArrayForm, read_npz

FORMS = {"times": ArrayForm(("m",), "f")}


def test_no_files(tmp_path):
    """Missing files, folders, invalid names, invalid UTF-8 and too long texts are refused."""
    for path in (tmp_path / "none.npz", tmp_path, "a\0b"):
        with pytest.raises(FileFormatError):
            read_npz(path, FORMS)
        with pytest.raises(FileFormatError):
            read_text(path)
    (tmp_path / "a.txt").write_bytes(b"abc\xff")
    with pytest.raises(FileFormatError, match="expected UTF-8"):
        read_text(tmp_path / "a.txt")
    (tmp_path / "a.txt").write_bytes("\ufeffabc".encode())
    assert read_text(tmp_path / "a.txt") == "abc"
    with pytest.raises(LimitError, match="longer than the limit of 5 bytes"):
        read_text(tmp_path / "a.txt", 5)


def test_the_longest_text(tmp_path):
    """A text of ten million bytes is read, one byte more is refused."""
    path = tmp_path / "long.txt"
    path.write_bytes(b"x" * 10_000_000)
    assert len(read_text(path)) == 10_000_000
    with path.open("ab") as file:
        file.write(b"x")
    with pytest.raises(LimitError, match="longer than the limit of 10,000,000 bytes"):
        read_text(path)


def test_toml(tmp_path):
    """TOML gives values, their lines, and decimals as they were written."""
    file = tmp_path / "a.toml"
    file.write_text("a = 0.10\n[b]\nc = [1,\n2]\n")
    found = read_toml(file, decimals=True)
    assert found.data == {"a": "0.10", "b": {"c": [1, 2]}}
    assert isinstance(found.data["a"], Decimal)
    assert read_toml(file).data["a"] == 0.1
    assert found.line(("b", "c", 1)) == 3
    with pytest.raises(FileFormatError, match="a.toml: line 3: wrong"):
        found.fail(("b", "c"), "wrong")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "a = 1\nb = x\n",
            r"line 2, column 5: expected TOML, got an error: .*\n    b = x\n        \^\nAdvice.",
        ),
        ("a = " + "[" * 5000, "nested too deeply|expected TOML"),
        ("a = 1" + "0" * 5000, "more digits"),
        ("a = 0x1" + "0" * 5000, "more digits"),
        ("a = 1979-13-45", "expected TOML"),
        ("# " + "x" * 10**5 + "\n" + "a = " + "1, " * 10**5, "expected TOML"),
    ],
)
def test_bad_toml(text, words):
    """Invalid TOML is refused with a short message, which ends in advice where that may help."""
    with pytest.raises(GeomtorsionError, match=f"(?s)^a.toml: .*({words})") as caught:
        read_toml_text(text, "a.toml", advice="Advice.")
    assert len(str(caught.value)) < 900


SCENE = '''# a comment with = and [brackets]
name = "top # no comment"
story = """
[body]
mass = 7
"""
watch = [
  "nutation",  # ] "
  "energy",
]

[body]
mass = 1.0
inertia = [
  [1, 0, 0],
]

[[effects]]
kind = "gravity"
g = 9.81

[[effects]]  # the second
kind = 'drag'
"c o" = 1
area.side = 2

[effects.inner]
depth = 3

[start]
omega = [0, 0, 1]
'''

LINES = {
    ("name",): 2,
    ("story",): 3,
    ("watch",): 7,
    ("watch", 1): 7,
    ("body",): 12,
    ("body", "mass"): 13,
    ("body", "inertia"): 14,
    ("effects",): 18,
    ("effects", 0): 18,
    ("effects", 0, "g"): 20,
    ("effects", 1): 22,
    ("effects", 1, "c o"): 24,
    ("effects", 1, "area", "side"): 25,
    ("effects", 1, "inner", "depth"): 28,
    ("effects", 1, "missing"): 22,
    ("start", "omega", 2): 31,
    ("t",): 0,
}


@pytest.mark.parametrize("key", LINES, ids=str)
def test_lines(key):
    """Comments, texts and lists over several lines do not change the line of a key."""
    assert read_toml_text(SCENE, "a.toml").line(key) == LINES[key]


def test_every_key_has_a_line():
    """Each key that tomllib finds has a line."""
    file = read_toml_text(SCENE, "a.toml")
    assert file.data == tomllib.loads(SCENE)

    def leaves(value, path):
        if isinstance(value, dict):
            for key, inside in value.items():
                yield from leaves(inside, (*path, key))
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for number, inside in enumerate(value):
                yield from leaves(inside, (*path, number))
        else:
            yield path

    found = list(leaves(file.data, ()))
    assert len(found) == 12
    assert all(path in file.lines for path in found)


def test_json():
    """JSON gives lists and numbers; nan, endless nesting and endless numbers are refused."""
    assert read_json_text("[1, {}]", "a.json") == [1, {}]
    for text, words in [
        ("[1, ", "line 1, column 5: expected JSON, got an error"),
        ("[NaN]", "NaN is not a number in JSON"),
        ("[" * 10**5, "nested too deeply|expected JSON"),
        ("1" * 5000, "more digits"),
    ]:
        with pytest.raises(GeomtorsionError, match=f"a.json: .*({words})"):
            read_json_text(text, "a.json")


def test_forms():
    """Data has the required form, or the message names the first part that has not."""
    form = {"a": float, "b": [int], "c": {str: (str, None)}, "d?": bool}
    good = {"a": 1, "b": [1, 2], "c": {"x": "y", "z": None}, "extra": 3}
    assert conforming(good, form, "f") is good
    for change, words in [
        ({"a": "1"}, "f: a: expected a finite number, got '1'"),
        ({"a": float("nan")}, "f: a: expected a finite number"),
        ({"a": True}, "f: a: expected a finite number"),
        ({"b": 3}, "f: b: expected a list"),
        ({"b": [1, 2.5]}, r"f: b\[1\]: expected a whole number"),
        ({"b": [True]}, r"f: b\[0\]: expected a whole number"),
        ({"c": []}, "f: c: expected a table"),
        ({"c": {"x": 1}}, "f: c.x: expected text"),
        ({"d": 1}, "f: d: expected true or false"),
    ]:
        with pytest.raises(FileFormatError, match=words):
            conforming(good | change, form, "f")
    with pytest.raises(CheckpointError, match="f: a is missing"):
        conforming({"b": [], "c": {}}, form, "f", CheckpointError)
    with pytest.raises(FileFormatError, match="f: expected a table"):
        conforming([], form, "f")
