"""Many students at once: each sends another request, and each gets the right answer."""

from __future__ import annotations

import asyncio

import pytest

from geomtorsion import Loop, burgers_vector, spaces
from geomtorsion.teaching.lab.controls import RADII
from tests.teaching.lab.serving import served
from tests.teaching.lab.session import Session, run

# The larger number exceeds the number of workers.
STUDENTS = [4, pytest.param(30, marks=pytest.mark.slow)]
# Seconds for all sessions together, on two loaded cores.
LIMIT = 120.0


async def student(url: str, place: int) -> float:
    """Open the page, go to the loops, choose a radius, and return the shown |b|."""
    async with Session(url) as session:
        await session.shown('id="compass"')
        await session.set(session.element("marimo-tabs"), "1")
        await session.shown('id="loop-result"')
        radius = session.element("marimo-slider", "radius")
        session.outputs.clear()
        await session.set(radius, place)
        found = await session.shown(r"\|b\| = ([0-9.e+-]+),")
        return float(found[1])


async def all_of_them(url: str, count: int) -> list[float]:
    return await asyncio.gather(*(student(url, 3 + k % 24) for k in range(count)))


@pytest.mark.parametrize("count", STUDENTS)
def test_many_sessions_are_answered(count, address):
    """Many sessions move a slider at once, and each gets its number in time."""
    sizes = run(asyncio.wait_for(all_of_them(address, count), LIMIT))
    assert len(sizes) == count
    frame = spaces.load("so3").frame
    for k, size in enumerate(sizes):
        loop = Loop.circle((0.3, 1.0, 0.2), RADII[3 + k % 24], (0, 1))
        assert size == pytest.approx(burgers_vector(frame, loop).magnitude, rel=1e-5)


def test_one_session_too_many_is_refused():
    """If two pages may be open, the third one gets the message that the lab is full."""

    async def three(url: str) -> tuple[int, str]:
        async with Session(url) as one, Session(url) as two:
            await one.shown("Torsion lab")
            await two.shown("Torsion lab")
            return await asyncio.to_thread(Session(url).get, "/")

    with served("--sessions", "2") as url:
        status, text = run(three(url))
    assert status == 503
    assert "The lab is full: 2 pages are open" in text
