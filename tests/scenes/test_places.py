"""Places: every key of a TOML file is found on its line."""

import tomllib

import pytest

from geomtorsion.errors import FileFormatError
from geomtorsion.scenes.places import read_toml, read_toml_text

TEXT = '''# a comment with = and [brackets]
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
    """Comments, texts and lists over several lines do not mislead."""
    assert read_toml_text(TEXT, "a.toml").line(key) == LINES[key]


def test_every_key_has_a_line():
    """All that tomllib finds is found."""
    file = read_toml_text(TEXT, "a.toml")
    assert file.data == tomllib.loads(TEXT)

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


def test_bad_files(tmp_path):
    """What cannot be read is refused with file and line."""
    with pytest.raises(FileFormatError, match=r"top.toml: line 2, column 5: this is no TOML"):
        read_toml_text("a = 1\ng = 9.81 m/s^2\n".replace("g = 9", "g = m9"), "top.toml")
    with pytest.raises(FileFormatError, match="cannot be read"):
        read_toml(tmp_path / "none.toml")
    file = tmp_path / "latin.toml"
    file.write_bytes(b'name = "\xe9"')
    with pytest.raises(FileFormatError, match="no UTF-8"):
        read_toml(file)
    with pytest.raises(FileFormatError, match=r"a.toml: line 20: wrong"):
        read_toml_text(TEXT, "a.toml").fail(("effects", 0, "g"), "wrong")
    with pytest.raises(FileFormatError, match="Did you mean mass"):
        read_toml_text(TEXT, "a.toml").unknown(("body", "maas"), ["mass", "moments"], "unknown")
