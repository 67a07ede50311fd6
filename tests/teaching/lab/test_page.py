"""The page in a real browser: tabs, typed entries, sliders, switches and answers."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlencode, urlsplit
from xml.etree import ElementTree

import numpy as np
import pytest

from geomtorsion import Frame, Loop, burgers_vector, exercises, spaces
from geomtorsion.teaching.lab.guides import TABS
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.space_info import space_form, typable
from tests.browser import PATIENCE, Watched

# The element that each tab shows when it is ready.
READY = {
    "The compass": "#compass iframe",
    "Any tetrad": "#torsion math",
    "Loops": "#loop svg",
    "Straightest and shortest": "#paths-result",
    "The top": "#top-plan table",
    "What accuracy costs": "#costs-result",
    "Exercises": "#statement",
}


def number(text: str) -> float:
    """A number in the notation of the page."""
    return float(text.replace("−", "-"))


def blank(lab: Watched) -> Any:
    """The tab for tetrads with a blank tetrad of two coordinates, computed."""
    page = lab.tab("Any tetrad")
    page.get_by_label("start from").select_option(label="blank, 2 coordinates")
    page.wait_for_selector("#torsion .zero")
    page.get_by_label("row 2, dy").wait_for()
    return page


def as_at_first(shared_lab: Watched) -> None:
    """Choose the first tetrad again, and wait until the address holds only the tab."""
    page = shared_lab.tab("Any tetrad")
    page.get_by_label("start from").select_option(label=next(iter(typable())))
    page.wait_for_url(lambda url: parse_qs(urlsplit(url).query).keys() <= {"tab"})


def too_wide(page: Any) -> list[Any]:
    """Names of the page or its scrolling part, if they are wider than the window."""
    return page.evaluate(
        """() => [document.documentElement, document.querySelector("#App")]
            .filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.tagName + e.id)"""
    )


def test_tabs_load_and_fit_a_phone(shared_lab: Watched):
    """Each tab loads, sends requests only to the server, and fits 320 pixels."""
    page = shared_lab.page
    for name in TABS:
        page.set_viewport_size({"width": 1200, "height": 900})
        shared_lab.tab(name)
        page.wait_for_selector(READY[name])
        for width in (320, 400):
            page.set_viewport_size({"width": width, "height": 800})
            assert too_wide(page) == [], name
        box = page.get_by_role("tab", name="Exercises").bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= 400
    # The arrow keys also move from tab to tab.
    page.get_by_role("tab", name="The compass").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector(READY["Loops"])
    assert page.get_by_role("tab", name="Loops").get_attribute("aria-selected") == "true"
    hosts = {urlsplit(url).hostname for url in shared_lab.asked if url.startswith(("http", "ws"))}
    assert hosts == {"127.0.0.1"}


def test_a_tetrad_is_typed(shared_lab: Watched):
    """Typed polar coordinates give the library's torsion; a singular coframe is reported."""
    page = blank(shared_lab)
    fraction = page.locator("#torsion mfrac").first
    shared_lab.typed({"coordinates": "r, phi", "row 2, dφ": "r"}, fraction)
    r, phi = (spaces.load("flat_polar").frame.coordinates[k] for k in (0, 1))
    assert str(Frame([r, phi], [[1, 0], [0, r]]).quantity("torsion")[0, 1, 1]) == "1/(2*r)"
    assert fraction.evaluate("e => [...e.children].map(x => x.textContent)") == ["1", "2r"]
    # A fault of the whole coframe is shown above the result.
    shared_lab.typed({"row 2, dφ": "0"}, page.get_by_text("coframe is singular"))
    as_at_first(shared_lab)


