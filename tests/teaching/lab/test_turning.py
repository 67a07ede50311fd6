"""Rotating figures in space in a real browser: an animation that runs, keys that rotate it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from geomtorsion.pictures.style import SERIES
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.turning import Curve, Film, turnable
from tests.browser import WINDOW, hosted

TIMES = 241
# The frame of the animation after half of its time, within one frame.
HALF = range(TIMES // 2 - 1, TIMES // 2 + 2)
INK = "e => [...e.getContext('2d').getImageData(0, 0, e.width, e.height).data].join()"


@pytest.fixture
def animation(browser: Any, tmp_path: Path) -> Iterator[Any]:
    """A page with an animation whose clock the test sets, in a window of its own."""
    points = [(k / 10, k % 7, k % 5) for k in range(TIMES)]
    scene = Film(
        "a", "An animation", ("x", "y", "z"), (Curve(points, SERIES[0]),), times=range(TIMES)
    )
    (tmp_path / "animation.html").write_text(turnable(scene), "utf-8")
    context = browser.new_context(viewport=WINDOW)
    page = context.new_page()
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.clock.install(time=0)
    with hosted(tmp_path / "animation.html") as address:
        page.goto(address)
        page.clock.pause_at(1000)
        yield page
    context.close()
    assert wrong == []


def picture(page: Any) -> int:
    """Number of the shown frame of the animation."""
    return int(page.locator("#time").input_value())


def test_an_animation_takes_its_time(animation: Any):
    """After half of the time, half of the animation is shown, although screen frames differ."""
    play = animation.locator("#play")
    play.click()
    assert play.inner_text() == "Pause"
    animation.clock.run_for(500 * PAGE.duration)
    assert picture(animation) in HALF
    play.click()
    assert play.inner_text() == "Play"
    animation.clock.run_for(1000)
    assert picture(animation) in HALF
    play.click()
    animation.clock.run_for(500 * PAGE.duration + 100)
    assert (picture(animation), play.inner_text()) == (TIMES - 1, "Play")


def test_an_animation_started_often_runs_once(animation: Any):
    """Many clicks before the first frame start the animation once."""
    animation.locator("#play").evaluate("e => { for (let k = 0; k < 7; k++) e.click(); }")
    animation.clock.run_for(500 * PAGE.duration)
    assert picture(animation) in HALF


def test_keys_of_the_browser_stay_its_own(animation: Any):
    """Arrows rotate the figure and plus enlarges it, but not with Control, Alt or Meta."""
    canvas = animation.locator("#space")
    canvas.focus()
    shown = canvas.evaluate(INK)
    for key in ("Control++", "Alt+ArrowLeft", "Meta+-"):
        animation.keyboard.press(key)
        assert canvas.evaluate(INK) == shown
    for key in ("+", "ArrowLeft"):
        animation.keyboard.press(key)
        assert canvas.evaluate(INK) != shown
        shown = canvas.evaluate(INK)


def test_a_cone_is_filled_once(browser: Any, tmp_path: Path):
    """A cone is a pale surface, which does not darken where its curve runs around twice."""
    shades = []
    for turns in (1, 2):
        angles = [turns * k * 2 * math.pi / 80 for k in range(81)]
        rim = Curve([(math.cos(a), math.sin(a), 1) for a in angles], SERIES[0], cone=True)
        path = tmp_path / f"cone{turns}.html"
        path.write_text(turnable(Film("cone", "A cone", ("", "", ""), (rim,))), "utf-8")
        page = browser.new_page(viewport=WINDOW)
        with hosted(path) as address:
            page.goto(address)
            # Pixels of the surface only: 18 % of full opacity. They are counted in the browser,
            # which takes half a minute to send them.
            shades.append(
                page.locator("#space").evaluate(
                    """(e, shade) => e.getContext('2d').getImageData(0, 0, e.width, e.height).data
                        .filter((value, k) => k % 4 === 3 && value === shade).length""",
                    round(0.18 * 255),
                )
            )
        page.close()
    assert shades[0] > 5000
    assert shades[1] == pytest.approx(shades[0], rel=0.02)
