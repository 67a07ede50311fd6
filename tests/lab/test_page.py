"""The page in a real browser: every tab, what is typed, moved, switched and answered."""

from __future__ import annotations

import re
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest

from geomtorsion import Frame, Loop, burgers_vector, exercises, spaces
from geomtorsion.lab.views import TABS
from tests.lab.conftest import Watched

# What each tab shows when it is ready.
READY = {
    "Any tetrad": "#torsion math",
    "Loops": "#loop svg",
    "Straightest and shortest": "#paths-said",
    "The top": "#top-plan table",
    "What accuracy costs": "#costs-said",
    "Exercises": "#statement",
}
# Seconds from a slider to its new picture.
PROMPT = 0.5
# Milliseconds from the next key to the next change of what is said about the loop.
TIMING = """(before) => {
    let pressed = 0;
    const press = () => { pressed = performance.now(); };
    window.addEventListener("keydown", press, { capture: true, once: true });
    window.moved = new Promise((done) => {
        const look = () => {
            const said = document.querySelector("#loop-said")?.innerText;
            if (said && said !== before) done(performance.now() - pressed);
            else requestAnimationFrame(look);
        };
        look();
    });
}"""


def number(text: str) -> float:
    """A number as the page writes it."""
    return float(text.replace("−", "-"))


def blank(lab: Watched) -> Any:
    """The tab for tetrads with an empty one of two coordinates, computed."""
    page = lab.tab("Any tetrad")
    page.get_by_label("start from").select_option(label="blank, 2 coordinates")
    page.wait_for_selector("#torsion .zero")
    # Fields that have just been drawn take what is typed a moment later.
    page.wait_for_timeout(500)
    return page


def too_wide(page: Any) -> list[Any]:
    """Which of the page, its scrolling part and all that stands in it is wider than the window."""
    return page.evaluate(
        """() => [document.documentElement, document.querySelector("#App")]
            .filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.tagName + e.id)"""
    )


@pytest.mark.parametrize("name", TABS)
def test_a_tab_loads_and_fits_a_phone(lab: Watched, name: str):
    """Each tab shows itself, asks for nothing but the server, and needs no more than 400 pixels."""
    page = lab.tab(name)
    page.wait_for_selector(READY[name])
    hosts = {urlsplit(url).hostname for url in lab.asked if url.startswith(("http", "ws"))}
    assert hosts == {"127.0.0.1"}
    page.set_viewport_size({"width": 400, "height": 800})
    assert too_wide(page) == []
    box = page.get_by_role("tab", name="Exercises").bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= 400


def test_a_tetrad_is_typed(lab: Watched):
    """Polar coordinates typed over a blank tetrad: the torsion is 1/(2 r), as in the library."""
    page = blank(lab)
    page.get_by_label("coordinates", exact=True).fill("r, phi")
    page.get_by_label("row 1, dy").fill("r")
    page.wait_for_function("document.querySelector('#torsion')?.innerText.includes('r')")
    r, phi = (spaces.load("flat_polar").frame.coordinates[k] for k in (0, 1))
    assert str(Frame([r, phi], [[1, 0], [0, r]]).quantity("torsion")[0, 1, 1]) == "1/(2*r)"
    fraction = page.locator("#torsion mfrac").first
    assert fraction.evaluate("e => [...e.children].map(x => x.textContent)") == ["1", "2\u2062r"]


def test_a_bad_tetrad_shows_its_error(lab: Watched):
    """The reason stands beside the entry at fault, and goes when it is mended."""
    page = lab.tab("Any tetrad")
    entry = page.get_by_label("row 0, dφ2")
    entry.fill("sin(phi1")
    fault = page.locator(".fault")
    fault.wait_for()
    assert fault.count() == 1
    cell = fault.locator("xpath=..")
    assert cell.get_by_label("row 0, dφ2").count() == 1
    assert page.locator("#torsion").count() == 0
    entry.fill("__import__('os')")
    page.locator(".fault", has_text="expressions are not code").wait_for()
    entry.fill("sin(phi1)")
    page.wait_for_selector("#torsion math")
    assert fault.count() == 0


def test_a_singular_tetrad_is_told(lab: Watched):
    """What is no single entry's fault stands above the result."""
    page = blank(lab)
    page.get_by_label("row 1, dy").fill("0")
    page.get_by_text("coframe is singular").wait_for()


def test_a_slider_moves_the_loop(lab: Watched):
    """The radius moved by key: new numbers within half a second, and they are the library's."""
    page = lab.tab("Loops")
    page.wait_for_selector("#loop svg")
    slider = page.get_by_role("slider").first
    slider.focus()
    took = []
    for _ in range(3):
        page.evaluate(TIMING, page.inner_text("#loop-said"))
        page.keyboard.press("ArrowRight")
        took.append(page.evaluate("() => window.moved") / 1000)
    frame = spaces.load("so3").frame
    b = burgers_vector(frame, Loop.circle((0.3, 1.0, 0.2), 0.45, (0, 1)))
    cells = page.locator("table.numbers tbody tr td:nth-child(2)").all_inner_texts()
    assert np.allclose([number(text) for text in cells], b.vector, atol=1e-6)
    assert f"|b| = {b.magnitude:.6g}" in page.inner_text("#loop-said")
    assert min(took) < PROMPT, f"the picture took {took} s"


def test_other_space_other_sliders(lab: Watched):
    """A chosen space brings its own coordinates; its loop is drawn."""
    page = lab.tab("Loops")
    page.get_by_label("space", exact=True).select_option(
        label="heisenberg: the Heisenberg group (Nil)"
    )
    page.wait_for_function("document.querySelector('#loop-said').innerText.includes('in x and y')")
    said = page.inner_text("#loop-said")
    assert f"|b| = {np.pi * 0.3**2:.6g}" in said


def test_the_curves_can_be_turned(lab: Watched):
    """Arrow keys turn the picture in space; the film runs to its end."""
    page = lab.tab("Straightest and shortest")
    page.wait_for_selector("#paths-said")
    assert "part: by" in page.inner_text("#paths-said")
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
    row = plan.locator("tr", has_text="gravity").first
    row.wait_for()
    assert row.inner_text().startswith("left out")
    page.get_by_label(re.compile("^fixed point")).check()
    page.wait_for_function(
        "[...document.querySelectorAll('#top-plan tr')].some(e => /^in.*gravity/.test(e.innerText))"
    )
    assert "angular momentum moves in space" in page.inner_text("#top-said")


def test_costs_of_the_case_on_the_screen(lab: Watched):
    """The case set on another tab is the one that is measured."""
    page = lab.tab("Loops")
    page.wait_for_selector("#loop svg")
    page.get_by_label("space", exact=True).select_option(
        label="heisenberg: the Heisenberg group (Nil)"
    )
    page.wait_for_function("document.querySelector('#loop-said').innerText.includes('in x and y')")
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


def test_tabs_by_keyboard(lab: Watched):
    """The arrow keys go from tab to tab."""
    page = lab.page
    page.get_by_role("tab", name="Any tetrad").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector(READY["Loops"])
    assert page.get_by_role("tab", name="Loops").get_attribute("aria-selected") == "true"