def test_a_bad_tetrad_shows_its_error(shared_lab: Watched):
    """The reason is beside the wrong entry, and disappears after the correction."""
    page = shared_lab.tab("Any tetrad")
    page.get_by_label("row 1, dφ2").wait_for()
    fault = page.locator(".fault")
    shared_lab.typed({"row 1, dφ2": "sin(phi1"}, fault)
    assert fault.count() == 1
    cell = fault.locator("xpath=..")
    assert cell.get_by_label("row 1, dφ2").count() == 1
    assert page.locator("#torsion").count() == 0
    code = page.locator(".fault", has_text="expressions are not code")
    shared_lab.typed({"row 1, dφ2": "__import__('os')"}, code)
    shared_lab.typed({"row 1, dφ2": "sin(phi1)"}, page.locator("#torsion math").first)
    assert fault.count() == 0


def test_a_slider_moves_the_loop(shared_lab: Watched):
    """Arrow keys change the radius; the numbers are the library's."""
    page = shared_lab.tab("Loops")
    page.wait_for_selector("#loop svg")
    slider = page.get_by_role("slider").first
    slider.focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    frame = spaces.load("so3").frame
    b = burgers_vector(frame, Loop.circle((0.3, 1.0, 0.2), 0.45, (0, 1)))
    shared_lab.shows("#loop-result", f"|b| = {b.magnitude:.6g}")
    # The table is drawn after the sentence.
    shared_lab.shows("table.numbers tbody", f"{b.vector[0]:.6g}")
    cells = page.locator("table.numbers tbody tr td:nth-child(2)").all_inner_texts()
    assert np.allclose([number(text) for text in cells], b.vector, atol=1e-6)
    for _ in range(3):
        page.keyboard.press("ArrowLeft")
    shared_lab.shows("#loop-result", f"Area A = {np.pi * 0.3**2:.6g}")


def test_the_curves_can_be_turned(shared_lab: Watched):
    """Arrow keys rotate the figure in space, and the slider sets the time of the animation."""
    page = shared_lab.tab("Straightest and shortest")
    shared_lab.shows("#paths-result", "separate by at most")
    frame = page.frame_locator("iframe")
    canvas = frame.locator("#space")
    canvas.wait_for()
    ink = "e => [...e.getContext('2d').getImageData(0, 0, e.width, e.height).data].join()"
    before = canvas.evaluate(ink)
    canvas.focus()
    page.keyboard.press("ArrowLeft")
    assert canvas.evaluate(ink) != before
    frame.get_by_label("time").fill("0")
    assert frame.locator("#clock").inner_text() == "t = 0.000"


def test_a_reload_keeps_tab_and_input(shared_lab: Watched):
    """The address stores tab, space, radius, entries and a sent answer, and nothing else."""
    page = shared_lab.tab("Loops")
    page.wait_for_selector("#loop svg")
    page.wait_for_url(lambda url: urlsplit(url).query == "tab=Loops")
    page.get_by_label("space", exact=True).select_option(
        label="screw_dislocation: screw dislocation along z"
    )
    shared_lab.shows("#loop-result", "all of b comes from the line inside the loop")
    slider = page.get_by_role("slider", name="radius")
    slider.focus()
    page.keyboard.press("ArrowRight")
    shared_lab.shows("#loop-result", f"Area A = {np.pi * 0.35**2:.6g}")
    page.wait_for_url("**radius=*")
    assert set(parse_qs(urlsplit(page.url).query)) == {"tab", "loop", "radius"}
    blank(shared_lab)
    fraction = page.locator("#torsion mfrac").first
    shared_lab.typed({"coordinates": "r, phi", "row 2, dφ": "r"}, fraction)
    shared_lab.tab("Exercises")
    answer = page.get_by_label("legs")
    answer.fill("1,1 = 17")
    page.get_by_role("button", name="Check").click()
    page.locator("#verdict .wrong").wait_for()
    page.reload()
    page.wait_for_selector("#statement")
    assert page.get_by_role("tab", name="Exercises").get_attribute("aria-selected") == "true"
    assert page.get_by_label("legs").input_value() == "1,1 = 17"
    # Typed text that was not sent is also kept; a verdict appears only after a click.
    assert page.locator("#verdict").count() == 0
    page.get_by_label("legs").fill("2,2 = 18")
    page.wait_for_url("**18*")
    page.reload()
    page.wait_for_selector("#statement")
    assert page.get_by_label("legs").input_value() == "2,2 = 18"
    page.get_by_role("button", name="Check").click()
    page.locator("#verdict .wrong").wait_for()
    shared_lab.tab("Any tetrad")
    page.locator("#torsion mfrac").first.wait_for()
    assert page.get_by_label("row 2, dφ", exact=True).input_value().strip() == "r"
    shared_lab.tab("Loops")
    assert f"Area A = {np.pi * 0.35**2:.6g}" in shared_lab.shows("#loop-result", "|b| = 0.48")


