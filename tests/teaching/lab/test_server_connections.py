"""Harmful connections: clients that never read, that have no origin, or that open many sessions."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import os
import socket
import time
import urllib.parse
import urllib.request
from typing import Any

import pytest

from geomtorsion.teaching.lab.server import AccessControl
from geomtorsion.teaching.lab.settings import PAGE
from tests.teaching.lab.serving import served
from tests.teaching.lab.session import run

HOST = (b"host", b"127.0.0.1:2718")
# Seconds after which a page counts as stopped; it takes one.
SOON = 30


def scope_of(kind: str, path: str, client: str = "10.0.0.1", *more: tuple[bytes, bytes]) -> Any:
    """A request of a client."""
    found = {"type": kind, "path": path, "headers": [HOST, *more], "client": (client, 4000)}
    return found | ({"method": "GET"} if kind == "http" else {})


async def page(scope: Any, receive: Any, send: Any) -> None:
    """An application with a page, and sessions that show a message and remain open."""
    await receive()
    if scope["type"] == "websocket":
        await send({"type": "websocket.accept"})
        await send({"type": "websocket.send", "text": '{"op": "completed-run"}'})
        await asyncio.Event().wait()
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"hello"})


class Client:
    """A client that reads, or one that never reads."""

    def __init__(self, *, reads: bool = True) -> None:
        self.reads = reads
        self.got: list[str] = []

    async def receive(self) -> Any:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(self, message: Any) -> None:
        if not self.reads:
            await asyncio.Event().wait()
        self.got.append(message["type"])


@pytest.mark.parametrize(("kind", "path"), [("http", "/"), ("websocket", "/ws")])
def test_a_client_that_never_reads_delays_nobody(kind: str, path: str):
    """The lock of the page is free while an answer is being sent."""

    async def both() -> list[str]:
        control, other = AccessControl(page), Client()
        idle = Client(reads=False)
        stuck = asyncio.create_task(control(scope_of(kind, path), idle.receive, idle.send))
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        scope = scope_of("http", "/", "10.0.0.2")
        await asyncio.wait_for(control(scope, other.receive, other.send), 2)
        stuck.cancel()
        await asyncio.gather(stuck, return_exceptions=True)
        return other.got

    assert run(both()) == ["http.response.start", "http.response.body"]


def test_a_browser_that_goes_at_once_does_not_free_the_lock():
    """The next session begins only when the thread of a closed session has compiled the page."""

    async def both() -> list[str]:
        compiling, order = {"first"}, []

        async def closes(scope: Any, receive: Any, send: Any) -> None:
            order.append(scope["query_string"].decode())
            await send({"type": "websocket.accept"})

        control = AccessControl(closes, starting=lambda name: name in compiling)

        async def session(name: str) -> None:
            scope = scope_of("websocket", "/ws") | {"query_string": f"session_id={name}".encode()}
            client = Client()
            await control(scope, client.receive, client.send)

        first = asyncio.create_task(session("first"))
        await asyncio.sleep(0)
        second = asyncio.create_task(session("second"))
        await asyncio.sleep(3 * PAGE.polling)
        order.append("compiled")
        compiling.clear()
        await asyncio.wait_for(asyncio.gather(first, second), SOON)
        return order

    assert run(both()) == ["session_id=first", "compiled", "session_id=second"]


@pytest.mark.parametrize(
    ("origin", "message"),
    [
        (b"null", "websocket.close"),
        (b"http://evil.example", "websocket.close"),
        (b"http://127.0.0.1:2718", "websocket.accept"),
    ],
)
def test_sessions_of_pages_without_a_name(origin: bytes, message: str):
    """The origin null, of a local file or a frame of another site, is refused."""

    async def opened() -> str:
        client = Client()
        scope = scope_of("websocket", "/ws", "10.0.0.1", (b"origin", origin))
        session = asyncio.create_task(AccessControl(page)(scope, client.receive, client.send))
        await asyncio.wait((session,), timeout=0.2)
        session.cancel()
        await asyncio.gather(session, return_exceptions=True)
        return client.got[0]

    assert run(opened()) == message


def test_one_client_cannot_fill_the_lab():
    """The last places are reserved for other clients; a session that closes frees a place."""

    async def filled() -> list[str]:
        control = AccessControl(page, sessions=8, reserve=2)
        sessions = []

        async def come(client: str) -> str:
            one = Client()
            scope = scope_of("websocket", "/ws", client)
            sessions.append(asyncio.create_task(control(scope, one.receive, one.send)))
            await asyncio.wait((sessions[-1],), timeout=0.1)
            return one.got[0]

        first = [await come("10.0.0.1") for _ in range(7)]
        other = await come("10.0.0.2")
        sessions[0].cancel()
        await asyncio.gather(sessions[0], return_exceptions=True)
        again = [await come(f"10.0.0.{client}") for client in (1, 2, 2, 3, 4)]
        for session in sessions:
            session.cancel()
        await asyncio.gather(*sessions, return_exceptions=True)
        return [*first, other, *again]

    accept, close = "websocket.accept", "websocket.close"
    expected = [accept] * 6 + [close, accept, close, accept, close, accept, close]
    assert run(filled()) == expected


@pytest.mark.parametrize(("sessions", "places"), [(1, 1), (2, 2), (40, 32), (64, 56)])
def test_a_class_behind_one_router(sessions: int, places: int):
    """One network address gets all places except a few."""

    async def filled() -> int:
        control, tasks, count = AccessControl(page, sessions=sessions), [], 0
        for _ in range(sessions):
            one = Client()
            scope = scope_of("websocket", "/ws", "10.0.0.1")
            tasks.append(asyncio.create_task(control(scope, one.receive, one.send)))
            await asyncio.sleep(0.01)
            count += one.got[:1] == ["websocket.accept"]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return count

    assert run(filled()) == places


def unread(host: str, port: int, request: bytes) -> socket.socket:
    """A connection with a small buffer that sends a request and never reads the reply."""
    link = socket.socket()
    link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
    link.connect((host, port))
    link.sendall(request)
    return link


def comes_soon(port: int, query: str) -> bool:
    """Whether another browser gets the page."""
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/?{query}", timeout=SOON) as reply:
        return reply.status == 200


@pytest.mark.slow
def test_real_pages_that_are_not_read():
    """Sixty requests on one connection fill the buffers of the system, so an answer waits."""
    with served() as url:
        port = urllib.parse.urlsplit(url).port
        assert port
        wanted = f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode() * 60
        with unread("127.0.0.1", port, wanted):
            # A page of 126 kB takes 0.3 s, and the system stores 2.6 MB of them.
            time.sleep(12)
            assert comes_soon(port, "")


def test_real_sessions_that_are_not_read():
    """Unread sessions with and without the token, and requests whose body never arrives."""
    with served("--host", "0.0.0.0") as url, contextlib.ExitStack() as links:
        parts = urllib.parse.urlsplit(url)
        assert parts.port
        key = base64.b64encode(os.urandom(16)).decode()
        head = f"HTTP/1.1\r\nHost: 127.0.0.1:{parts.port}\r\n"
        upgrade = (
            "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
            f"Sec-WebSocket-Key: {key}\r\n\r\n"
        )
        for request in (
            f"GET / {head}Content-Length: 1000\r\n\r\n",
            f"GET /?{parts.query} {head}Content-Length: 1000\r\n\r\n",
            f"GET /ws?session_id=s_111111 {head}{upgrade}",
            f"GET /ws?session_id=s_222222&{parts.query} {head}{upgrade}",
        ):
            links.enter_context(unread("127.0.0.1", parts.port, request.encode()))
        assert comes_soon(parts.port, parts.query)
