"""Composed sentences: all of their words are texts of the language, none is of the library."""

from __future__ import annotations

import html
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
import pytest

from geomtorsion import SampledFrame
from geomtorsion.spaces import load
from geomtorsion.teaching.lab.closure_failure import closure_failure
from geomtorsion.teaching.lab.costs import costs
from geomtorsion.teaching.lab.export import TETRADS, tetrads
from geomtorsion.teaching.lab.map_circuits import map_circuit, map_facts
from geomtorsion.teaching.lab.space_info import space_info
from geomtorsion.teaching.lab.tetrad import OFFERED, tetrad
from geomtorsion.teaching.lab.top import top
from geomtorsion.teaching.texts import FOLDER, placeholders, texts
from tests.teaching.lab.maps import atoms, saved, twisted, wall_ctf


def wordless(entry: Any) -> Any:
    """Texts with their placeholders and without their words."""
    if isinstance(entry, dict):
        return {key: wordless(value) for key, value in entry.items()}
    if isinstance(entry, list):
        return [wordless(value) for value in entry]
    # Texts stay different where they were, as names of methods have to.
    mark = str(crc32(entry.encode()))
    return " ".join([mark, *(f"@{{{name}}}" for name in sorted(placeholders(entry)))])


def lines(table: dict[str, Any], path: tuple[str, ...] = ()) -> Iterator[str]:
    """A table as TOML, a dotted key a line."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from lines(value, (*path, key))
        else:
            name = ".".join(f'"{part}"' for part in (*path, key))
            yield f"{name} = {value!r}"


@pytest.fixture(scope="module")
def blank(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A language that has no words: whatever words a sentence has are not from its texts."""
    folder = tmp_path_factory.mktemp("blank")
    for name in ("figures", "lab"):
        english = tomllib.loads((FOLDER / "en" / f"{name}.toml").read_text("utf-8"))
        (folder / f"{name}.toml").write_text("\n".join(lines(wordless(english))), "utf-8")
    return str(folder)


def words(reply: Any) -> set[str]:
    """Words of three letters or more in a text, without tags."""
    return set(re.findall(r"[^\W\d_]{3,}", html.unescape(re.sub(r"<[^>]*>", " ", str(reply)))))


def test_a_blank_language_has_no_words(blank: str):
    """The test finds a word that is not from a text, and no word of a text."""
    [entry] = wordless({"a": ["all of @{here}"]})["a"]
    assert words(entry.replace("@{here}", "")) == set()
    assert words("<td>x &lt; 1 all</td>") == {"all"}


@pytest.mark.parametrize(
    ("name", "centre", "names"),
    [("heisenberg", [0, 0, 0], set()), ("screw_dislocation", None, set()),
     ("so3_axis_angle", [0.1, 0.1, 0.3], {"chi"}), ("so3", [1, 1, 1], set())],
)  # fmt: skip
def test_sentences_below_a_loop(blank: str, name: str, centre: list[float] | None, names: set[str]):
    """A loop of constant torsion, around a line, beyond its coordinates, and of none of these."""
    reply = closure_failure(name, centre or space_info(name)["loop_centre"], 0.5, [0, 1], blank)
    assert words(reply["sentence"]) | words(reply["table"]) <= names


def test_german_sentences_below_a_loop():
    """The comparison of two computations and an enclosed line in German."""
    regular, line = (
        closure_failure(name, [0.1, 0.1, 0.3], 0.5, [0, 1], "de")["sentence"]
        for name in ("heisenberg", "screw_dislocation")
    )
    assert "Zwei Rechnungen, entlang der Schleife und über den Fluss der Torsion" in regular
    assert "umschließt eine Linie (x = 0, y = 0, einmal)" in line


@pytest.mark.parametrize(
    ("kind", "case"),
    [("loop", {"space": "so3", "centre": [0.3, 1, 0.2], "radius": 0.1, "plane": [0, 1]}),
     ("shortest", {"space": "s2", "velocity": [0.4, 0.3], "t": 2.0}),
     ("top", {"moments": [1, 2, 3], "omega": [0.1, 2, 0.1], "tilt": 0.3, "t": 3.0})],
)  # fmt: skip
def test_advice_about_costs(blank: str, kind: str, case: dict[str, Any]):
    """Advice, truth and methods; names of engines are the same in every language."""
    reply = costs(kind, case, blank)
    found = words(reply["advice"]) | words(reply["table"]) | words(reply["truth"])
    assert found <= {"Taylor", "RungeKutta"}
    german = costs(kind, case, "de")
    assert german["advice"].startswith("Nimm ")
    assert " dieser Zeit. " in german["advice"]
    assert german["truth"].startswith(("ein", "die "))


