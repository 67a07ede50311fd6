"""Make the pictures of the README and the home page: python examples/site/pictures/make.py.

closure.png needs the extra `plots`; classroom.png needs the extra `test` and a browser.
"""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[2]))

import geomtorsion as gt  # noqa: E402  # the one of this checkout

RESOLUTION = 100  # dots per inch
WINDOW = {"width": 1200, "height": 770}
# Milliseconds after which the page has drawn the tab.
DRAWN = 12_000


def closure() -> None:
    """A closed circle in the rotation angles, and its open image in the frame of SO(3)."""
    so3 = gt.spaces.load("so3").frame
    b = gt.burgers_vector(so3, gt.Loop.circle([0.3, 1.0, 0.2], 0.7))
    gt.pictures.save(gt.pictures.draw_closure(b), HERE / "closure.png", RESOLUTION)


def classroom() -> None:
    """The tab "Loops" of the classroom page in a browser."""
    from playwright.sync_api import sync_playwright  # part of the extra `test`

    from tests.teaching.lab.serving import served

    with served() as address, sync_playwright() as driver:
        options = ["--headless", "--no-sandbox", "--disable-gpu"]
        path = next((one for one in map(Path, BROWSERS) if one.exists()), None)
        browser = driver.chromium.launch(executable_path=path, args=options)
        page = browser.new_page(viewport={"width": WINDOW["width"], "height": WINDOW["height"]})
        page.goto(address)
        page.get_by_role("tab", name="Loops", exact=True).click()
        page.wait_for_timeout(DRAWN)
        page.screenshot(path=HERE / "classroom.png")
        browser.close()


BROWSERS = ("/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome")

if __name__ == "__main__":
    closure()
    classroom()
