"""The page in a real browser: every tab, what is typed, moved, switched and answered."""

from __future__ import annotations

import re
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from geomtorsion import Frame, Loop, burgers_vector, exercises, spaces
from geomtorsion.lab.views import TABS
from tests.browser import Watched

# What each tab shows when it is ready.
READY = {
    "Any tetrad": "#torsion math",
    "Loops": "#loop svg",
    "Straightest and shortest": "#paths-said",
    "The top": "#top-plan table",
    "What accuracy costs": "#costs-said",
    "Exercises": "#statement",
}


def number(text: str) -> float:
    """A number as the page writes it."""
    return float(text.replace("−", "-"))


def blank(lab: Watched) -> Any:
    """The tab for tetrads with an empty one of two coordinates, computed."""
    page = lab.tab("Any tetrad")
    page.get_by_label("start from").select_option(label="blank, 2 coordinates")
    page.wait_for_selector("#torsion .zero")
    page.get_by_label("row 1, dy").wait_for()
    return page


def too_wide(page: Any) -> list[Any]:
    """Which of the page, its scrolling part and all that stands in it is wider than the window."""
    return page.evaluate(
        """() => [document.documentElement, document.querySelector("#App")]
            .filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.tagName + e.id)"""
    )


def test_tabs_load_and_fit_a_phone(lab: Watched):
    """Each tab shows itself, asks for nothing but the server, and needs no more than 400 pixels."""
    page = lab.page
    for name in TABS:
        page.set_viewport_size({"width": 1200, "height": 900})
        lab.tab(name)
        page.wait_for_selector(READY[name])
        page.set_viewport_size({"width": 400, "height": 800})
        assert too_wide(page) == [], name
        box = page.get_by_role("tab", name="Exercises").bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= 400
    # The arrow keys go from tab to tab too.
    page.get_by_role("tab", name="Any tetrad").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector(READY["Loops"])
    assert page.get_by_role("tab", name="Loops").get_attribute("aria-selected") == "true"
    hosts = {urlsplit(url).hostname for url in lab.asked if url.startswith(("http", "ws"))}
    assert hosts == {"127.0.0.1"}


def test_a_tetrad_is_typed(lab: Watched):
    """Polar coordinates over a blank tetrad: the torsion is the library's; then a singular one."""
    page = blank(lab)
    fraction = page.locator("#torsion mfrac").first
    lab.typed({"coordinates": "r, phi", "row 1, dy": "r"}, fraction)
    r, phi = (spaces.load("flat_polar").frame.coordinates[k] for k in (0, 1))
    assert str(Frame([r, phi], [[1, 0], [0, r]]).quantity("torsion")[0, 1, 1]) == "1/(2*r)"
    assert fraction.evaluate("e => [...e.children].map(x => x.textContent)") == ["1", "2r"]
    # What is no single entry's fault stands above the result.
    lab.typed({"row 1, dy": "0"}, page.get_by_text("coframe is singular"))


def test_a_bad_tetrad_shows_its_error(lab: Watched):
    """The reason stands beside the entry at fault, and goes when it is mended."""
    page = lab.tab("Any tetrad")
    page.get_by_label("row 0, dφ2").wait_for()
    fault = page.locator(".fault")
    lab.typed({"row 0, dφ2": "sin(phi1"}, fault)
    assert fault.count() == 1
    cell = fault.locator("xpath=..")
    assert cell.get_by_label("row 0, dφ2").count() == 1
    assert page.locator("#torsion").count() == 0
    code = page.locator(".fault", has_text="expressions are not code")
    lab.typed({"row 0, dφ2": "__import__('os')"}, code)
    lab.typed({"row 0, dφ2": "sin(phi1)"}, page.locator("#torsion math").first)
    assert fault.count() == 0


def test_a_slider_moves_the_loop(lab: Watched):
    """The radius moved by key: new numbers, and they are the library's."""
    page = lab.tab("Loops")
    page.wait_for_selector("#loop svg")
    slider = page.get_by_role("slider").first
    slider.focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    frame = spaces.load("so3").frame
    b = burgers_vector(frame, Loop.circle((0.3, 1.0, 0.2), 0.45, (0, 1)))
    lab.says("#loop-said", f"|b| = {b.magnitude:.6g}")
    cells = page.locator("table.numbers tbody tr td:nth-child(2)").all_inner_texts()
    assert np.allclose([number(text) for text in cells], b.vector, atol=1e-6)


def test_the_curves_can_be_turned(lab: Watched):
    """Arrow keys turn the picture in space; the film runs to its end."""
    page = lab.tab("Straightest and shortest")
    lab.says("#paths-said", "part: by")
    frame = page.frame_locator("iframe")
    canvas = frame.locator("canvas")
    canvas.wait_for()
    ink = "e => [...e.getContext('2d').getImageData(0, 0, e.width, e.height).data].join()"
    before = canvas.evaluate(ink)
    canvas.focus()
    page.keyboard.press("ArrowLeft")
    assert canvas.evaluate(ink) != before
    frame.get_by_label("time").fill("0")
    assert frame.locator("#clock").inner_text() == "t = 0.000"


def test_effects_are_switched(lab: Watched):
    """Gravity alone changes nothing that is watched; with a fixed point it is in the equations."""
    page = lab.tab("The top")
    plan = page.locator("#top-plan")
    plan.get_by_text("To watch nutation angle: 6 equations").wait_for()
    page.get_by_label(re.compile("^gravity")).check()
    plan.locator("tr", has_text=re.compile(r"^\s*left out.*gravity", re.DOTALL)).first.wait_for()
    page.get_by_label(re.compile("^fixed point")).check()
    plan.locator("tr", has_text=re.compile(r"^\s*in.*gravity", re.DOTALL)).first.wait_for()
    lab.says("#top-said", "angular momentum moves in space")


def test_another_space_and_what_it_costs(lab: Watched):
    """A chosen space brings its own coordinates and its loop; this case is the one measured."""
    page = lab.tab("Loops")
    page.wait_for_selector("#loop svg")
    page.get_by_label("space", exact=True).select_option(
        label="heisenberg: the Heisenberg group (Nil)"
    )
    assert f"|b| = {np.pi * 0.3**2:.6g}" in lab.says("#loop-said", "in x and y")
    lab.tab("What accuracy costs")
    page.get_by_label("A circle of radius 0.3 in heisenberg").wait_for()
    page.get_by_label("the top", exact=True).click()
    page.get_by_label("The top (free), to t = 12 s").wait_for()


def test_an_exercise_is_answered(lab: Watched):
    """Wrong with its diagnosis, then right; a hint is taken."""
    page = lab.tab("Exercises")
    page.get_by_label("exercise", exact=True).select_option(
        label=f"2.1 {exercises.titles()['2.1']}"
    )
    page.get_by_text("2.1 ", exact=False).first.wait_for()
    field = page.get_by_label("connection")
    field.wait_for()
    field.fill("2,1,2 = 1/r")
    page.get_by_role("button", name="Check").click()
    page.locator("#verdict .wrong").wait_for()
    field.fill("1,2,2 = 1/r")
    page.get_by_role("button", name="Check").click()
    page.locator("#verdict .right").wait_for()
    assert page.locator("#verdict .wrong").count() == 0
    page.get_by_role("button", name="Next hint").click()
    page.locator("#hints li").first.wait_for()
    assert page.locator("#hints li").count() == 1