def test_sentences_below_a_map(blank: str, tmp_path: Path):
    """Frames with and without noise, holes and a third axis; grains; a lattice image."""
    axes = [np.arange(8.0), np.arange(9.0), np.arange(7.0)]
    x, y, z = np.meshgrid(*axes, indexing="ij")
    volume = SampledFrame(axes, np.array([[-y * z, x * z, 0 * z]]) / 2)
    noisy = SampledFrame([axes[0], axes[1]], np.array([[-y[..., 0], x[..., 0]]]) / 2, sigma=0.1)
    for content in (
        *(saved(frame, tmp_path, ".npz") for frame in (twisted(hole=True), volume, noisy)),
        wall_ctf(), atoms(".npy"),
    ):  # fmt: skip
        facts = map_facts(content, "a", language=blank)
        reply = map_circuit(content, "a", facts["middle"], facts["least"], language=blank)
        drawn = re.findall(r">([^<>]*)</text>", reply["picture"])
        found = words(facts["sentence"]) | words(drawn)
        assert found | words(reply.get("sentence")) | words(reply.get("table")) <= {
            "Nickel", "None",
        }  # fmt: skip


def test_german_sentences_below_a_map():
    """A map of one grain and of two, and the circuit across the wall."""
    content = wall_ctf()
    one, two = (map_facts(content, "a.ctf", x, language="de")["sentence"] for x in (5.0, 1.0))
    assert (
        one == "a.ctf ist eine Orientierungskarte mit 20 × 24 Pixeln (Nickel: m-3m), 1 Korn bei 5°."
    )
    assert "2 Körner bei 1°" in two
    said = map_circuit(content, "a.ctf", [12, 10], 6, language="de")["sentence"]
    assert said.startswith("Umlauf von 6 × 6 Zellen: |b| = ")
    assert "Korn 0, Nickel." in said


def test_notes_below_the_components_of_a_tetrad(blank: str):
    """A component that follows by symmetry, in German and without words."""
    every: dict[str, Any] = {"show": OFFERED}
    case: dict[str, Any] = {
        "coordinates": "r, phi",
        "entries": [["1", "0"], ["0", "r"]],
        "show": ["torsion"],
    }
    assert "1 weitere Komponente folgt aus der Symmetrie." in tetrad(**case, language="de")["html"]
    assert not words(tetrad(**case | every, language=blank)["html"])


def test_the_plan_of_a_top(blank: str):
    """Causes, effects and groups of states of each switch and quantity, also in German."""
    case: dict[str, Any] = {"moments": [1, 2, 3], "omega": [0.1, 2, 0.1], "tilt": 0.3, "t": 1.0}
    for effects in ((), ("gravity",), ("gravity", "pivot"), ("torsion", "magnet", "rotor")):
        for watched in ("nutation", "energy", "position"):
            reply = top(**case, effects=effects, watch=[watched], language=blank)
            assert words(reply["plan"]) | words(reply["table"]) <= {"Taylor"}
    german = top(**case, effects=["gravity", "pivot"], watch=["omega"], language="de")["plan"]
    assert "n1..n3: nötig für Drehung (wegen: Schwerkraft, fester Punkt)" in german
    free = top(**case, language="de")
    assert "weder für die gewählte Größe noch für einen Effekt nötig" in free["plan"]
    assert "freier Kreisel (Jacobische elliptische Funktionen)" in free["table"]


def test_stories_on_pages_without_a_server():
    """Each tetrad of the pages has its story in the language, the English one as in the library."""
    stories = texts("spaces", "stories").table()
    assert {name: " ".join(load(name).story.split()) for name in TETRADS} == stories
    german = tetrads("de")
    for story in texts("spaces", "stories", "de").table().values():
        assert story in html.unescape(german)
