"""Typed text: the names of differentials in a line element such as dr^2 + r^2 dOmega^2."""

from __future__ import annotations

import re

# The line element of the unit sphere, as books abbreviate it, and the names of its angles.
SPHERE = re.compile(r"d(?:Ω|Omega)(?:_2)?\s*(?:\^|\*\*)\s*2(?!\d)")
ANGLES = (("theta", "phi"), ("θ", "φ"), ("theta", "varphi"), ("θ", "ϕ"))
# A name with d before it that is not a function; a number may come before it.
DIFFERENTIAL = re.compile(r"(?<![^\W\d])(d(?!elta\b|s\b|Omega|Ω)[^\W\d]\w*)(?!\w|\s*\()")
# A square or a product of differentials, as opposed to a one-form.
QUADRATIC = re.compile(r"\^|\*\*|(?<![^\W\d])d[^\W\d]\w*[\s*]+d[^\W\d]")


def is_typed(text: str) -> bool:
    """Whether a text contains differentials, as no name of a space or file does.

    Examples
    --------
    >>> is_typed("dr^2 + r^2 dtheta^2"), is_typed("dr, r dtheta"), is_typed("desitter.toml")
    (True, True, False)
    """
    has_sign = re.search(r"[\^*+,\s]", text.strip()) is not None
    return has_sign and bool(DIFFERENTIAL.search(text) or SPHERE.search(text))


def separated(text: str) -> list[str]:
    """Expressions separated by commas outside of brackets.

    Examples
    --------
    >>> separated("A(t, r), 0")
    ['A(t, r)', '0']
    """
    pieces, depth = [""], 0
    for sign in text:
        depth += (sign == "(") - (sign == ")")
        if sign == "," and not depth:
            pieces.append("")
        else:
            pieces[-1] += sign
    return [piece.strip() for piece in pieces]
