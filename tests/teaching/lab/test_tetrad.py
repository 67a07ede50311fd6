"""Typed tetrads: shown quantities equal the library's, and errors are at their entries."""

from __future__ import annotations

import re
from html import unescape

import pytest

from geomtorsion import spaces
from geomtorsion.errors import SignatureError
from geomtorsion.pictures.quantities import chosen_quantities
from geomtorsion.pictures.sections import section
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.space_info import drawable, space_info
from geomtorsion.teaching.lab.tetrad import OFFERED, signs_of, tetrad
from tests.chosen import one_in

POLAR = {"coordinates": "r, phi", "entries": [["1", "0"], ["0", "r"]]}


def test_a_shipped_tetrad_typed_again_gives_the_same_cards():
    """The coframe of so3, typed as text, gives the mathematics of the shipped space."""
    known = space_info("so3")
    found = tetrad(", ".join(known["coordinates"]), known["coframe"], signature=known["signature"])
    shipped = spaces.load("so3")
    for name in ("metric", "torsion", "cartan_connection", "ricci", "cartan_curvature"):
        [chosen] = chosen_quantities(shipped, [name])
        assert section(chosen).removesuffix("</section>") in found["html"]


@pytest.mark.parametrize("name", one_in(3, list(drawable().values())))
def test_every_offered_space_can_be_typed(name):
    """The facts about a space are enough to type its tetrad."""
    known = space_info(name)
    found = tetrad(
        ", ".join(known["coordinates"]),
        known["coframe"],
        ", ".join(known["parameters"]),
        known["signature"],
        ["metric", "torsion"],
    )
    assert found["errors"] == {}
    assert "problem" not in found
    assert 'id="torsion"' in found["html"]


def test_only_requested_quantities_are_shown():
    """Only the requested quantity is shown."""
    found = tetrad(**POLAR, show=["torsion"])
    assert found["html"].count('<section class="card"') == 1
    assert set(OFFERED) > {"torsion", "riemann"}


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("rr", "rr is neither a coordinate nor a declared parameter"),
        ("sin(r", "never closed"),
        ("0.5*r", "Write 1/2"),
        ("__import__('os')", "expressions are not code"),
        ("r.real", "a dot is allowed only between"),
        ("sign(r)", "sign is not smooth"),
        ("r**99", "the limit is 32"),
        ("+".join(["r"] * 400), "at most 600 characters"),
        ("(" * 40 + "r" + ")" * 40, "the limit is 20"),
    ],
)
def test_a_message_belongs_to_its_entry(entry, message):
    """The message belongs to the wrong entry, and to no other."""
    found = tetrad("r, phi", [["1", "0"], ["0", entry]])
    assert list(found["errors"]) == ["1,1"]
    assert message in found["errors"]["1,1"]
    assert found["html"] == ""


def test_several_faults_at_once():
    """All wrong entries are reported."""
    found = tetrad("r, phi", [["oops", "0"], ["0", "rr"]])
    assert list(found["errors"]) == ["0,0", "1,1"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"entries": [["1", "0"], ["1", "0"]]}, "singular"),
        ({"coordinates": "r"}, "coordinates"),
        ({"coordinates": "r, 2x"}, "expected names, got '2x'"),
        ({"coordinates": ""}, "at least one name"),
        ({"parameters": "r"}, "got r twice"),
        ({"signature": "-++"}, "2 signs"),
        ({"coordinates": "a b c d e f g"}, f"at most {PAGE.dimensions}, got 7"),
    ],
)
def test_faults_of_the_whole_tetrad_are_reported(changes, message):
    """A fault that belongs to no single entry is reported as a problem."""
    found = tetrad(**(POLAR | changes))
    assert message in found["problem"]
    assert found["html"] == ""


def test_unknown_functions():
    """Quantities of a space with a(t) equal the library's."""
    known = space_info("frw")
    found = tetrad(
        ", ".join(known["coordinates"]),
        known["coframe"],
        ", ".join(known["parameters"]),
        known["signature"],
        ["torsion", "scalar_curvature"],
        ", ".join(known["functions"]),
    )
    assert known["functions"] == ["a(t)"]
    for chosen in chosen_quantities(spaces.load("frw"), ["torsion", "scalar_curvature"]):
        assert section(chosen).removesuffix("</section>") in found["html"]


