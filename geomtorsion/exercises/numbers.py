"""Numbers: answers with units, and whether they are within the tolerance."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import isfinite, pi
from types import MappingProxyType
from typing import TYPE_CHECKING

import sympy

from geomtorsion.errors import ExpressionError
from geomtorsion.exercises.answers import components, expression
from geomtorsion.exercises.numeric import at_point

if TYPE_CHECKING:
    from geomtorsion.exercises.compare import Index
    from geomtorsion.exercises.question import Question

# Unit -> what it measures, and its size.
UNITS: Mapping[str, tuple[str, float]] = MappingProxyType(
    {
        "rad": ("angle", 1.0), "radian": ("angle", 1.0), "radians": ("angle", 1.0),
        "mrad": ("angle", 1e-3), "deg": ("angle", pi / 180),
        "degree": ("angle", pi / 180), "degrees": ("angle", pi / 180), "°": ("angle", pi / 180),
        "turn": ("angle", 2 * pi), "turns": ("angle", 2 * pi),
        "s": ("time", 1.0), "ms": ("time", 1e-3), "min": ("time", 60.0),
        "m": ("length", 1.0), "mm": ("length", 1e-3), "cm": ("length", 1e-2),
        "km": ("length", 1e3), "nm": ("length", 1e-9),
        "rad/s": ("rate", 1.0), "deg/s": ("rate", pi / 180), "1/s": ("rate", 1.0),
        "m/s": ("speed", 1.0), "km/s": ("speed", 1e3),
        "J": ("energy", 1.0), "Nm": ("energy", 1.0), "%": ("share", 1e-2),
    }
)  # fmt: skip
_UNIT = re.compile(r"^(.*?(?:[\d.)]|pi|π))\s*([A-Za-z°%]+(?:/s)?|1/s)\s*$", re.DOTALL)
# Rounding to two digits changes a number by no more than this share: 1.05 is written as 1.1.
ROUNDED = 0.05


class UnitError(ExpressionError):
    """The unit of an answer does not measure what is asked for."""


def numbers(question: Question, given: object, where: str) -> dict[Index, float]:
    """Numbers by their indices, in the unit of the question.

    Raises
    ------
    ExpressionError
        It is no number.
    UnitError
        Its unit measures something else.
    """
    text, factor = given, 1.0
    if isinstance(given, str):
        text, factor = _without_unit(question, given, where)
        comma = re.fullmatch(r"\s*([-+]?[0-9]+),([0-9]+)\s*", str(text)[:100])
        if comma and not question.shape:
            raise ExpressionError(
                f"{where}: a number was needed, but {comma[0].strip()} has a comma. Write "
                f"{comma[1]}.{comma[2]} with a point."
            )
    if not question.shape:
        return {(): factor * _float(expression(question, text, where), where)}
    found = components(question, text, where)
    return {key: factor * _float(value, f"{where}[{key[0] + 1}]") for key, value in found.items()}


def _without_unit(question: Question, text: str, where: str) -> tuple[str, float]:
    """The text before the unit, and how many units of the question it is worth."""
    # Cut before it is matched: a pattern with a lazy part is slow on long texts.
    match = _UNIT.match(text.strip()[:2000])
    if match is None or (match[2] not in UNITS and match[2] in ("pi", "π", "E", "i", "I")):
        return text, 1.0
    unit = match[2]
    if unit not in UNITS:
        known = ", ".join(name for name in UNITS if name.isascii())
        raise UnitError(f"{where}: {unit[:20]} is no unit that is known here. Known are {known}.")
    if not question.unit:
        if UNITS[unit][0] == "share":
            return match[1], UNITS[unit][1]
        raise UnitError(f"{where}: a pure number was needed, but one in {unit} came.")
    measured, size = UNITS[unit]
    wanted, own = UNITS[question.unit]
    if measured != wanted:
        raise UnitError(
            f"{where}: a number in {question.unit} ({wanted}) was needed, but one in {unit} "
            f"({measured}) came."
        )
    return match[1], size / own


def _float(expr: sympy.Expr, where: str) -> float:
    """An expression without symbols as a number."""
    found = at_point(expr, {})
    if found is None or found.imag or not isfinite(float(found.real)):
        raise ExpressionError(f"{where}: this has no finite real value. Give a number.")
    return float(found.real)
