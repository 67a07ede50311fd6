"""A map that is given to the page: through a session, hostile ones too, and in a browser."""

from __future__ import annotations

import base64
from math import radians, sin
from pathlib import Path
from typing import Any

import pytest

from geomtorsion.lab.settings import PAGE
from tests.browser import Watched
from tests.lab.maps import STEP, TILT, TWIST, bomb, saved, twisted, wall_ctf
from tests.lab.serving import served
from tests.lab.session import Session, run


async def give(session: Session, field: str, name: str, content: bytes) -> None:
    """Put a file into the field, as the browser does; what was shown before is forgotten."""
    session.outputs.clear()
    await session.set(field, [[name, base64.b64encode(content).decode()]])


def test_a_session_gives_good_maps_and_bad_ones(tmp_path: Path):
    """A frame, then what is none, then an orientation map: each answered, none stops the page."""
    frame = saved(twisted(), tmp_path, ".npz")

    async def visit(url: str) -> dict[str, str]:
        seen = {}
        async with Session(url) as session:
            await session.shown("Cartan connection")
            await session.set(session.element("marimo-tabs"), "1")
            await session.shown("A map of your own")
            field = session.element("marimo-file")
            await give(session, field, "twisted.npz", frame)
            await session.shown("twisted.npz is a sampled frame of 24 × 20 nodes")
            seen["frame"] = (await session.shown(r"\|b\| = ([0-9.e+-]+) um"))[1]
            for name, content, said in (
                ("<b>x</b>", b"\x80\x04.", "a pickle"),
                ("bomb.npz", bomb(), "unpacks up to"),
                ("long", bytes(PAGE.upload + 1), "takes up to 4,000,000"),
            ):
                await give(session, field, name, content)
                await session.shown(said)
                assert not any("<b>x</b>" in text for text in session.outputs.values())
                assert not any("Traceback" in text for text in session.outputs.values())
            await give(session, field, "wall.ctf", wall_ctf())
            await session.shown("wall.ctf is an orientation map of 20 × 24 pixels")
            seen["wall"] = (await session.shown("Nickel; components along the axes"))[0]
        return seen

    with served() as url:
        seen = run(visit(url))
    # The first circuit has an eighth of the shorter side.
    assert float(seen["frame"]) == pytest.approx(TWIST * (2 * STEP) ** 2)
    assert seen["wall"]


@pytest.mark.parametrize("width", [1280, 400])
def test_a_map_in_a_browser(lab: Watched, tmp_path: Path, width: int):
    """The file chosen, the circuit moved: numbers, picture, and nothing wider than the window."""
    page: Any = lab.page
    page.set_viewport_size({"width": width, "height": 900})
    lab.tab("Loops")
    page.wait_for_selector("#loop svg")
    file = tmp_path / "wall.ctf"
    file.write_bytes(wall_ctf())
    page.locator("input[type=file]").set_input_files(str(file))
    lab.says("#map-facts", "wall.ctf is an orientation map of 20 × 24 pixels (Nickel)")
    b = 2 * 2 * sin(radians(TILT) / 2)
    lab.says("#map-said", f"Circuit of 2 × 2 cells: |b| = {b:.4g} um")
    image = page.locator("#map svg image").first
    assert image.evaluate("e => e.getBoundingClientRect().width") > 150
    slider = page.get_by_role("slider", name="side in pixels")
    slider.focus()
    page.keyboard.press("ArrowRight")
    lab.says("#map-said", f"Circuit of 3 × 3 cells: |b| = {1.5 * b:.4g} um")
    wide = "() => document.documentElement.scrollWidth <= document.documentElement.clientWidth"
    assert page.evaluate(wide)
    page.screenshot(path=str(tmp_path / f"map-{width}.png"), full_page=True)
    page.locator("#map").scroll_into_view_if_needed()
    page.screenshot(path=str(tmp_path / f"seen-{width}.png"))
    page.get_by_label("unit of the map").click()
    page.get_by_role("slider", name="side in um").wait_for()
