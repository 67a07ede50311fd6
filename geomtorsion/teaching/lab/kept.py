"""kept: what the address of the page says of its input, so that a reload or a link brings it back.

Whoever sends a link chooses what stands in it: texts are cut, numbers bounded, names looked up in
lists. What is odd counts as absent.
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
class Kept:
    """Texts by key, as they stand in the address.

    Examples
    --------
    >>> kept = Kept.of({"radius": "0.1", "tab": ["Loops", "Exercises"]})
    >>> kept.numbers("radius", [(0, 1)], [0.3]), kept.numbers("radius", [(1, 2)], [1.5])
    ([0.1], [1.5])
    >>> kept.one_of("tab", ["Loops"], "Any tetrad")
    'Loops'
    """

    texts: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def now(cls, mo: ModuleType) -> Kept:
        """What stands in the address at this moment; it is written as the page is used."""
        return cls.of(mo.query_params().to_dict())

    @classmethod
    def of(cls, query: Mapping[str, str | list[str]]) -> Kept:
        """What stands in a query; of a key that stands there twice the first."""
        first = {key: text[0] if isinstance(text, list) else text for key, text in query.items()}
        return cls({key: text for key, text in first.items() if len(text) <= PAGE.address})

    def of_case(self, key: str, chosen: object, usual: object) -> Kept:
        """What is kept of a case, as long as its space, kept under this key, is the chosen one.

        Examples
        --------
        >>> kept = Kept({"loop": "s2", "radius": "0.1"})
        >>> kept.of_case("loop", "s2", "so3") == kept, kept.of_case("loop", "so3", "so3") == Kept()
        (True, True)
        """
        return self if self.text(key, str(usual)) == str(chosen) else Kept()

    def text(self, key: str, default: str) -> str:
        """A text of a field; nothing says what is in it."""
        return self.texts.get(key, default)

    def one_of(self, key: str, options: Sequence[T], default: T) -> T:
        """The option that is written so."""
        given = self.texts.get(key)
        return next((one for one in options if str(one) == given), default)

    def some_of(self, key: str, options: Sequence[str], default: Sequence[str]) -> list[str]:
        """Options with commas between them."""
        if key not in self.texts:
            return list(default)
        given = self.texts[key].split(",")
        return [one for one in options if one in given]

    def numbers(
        self, key: str, ranges: Sequence[tuple[float, float]], default: Sequence[float]
    ) -> list[float]:
        """As many numbers as there are ranges, each within its own; else the default."""
        try:
            found = [float(part) for part in self.texts.get(key, "").split(",")]
        except ValueError:
            return list(default)
        fits = len(found) == len(ranges) and all(
            math.isfinite(x) and low <= x <= high
            for x, (low, high) in zip(found, ranges, strict=True)
        )
        return found if fits else list(default)


def written(values: Sequence[float]) -> str:
    """Numbers as they stand in an address.

    Examples
    --------
    >>> written([0.1, 2.0, -1])
    '0.1,2,-1'
    """
    return ",".join(f"{value:.10g}" for value in values)


def keep(mo: ModuleType, values: Mapping[str, tuple[str, str]]) -> None:
    """Write texts into the address, each given with what it is where nothing was changed.

    Only what differs from that is written: a page that nobody has touched has a short address.
    """
    query = mo.query_params()
    for key, (text, usual) in values.items():
        wanted = "" if text == usual or len(text) > PAGE.address else text
        if wanted and query.get(key) != wanted:
            query.set(key, wanted)
        elif not wanted and key in query:
            query.remove(key)
