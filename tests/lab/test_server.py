"""What is computed before anybody asks: exactly what the tabs ask for when they are opened."""

from __future__ import annotations

import json
from typing import Any

import marimo

from geomtorsion.lab import controls
from geomtorsion.lab.kept import Kept
from geomtorsion.lab.server import FIRST
from geomtorsion.lab.space_info import space_info


def test_the_first_requests_are_those_of_the_tabs():
    """Equal as text, since that is by what an answer is kept."""
    kept = Kept()
    facts = space_info(controls.FIRST_LOOP)
    # What controls hold has no type of its own in marimo.
    centre: Any = controls.centre(marimo, facts, kept).value
    body: Any = controls.body(marimo, kept).value
    switches: Any = controls.switches(marimo, kept).value
    loop = controls.loop_case(
        controls.FIRST_LOOP,
        centre,
        controls.radius(marimo, kept).value,
        controls.plane(marimo, facts, kept).value,
    )
    top = controls.top_case(body, switches, controls.watched(marimo, kept).value)
    asked = {json.dumps([name, arguments]) for name, arguments in FIRST}
    assert json.dumps(["loop", loop]) in asked
    assert json.dumps(["top", top]) in asked
