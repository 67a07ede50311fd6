"""Values of controls from outside: a wrong one gets an answer in words, and no traceback."""

from __future__ import annotations

import asyncio
import json
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

import pytest

from geomtorsion.teaching.lab.control_values import Control, ControlValues, ValueRefusedError
from geomtorsion.teaching.lab.guides import TABS
from tests.teaching.lab.serving import served
from tests.teaching.lab.session import PATIENCE, Session, run

WRONG: tuple[Any, ...] = (
    None, True, 3, -1, 2.5, 10**400, "a", "", [], {}, [1], ["x"], [["a", "!"]], [["a", 1]],
    {"a": 1}, {"q0": 1}, [[[]]],
)  # fmt: skip
BODIES = (
    b"", b"{", b"[]", b"null", b"\xff", b"3", b'"a"', b"[" * 100_000,
    b'{"objectIds": ["a"]}', b'{"objectIds": "a", "values": [1]}',
    b'{"objectIds": ["a"], "values": []}', b'{"objectIds": [3], "values": [1]}',
    b'{"objectIds": ["a"], "values": [NaN]}',
)  # fmt: skip


def posted(session: Session, body: bytes, name: str = "") -> tuple[int, str]:
    """Status and text of the answer to a request with values."""
    request = urllib.request.Request(
        f"{session.url}/api/kernel/set_ui_element_value",
        body,
        {
            "Content-Type": "application/json",
            "Marimo-Session-Id": name or session.name,
            "Marimo-Server-Token": session.token,
        },
    )
    try:
        with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
            return reply.status, reply.read().decode()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.read().decode()


def test_wrong_values_get_words_and_no_traceback(tmp_path: Path):
    """Every control of every tab, with values of all types: accepted, or refused with words."""

    async def answers(url: str) -> list[tuple[int, str]]:
        found: list[tuple[int, str]] = []
        async with Session(url) as session:
            await session.shown("compass")
            found += [await asyncio.to_thread(posted, session, body) for body in BODIES]
            whole = b'{"objectIds": [], "values": []}'
            found.append(await asyncio.to_thread(posted, session, whole, "s_nobody"))
            tabs = session.element("marimo-tabs")
            seen = ControlValues()
            seen.open("all")
            for tab in range(len(TABS)):
                await session.set(tabs, str(tab))
                await session.shown(f'data-of="{tab}" data-result')
                for text in session.outputs.values():
                    seen.record("all", json.dumps({"html": text}))
            controls = seen.sessions["all"]
            # Sliders, lists, texts and switches: the page has dozens.
            assert len({control.kind for control in controls.values()}) > 6
            for name in controls:
                for value in WRONG if name != tabs else WRONG[:1]:
                    body = json.dumps({"objectIds": [name], "values": [value]}).encode()
                    found.append(await asyncio.to_thread(posted, session, body))
            # The page still answers.
            await session.set(tabs, "0")
            await session.shown('data-of="0" data-result')
        return found

    log = tmp_path / "errors.txt"
    with log.open("w") as errors, served(errors=errors) as url:
        found = run(answers(url))
    assert "Traceback" not in log.read_text(), log.read_text()[:3000]
    assert {code for code, _ in found} == {200, 400, 404, 422}
    assert [code for code, _ in found[: len(BODIES)]] == [400] * len(BODIES)
    assert all(text.endswith(".") for code, text in found if code != 200)


@pytest.mark.parametrize(
    ("control", "right", "wrong"),
    [
        (Control("slider", 3, ends=(0, 5), whole=True), [0, 5, 2.0], [2.5, 6, -1, "3", True, None]),
        (Control("slider", 0.5, ends=(0.0, 1.0)), [0, 0.3], [1.1, [], 10**400]),
        (Control("number", 0), [7, None, 2.5], ["7", float("nan"), False]),
        (
            Control("dropdown", ["a"], ("a", "b")),
            [["b"]],
            [[], "a", ["c"], [1], [["a"]], ["a", "b"]],
        ),
        (Control("dropdown", [], ("a", "b")), [["b"], []], [["c"]]),
        (Control("radio", None, ("a", "b")), ["a", None], ["c", ["a"], 1]),
        (Control("checkbox", first=False), [True], [0, "true"]),
        (Control("text", ""), ["x"], [1, None, ["x"]]),
        (Control("file", []), [[["m.ang", "QUJD"]], []], [[["m.ang", "!"]], [1], "x"]),
    ],
    ids=lambda one: one.kind if isinstance(one, Control) else "",
)
def test_each_kind_of_control_takes_its_values(control, right, wrong):
    """A value of the right kind fits; any other is refused, with the kind in words."""
    assert [control.fault(value) for value in right] == [""] * len(right)
    assert all(control.fault(value).startswith(f"{control.kind}: expected ") for value in wrong)


def test_values_in_a_form_are_checked():
    """A form has the values of its fields by key."""
    values = ControlValues()
    values.open("s")
    values.sessions["s"] = {
        "form": Control("dict", {"q0": ""}, inner={"q0": "field"}),
        "field": Control("text", ""),
    }
    right = json.dumps({"objectIds": ["form"], "values": [{"q0": "r"}]}).encode()
    assert json.loads(values.checked("s", right)) == json.loads(right)
    for inner in ({"q0": 1}, {"q1": "r"}):
        body = json.dumps({"objectIds": ["form"], "values": [inner]}).encode()
        with pytest.raises(ValueRefusedError, match="expected"):
            values.checked("s", body)
