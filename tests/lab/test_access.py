"""The access control: who may come in, how much they may carry, and what the browser is told."""

from __future__ import annotations

import http.client
import json
import subprocess
import sys
import urllib.error
import urllib.parse
import urllib.request
from typing import Any

import pytest

from geomtorsion.errors import LimitError
from geomtorsion.lab.access import AccessControl
from geomtorsion.lab.server import Address, _socket
from geomtorsion.lab.settings import PAGE
from tests.lab.serving import ROOT, served
from tests.lab.session import run

OPEN = ("default-src 'self'", "connect-src 'self'")


async def inner(scope: Any, receive: Any, send: Any) -> None:
    """An application that reads what it is sent and says hello."""
    more = True
    while more:
        message = await receive()
        if message["type"] == "http.disconnect":
            return
        more = message.get("more_body", False)
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"hello"})


def ask(
    control: AccessControl,
    headers: dict[str, str],
    method: str = "GET",
    path: str = "/",
    bodies: Any = (b"",),
) -> tuple[int, dict[str, str]]:
    """Status and headers of what the access control answers; 0 if it hangs up."""
    sent: list[dict[str, Any]] = []
    parts = list(bodies)

    async def receive() -> dict[str, Any]:
        body = parts.pop(0)
        return {"type": "http.request", "body": body, "more_body": bool(parts)}

    async def send(message: Any) -> None:
        sent.append(message)

    scope = {
        "type": "http",
        "method": method,
        "path": path,
        "headers": [(k.lower().encode(), v.encode("latin-1")) for k, v in headers.items()],
    }
    run(control(scope, receive, send))
    if not sent:
        return 0, {}
    return sent[0]["status"], {k.decode(): v.decode() for k, v in sent[0]["headers"]}


HOST = {"host": "127.0.0.1:2718"}


def test_the_usual_visitor_comes_in():
    """A browser on this machine gets the page, with the order to load nothing else."""
    status, headers = ask(AccessControl(inner), HOST | {"origin": "http://127.0.0.1:2718"})
    assert status == 200
    for rule in OPEN:
        assert rule in headers["content-security-policy"]


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"host": "evil.example"}, 421),
        ({}, 421),
        (HOST | {"origin": "http://evil.example"}, 403),
        (HOST | {"origin": "http://127.0.0.1:9999"}, 403),
        (HOST | {"content-length": str(PAGE.body + 1)}, 413),
        (HOST | {"content-length": "many"}, 413),
        (HOST | {"content-length": "9" * 5000}, 413),
        (HOST | {"content-length": "\u00b2"}, 413),
        ({"host": "["}, 421),
        ({"host": "[::1"}, 421),
        (HOST | {"origin": "http://[bad"}, 403),
    ],
)
def test_others_stay_outside(headers, status):
    """Other names (DNS rebinding), pages of other sites and long bodies are refused."""
    assert ask(AccessControl(inner), headers, "POST", "/api/kernel/run")[0] == status


def test_a_body_without_a_length_ends_where_it_is_too_long():
    """Whatever the header says, no more than the limit is read."""
    status, _ = ask(
        AccessControl(inner), HOST, "POST", "/x", [b"x" * 200_000, b"x" * 200_000, b"x"]
    )
    assert status == 0


def test_who_needs_a_token():
    """This machine alone: no token; anybody else: a long one."""
    assert Address().guarded().token == ""
    assert Address("::1").guarded().token == ""
    guarded = Address("0.0.0.0").guarded()
    assert len(guarded.token) >= 20
    assert guarded.token in guarded.url(80)
    assert "token" not in repr(guarded)


def test_a_port_that_is_taken_is_told():
    """The message says what to do."""
    taken = _socket(Address(port=0))
    try:
        with pytest.raises(LimitError, match="--port 0"):
            _socket(Address(port=taken.getsockname()[1]))
    finally:
        taken.close()


def test_without_the_token_nobody_comes_in():
    """Bound to all interfaces, the page asks for its token: none, a wrong one, the right one."""
    with served("--host", "0.0.0.0") as url:
        parts = urllib.parse.urlsplit(url)
        port = parts.port
        assert port
        statuses = []
        for query in ("", "?access_token=wrong", f"?{parts.query}"):
            link = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
            link.request("GET", f"/{query}")
            reply = link.getresponse()
            text = reply.read().decode()
            statuses.append((reply.status, "marimo-server-token" in text))
            link.close()
    assert [shown for _, shown in statuses[:2]] == [False, False]
    assert statuses[2][0] in (200, 302, 303, 307)


def test_the_page_runs_no_code_of_its_visitors():
    """The kernel refuses to run cells, and refuses other origins."""
    with served() as url:
        body = json.dumps({"cellIds": ["Hbol"], "codes": ["import os"]}).encode()
        headers = {"Content-Type": "application/json", "Marimo-Session-Id": "s_000000"}
        codes = []
        for path, more in (
            ("api/kernel/run", {}),
            ("api/kernel/save", {}),
            ("api/kernel/set_ui_element_value", {"Origin": "http://evil.example"}),
        ):
            request = urllib.request.Request(url + path, body, headers | more)
            try:
                with urllib.request.urlopen(request, timeout=30) as reply:
                    codes.append(reply.status)
            except urllib.error.HTTPError as error:
                with error:
                    codes.append(error.code)
    assert all(code >= 400 for code in codes), codes
    assert codes[2] == 403


def test_importing_the_command_is_light():
    """The command line does not load marimo before the page is asked for."""
    code = "import sys, geomtorsion.cli.app; print('marimo' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert done.stdout.strip() == "False"
