"""localized: the page in the language of its server, unless its address names another."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any
from urllib.parse import parse_qs, quote

from geomtorsion.teaching.texts import ENGLISH

# The parts of ASGI, the interface of web servers in Python.
Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]
# The entry of a request that the page reads.
CHAPTER = "chapter"


def with_chapter(app: App, folder: str) -> App:
    """An ASGI application whose requests name the folder of a teacher's chapter.

    Only the server names it: nothing in an address or a message of a browser chooses a folder.
    """
    if not folder:
        return app

    async def answered(scope: Scope, receive: Receive, send: Send) -> None:
        await app({**scope, "meta": {CHAPTER: folder}}, receive, send)

    return answered


def localized(app: App, language: str) -> App:
    """An ASGI application that sends a browser without a language to the page in this one.

    The page reads its language from its address, where a student can change it.
    """
    if language == ENGLISH:
        return app

    async def answered(scope: Scope, receive: Receive, send: Send) -> None:
        query = scope.get("query_string", b"").decode("latin-1")
        reads = scope["type"] == "http" and scope.get("method") in ("GET", "HEAD")
        if not reads or scope["path"] != "/" or "language" in parse_qs(query):
            await app(scope, receive, send)
            return
        where = "/?" + "&".join(filter(None, (query, f"language={quote(language)}")))
        headers = [(b"location", where.encode("latin-1")), (b"content-length", b"0")]
        await send({"type": "http.response.start", "status": 307, "headers": headers})
        await send({"type": "http.response.body", "body": b""})

    return answered
