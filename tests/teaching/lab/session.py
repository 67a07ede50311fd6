"""A session of the page without a browser: requests that a browser sends, and the replies."""

from __future__ import annotations

import asyncio
import json
import re
import secrets
import urllib.error
import urllib.request
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from types import TracebackType
from typing import Any, TypeVar

from websockets.asyncio.client import connect

Result = TypeVar("Result")
# Seconds for one answer while thirty sessions wait.
PATIENCE = 60.0


def run(work: Coroutine[Any, Any, Result]) -> Result:
    """Result of a coroutine, run in a thread, because Playwright runs a loop in the main thread."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(asyncio.run, work).result()


class Session:
    """One open page. `outputs` holds the content of each cell, by the cell's name.

    query: what the address of the page holds, such as "language=de".
    """

    def __init__(self, url: str, query: str = "") -> None:
        self.url = url.rstrip("/")
        self.query = f"&{query}" if query else ""
        self.name = f"s_{secrets.token_hex(3)}"
        self.outputs: dict[str, str] = {}

    async def __aenter__(self) -> Session:
        _, html = await asyncio.to_thread(self.get, "/")
        found = re.search(r'data-token="([^"]*)"', html)
        self.token = found[1] if found else ""
        address = f"ws{self.url.removeprefix('http')}/ws?session_id={self.name}{self.query}"
        self.socket = await connect(
            address, max_size=2**24, max_queue=None, open_timeout=PATIENCE, ping_timeout=PATIENCE
        )
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.socket.close()

    def get(self, path: str) -> tuple[int, str]:
        """Status and text of a page."""
        try:
            with urllib.request.urlopen(self.url + path, timeout=PATIENCE) as reply:
                return reply.status, reply.read().decode()
        except urllib.error.HTTPError as error:
            with error:
                return error.code, error.read().decode()

    def _post(self, path: str, content: Any) -> None:
        request = urllib.request.Request(
            self.url + path,
            json.dumps(content).encode(),
            {
                "Content-Type": "application/json",
                "Marimo-Session-Id": self.name,
                "Marimo-Server-Token": self.token,
            },
        )
        with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
            assert reply.status == 200

    async def set(self, element: str, value: Any) -> None:
        """Set the value of a control."""
        content = {"objectIds": [element], "values": [value]}
        await asyncio.to_thread(self._post, "/api/kernel/set_ui_element_value", content)

    async def shown(self, pattern: str) -> re.Match[str]:
        """Wait until a cell contains a match of the pattern."""
        async with asyncio.timeout(PATIENCE):
            while True:
                for text in self.outputs.values():
                    found = re.search(pattern, text)
                    if found:
                        return found
                await self._next()

    async def _next(self) -> None:
        """Receive one message and store its output."""
        message = json.loads(await self.socket.recv())
        data = message.get("data", {})
        if message.get("op") == "cell-op" and data.get("output"):
            self.outputs[data["cell_id"]] = str(data["output"]["data"])

    def element(self, kind: str, text: str = "") -> str:
        """The name of the control of a kind whose markup contains a text."""
        pattern = rf"object-id='([^']+)'[^>]*><{kind}([^>]*)>"
        for shown in self.outputs.values():
            for found in re.finditer(pattern, shown):
                if text in found[2]:
                    return found[1]
        raise AssertionError(f"no {kind} is called {text!r}")
