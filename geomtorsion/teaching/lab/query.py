"""query: the input that the address of the page stores, so that a reload or a link restores it.

The author of a link chooses its content: texts are cut, numbers bounded, names looked up in
lists. An invalid entry counts as absent.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import TypeVar

from geomtorsion.teaching.lab.settings import PAGE

T = TypeVar("T")


@dataclass(frozen=True)
class Query:
    """Texts by key, from the address.

    Examples
    --------
    >>> query = Query.of({"radius": "0.1", "tab": ["Loops", "Exercises"]})
    >>> query.numbers("radius", [(0, 1)], [0.3]), query.numbers("radius", [(1, 2)], [1.5])
    ([0.1], [1.5])
    >>> query.one_of("tab", ["Loops"], "Any tetrad")
    'Loops'
    """

    texts: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def now(cls, mo: ModuleType) -> Query:
        """The current content of the address, which the page updates while it is used."""
        return cls.of(mo.query_params().to_dict())

    @classmethod
    def of(cls, texts: Mapping[str, str | list[str]]) -> Query:
        """The content of a query; the first value of a repeated key."""
        first = {key: text[0] if isinstance(text, list) else text for key, text in texts.items()}
        return cls({key: text for key, text in first.items() if len(text) <= PAGE.address})

    def of_case(self, key: str, chosen: object, usual: object) -> Query:
        """The stored values of a case if its space, stored under this key, is the chosen one.

        Examples
        --------
        >>> query = Query({"loop": "s2", "radius": "0.1"})
        >>> query.of_case("loop", "s2", "so3") == query
        True
        >>> query.of_case("loop", "so3", "so3") == Query()
        True
        """
        return self if self.text(key, str(usual)) == str(chosen) else Query()

    def text(self, key: str, default: str) -> str:
        """The unchecked text of a field."""
        return self.texts.get(key, default)

    def one_of(self, key: str, options: Sequence[T], default: T) -> T:
        """The option whose text is stored."""
        text = self.texts.get(key)
        return next((one for one in options if str(one) == text), default)

    def some_of(self, key: str, options: Sequence[str], default: Sequence[str]) -> list[str]:
        """The stored options, separated by commas."""
        if key not in self.texts:
            return list(default)
        words = self.texts[key].split(",")
        return [one for one in options if one in words]

    def numbers(
        self, key: str, ranges: Sequence[tuple[float, float]], default: Sequence[float]
    ) -> list[float]:
        """One number for each range, if all are in their ranges; otherwise the default."""
        try:
            values = [float(part) for part in self.texts.get(key, "").split(",")]
        except ValueError:
            return list(default)
        fits = len(values) == len(ranges) and all(
            math.isfinite(x) and low <= x <= high
            for x, (low, high) in zip(values, ranges, strict=True)
        )
        return values if fits else list(default)


def numbers_text(values: Sequence[float]) -> str:
    """Numbers in the form of an address.

    Examples
    --------
    >>> numbers_text([0.1, 2.0, -1])
    '0.1,2,-1'
    """
    return ",".join(f"{value:.10g}" for value in values)


def store(mo: ModuleType, values: Mapping[str, tuple[str, str]]) -> None:
    """Write texts into the address; each is given with its default.

    Only values that differ from the default are written: an untouched page has a short address.
    """
    address = mo.query_params()
    for key, (text, usual) in values.items():
        new_text = "" if text == usual or len(text) > PAGE.address else text
        if new_text and address.get(key) != new_text:
            address.set(key, new_text)
        elif not new_text and key in address:
            address.remove(key)
