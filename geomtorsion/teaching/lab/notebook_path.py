"""notebook path: the place of the page's file on the server, removed from what browsers get."""

from __future__ import annotations

import json
import os
import re
from collections.abc import MutableMapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

Message = MutableMapping[str, Any]
# marimo writes the folder of the project into the page, for editors.
_PROJECT = re.compile(rb'("rootUri": ")file:[^"]*"')


def without_path(answer: Sequence[Message], notebook: Path) -> list[Message]:
    """The messages of an answer whose text has the name of the notebook instead of its path.

    Examples
    --------
    >>> page = Path("/home/ada/page.py")
    >>> body = {"type": "http.response.body", "body": b'"/home/ada/page.py", "/home/ada"'}
    >>> without_path([{"type": "http.response.start", "headers": []}, body], page)[-1]["body"]
    b'"page.py", ""'
    """
    starts = [dict(message) for message in answer if message["type"] == "http.response.start"]
    body = b"".join(message.get("body", b"") for message in answer)
    body = _PROJECT.sub(rb'\1file:///"', body.replace(notebook.as_uri().encode(), b"file:///"))
    # With the separator first: what remains of the path of the file is its name.
    for folder in (f"{notebook.parent}{os.sep}", str(notebook.parent)):
        for text in (folder, json.dumps(folder)[1:-1], quote(folder, safe="")):
            body = body.replace(text.encode(), b"")
    for message in starts if body else ():
        rest = [(key, x) for key, x in message["headers"] if key.lower() != b"content-length"]
        message["headers"] = [*rest, (b"content-length", str(len(body)).encode())]
    return [*starts, {"type": "http.response.body", "body": body}]
