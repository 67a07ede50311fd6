"""The server: prepared answers, access control, tokens, ports and routes."""

from __future__ import annotations

import http.client
import json
import re
import subprocess
import sys
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import marimo
import pytest

from geomtorsion.errors import LimitError
from geomtorsion.teaching.lab import controls
from geomtorsion.teaching.lab.address import LETTERS, Address
from geomtorsion.teaching.lab.query import Query
from geomtorsion.teaching.lab.server import (
    FIRST,
    ROUTES,
    AccessControl,
    _socket,
    application,
    is_used,
)
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.space_info import space_info
from tests.teaching.lab.serving import ROOT, served
from tests.teaching.lab.session import run


def test_prepared_requests_equal_first_requests():
    """Two prepared requests equal the tabs' first requests as text, which is the cache key."""
    query = Query()
    facts = space_info(controls.FIRST_LOOP)
    # marimo has no type for the value of a control.
    place: Any = controls.place(marimo, facts, query).value
    body: Any = controls.top(marimo, query).value
    loop = controls.loop_case(facts, place, controls.radius(marimo, query).value)
    top = controls.top_case(body)
    asked = {json.dumps([name, arguments]) for name, arguments in FIRST}
    assert json.dumps(["loop", loop]) in asked
    assert json.dumps(["top", top]) in asked


OPEN = ("default-src 'self'", "connect-src 'self'")


async def inner(scope: Any, receive: Any, send: Any) -> None:
    """An application that reads the request and answers with hello."""
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
    """Status and headers of the reply of the access control; 0 if it closes the connection."""
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
USED = "/api/kernel/set_ui_element_value"


def test_the_usual_visitor_comes_in():
    """A browser on this machine gets the page with a policy that forbids other sources."""
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
        (HOST | {"content-length": str(PAGE.carried + 1)}, 413),
        (HOST | {"content-length": "many"}, 413),
        (HOST | {"content-length": "9" * 5000}, 413),
        (HOST | {"content-length": "\u00b2"}, 413),
        ({"host": "["}, 421),
        ({"host": "[::1"}, 421),
        (HOST | {"origin": "http://[bad"}, 403),
    ],
)
def test_others_stay_outside(headers, status):
    """Other host names (DNS rebinding), other origins and long bodies are refused."""
    assert ask(AccessControl(inner), headers, "POST", USED)[0] == status


def test_only_where_files_arrive_requests_may_be_long():
    """A file fits into the request that sends values of controls, and into no other request."""
    # 404: the request was read, but it names no open session.
    for path, status in ((USED, 404), ("/auth/login", 413)):
        headers = HOST | {"content-length": str(PAGE.body + 1)}
        assert ask(AccessControl(inner), headers, "POST", path)[0] == status
    parts = [bytes(PAGE.carried), b"x", b""]
    assert ask(AccessControl(inner), HOST, "POST", USED, parts[:1])[0] == 404
    assert ask(AccessControl(inner), HOST, "POST", USED, parts)[0] == 0


def test_a_body_without_a_length_ends_where_it_is_too_long():
    """A body without a declared length is read only up to the limit."""
    status, _ = ask(
        AccessControl(inner), HOST, "POST", "/auth/login", [b"x" * 200_000, b"x" * 200_000, b"x"]
    )
    assert status == 0


def test_who_needs_a_token():
    """This machine needs no token; others need a code that can be typed but not guessed."""
    assert Address().guarded().token == ""
    assert Address("::1").guarded().token == ""
    guarded = Address("0.0.0.0").guarded()
    assert len(guarded.token) == 8
    assert len(LETTERS) ** len(guarded.token) > 5e11
    assert Address("0.0.0.0").guarded().token != guarded.token
    assert guarded.token in guarded.url(80)
    assert "token" not in repr(guarded)


def test_a_taken_port_is_reported():
    """The message gives the remedy: --port 0."""
    taken = _socket(Address(port=0))
    try:
        with pytest.raises(LimitError, match="--port 0"):
            _socket(Address(port=taken.getsockname()[1]))
    finally:
        taken.close()


@pytest.mark.parametrize("port", [-1, 65536])
def test_an_invalid_port_is_reported(port: int):
    """Python raises OverflowError for these ports, which was once shown as a traceback."""
    with pytest.raises(LimitError, match=f"port {port} cannot be used"):
        _socket(Address(port=port))


def test_without_the_token_nobody_comes_in():
    """Bound to all interfaces, the page opens only with the right token."""
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


