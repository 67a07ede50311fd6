"""Folder: everything is inside, nothing asks other hosts; in a browser, with the network cut."""

from __future__ import annotations

import functools
import http.server
import json
import re
import threading
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import pytest

from geomtorsion.errors import PackageError
from geomtorsion.lab import views
from geomtorsion.lab.live import packages
from geomtorsion.lab.live.folder import PACKAGE, configuration, page, script, write_live, zipped
from geomtorsion.lab.live.guides import UNGRADED
from tests.browser import Watched
from tests.lab.test_tasks import SLOW

# Milliseconds that Python may take to start in the browser of a loaded machine, and to answer.
START, ANSWER = 300_000, 60_000
# Seconds after which a tetrad is stopped in these tests.
LIMIT = 6


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder, written once; what it needs is fetched, or was."""
    target = tmp_path_factory.mktemp("live") / "lab"
    try:
        write_live(target)
    except PackageError as error:
        pytest.skip(str(error))
    index = target / "index.html"
    text = index.read_text("utf-8")
    shorter = re.sub(r'("Any tetrad": )\d+', rf"\g<1>{LIMIT}", text)
    assert shorter != text
    index.write_text(shorter, "utf-8")
    return target


def test_the_page_needs_nothing_else():
    """No address but those of the folder; the browser is told so, too."""
    text = page(configuration(["wheels-0/a.whl"], 1))
    assert "default-src 'none'" in text
    assert "connect-src 'self'" in text
    everything = text + "".join(map(script, ("live.js", "worker.js", "service.js", "live.css")))
    assert not [url for url in re.findall(r"https?://[\w.]+", everything) if "w3.org" not in url]
    for tab in views.TABS:
        assert f">{tab}</button>" in text
    assert "numpy and scipy" in text
    data = re.search(r'id="config">(.*?)</script>', text)
    assert data is not None
    assert json.loads(data[1])["seconds"].keys() < views.TABS.keys()


def test_the_package_is_zipped():
    """All of it but the command line; equal packages give equal bytes."""
    made = zipped(PACKAGE)
    assert made == zipped(PACKAGE)
    names = zipfile.ZipFile(BytesIO(made)).namelist()
    assert "geomtorsion/lab/live/browser.py" in names
    assert "geomtorsion/spaces/__init__.py" in names
    assert not [name for name in names if "/cli/" in name or "__pycache__" in name]


def test_a_folder_is_whole(site: Path):
    """Index, scripts, Python and packages; what changes has another name."""
    names = {path.relative_to(site).as_posix() for path in site.rglob("*") if path.is_file()}
    assert {"index.html", "live.js", "worker.js", "service.js"} <= names
    assert {f"pyodide/{name}" for name in packages.CORE_FILES} <= names
    wheels = {name.rpartition("/")[2] for name in names if name.startswith("wheels-")}
    assert wheels == {*(wheel.file for wheel in packages.WHEELS), "geomtorsion.zip"}


class Quiet(http.server.SimpleHTTPRequestHandler):
    """A static host: files of a folder, and nothing on the screen."""

    def log_message(self, format: str, *args: object) -> None:
        return


@contextmanager
def served_folder(folder: Path, host: type[Quiet] = Quiet) -> Iterator[str]:
    """The address of a folder on a static host."""
    handler = functools.partial(host, directory=str(folder))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/"
    finally:
        server.shutdown()
        server.server_close()


@pytest.fixture(scope="module")
def offline(site: Path, browser: Any) -> Iterator[Watched]:
    """The page, opened once from a static host and then again without any network.

    What the page asked for and logged is checked at the end.
    """
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    opened = context.new_page()
    opened.set_default_timeout(START)
    seen = Watched(opened)
    opened.on("console", lambda m: seen.errors.append(m.text) if m.type == "error" else None)
    opened.on("pageerror", lambda error: seen.errors.append(str(error)))
    opened.on("dialog", lambda dialog: seen.errors.append(dialog.message))
    context.on("request", lambda request: seen.asked.append(request.url))
    with served_folder(site) as address:
        opened.goto(address)
        # Everything is loaded when Python starts to import.
        opened.wait_for_selector("#starting:has-text('starting exact')")
    context.set_offline(True)
    opened.goto(f"{address}?start=flat_polar")
    opened.wait_for_selector("body[data-state=ready] #torsion math")
    yield seen
    context.close()
    assert [url for url in seen.asked if not url.startswith((address, "data:"))] == []
    # What is asked for first, and then taken from what was kept, is told by the browser.
    assert [text for text in seen.errors if "ERR_INTERNET_DISCONNECTED" not in text] == []


def says(
    seen: Watched, tab: str, selector: str, text: str | re.Pattern[str], patience: int = ANSWER
) -> str:
    """Wait until a part of a tab says this; all that it says then."""
    from playwright.sync_api import expect

    part = seen.page.locator(f'[data-tab="{tab}"] {selector}')
    expect(part).to_contain_text(text, use_inner_text=True, timeout=patience)
    return part.inner_text()


def fits(seen: Watched) -> bool:
    """Whether nothing is wider than the window, at two widths."""
    widths = []
    for width in (400, 1280):
        seen.page.set_viewport_size({"width": width, "height": 900})
        widths.append(seen.page.evaluate("document.documentElement.scrollWidth") <= width)
    return all(widths)


def test_a_tetrad_is_typed(offline: Watched):
    """Torsion of the polar frame, none of the Cartesian one; the address keeps what is typed."""
    page = offline.tab("Any tetrad")
    assert page.get_by_label("row 2, dφ", exact=True).input_value() == "r"
    assert "1" in page.locator("#torsion").inner_text()
    entries = {
        "row 1, dr": "cos(phi)", "row 1, dφ": "-r*sin(phi)", "row 2, dr": "sin(phi)",
        "row 2, dφ": "r*cos(phi)",
    }  # fmt: skip
    for label, text in entries.items():
        page.get_by_label(label, exact=True).fill(text)
    says(offline, "Any tetrad", "#torsion", re.compile(r"=\s*0\s+Copy"))
    assert "coframe=cos" in page.url
    assert fits(offline)
    milliseconds = page.locator('[data-tab="Any tetrad"]').get_attribute("data-milliseconds")
    assert int(milliseconds) >= 0


def test_what_is_typed_is_escaped(offline: Watched):
    """It is told beside its entry, as text."""
    page = offline.tab("Any tetrad")
    field = page.get_by_label("row 1, dr", exact=True)
    field.fill("<img src=x onerror=alert(1)>")
    said = says(offline, "Any tetrad", ".fault >> nth=0", "is not part of an expression")
    assert "<img src=x onerror=alert(1)>" in said
    assert page.locator('[data-tab="Any tetrad"] img').count() == 0
    field.fill("1")
    says(offline, "Any tetrad", "#metric", "Copy")


def test_an_exercise_is_answered(offline: Watched):
    """Right, and wrong with what has happened; hints one by one."""
    page = offline.tab("Exercises")
    page.locator('[data-tab="Exercises"] select').select_option(
        "2.1 One coefficient of the Cartan connection"
    )
    says(offline, "Exercises", "h2", "2.1")
    answer = page.locator('[data-tab="Exercises"] textarea')
    answer.fill("2,1,2 = 1/r")
    page.get_by_role("button", name="Check").click()
    says(offline, "Exercises", "#verdict", "not right")
    answer.fill("1,2,2 = 1/r")
    page.get_by_role("button", name="Check").click()
    says(offline, "Exercises", "#verdict", "✓ right")
    page.get_by_role("button", name="Next hint").click()
    page.wait_for_selector("#hints li")
    assert fits(offline)


def test_the_list_marks_exercises_that_need_numbers(offline: Watched):
    """Before one is opened, below a heading; the page does not grow wider, and says why."""
    page = offline.tab("Exercises")
    listed = page.locator('[data-tab="Exercises"] select')
    marked = listed.locator('optgroup[label*="not in this page"] option').all_inner_texts()
    assert {text.split()[0] for text in marked} == UNGRADED
    listed.select_option(marked[0])
    says(offline, "Exercises", '[data-part="result"]', "this needs numpy")
    assert fits(offline)


def test_loops_curves_and_tops_in_closed_form(offline: Watched):
    """b of a screw, equations of curves, Euler's equations; what is missing is said."""
    page = offline.tab("Loops")
    page.locator('[data-tab="Loops"] select').first.select_option(
        "screw_dislocation: screw dislocation along z"
    )
    says(offline, "Loops", "#loop-said", "runs round a line")
    assert fits(offline)
    offline.tab("Straightest and shortest")
    says(offline, "Straightest and shortest", "#paths-said", "torsion force")
    assert fits(offline)
    offline.tab("The top")
    says(offline, "The top", "#top-said", "the same, exactly")
    assert fits(offline)
    page = offline.tab("What accuracy costs")
    assert page.get_by_text("numpy and scipy have no builds for browsers").is_visible()