def test_back_leaves_the_lab(watched: Watched, address: str):
    """Back leaves the page after many changes, because changes replace the address."""
    page = watched.page
    page.goto("about:blank")
    page.goto(address)
    page.wait_for_selector(READY["The compass"])
    for tab in ("Loops", "The top", "Exercises"):
        watched.tab(tab)
        page.wait_for_selector(READY[tab])
    page.wait_for_url("**tab=Exercises")
    page.go_back()
    page.wait_for_url("about:blank")
    page.go_forward()
    page.wait_for_selector(READY["Exercises"])


def test_answers_stay_while_another_exercise_is_looked_at(shared_lab: Watched):
    """An answer typed in one exercise is present when the exercise is opened again."""
    page = shared_lab.tab("Exercises")
    listed = page.get_by_label("exercise", exact=True)
    page.get_by_label("legs").fill("1,1 = 17")
    page.wait_for_url("**17*")
    listed.select_option(index=1)
    page.get_by_label("legs").wait_for(state="detached")
    page.wait_for_url("**exercise=1.2*")
    listed.select_option(index=0)
    page.get_by_label("legs").wait_for()
    assert page.get_by_label("legs").input_value() == "1,1 = 17"
    page.wait_for_url(lambda url: "exercise" not in parse_qs(urlsplit(url).query))
    assert "17" in page.url
    page.get_by_label("legs").fill("")
    page.wait_for_url(lambda url: parse_qs(urlsplit(url).query).keys() <= {"tab"})


def test_a_blank_tetrad_is_blank_after_a_reload_too(shared_lab: Watched):
    """An address restores its tetrad once; the choice of a blank tetrad then gives a blank one."""
    page = blank(shared_lab)
    shared_lab.typed({"row 2, dy": "x"}, page.locator("#torsion mfrac").first)
    page.wait_for_url("**coframe*")
    page.reload()
    page.locator("#torsion mfrac").first.wait_for()
    page.get_by_label("start from").select_option(label=next(iter(typable())))
    page.get_by_label("row 3, dφ3").wait_for()
    page.wait_for_url(lambda url: "start" not in parse_qs(urlsplit(url).query))
    page.get_by_label("start from").select_option(label="blank, 2 coordinates")
    page.get_by_label("row 2, dy").wait_for()
    assert page.get_by_label("row 2, dy", exact=True).input_value() == "1"
    as_at_first(shared_lab)


def test_a_link_with_nonsense_opens_the_page(watched: Watched, address: str):
    """Foreign text in an address is shown as text or ignored: no script, no odd number."""
    attack = "<img src=x onerror=alert(1)>"
    query = {
        "tab": "nowhere", "loop": "nobody", "radius": "nan", "centre": "1e999,0", "omega": attack,
        "coordinates": f"r, {attack}", "coframe": f"{attack}|0;0|**x**", "exercise": "99.9",
        "variant": "-1", "start": "flat_polar", "signature": attack, "body": "1,2", "effects": "x",
    }  # fmt: skip
    page = watched.page
    page.goto(f"{address}?{urlencode(query)}")
    page.wait_for_selector(READY["The compass"])
    watched.tab("Any tetrad")
    page.get_by_text("expected names, got").wait_for()
    assert page.get_by_label("row 1, dr", exact=True).input_value() == attack
    assert page.locator("img[src=x]").count() == 0
    lab_tab = watched.tab("Loops")
    lab_tab.wait_for_selector("#loop svg")
    assert "0.282743" in watched.shows("#loop-result", "Area A")
    watched.tab("The top").wait_for_selector("#top-plan table")


