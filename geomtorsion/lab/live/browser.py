"""browser: what the worker of the page calls: text comes, text goes."""

from __future__ import annotations

import json

from geomtorsion.errors import GeomtorsionError
from geomtorsion.exercises.worker_pool import EXCEEDED, answered
from geomtorsion.files import conforming, read_json_text
from geomtorsion.lab.live.tabs import TABS, show
from geomtorsion.lab.tasks import checked_length, common_runner, too_much
from geomtorsion.lab.views import TETRAD

# What a request of the page looks like.
FORM = {
    "tab": frozenset(TABS), "values": {str: str}, "kept?": {str: str}, "changed?": [str],
    "action?": str,
}  # fmt: skip


def answer(text: str) -> str:
    """A tab as JSON for a request as JSON (see `tabs.show`), or ``{"problem": message}``.

    Examples
    --------
    >>> json.loads(answer('{"tab": "Any tetrad", "values": {"start from": "nowhere"}}'))["shape"]
    "so3|['phi1', 'phi2', 'phi3']"
    """
    try:
        request = conforming(read_json_text(checked_length(text), "request"), FORM, "request")
        reply = answered(lambda asked: show(asked, common_runner()), request)
    except GeomtorsionError as error:
        reply = {"problem": str(error)}
    if EXCEEDED in reply:
        reply = {"problem": too_much(reply)}
    return json.dumps(reply)


def warm() -> None:
    """Let the first tab be shown once: what it needs is loaded then."""
    answer(json.dumps({"tab": TETRAD, "values": {}}))