def test_a_hostile_tetrad_ends_its_worker(offline: Watched):
    """It is stopped after its time; the page lives on, and a new worker answers."""
    page = offline.tab("Any tetrad")
    page.get_by_label("start from").select_option("blank, 4 coordinates")
    page.wait_for_selector('[data-tab="Any tetrad"] [data-name="3,3"]')
    says(offline, "Any tetrad", "#metric", "Copy")
    page.locator('[data-tab="Any tetrad"] summary').first.click()
    page.get_by_label("Weyl tensor").check()
    names = page.get_by_label("coordinates", exact=True)
    names.fill(", ".join(SLOW["coordinates"].split()))
    says(offline, "Any tetrad", ".tetrad", "row 1, da")
    for i, row in enumerate(SLOW["entries"]):
        for k, text in enumerate(row):
            page.locator(f'[data-name="{i},{k}"]').fill(text)
    says(offline, "Any tetrad", '[data-part="problem"]', f"takes longer than the {LIMIT} s")
    page.wait_for_selector("body[data-state=ready]")
    page.get_by_label("start from").select_option(index=0)
    says(offline, "Any tetrad", "#torsion", "sin", START)
    page = offline.tab("Exercises")
    page.locator('[data-tab="Exercises"] select').select_option(
        "2.1 One coefficient of the Cartan connection"
    )
    says(offline, "Exercises", "h2", "2.1")
    page.locator('[data-tab="Exercises"] textarea').fill("1,2,2 = 1/r")
    page.get_by_role("button", name="Check").click()
    says(offline, "Exercises", "#verdict", "✓ right")


