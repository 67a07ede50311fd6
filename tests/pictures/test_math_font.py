"""Formulas where no font is made for them: ours is used, brackets grow, nothing is cut off."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from geomtorsion import spaces
from geomtorsion.exercises.sheets import write_sheet
from geomtorsion.pictures import math_font
from geomtorsion.pictures.formula import LETTERS, SIGNS
from geomtorsion.pictures.math_font import font_face
from geomtorsion.pictures.mathml import mathml
from geomtorsion.pictures.report import write_report
from tests.browser import Watched

# The file is loaded with every report; no more than this is worth it.
MOST_BYTES = 150_000
# A bracket is at least as high as this part of the matrix that it holds.
COVERED = 0.9
LEAVES = "math mi, math mo, math mn"


def fonts_of(page: Any, selector: str) -> set[tuple[str, bool]]:
    """Family of each font with which elements are drawn, and whether it came with the page."""
    link = page.context.new_cdp_session(page)
    link.send("DOM.enable")
    link.send("CSS.enable")
    root = link.send("DOM.getDocument")["root"]["nodeId"]
    nodes = link.send("DOM.querySelectorAll", {"nodeId": root, "selector": selector})["nodeIds"]
    assert nodes
    found = set()
    for node in nodes:
        for font in link.send("CSS.getPlatformFontsForNode", {"nodeId": node})["fonts"]:
            found.add((font["familyName"], font["isCustomFont"]))
    return found


def cut_off(page: Any) -> list[str]:
    """Boxes that hide a part of what is in them above or below."""
    return page.evaluate(
        """() => [...document.querySelectorAll(".scroll, .head, main p, main li, .wide")]
            .filter((e) => e.offsetParent && getComputedStyle(e).overflowY === "hidden")
            .filter((e) => {
                const box = e.getBoundingClientRect();
                return [...e.querySelectorAll("math, math *")].some((m) => {
                    const b = m.getBoundingClientRect();
                    return b.height && (b.top < box.top - 0.5 || b.bottom > box.bottom + 0.5);
                });
            }).map((e) => e.textContent.slice(0, 60))"""
    )


def test_the_font_is_small_and_says_what_it_is():
    """A file of moderate size, with its license beside it."""
    folder = Path(math_font.__file__).with_name("fonts")
    [font] = folder.glob("*.woff2")
    assert font.stat().st_size < MOST_BYTES
    assert font.read_bytes()[:4] == b"wOF2"
    text = (folder / "OFL.txt").read_text("utf-8")
    assert font.name in text
    assert "SIL OPEN FONT LICENSE" in text
    assert "The STIX Fonts Project Authors" in text


def test_every_letter_and_sign_is_in_it(watched: Watched):
    """All that a formula can be made of is drawn with this font, and with no other."""
    letters = [rf"\{name}" for name in (*LETTERS, *SIGNS)]
    letters += [chr(k) for k in (*range(ord("a"), ord("z") + 1), *range(ord("A"), ord("Z") + 1))]
    latex = [*letters, r"\bar{a}\dot{b}\ddot{c}\hat{d}\tilde{e}'", "0123456789.", r"-+=,;/|!<>()[]"]
    latex += [r"\sin x \text{ words, too }", r"\sqrt{x}", r"\left(\frac{1}{2}\right)"]
    html = "".join(f"<p>{mathml(text)}</p>" for text in latex)
    watched.page.set_content(f"<!doctype html><style>{font_face()}</style>{html}")
    watched.page.evaluate("document.fonts.ready")
    assert fonts_of(watched.page, LEAVES) == {("STIX Two Math", True)}


@pytest.mark.parametrize("name", ["so3", "schwarzschild"])
def test_a_report_brings_its_font(name: str, watched: Watched, tmp_path: Path):
    """Brackets are as high as their matrix; no index above a bar is cut off."""
    page = watched.page
    page.goto(write_report(spaces.load(name), tmp_path, pictures=False).as_uri())
    page.evaluate("document.fonts.ready")
    assert fonts_of(page, LEAVES) == {("STIX Two Math", True)}
    heights = page.locator("#metric mtable").evaluate_all(
        """(all) => all.map((m) => [m.getBoundingClientRect().height,
            m.previousElementSibling.getBoundingClientRect().height])"""
    )
    assert heights
    assert all(bracket > COVERED * matrix for matrix, bracket in heights)
    assert cut_off(page) == []


def test_a_sheet_brings_its_font(watched: Watched, tmp_path: Path):
    """The same for a sheet of exercises."""
    sheet = write_sheet("4", tmp_path)[0]
    watched.page.goto(sheet.as_uri())
    watched.page.evaluate("document.fonts.ready")
    assert fonts_of(watched.page, LEAVES) == {("STIX Two Math", True)}
    assert cut_off(watched.page) == []


def test_the_page_brings_its_font(lab: Watched):
    """The same for the page, which is served."""
    lab.page.evaluate("document.fonts.ready")
    assert fonts_of(lab.page, LEAVES) == {("STIX Two Math", True)}
    assert cut_off(lab.page) == []
