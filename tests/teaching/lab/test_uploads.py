"""Files that a user uploads: recognised by content, read, or refused with a sentence."""

# Tests pass wrong types on purpose, as users do, and read attributes that may be missing.
# pyright: reportArgumentType=false

from __future__ import annotations

import base64
import io
import pickle
from collections.abc import Iterator
from math import radians, sin
from pathlib import Path
from typing import Any
from urllib.error import HTTPError

import numpy as np
import pytest

from geomtorsion import SampledFrame
from geomtorsion.errors import FileFormatError, GeomtorsionError, LimitError
from geomtorsion.materials.images import LatticePhases
from geomtorsion.materials.maps import OrientationMap
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.uploads import kind_of, read_map
from tests.browser import Watched, loaded, opened
from tests.real import real
from tests.teaching.lab.maps import STEP, TILT, TWIST, atoms, bomb, saved, twisted, wall_ctf
from tests.teaching.lab.session import Session, run

# Width of a phone and of a screen, in pixels.
NARROW, BROAD = 400, 1280
# Width of an element, and whether nothing is wider than the window.
WIDTH = "e => e.getBoundingClientRect().width"
WIDE = "() => document.documentElement.scrollWidth <= document.documentElement.clientWidth"


def fits(page: Any) -> bool:
    """Whether nothing is wider than the window, on a screen and on a phone."""
    found = []
    for width in (BROAD, NARROW):
        page.set_viewport_size({"width": width, "height": 900})
        found.append(page.evaluate(WIDE))
    return all(found)


class Trap:
    """An object that fails the test when it is unpickled."""

    def __reduce__(self):
        return (pytest.fail, ("a file was unpickled",))


def objects() -> bytes:
    """An archive whose array holds pickled objects."""
    stream = io.BytesIO()
    np.savez(stream, axis_x=np.arange(5.0), axis_y=np.arange(5.0), coframe=np.array([Trap()]))
    return stream.getvalue()


def nowhere() -> bytes:
    """A grid with NaN at every node."""
    stream = io.BytesIO()
    line = np.arange(9.0)
    np.savez(stream, axis_x=line, axis_y=line, coframe=np.full((2, 2, 9, 9), np.nan))
    return stream.getvalue()


def npy(array: np.ndarray) -> bytes:
    """Content of an .npy file with the array."""
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


@pytest.mark.parametrize("end", [".npz", ".csv"])
def test_a_sampled_frame_is_read_whatever_its_name(tmp_path: Path, end: str):
    """Both formats of saved frames are recognised, although the file has another name."""
    frame = twisted()
    content = saved(frame, tmp_path, end)
    assert kind_of(content) == end
    found = read_map(content, "photo.png")
    assert isinstance(found, SampledFrame)
    assert np.allclose(found.coframe, frame.coframe)
    assert found.sigma is not None
    assert found.unit == "um"


def test_an_orientation_map_is_read():
    """A .ctf file is recognised by its first line."""
    found = read_map(wall_ctf(), "table.csv")
    assert isinstance(found, OrientationMap)
    assert found.shape == (20, 24)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "empty"),
        (b"  \n\n", "empty"),
        (b"\x89PNG\r\n\x1a\n" + bytes(50), "truncated"),
        (b"II*\x00" + bytes(50), "truncated"),
        (b"\x93NUMPY" + bytes(50), "truncated"),
        (npy(np.array([Trap()])), "map.npz"),
        (
            npy(np.zeros((2000, 2000), np.uint8)),
            "expected at most 1,048,576 pixels, got an image of 4,000,000",
        ),
        (npy(np.full((64, 64), np.nan)), "not finite"),
        (npy(np.random.default_rng(0).normal(size=(64, 64))), "no visible lattice"),
        (b"\xff\xd8\xff" + bytes(50), "JPEG"),
        (nowhere(), "expected values at some nodes, got none"),
        (wall_ctf().replace(b"\r\n1\t", b"\r\n0\t"), "got phase 0 (not indexed) for all"),
        (wall_ctf().replace(b"\r\n1\t5.0", b"\r\n1\t5.3", 1).replace(b"5.3", b"5.7", 1), "mixed"),
        (wall_ctf().replace(b"\r\n1\t7.0", b"\r\n4\t7.0", 1), "without an orientation, got 4"),
        (wall_ctf().replace(b"Euler2", b"Angle2"), "expected a column Euler2"),
        (pickle.dumps(Trap()), "pickle"),
        (objects(), "map.npz"),
        (bomb(), "unpacked bytes"),
        (b"PK\x03\x04" + bytes(40), "archive"),
        (bytes(range(256)) * 9, "without a header of columns"),
        (b"__import__('os').system('true')", "without a header of columns"),
        (b"x,y,e_0_0,e_0_1\n0,0,__import__('os'),1\n", "line 2"),
        (b"x,y,e_0_0,e_0_1\n0,0,1\n", "line 2"),
        (wall_ctf()[:3000], "Is the file complete?"),
        (wall_ctf().replace(b"Nickel\t11", b"Nickel\t99"), "line"),
        (wall_ctf()[:900].replace(b"XCells\t24", b"XCells\t9999999999"), "XCells"),
        (b"# HEADER\n 1 2 3 4 5 6 7 8\n", "map.npz"),
    ],
    ids=range(27),
)
def test_hostile_and_damaged_files_are_refused(content: bytes, words: str):
    """An error of our own names the problem and no path of this machine."""
    with pytest.raises(GeomtorsionError) as told:
        read_map(content, "map.npz")
    assert words in str(told.value)
    assert "given-map" not in str(told.value)
    assert "/tmp" not in str(told.value)