# In the place of Python: it answers after a while, with what it was asked for and its form; one
# whose text begins with "new" is of another shape.
FAKE = """
onmessage = ({ data }) => {
  if (data.kind === "start") return postMessage({ kind: "ready" });
  const { values, changed, tab } = JSON.parse(data.request);
  if (values.text === "crash") throw new Error("on purpose");
  const controls = '<input type="text" data-name="text"><input type="text" data-name="more">'
    + '<input type="checkbox" data-name="tick">';
  const shape = values.text?.startsWith("new") ? "b" : "a";
  const result = JSON.stringify([values, changed]).replaceAll("<", "");
  const reply = JSON.stringify({ controls, shape, parts: { result }, kept: {} });
  setTimeout(() => postMessage({ kind: "reply", reply }), 600);
};
"""


class Bare(Quiet):
    """A static host without a page under the address of a folder."""

    def do_GET(self) -> None:
        if self.path == "/":
            self.send_error(404)
        else:
            super().do_GET()


@pytest.fixture
def scripted(tmp_path: Path, browser: Any) -> Iterator[Any]:
    """The page with its scripts, but without Python, on a host that serves no folders."""
    (tmp_path / "index.html").write_text(page(configuration([], 1)), "utf-8")
    for name in ("live.js", "service.js"):
        (tmp_path / name).write_text(script(name), "utf-8")
    (tmp_path / "worker.js").write_text(FAKE, "utf-8")
    context = browser.new_context()
    with served_folder(tmp_path, Bare) as address:
        opened = context.new_page()
        opened.goto(f"{address}index.html")
        opened.wait_for_selector("body[data-state=ready]")
        yield opened
    context.close()