def test_labels_follow_the_coordinates(shared_lab: Watched):
    """With renamed coordinates each field has its new label and keeps its text."""
    page = blank(shared_lab)
    shared_lab.typed({"row 1, dx": "2"}, page.locator("#metric mn", has_text="4"))
    field = page.get_by_label("coordinates", exact=True)
    field.fill("u, v, w")
    page.get_by_label("row 3, dw", exact=True).wait_for()
    assert page.get_by_label("row 1, du", exact=True).input_value().strip() == "2"
    assert page.get_by_label("row 1, dx", exact=True).count() == 0
    # The field in use keeps the focus.
    field.click()
    page.keyboard.type("1")
    page.get_by_label("row 3, dw1", exact=True).wait_for()
    page.keyboard.type("2")
    page.get_by_label("row 3, dw12", exact=True).wait_for()
    as_at_first(shared_lab)


def test_a_case_takes_nothing_from_the_one_before(shared_lab: Watched):
    """A case chosen before the typed text is sent, or passed by keys, has its own fields."""
    page = blank(shared_lab)
    start = page.get_by_label("start from")
    so3, *_, last = typable()
    for title in (so3, last):
        page.get_by_label("coordinates", exact=True).fill("r, phi")
        start.select_option(label=title)
        page.wait_for_url(lambda url, title=title: own_address(url, title))
        page.wait_for_timeout(2 * PAGE.pause)
        assert held(page) == holds(title)
        assert own_address(page.url, title)
        start.select_option(label="blank, 2 coordinates")
        page.get_by_label("row 2, dy").wait_for()
    for pause in (15, 150):
        start.focus()
        for key in ("Home", *["ArrowDown"] * 8, "ArrowUp"):
            page.keyboard.press(key)
            page.wait_for_timeout(pause)
        title = start.evaluate("e => e.selectedOptions[0].text")
        page.wait_for_url(lambda url, title=title: own_address(url, title))
        page.wait_for_timeout(2 * PAGE.pause)
        assert held(page) == holds(title)
        assert own_address(page.url, title)
    as_at_first(shared_lab)


def own_address(url: str, title: str) -> bool:
    """Whether an address names a tetrad of the list and holds no typed text."""
    first, name = next(iter(typable().values())), typable()[title]
    query = parse_qs(urlsplit(url).query)
    query.pop("tab", None)
    return query == ({} if name == first else {"start": [name]})


def holds(title: str) -> tuple[str, str, list[str]]:
    """Coordinates, signature and entries of a tetrad of the list."""
    form = space_form(typable()[title])
    entries = [text for row in form["coframe"] for text in row]
    return ", ".join(form["coordinates"]), form["signature"], entries


def held(page: Any) -> tuple[str, str, list[str]]:
    """Coordinates, signature and entries that the fields contain."""
    names = [page.get_by_label(name, exact=True) for name in ("coordinates", "signature")]
    entries = page.locator(".tetrad input").evaluate_all("es => es.map(e => e.value)")
    return (*(name.input_value() for name in names), entries)


def test_unknown_functions_have_a_field(shared_lab: Watched):
    """An undeclared function is reported; the expanding universe with a(t) is offered."""
    page = blank(shared_lab)
    shared_lab.typed(
        {"row 2, dy": "f(x)"}, page.locator(".fault", has_text="eclare it as an unknown")
    )
    shared_lab.typed({"unknown functions": "f(x)"}, page.locator("#torsion mfrac").first)
    page.get_by_label("start from").select_option(
        label="frw: expanding universe, unknown a(t), curvature k"
    )
    page.get_by_label("row 4, dφ", exact=True).wait_for()
    page.locator("#ricci").wait_for()
    assert page.get_by_label("unknown functions").input_value() == "a(t)"
    as_at_first(shared_lab)


