"""loop_text: loops as they are written on the command line, as plain data."""

from __future__ import annotations

from typing import Any

from geomtorsion.errors import LoopError

SHAPES = {
    "circle": ("centre", "radius", "plane"),
    "ellipse": ("centre", "axes", "plane"),
    "plaquette": ("corner", "steps", "plane"),
}


def described(kind: str, text: str, interval: str) -> dict[str, Any]:
    """The loop that `--kind TEXT` means, as `loop_from_data` takes it."""
    if kind in SHAPES:
        keys = SHAPES[kind]
        fields = [field.strip() for field in text.split(":")]
        if not 2 <= len(fields) <= 3:
            wanted = f"{keys[0].upper()}:{keys[1].upper()}[:PLANE]"
            raise LoopError(f"--{kind} {text}: {wanted} was needed, {len(fields)} parts came.")
        values: dict[str, Any] = {
            key: _list(field) for key, field in zip(keys, fields, strict=False)
        }
        if kind == "circle":
            values["radius"] = fields[1]
        return {kind: values, "name": f"{kind} {text}"}
    if kind == "curve":
        expressions = [part.strip() for part in text.split(";")]
        bounds = [part.strip() for part in interval.split(",")]
        return {kind: {"expressions": expressions, "interval": bounds}, "name": f"curve {text}"}
    points = [_list(point) for point in text.split(";") if point.strip()]
    return {kind: {"points" if kind == "spline" else "vertices": points}, "name": f"{kind} {text}"}


def _list(text: str) -> list[str]:
    """Numbers (or names) separated by commas."""
    return [part.strip() for part in text.split(",")]


def assignments(texts: list[str]) -> dict[str, Any]:
    """Values of parameters from NAME=VALUE."""
    from geomtorsion.loops.loop_files import number_of

    values = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip() or not value.strip():
            raise LoopError(f"--set {text}: NAME=VALUE was needed, as in --set R=1.5.")
        values[name.strip()] = number_of(value.strip(), f"--set {name.strip()}")
    return values
