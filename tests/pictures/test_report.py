"""The report: one self-contained page, well formed and complete, and the same content as data."""

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest

from geomtorsion.geometry.quantities import TABLE
from geomtorsion.pictures.report import widest_gap, write_report
from geomtorsion.spaces import load, read_file
from tests.pictures.test_formula import parsed

DATA = Path(__file__).parent.parent / "data"
VOID = {"meta", "br", "link", "img", "hr", "input"}
SHOWN = [entry for entry in TABLE if entry.reported and entry.of != "connection"]


class Structure(HTMLParser):
    """Parser that checks the order of end tags and collects ids, links and text."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.links: list[str] = []
        self.loads: list[str] = []
        self.pictures: list[str] = []
        self.text = ""

    def handle_starttag(self, tag, attrs):
        given = {name: value or "" for name, value in attrs}
        self.ids += [given["id"]] if "id" in given else []
        self.links += [given["href"]] if tag == "a" else []
        inside = tag == "img" and given["src"].startswith("data:image/svg+xml;base64,")
        self.pictures += [given["alt"]] if inside else []
        self.loads += [tag] if {"src", "srcset", "data"} & given.keys() and not inside else []
        self.loads += [tag] if tag in ("script", "link", "iframe", "object") else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        return

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def structure(html: str) -> Structure:
    """Checked structure of a page."""
    found = Structure()
    found.feed(html)
    found.close()
    assert not found.open
    return found


@pytest.fixture(scope="module")
def so3(tmp_path_factory):
    """Page and data of so3."""
    folder = tmp_path_factory.mktemp("so3")
    page = write_report(load("so3"), folder)
    return page.read_text("utf-8"), json.loads((folder / "geometry.json").read_text("utf-8"))


def test_the_page_is_well_formed(so3):
    """Elements close in order, anchors are unique, links lead to them or to the data."""
    page = structure(so3[0])
    assert len(page.ids) == len(set(page.ids))
    for link in page.links:
        assert link == "geometry.json" or link.removeprefix("#") in page.ids
    formulas = re.findall(r"<math[^>]*>(.*?)</math>", so3[0])
    assert len(formulas) > 80
    for formula in formulas:
        parsed(formula)


def test_the_page_loads_nothing(so3):
    """No script, no address, embedded images; a policy forbids the browser to load anything."""
    assert not structure(so3[0]).loads
    assert "http://" not in so3[0]
    assert "https://" not in so3[0]
    assert so3[0].count("url(") == so3[0].count('url("data:font/') == 1
    assert "default-src 'none'" in so3[0]


def test_the_page_holds_everything(so3):
    """Story, source, all quantities, identities of both connections, and no failed check."""
    page = structure(so3[0])
    assert "angular velocity" in page.text
    assert "FUB-HEP/94-5" in page.text
    assert {entry.name for entry in SHOWN} <= set(page.ids)
    assert page.text.count("second Bianchi") == 2
    assert page.text.count("✓") == 26
    assert "✗" not in page.text


def test_the_data_is_the_same(so3):
    """The JSON holds the same quantities and checks."""
    _, data = so3
    assert list(data["quantities"]) == [entry.name for entry in SHOWN]
    assert data["quantities"]["scalar_curvature"]["components"] == {"": "3/2"}
    checks = [check for found in data["checks"].values() for check in found]
    assert len(checks) == 26
    assert all(check["holds"] for check in checks)


def test_branches_of_roots_are_stated(tmp_path):
    """Schwarzschild's page states the branch with which its root is read."""
    text = write_report(load("schwarzschild"), tmp_path, pictures=False).read_text("utf-8")
    assert "Branches of roots" in text
    assert "is read as" in text
    structure(text)


@pytest.mark.parametrize("name", ["universe", "null", "twisted", "schwarzschild"])
def test_pages_of_files(name, tmp_path):
    """Unknown functions, null frames, own connections and plain metrics give well-formed pages."""
    space = read_file(DATA / f"{name}.toml")
    html = write_report(space, tmp_path, pictures=False).read_text("utf-8")
    page = structure(html)
    for formula in re.findall(r"<math[^>]*>(.*?)</math>", html):
        parsed(formula)
    assert ("connection_torsion" in page.ids) == (space.connection is not None)


def test_names_are_stated_and_used(tmp_path):
    """The page defines the name Delta and uses it in the components."""
    space = load("kerr")
    named = replace(space, frame=space.frame.named(Delta="r**2 - 2*M*r + a**2"))
    plain, html = (
        write_report(one, tmp_path / str(k), pictures=False).read_text("utf-8")
        for k, one in enumerate((space, named))
    )
    assert "<dt>Names</dt>" not in plain
    assert "<dt>Names</dt>" in html
    metric, inverse = html.split('id="metric"')[1].split('id="inverse_metric"')
    assert "Δ" in metric
    assert "Δ" in inverse
    assert "Δ" not in plain.split('id="metric"')[1].split('id="torsion"')[0]
    structure(html)


def test_text_from_a_file_is_escaped(tmp_path):
    """Markup in texts of a space is escaped."""
    evil = "<script>alert(1)</script>"
    space = replace(load("s2"), title=evil, story=evil, source=evil, notes=evil)
    html = write_report(space, tmp_path, pictures=False).read_text("utf-8")
    assert "<script" not in html
    structure(html)


def test_nothing_is_written_when_it_fails(tmp_path):
    """An error during the work leaves no directory."""

    class Stop(Exception):
        pass

    def stop(step: str) -> None:
        if step == "known answers":
            raise Stop

    with pytest.raises(Stop):
        write_report(load("s2"), tmp_path / "report", stop)
    assert not (tmp_path / "report").exists()


def test_the_page_shows_motions_and_a_loop(so3):
    """Motions and loop have text, and figures if matplotlib is installed."""
    page = structure(so3[0])
    assert {"about-motions", "about-closure"} <= set(page.ids)
    assert "straightest and shortest path are one" in page.text
    assert "fails to close by b = (" in page.text
    if "Pictures need matplotlib" not in page.text:
        assert len(page.pictures) == 4
        assert all(page.pictures)


@pytest.mark.parametrize("name", ["schwarzschild_isotropic", "so3_quaternion"])
def test_the_gap_of_the_loop_is_seen(name):
    """The gap is between 3 % and 60 % of the length of the loop."""
    gap = widest_gap(load(name))
    assert 0.03 < gap.magnitude / gap.loop.length < 0.6


@pytest.mark.parametrize("name", ["universe", "null"])
def test_why_there_are_no_motions(name, tmp_path):
    """Unknown functions and null tetrads have no motions; the page is written with the reason."""
    html = write_report(read_file(DATA / f"{name}.toml"), tmp_path).read_text("utf-8")
    assert "No motions: " in structure(html).text