def test_the_page_runs_no_code_of_its_visitors(address: str):
    """The kernel refuses to run cells, and refuses other origins."""
    body = json.dumps({"cellIds": ["Hbol"], "codes": ["import os"]}).encode()
    headers = {"Content-Type": "application/json", "Marimo-Session-Id": "s_000000"}
    codes = []
    for path, more in (
        ("api/kernel/run", {}),
        ("api/kernel/save", {}),
        ("api/kernel/set_ui_element_value", {"Origin": "http://evil.example"}),
    ):
        request = urllib.request.Request(address + path, body, headers | more)
        try:
            with urllib.request.urlopen(request, timeout=30) as reply:
                codes.append(reply.status)
        except urllib.error.HTTPError as error:
            with error:
                codes.append(error.code)
    assert all(code >= 400 for code in codes), codes
    assert codes[2] == 403


def registered(routes: Any, prefix: str = "") -> Iterator[tuple[str, str]]:
    """Method and path of each route of a Starlette application, also inside mounts."""
    for route in routes:
        path = prefix + route.path
        inside = getattr(route, "routes", None)
        if inside:
            yield from registered(inside, path)
        elif hasattr(route, "methods"):
            yield from ((method, path) for method in sorted(route.methods))
        elif type(route).__name__ == "WebSocketRoute":
            yield "WEBSOCKET", path
        else:
            # A folder of files.
            yield "GET", f"{path}/*"


def test_only_requests_of_the_page_are_answered():
    """Each route of marimo is on the list with its use, or answers 404."""
    control = application(Address())
    every = set(registered(control.app.routes))
    # marimo 0.25 has 108 routes; if far fewer are found, this test looks in the wrong place.
    assert len(every) > 80
    assert ("POST", "/api/home/workspace_files") in every
    assert ("POST", "/api/export/html") in every
    # The last route answers all other paths: icons are on the list with their own names.
    assert ("GET", "/{path:path}") in every
    others = {one for one in every if one not in ROUTES and one[0] != "HEAD"}
    assert len(every) - len(others) < 40
    for method, path in sorted(others):
        real = re.sub(r"{.*}", "some/file.py", path).replace("*", "some")
        if method == "WEBSOCKET":
            assert not is_used({"type": "websocket", "path": real}), real
            continue
        status, _ = ask(control, HOST, method, real, (b"{}",))
        assert status == 404, (method, real)
    assert all(use for use in ROUTES.values())


@pytest.mark.parametrize("path", ["/ws/../terminal/ws", "/terminal/ws", "/ws_sync", "/"])
def test_only_the_session_has_a_socket(path: str):
    """Any other socket is closed before it opens."""
    sent: list[Any] = []

    async def receive() -> dict[str, Any]:
        return {"type": "websocket.connect"}

    async def send(message: Any) -> None:
        sent.append(message["type"])

    scope = {"type": "websocket", "path": path, "headers": [(b"host", b"127.0.0.1:2718")]}
    run(AccessControl(inner)(scope, receive, send))
    assert sent == ["websocket.close"]


def test_no_path_of_this_machine_is_revealed(address: str):
    """These routes answer 404, without a file name of this machine."""
    headers = {"Content-Type": "application/json", "Marimo-Session-Id": "s_000000"}
    for path in ("api/home/workspace_files", "api/export/html", "api/status", "api/sessions"):
        for body in (b"{}", None):
            request = urllib.request.Request(address + path, body, headers)
            with pytest.raises(urllib.error.HTTPError) as told:
                urllib.request.urlopen(request, timeout=30)
            with told.value as error:
                assert error.code == 404
                assert str(ROOT).encode() not in error.read()


def test_the_page_names_no_folder_of_this_machine(address: str):
    """The page itself has the name of its file, and no folder, in no form of writing."""
    with urllib.request.urlopen(address, timeout=60) as answer:
        length, content = answer.headers["content-length"], answer.read()
    text = content.decode()
    assert int(length) == len(content)
    assert "<marimo-filename hidden>page.py</marimo-filename>" in text
    for folder in (ROOT, ROOT / "geomtorsion", Path(str(marimo.__file__)).parent):
        for form in (str(folder), folder.as_uri(), urllib.parse.quote(str(folder), safe="")):
            assert form not in text, form


def test_importing_the_command_is_light():
    """The command line does not load marimo before the page is requested."""
    code = "import sys, geomtorsion.cli.app; print('marimo' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert done.stdout.strip() == "False"