def field(opened: Any, tab: str, name: str) -> Any:
    """A field of a tab."""
    return opened.locator(f'[data-tab="{tab}"] [data-name={name}]')


def asked(opened: Any, tab: str, text: str) -> Any:
    """What was asked for last, when it is about a text: values and what has changed."""
    part = opened.locator(f'[data-tab="{tab}"] [data-part=result]', has_text=text)
    part.wait_for(timeout=ANSWER, state="attached")
    return json.loads(part.inner_text() or part.text_content())


def test_a_host_without_pages_of_folders(scripted: Any):
    """What cannot be kept keeps nobody waiting: the page starts, and what can be is kept."""
    asked(scripted, "Any tetrad", "[")
    kept = "caches.keys().then(k => caches.open(k[0])).then(c => c.keys()).then(k => k.length)"
    scripted.wait_for_function("() => navigator.serviceWorker.controller")
    assert scripted.evaluate(kept) >= 2


def test_every_field_waits_for_itself(scripted: Any):
    """What is typed in one tab is asked for, though somebody types in another at once."""
    asked(scripted, "Any tetrad", "[")
    scripted.get_by_role("tab", name="Loops").click()
    asked(scripted, "Loops", "[")
    scripted.evaluate(
        """() => {
            for (const tab of ["Any tetrad", "Loops"]) {
                const field = document.querySelector(`[data-tab="${tab}"] [data-name=text]`);
                field.value = "typed";
                field.dispatchEvent(new Event("input", { bubbles: true }));
            }
        }"""
    )
    assert asked(scripted, "Loops", "typed")[1] == ["text"]
    assert asked(scripted, "Any tetrad", "typed")[1] == ["text"]


def test_what_changes_while_python_works_stays(scripted: Any):
    """Two texts and a box, though the form is drawn anew under them; all of them count."""
    asked(scripted, "Any tetrad", "[")
    text, more, tick = (field(scripted, "Any tetrad", name) for name in ("text", "more", "tick"))
    text.fill("new")
    scripted.wait_for_selector('[data-tab="Any tetrad"][aria-busy=true]')
    scripted.evaluate(
        """() => {
            const [text, more, tick] = document.querySelectorAll('[data-tab="Any tetrad"] input');
            [text.value, more.value, tick.checked] = ["new!", "late", true];
        }"""
    )
    values, changed = asked(scripted, "Any tetrad", "late")
    assert values == {"text": "new!", "more": "late", "tick": "true"}
    assert sorted(changed) == ["more", "text", "tick"]
    assert (text.input_value(), more.input_value(), tick.is_checked()) == ("new!", "late", True)


def test_a_worker_that_breaks_down(scripted: Any):
    """It is said at once, a new one begins, and answers."""
    asked(scripted, "Any tetrad", "[")
    field(scripted, "Any tetrad", "text").fill("crash")
    problem = scripted.locator(
        '[data-tab="Any tetrad"] [data-part=problem]', has_text="worker ended"
    )
    problem.wait_for()
    scripted.wait_for_selector("body[data-state=ready]")
    field(scripted, "Any tetrad", "text").fill("well")
    assert asked(scripted, "Any tetrad", "well")[0]["text"] == "well"


@pytest.mark.slow
def test_a_link_that_asks_too_much(offline: Watched):
    """Whoever follows it is told, and gets a form to begin with."""
    page = offline.page
    coframe = ";".join("|".join(row) for row in SLOW["entries"])
    kept = {"coordinates": SLOW["coordinates"], "coframe": coframe, "signature": "++++"}
    query = urlencode(kept | {"show": "weyl"})
    page.goto(f"{page.url.partition('?')[0]}?{query}")
    page.wait_for_selector("body[data-state=ready]")
    says(offline, "Any tetrad", '[data-part="problem"]', f"longer than the {LIMIT} s", START)
    says(offline, "Any tetrad", "#torsion", "sin", START)
    assert page.get_by_label("coordinates", exact=True).input_value() == "phi1, phi2, phi3"
