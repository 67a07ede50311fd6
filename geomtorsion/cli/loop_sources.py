"""loops: closed loops from the command line and from files."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

from geomtorsion.cli.options import option
from geomtorsion.errors import LoopError
from geomtorsion.geometry import Frame
from geomtorsion.loops import Loop
from geomtorsion.loops.loop_files import (
    KINDS,
    LoopFile,
    loop_from_data,
    loops_from_json,
    read_loops,
)
from geomtorsion.support.checks import cut

WHOLE_TURN = "0,2*pi"
# Kinds of loops whose fields are separated by colons, and what the fields are called.
FIELDS = {
    "circle": ("centre", "radius", "plane"),
    "ellipse": ("centre", "axes", "plane"),
    "plaquette": ("corner", "steps", "plane"),
}
Texts = list[str]

LoopFiles = Annotated[
    list[Path],
    option(
        "--loops",
        metavar="FILE",
        text="Loops from a JSON or CSV file; - for JSON on standard input.",
    ),
]


def files_of_loops(frame: Frame, paths: Iterable[Path]) -> list[tuple[Path, LoopFile]]:
    """Each file with its loops; the path - is standard input."""
    return [
        (
            path,
            loops_from_json(frame, sys.stdin.read(), "standard input")
            if str(path) == "-"
            else read_loops(frame, path),
        )
        for path in paths
    ]


def typed_loop(frame: Frame, kind: str, text: str, interval: str | None = None) -> Loop:
    """The loop that `--KIND TEXT` means; interval: the bounds of s in a curve."""
    typed = f"--{kind} {cut(text)}"
    return loop_from_data(frame, _data(kind, text, interval, typed), typed)


def named_loop(frame: Frame, text: str, interval: str | None = None) -> Loop:
    """The loop that `--loop "KIND TEXT"` means."""
    kind, _, rest = text.strip().partition(" ")
    if kind not in KINDS or not rest.strip():
        raise LoopError(
            f"--loop: expected one of {', '.join(KINDS)} and its numbers, got {cut(text)}. Write "
            "--loop 'circle 20,30:8'."
        )
    typed = f"--loop {cut(text)}"
    return loop_from_data(frame, _data(kind, rest.strip(), interval, typed), typed)


def _data(kind: str, text: str, interval: str | None, typed: str) -> dict[str, Any]:
    """A typed loop as `loop_from_data` takes it; typed: how, for messages."""
    inner: dict[str, Any]
    if kind in FIELDS:
        keys, fields = FIELDS[kind], _split(text, ":")
        if not 2 <= len(fields) <= 3:
            pattern = f"{keys[0].upper()}:{keys[1].upper()}[:PLANE]"
            came = "1 part" if len(fields) == 1 else f"{len(fields)} parts"
            raise LoopError(f"{typed}: expected {pattern}, got {came}. Separate parts with colons.")
        inner = {key: _split(field, ",") for key, field in zip(keys, fields, strict=False)}
        if kind == "circle":
            inner["radius"] = fields[1]
    elif kind == "curve":
        inner = {"expressions": _split(text, ";"), "interval": _split(interval or WHOLE_TURN, ",")}
    else:
        points = [_split(point, ",") for point in text.split(";") if point.strip()]
        inner = {"points" if kind == "spline" else "vertices": points}
    return {kind: inner, "name": f"{kind} {cut(text)}"}


def _split(text: str, separator: str) -> list[str]:
    return [part.strip() for part in text.split(separator)]