@pytest.mark.parametrize("end", [".npz", ".csv", ".ctf"])
def test_a_file_cut_anywhere_is_refused_or_read(tmp_path: Path, end: str):
    """A file cut at any of 40 places is a readable map or raises an error of our own."""
    content = wall_ctf() if end == ".ctf" else saved(twisted((9, 8)), tmp_path, end)
    refused = 0
    for k in range(0, len(content), max(1, len(content) // 40)):
        try:
            read_map(content[:k], "map")
        except GeomtorsionError:
            refused += 1
    # A table cut at the end of a line is a smaller table, with holes, so fewer cuts are refused.
    assert refused >= (20 if end != ".csv" else 5)


@pytest.mark.parametrize("end", [".npy", ".png", ".tif"])
def test_a_picture_of_a_lattice_is_read(end: str):
    """An image of a lattice is read in each format, with its lattice, under any name."""
    found = read_map(atoms(end), "data.csv")
    assert isinstance(found, LatticePhases)
    assert np.hypot(*found.lattice.T) == pytest.approx([8, 8], rel=0.01)


def test_a_map_with_too_many_nodes_is_refused():
    """A map with the maximal number of nodes is read; a larger one is refused."""
    most = PAGE.nodes
    stream = io.BytesIO()
    for extra in (0, 1):
        stream = io.BytesIO()
        values = np.zeros((1, 2, most // 10 + extra, 10), np.float32)
        axes = {"axis_x": np.arange(most // 10 + extra), "axis_y": np.arange(10)}
        np.savez_compressed(stream, coframe=values, **axes)
        if extra:
            with pytest.raises(LimitError, match="expected a map of at most"):
                read_map(stream.getvalue(), "map")
        else:
            assert read_map(stream.getvalue(), "map") is not None


def test_a_damaged_archive_is_refused():
    """An archive without its last 30 bytes is refused as incomplete."""
    with pytest.raises(FileFormatError, match="complete"):
        read_map(bomb()[:-30], "map")


async def give(session: Session, field: str, name: str, content: bytes) -> None:
    """Upload a file as a browser does; forget the shown outputs."""
    session.outputs.clear()
    await session.set(field, [[name, base64.b64encode(content).decode()]])


def test_a_session_gives_good_maps_and_bad_ones(tmp_path: Path, address: str):
    """A frame, bad files, an image and a map: each gets an answer, and none stops the page."""
    frame = saved(twisted(), tmp_path, ".npz")

    async def visit(url: str) -> dict[str, str]:
        seen = {}
        async with Session(url) as session:
            await session.shown('id="compass"')
            await session.set(session.element("marimo-tabs"), "1")
            await session.shown("A map or an image of your own")
            field = session.element("marimo-file")
            await give(session, field, "twisted.npz", frame)
            await session.shown("twisted.npz is a sampled frame of 24 × 20 nodes")
            seen["frame"] = (await session.shown(r"\|b\| = ([0-9.e+-]+) um"))[1]
            for name, content, words in (
                ("<b>x</b>", b"\x80\x04.", "a pickle"),
                ("bomb.npz", bomb(), "unpacked bytes"),
                ("long", bytes(PAGE.upload + 1), "expected a file of at most 4,000,000 bytes"),
            ):
                await give(session, field, name, content)
                await session.shown(words)
                assert not any("<b>x</b>" in text for text in session.outputs.values())
                assert not any("Traceback" in text for text in session.outputs.values())
            # Values that no browser sends are refused.
            for odd in (5, [["a", "no base64"]], [[1, 2]], [[]]):
                with pytest.raises(HTTPError, match="422"):
                    await session.set(field, odd)
            await give(session, field, "atoms.png", atoms(".png"))
            await session.shown("atoms.png is an image of 256 × 256 pixels")
            seen["whole"] = (await session.shown(r"b = \(([0-9−, ]+)\) in lattice vectors"))[1]
            await give(session, field, "wall.ctf", wall_ctf())
            await session.shown("wall.ctf is an orientation map of 20 × 24 pixels")
            seen["wall"] = (await session.shown(r"Nickel\. Components are along the axes"))[0]
        return seen

    seen = run(visit(address))
    # The first circuit has an eighth of the shorter side.
    assert float(seen["frame"]) == pytest.approx(TWIST * (2 * STEP) ** 2)
    assert seen["wall"]
    # The first circuit runs through the middle of the image, around the core.
    assert seen["whole"] == "−1, 0"


@pytest.mark.parametrize("name", ["si_wafer.ctf", "sdss_ferrite_austenite.ang"])
def test_measured_maps_are_read(name: str):
    """The measured maps are read, if the files are available."""
    assert isinstance(read_map(real(f"ebsd/{name}").read_bytes(), "given"), OrientationMap)


@pytest.fixture(scope="module")
def file_page(context: Any, address: str) -> Iterator[Watched]:
    """A page for files, loaded once: each upload replaces the previous one."""
    seen = loaded(opened(context), address)
    seen.page.set_viewport_size({"width": NARROW, "height": 900})
    seen.tab("Loops")
    seen.page.wait_for_selector("#loop svg")
    yield seen
    seen.page.close()


@pytest.fixture
def loops_tab(file_page: Watched) -> Iterator[Watched]:
    """The page for files; a logged error fails the test."""
    yield file_page
    assert file_page.errors == []


def test_a_picture_of_a_lattice_in_a_browser(loops_tab: Watched, tmp_path: Path):
    """An uploaded image shows whole lattice vectors; a circuit outside the image is refused."""
    page: Any = loops_tab.page
    file = tmp_path / "atoms.png"
    file.write_bytes(atoms(".png"))
    page.locator("input[type=file]").set_input_files(str(file))
    loops_tab.shows("#map-facts", "atoms.png is an image of 256 × 256 pixels of a lattice")
    loops_tab.shows("#map-result", "b = (−1, 0) in lattice vectors, exactly")
    assert page.locator("#map svg image").first.evaluate(WIDTH) > 150
    assert page.locator("#map svg #circuit").count() == 2
    slider = page.get_by_role("slider", name="centre x in pixels")
    slider.focus()
    page.keyboard.press("Home")
    loops_tab.shows("#map-result", "leaves the image")
    assert fits(page)


def test_grains_and_symmetry_are_chosen_in_a_browser(loops_tab: Watched, tmp_path: Path):
    """A finer threshold or another Laue group splits the wall; the circuit remains."""
    page: Any = loops_tab.page
    file = tmp_path / "wall.ctf"
    file.write_bytes(wall_ctf())
    page.locator("input[type=file]").set_input_files(str(file))
    loops_tab.shows("#map-facts", "(Nickel: m-3m), 1 grain at 5°")
    slider = page.get_by_role("slider", name="least angle between grains in degrees")
    slider.focus()
    page.keyboard.press("Home")
    loops_tab.shows("#map-facts", "2 grains at 0.5°")
    loops_tab.shows("#map-result", "crosses a boundary")
    page.keyboard.press("End")
    loops_tab.shows("#map-facts", "1 grain at 20°")
    page.get_by_label("Laue group").select_option("mmm")
    loops_tab.shows("#map-facts", "(Nickel: mmm), 2 grains at 20°")
    page.get_by_label("shown phase", exact=True).select_option("1: Nickel")
    page.get_by_label("Laue group").select_option("4/m")
    loops_tab.shows("#map-facts", "(Nickel: 4/m), 1 grain at 20°")
    loops_tab.shows("#map-result", "Circuit of 2 × 2 cells: |b| =")
    assert fits(page)


def test_a_map_in_a_browser(loops_tab: Watched, tmp_path: Path):
    """An uploaded map shows numbers and a figure, the side can be changed, and the page fits."""
    page: Any = loops_tab.page
    file = tmp_path / "wall.ctf"
    file.write_bytes(wall_ctf())
    page.locator("input[type=file]").set_input_files(str(file))
    loops_tab.shows("#map-facts", "wall.ctf is an orientation map of 20 × 24 pixels (Nickel: m-3m)")
    b = 2 * 2 * sin(radians(TILT) / 2)
    loops_tab.shows("#map-result", f"Circuit of 2 × 2 cells: |b| = {b:.4g} um")
    image = page.locator("#map svg image").first
    assert image.evaluate(WIDTH) > 150
    slider = page.get_by_role("slider", name="side of the square in pixels")
    slider.focus()
    page.keyboard.press("ArrowRight")
    loops_tab.shows("#map-result", f"Circuit of 3 × 3 cells: |b| = {1.5 * b:.4g} um")
    assert fits(page)
    page.get_by_label("unit of the map").click()
    page.get_by_role("slider", name="side of the square in um").wait_for()