def test_latex_is_copied(shared_lab: Watched):
    """The button copies the equations of its card to the clipboard."""
    page = shared_lab.tab("Any tetrad")
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Copy LaTeX: Scalar curvature").click()
    page.get_by_text("Copied").wait_for()
    copied = page.evaluate("navigator.clipboard.readText()")
    assert "\\begin{align*}" in copied
    assert "frac{3}{2}" in copied


def test_latex_of_an_exercise_is_copied(shared_lab: Watched):
    """The statement with its questions and the shown hints can be copied."""
    page = shared_lab.tab("Exercises")
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    posed = exercises.load("1.1")
    page.locator("#statement", has_text="coframe").wait_for()

    def copied(what: str) -> str:
        button = page.get_by_role("button", name=f"Copy LaTeX: {what}")
        button.click()
        page.get_by_role("button", name=f"Copy LaTeX: {what}").get_by_text("Copied").wait_for()
        return page.evaluate("navigator.clipboard.readText()")

    found = copied("statement and questions")
    assert r"\begin{pmatrix} \cos{\phi} & - r \sin{\phi} \\" in found
    assert r"with one leg per \textbf{column}: row $\mu$, column $i$." in found
    page.get_by_role("button", name="Next hint").click()
    page.locator("#hints li").first.wait_for()
    assert copied("hints") == posed.hints[0]


def test_a_variant_that_there_is_not_is_refused(shared_lab: Watched):
    """A wrong variant remains in its field, and no other variant is shown."""
    page = shared_lab.tab("Exercises")
    page.wait_for_selector(READY["Exercises"])
    field = page.get_by_role("textbox", name="variant", exact=True)
    refused = page.get_by_text("expected a whole number from 0 to 1,000,000,000").first
    shared_lab.typed({"variant": "3.7"}, refused, filler="0", key="Tab")
    assert float(field.input_value()) == 3.7
    assert page.locator("#statement").count() == 0
    field.fill("3")
    field.press("Tab")
    page.get_by_text("; variant 3").wait_for()
    field.fill("0")
    field.press("Tab")
    page.wait_for_url(lambda url: parse_qs(urlsplit(url).query).keys() <= {"tab"})


def focused(page: Any) -> tuple[str, str]:
    """Role and text of the focused element, also inside shadow trees."""
    return page.evaluate(
        """() => { let e = document.activeElement;
            while (e.shadowRoot?.activeElement) e = e.shadowRoot.activeElement;
            return [e.getAttribute("role") ?? e.tagName, e.textContent.trim()]; }"""
    )


def test_the_keyboard_reaches_the_tabs(lab: Watched):
    """Tab reaches the open tab without a change, arrows change it, Shift and Tab go back."""
    page = lab.page
    page.keyboard.press("Tab")
    assert focused(page) == ["tab", "The compass"]
    assert page.get_by_role("tab", name="The compass").get_attribute("aria-selected") == "true"
    page.keyboard.press("ArrowRight")
    page.wait_for_selector(READY["Loops"])
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    # The question of the tab comes before its controls.
    assert focused(page)[0] == "SUMMARY"
    page.keyboard.press("Tab")
    assert focused(page)[0] == "SELECT"
    for _ in range(3):
        page.keyboard.press("Shift+Tab")
    assert focused(page) == ["tab", "Loops"]
    lab.tab("What accuracy costs")
    page.wait_for_selector(READY["What accuracy costs"])
    for _ in range(3):
        page.keyboard.press("Tab")
    page.keyboard.press("ArrowDown")
    page.get_by_role("radio", name="the straightest path", checked=True).wait_for()