@pytest.mark.parametrize(
    ("functions", "message"),
    [
        ("a", "functions with arguments, got"),
        ("a(", "functions with arguments, got"),
        ("a()", "as arguments of a, got none"),
        ("a(x)", "as arguments of a, got x"),
        ("a(r), a(phi)", "got a twice"),
        ("r(phi)", "got r twice"),
        ("a(r) + 1", "functions with arguments, got '\\+1'"),
    ],
)
def test_odd_functions_are_refused(functions, message):
    """A text that is not an unknown function is refused with a remedy."""
    assert re.search(message, tetrad(**POLAR, functions=functions)["problem"])


@pytest.mark.parametrize(
    "entry", ["r", "2r/2", "r √(R²)/R", "½ 2r", "r sin²φ + r cos^2 phi", r"\frac{r^2}{r}", "R r/R"]
)
def test_entries_as_on_paper(entry):
    """Products without a sign, functions without brackets, other signs, and LaTeX are read."""
    assert tetrad("r, phi", [["1", "0"], ["0", entry]], "R") == tetrad(**POLAR, parameters="R")


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("sin r phi", "Write sin(r)*phi or sin(r*phi)."),
        ("1/2r", "can be read in two ways"),
        ("sqrt(-1)", "give real entries"),
        ("2 rr", "rr is neither a coordinate nor a declared parameter"),
        ("r' phi", "r' is neither a coordinate nor a declared parameter"),
        ("|r - 2", "'|' is not part of an expression"),
    ],
)
def test_messages_quote_unreadable_entries(entry, message):
    """The message quotes the typed text; an ambiguous text gets both readings."""
    found = tetrad("r, phi", [["1", "0"], ["0", entry]])
    assert message in found["errors"]["1,1"]
    assert "complex=True" not in found["errors"]["1,1"]


@pytest.mark.parametrize(
    ("typed", "plain"),
    [("sin f", "sin(f(r))"), ("2f(r) r", "2*f(r)*r"), ("f r", "f(r)*r"), ("2_000 r", "2000*r"),
     ("2 diff(f(r), r) r", "2*diff(f(r), r)*r")],
)  # fmt: skip
def test_unknown_functions_as_on_paper(typed, plain):
    """A declared function may be typed without its arguments, and in products without a sign."""
    one, two = (
        tetrad("r, phi", [["1", "0"], ["0", entry]], functions="f(r)") for entry in (typed, plain)
    )
    assert one == two
    assert not one.get("errors")


@pytest.mark.parametrize(
    "text", ["-+", "− +", "-1, 1", "[-1, 1]", "(-,+)", "-1 1", "－＋", "-1 +1"]
)
def test_signs_as_people_write_them(text):
    """Signs are read in the notation of tetrad files and books, with other minus signs also."""
    assert signs_of(text, 2) == (-1, 1)


@pytest.mark.parametrize("text", ["1", "-", "+-+", "-1, 1, 1", "x", "0 1", "11 -1", "±+", "-2 1"])
def test_invalid_signs_are_refused(text):
    """Too few signs, too many signs, or other text are refused."""
    with pytest.raises(SignatureError, match="2 signs"):
        signs_of(text, 2)


def test_rows_are_counted_from_one():
    """A message calls the first row row 1, as the page does."""
    found = tetrad("r, phi", [["1", "r"], ["2", "2*r"]])
    assert "Row 2 equals (2) * row 1." in found["problem"]
    assert "from 0" not in found["problem"]


def test_frame_indices_are_counted_from_one():
    """Frame indices with a hat are counted from 1, as in the paper."""
    shown = tetrad(**POLAR, show=["anholonomy"])["html"]
    assert set(re.findall(r"<mn>(\d)</mn><mo[^>]*>ˆ", shown)) == {"1", "2"}


def test_each_card_has_its_latex():
    """The button copies the nonzero components, one line each."""
    shown = tetrad(**POLAR, show=["torsion"])["html"]
    [latex] = re.findall(r'data-latex="([^"]*)"', shown)
    assert unescape(latex).count("&=") == 1
    assert r"\frac{1}{2 r}" in latex


def test_a_blank_entry_is_zero():
    """An empty entry is read as zero."""
    assert tetrad("r, phi", [["1", ""], [" ", "r"]]) == tetrad(**POLAR)
