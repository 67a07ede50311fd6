"""Draw: the choices that make a variant, one digit of its seed for each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

Option = TypeVar("Option")


class Draw:
    """Read a seed as a number with mixed digits; each choice takes the next digit.

    Seed 0 takes the first option of every choice. Two seeds below the number of combinations never
    make the same choices: these differ at the first different digit. Each digit is
    shifted by the digits before it, so that neighbouring seeds differ in all choices.

    Examples
    --------
    >>> draw = Draw(1)
    >>> draw.choice("abc"), draw.choice("abc")
    ('b', 'b')
    """

    def __init__(self, seed: int) -> None:
        self._rest, self._shift = seed, 0

    def choice(self, options: Sequence[Option]) -> Option:
        """One of the options."""
        self._rest, digit = divmod(self._rest, len(options))
        self._shift += digit
        return options[self._shift % len(options)]