def test_names_and_values_for_readers(shared_lab: Watched):
    """A slider has its value and unit; no name contains markup; the animation has a title."""
    page = shared_lab.tab("Loops")
    page.wait_for_selector("#loop svg")
    radius = page.get_by_role("slider", name="radius")
    assert radius.get_attribute("aria-valuetext") == "0.3"
    radius.focus()
    page.keyboard.press("ArrowLeft")
    page.wait_for_function("document.querySelector('#loop-result').innerText.includes('0.19635')")
    assert radius.get_attribute("aria-valuetext") == "0.25"
    page.keyboard.press("ArrowRight")
    shared_lab.shows("#loop-result", f"Area A = {np.pi * 0.3**2:.6g}")
    assert page.get_by_role("slider", name="φ2 in rad").count() == 1
    shared_lab.tab("The top")
    page.wait_for_selector(READY["The top"])
    for name in ("I1 in kg m²", "Ω3 in rad/s", "tilt of axis 3 in rad", "time in s"):
        assert page.get_by_role("slider", name=name).count() == 1
    assert page.locator("iframe").get_attribute("title") == "Animation: Body cone and space cone"
    shared_lab.tab("Exercises")
    page.wait_for_selector(READY["Exercises"])
    assert page.get_by_role("textbox", name="variant", exact=True).count() == 1
    link = page.context.new_cdp_session(page)
    nodes = link.send("Accessibility.getFullAXTree")["nodes"]
    names = [str(node.get("name", {}).get("value", "")) for node in nodes]
    assert len(names) > 50
    assert [name for name in names if "<" in name] == []


def test_dark_and_narrow(shared_lab: Watched):
    """In dark mode all parts are dark; on a phone, animation and controls are visible together."""
    from playwright.sync_api import expect

    page = shared_lab.page
    page.set_viewport_size({"width": 400, "height": 800})
    page.emulate_media(color_scheme="dark")
    shared_lab.tab("The top")
    page.wait_for_selector(READY["The top"])
    dark = """(e) => { while (e) {
        const c = getComputedStyle(e).backgroundColor.match(/[0-9.]+/g).map(Number);
        if (c.length < 4 || c[3] > 0) return Math.max(...c.slice(0, 3)) < 80;
        e = e.parentElement; } }"""
    assert page.locator("#top-plan").evaluate(dark)
    light = "(e) => Math.min(...getComputedStyle(e).color.match(/[0-9]+/g).map(Number)) > 150"
    assert page.locator("#top-result").evaluate(light)
    assert "invert" in page.locator("iframe").evaluate("(e) => getComputedStyle(e).filter")
    # Parts appear one by one: the animation may be present before the old content is removed.
    expect(page.locator("iframe")).to_be_in_viewport(timeout=PATIENCE)
    film = page.locator("iframe").bounding_box()
    # The figure is not hidden by its controls, which a button unfolds below it.
    button = page.get_by_role("button", name="Controls")
    assert film["y"] + 200 < button.bounding_box()["y"]
    watch = page.get_by_label("quantity in the chart")
    expect(watch).not_to_be_visible()
    button.click()
    assert button.get_attribute("aria-expanded") == "true"
    expect(watch).to_be_in_viewport()
    plan = page.locator("#top-plan").bounding_box()
    assert film["y"] < 800
    assert film["y"] < watch.bounding_box()["y"] < plan["y"]
    # This also holds while the page is scrolled with the pointer on the figure.
    page.mouse.move(200, film["y"] + 20)
    page.mouse.wheel(0, 300)
    on_top = """e => { const box = e.getBoundingClientRect();
        return e.contains(document.elementFromPoint(box.x + 9, box.y + box.height / 2)); }"""
    panel = page.locator(".controls.after")
    page.wait_for_function("document.querySelector('#App').scrollTop === 300")
    expect(panel).to_be_in_viewport()
    assert panel.evaluate(on_top)
    assert too_wide(page) == []
    button.click()
    expect(watch).not_to_be_visible()
    page.emulate_media(color_scheme="light")


