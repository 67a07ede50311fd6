"""Broken scene files: any damage to a file gives an error of ours that names the file."""

import random

import pytest

from geomtorsion.errors import GeomtorsionError
from geomtorsion.scenes.scene_files import scene_from
from geomtorsion.scenes.shipped import names, path_of
from geomtorsion.support.files import read_toml_text

PIECES = (
    '"', "[", "]", "{", "=", "#", "1", "-1", "1e400", "nan", "true", '"x"', '"1/0"', "[]", "{}",
    '"3 m"', "\"__import__('os')\"", "1979-05-27", "[start]", "[[effects]]", "[body]", '"2**2**99"',
    '"' + "(" * 300 + '"', "é", "\x00", "'''", '"""', "a.b=1", "[1,2,3]", "1" * 400, '"t"',
)  # fmt: skip


def broken(chance: random.Random) -> str:
    """A shipped scene file with one to three lines changed, cut or mixed up."""
    texts = [path_of(name).read_text("utf-8") for name in names()]
    lines = chance.choice(texts).split("\n")
    for _ in range(chance.randint(1, 3)):
        k, place = chance.randrange(len(lines)), chance.random()
        cut = chance.randrange(len(lines[k]) + 1)
        piece = chance.choice(PIECES)
        if place < 0.4 and "=" in lines[k]:
            lines[k] = f"{lines[k].split('=')[0]}= {piece}"
        elif place < 0.6:
            lines[k] = lines[k][:cut] + piece + lines[k][cut:]
        elif place < 0.8:
            lines[k] = lines[k][:cut] + lines[k][cut + 1 :]
        else:
            lines[k] = chance.choice(chance.choice(texts).split("\n"))
    return "\n".join(lines)


@pytest.mark.parametrize("seed", range(4))
def test_broken_files_end_in_errors_of_ours(seed):
    """Most broken files are refused and some are still scenes; there is no other error."""
    chance = random.Random(seed)
    refused: list[str] = []
    for _ in range(150):
        text = broken(chance)
        try:
            scene_from(read_toml_text(text, "broken.toml"))
        except GeomtorsionError as error:
            refused.append(str(error))
    assert len(refused) > 50
    assert all(message.startswith("broken.toml: ") for message in refused)
