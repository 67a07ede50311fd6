"""numbers: lists of numbers and name=number pairs as a person types them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from geomtorsion.errors import ExpressionError, StartError, UnknownNameError

if TYPE_CHECKING:
    from geomtorsion.motion import Engine


def number(text: str, what: str) -> float:
    """A number, written as one or as an expression such as pi/2.

    Examples
    --------
    >>> number("pi/2", "start"), number("-1e-3", "start")
    (1.5707963267948966, -0.001)
    """
    text = text.strip()
    try:
        value = float(text)
    except ValueError:
        value = _expression(text, what)
    if not math.isfinite(value):
        raise StartError(f"{what}: {text} is not finite. Give finite numbers.")
    return value


def _expression(text: str, what: str) -> float:
    from geomtorsion.exact import parse_expression

    try:
        return float(parse_expression(text, symbols={}, functions={}))
    except (ExpressionError, TypeError):
        raise StartError(
            f"{what}: a number was needed, {text!r} came. "
            "Write numbers separated by commas, such as 0.3,pi/2,-1e-3."
        ) from None


def numbers(text: str | None, what: str) -> list[float] | None:
    """Numbers separated by commas; None where nothing was given.

    Examples
    --------
    >>> numbers("1, pi, sqrt(2)", "start")
    [1.0, 3.141592653589793, 1.4142135623730951]
    """
    if text is None:
        return None
    return [number(part, what) for part in text.split(",")]


def named_numbers(*texts: str) -> dict[str, float]:
    """name=number pairs separated by commas, in one text or in several.

    Examples
    --------
    >>> named_numbers("M=1, a=1/2")
    {'M': 1.0, 'a': 0.5}
    """
    found: dict[str, float] = {}
    for part in ",".join(texts).split(","):
        if not part.strip():
            continue
        name, sign, value = part.partition("=")
        name = name.strip()
        if not sign or not name:
            raise StartError(
                f"parameters: name=number was needed, {part.strip()!r} came. Write M=1,a=0.5."
            )
        if name in found:
            raise StartError(f"parameters: {name} is given twice. Give it once.")
        found[name] = number(value, f"parameter {name}")
    return found


def engine_of(name: str) -> Engine | None:
    """The engine of a name; None, which lets the solver choose, for auto."""
    from geomtorsion.motion import RungeKutta, Stiff, Taylor

    if name == "auto":
        return None
    makers = {"taylor": Taylor, "rungekutta": RungeKutta, "stiff": Stiff}
    if name.lower() not in makers:
        raise UnknownNameError(f"there is no engine {name!r}. There are auto, {', '.join(makers)}.")
    return makers[name.lower()]()