def test_a_tab_shows_that_it_computes(lab: Watched):
    """While a tab computes, the page reports it, and nothing of the tab before is visible."""
    from playwright.sync_api import expect

    page = lab.tab("Loops")
    page.wait_for_selector("#loop-table, #loop svg")
    waiting = page.get_by_text("Computing ...")
    expect(waiting).not_to_be_visible(timeout=PATIENCE)
    # In one turn of the browser no result can come from the server.
    seen = page.evaluate(
        """async () => {
            const tabs = (root) => [...root.querySelectorAll("*")].flatMap((e) => [
                ...(e.matches('[role="tab"]') ? [e] : []),
                ...(e.shadowRoot ? tabs(e.shadowRoot) : [])]);
            const tab = tabs(document).find((e) => e.textContent.trim() === "What accuracy costs");
            tab.dispatchEvent(new MouseEvent("mousedown", { bubbles: true, button: 0 }));
            tab.click();
            await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
            const visible = (e) => e && e.checkVisibility();
            return [visible(document.querySelector(".computing")),
                    [...document.querySelectorAll('[data-of="1"]')].filter(visible).length];
        }"""
    )
    assert seen == [True, 0]
    page.wait_for_selector("#costs-result", timeout=2 * PATIENCE)
    expect(waiting).not_to_be_visible()


def test_a_change_of_a_control_shows_that_it_computes(lab: Watched):
    """While a result is computed again it stays, with a note that appears after a moment."""
    from playwright.sync_api import expect

    page = lab.tab("The top")
    page.get_by_label("nutation angle over time, by both laws").wait_for()
    waiting = page.get_by_text("Computing ...")
    expect(waiting).not_to_be_visible(timeout=PATIENCE)
    page.evaluate(
        """() => {
            const note = document.querySelector(".computing");
            const look = () => {
                const { display, position, animationDelay } = getComputedStyle(note);
                if (display === "block") window.noted = [
                    position, animationDelay, document.querySelectorAll("#top-result").length];
            };
            new MutationObserver(look).observe(document.body, {
                subtree: true, attributeFilter: ["class"] });
        }"""
    )
    page.get_by_role("slider").first.press("ArrowRight")
    page.wait_for_url("**body=**")
    page.wait_for_function("window.noted", timeout=PATIENCE)
    assert page.evaluate("window.noted") == ["fixed", "0.3s", 1]
    expect(waiting).not_to_be_visible(timeout=PATIENCE)


def test_a_watched_quantity_is_drawn(shared_lab: Watched):
    """Another watched quantity changes the chart and the plan."""
    page = shared_lab.tab("The top")
    page.get_by_label("nutation angle over time, by both laws").wait_for()
    page.get_by_label("quantity in the chart").select_option(label="energy")
    page.get_by_label("energy over time, by both laws").wait_for()
    page.locator("#top-plan").get_by_text("needed for the energy: ").wait_for()
    page.get_by_label("quantity in the chart").select_option(label="nutation angle")
    page.get_by_label("nutation angle over time, by both laws").wait_for()


def test_effects_are_switched(shared_lab: Watched):
    """Gravity without a fixed point is omitted from the equations; with one it is included."""
    page = shared_lab.tab("The top")
    plan = page.locator("#top-plan")
    plan.get_by_text("needed for the nutation angle: 6").wait_for()
    page.get_by_label(re.compile("^gravity")).check()
    plan.locator("tr", has_text=re.compile(r"^\s*omitted.*gravity", re.DOTALL)).first.wait_for()
    page.get_by_label(re.compile("^fixed point")).check()
    plan.locator("tr", has_text=re.compile(r"^\s*included.*gravity", re.DOTALL)).first.wait_for()
    shared_lab.shows("#top-result", "the angular momentum changes in space")
    for effect, left in (("fixed point", "gravity"), ("gravity", "nothing")):
        page.get_by_label(re.compile(f"^{effect}")).uncheck()
        page.wait_for_url(lambda url, left=left: ("effects" in url) == (left != "nothing"))
    plan.get_by_text("needed for the nutation angle: 6").wait_for()


