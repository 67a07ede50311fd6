"""Speed of the page: time from a moved slider to the new picture, in a real browser.

Run with `python -m pytest tests/benchmarks/test_page_speed.py -s`. The test asserts that each
movement changes the picture, and no time.
"""

from __future__ import annotations

import statistics

import pytest

from tests.browser import (  # noqa: F401 (fixtures)
    Watched,
    address,
    browser,
    context,
    lab,
    watched,
)

# Milliseconds from the next key to the next change of the text about the loop.
TIMING = """(before) => {
    let pressed = 0;
    const press = () => { pressed = performance.now(); };
    window.addEventListener("keydown", press, { capture: true, once: true });
    window.moved = new Promise((done) => {
        const look = () => {
            const text = document.querySelector("#loop-result")?.innerText;
            if (text && text !== before) done(performance.now() - pressed);
            else requestAnimationFrame(look);
        };
        look();
    });
}"""


def test_from_slider_to_picture(lab: Watched, capsys: pytest.CaptureFixture[str]):  # noqa: F811 (the fixture)
    """Each of ten key presses on the slider of the radius changes the result of the loop."""
    page = lab.tab("Loops")
    page.wait_for_selector("#loop svg")
    page.get_by_role("slider").first.focus()
    took = []
    for _ in range(10):
        page.evaluate(TIMING, lab.shows("#loop-result", "|b| = "))
        page.keyboard.press("ArrowRight")
        took.append(page.evaluate("() => window.moved"))
    assert min(took) > 0
    with capsys.disabled():
        print(f"\nslider to picture: {statistics.median(took):.0f} ms, at most {max(took):.0f}")