def test_another_space_and_its_cost(shared_lab: Watched):
    """A chosen space has its own coordinates and loop, and the tab of costs measures this case."""
    page = shared_lab.tab("Loops")
    page.wait_for_selector("#loop svg")
    spaces_offered = page.get_by_label("space", exact=True)
    usual = spaces_offered.input_value()
    spaces_offered.select_option(label="heisenberg: the Heisenberg group (Nil)")
    assert f"|b| = {np.pi * 0.3**2:.6g}" in shared_lab.shows(
        "#loop-result", "in the plane of x and y"
    )
    shared_lab.tab("What accuracy costs")
    page.get_by_label("A circle of radius 0.3 in heisenberg").wait_for()
    page.get_by_label("the top", exact=True).click()
    page.get_by_label("The top (free), to t = 12 s").wait_for()
    page.get_by_role("radio", name="the loop").check()
    shared_lab.tab("Loops")
    spaces_offered.select_option(usual)
    shared_lab.shows("#loop-result", "in the plane of φ")


def test_an_exercise_is_answered(shared_lab: Watched):
    """A wrong answer and a right one have their verdicts; a hint is shown."""
    page = shared_lab.tab("Exercises")
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
    page.get_by_label("exercise", exact=True).select_option(
        label=f"1.1 {exercises.titles()['1.1']}"
    )
    page.get_by_label("legs").wait_for()


@pytest.mark.parametrize("kind", ["svg", "png"])
def test_every_picture_can_be_saved(shared_lab: Watched, kind: str):
    """The globe and a chart are saved as files in the format of the button."""
    page = shared_lab.tab("The compass")
    places = {
        "The compass": page.frame_locator("#compass iframe"),
        "Loops": page.locator("#loop"),
    }
    for tab, place in places.items():
        shared_lab.tab(tab).wait_for_selector(READY[tab])
        button = place.locator(f"button[data-save={kind}]").last
        with page.expect_download(timeout=PATIENCE) as saved:
            button.click()
        content = Path(saved.value.path()).read_bytes()
        assert saved.value.suggested_filename.endswith(f".{kind}")
        if kind == "png":
            assert content.startswith(b"\x89PNG")
        else:
            assert ElementTree.fromstring(content).tag == "{http://www.w3.org/2000/svg}svg"
        assert len(content) > 3000


def test_each_picture_has_its_buttons(shared_lab: Watched):
    """Each chart has a button to save it."""
    for tab in ("Loops", "Straightest and shortest", "The top", "What accuracy costs"):
        page = shared_lab.tab(tab)
        page.wait_for_selector(READY[tab])
        charts = page.locator("svg.plot").count()
        assert charts
        assert page.locator("svg.plot + .save [data-save=png]").count() == charts


def test_the_course_moves_the_ships(shared_lab: Watched):
    """Another course changes the figure and the address."""
    page = shared_lab.tab("The compass")
    page.wait_for_selector(READY["The compass"])
    before = page.locator("#compass iframe").get_attribute("srcdoc")
    page.get_by_role("slider", name="course").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_url("**course=80*")
    page.wait_for_function(
        "(old) => document.querySelector('#compass iframe')?.srcdoc !== old", arg=before
    )
    page.get_by_role("slider", name="course").focus()
    page.keyboard.press("ArrowLeft")
    page.wait_for_url(lambda url: "course" not in url)


def test_sliders_name_axis_motion_and_unit(shared_lab: Watched):
    """The label names the axis, rotation or motion, and the unit."""
    page = shared_lab.tab("Straightest and shortest")
    page.wait_for_selector(READY["Straightest and shortest"])
    for name in ("turn about axis 1: u1 in rad/time", "move along axis 3: u6 in length/time"):
        assert page.get_by_role("slider", name=name).count() == 1
