"""Structures: facts about crystal structures, by name."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

Indices = Sequence[float]
# Name, prototype and colour of a family of Burgers vectors, as OVITO writes them.
Family = tuple[str, str, str]


@dataclass(frozen=True)
class Structure:
    """Facts about a crystal structure; an empty field means unknown.

    rows: lattice vectors in units of the shortest one; simulations give b in this unit.
    slip: the usual planes (h, k, l) with a Burgers vector in units of a, b, c; hcp: four indices.
    number, title: of the structure in OVITO. families: names and colours of its lines in OVITO.
    """

    rows: tuple[tuple[float, float, float], ...] = ()
    slip: tuple[tuple[Indices, Indices], ...] = ()
    number: int = 0
    title: str = ""
    families: tuple[Family, ...] = ()


_THIRD, _SIXTH, _HALF = "0.333333333333", "0.166666666667", "0.5"
_SIDE, _CORNER = 1 / math.sqrt(2), 1 / math.sqrt(3)
_CUBIC_SLIP = (((1, 1, 1), (0.5, -0.5, 0)),)
_HEXAGONAL: tuple[Family, ...] = (
    ("1/3<1-210>", f"{math.sqrt(0.5)!r} 0 0", "0 1 0"),
    ("<0001>", f"0 0 {math.sqrt(4 / 3)!r}", "0.2 0.2 1"),
    ("<1-100>", f"0 {math.sqrt(1.5)!r} 0", "1 0 1"),
    ("1/3<1-100>", f"0 {math.sqrt(1 / 6)!r} 0", "1 0.5 0"),
    ("1/3<1-213>", f"{math.sqrt(0.5)!r} 0 {math.sqrt(4 / 3)!r}", "1 1 0"),
)
STRUCTURES: Mapping[str, Structure] = {
    "sc": Structure(rows=((1, 0, 0), (0, 1, 0), (0, 0, 1))),
    "fcc": Structure(
        rows=((0, _SIDE, _SIDE), (_SIDE, 0, _SIDE), (_SIDE, _SIDE, 0)),
        slip=_CUBIC_SLIP,
        number=1,
        title="FCC",
        families=(
            ("1/2<110> (Perfect)", f"{_HALF} {_HALF} 0", "0.2 0.2 1"),
            ("1/6<112> (Shockley)", f"{_SIXTH} {_SIXTH} {_THIRD}", "0 1 0"),
            ("1/6<110> (Stair-rod)", f"{_SIXTH} {_SIXTH} 0", "1 0 1"),
            ("1/3<100> (Hirth)", f"{_THIRD} 0 0", "1 1 0"),
            ("1/3<111> (Frank)", f"{_THIRD} {_THIRD} {_THIRD}", "0 1 1"),
        ),
    ),
    "bcc": Structure(
        rows=(
            (-_CORNER, _CORNER, _CORNER),
            (_CORNER, -_CORNER, _CORNER),
            (_CORNER, _CORNER, -_CORNER),
        ),
        slip=(
            ((1, 1, 0), (0.5, -0.5, 0.5)),
            ((1, 1, 2), (0.5, 0.5, -0.5)),
            ((1, 2, 3), (0.5, 0.5, -0.5)),
        ),
        number=3,
        title="BCC",
        families=(
            ("1/2<111>", f"{_HALF} {_HALF} {_HALF}", "0 1 0"),
            ("<100>", "1 0 0", "1 0.3 0.8"),
            ("<110>", "1 1 0", "0.2 0.5 1"),
        ),
    ),
    "hcp": Structure(
        # The ideal ratio c / a; real crystals deviate from it.
        rows=((1, 0, 0), (-0.5, math.sqrt(0.75), 0), (0, 0, math.sqrt(8 / 3))),
        slip=(
            ((0, 0, 0, 1), (2 / 3, -1 / 3, -1 / 3, 0)),
            ((0, 1, -1, 0), (2 / 3, -1 / 3, -1 / 3, 0)),
            ((0, 1, -1, 1), (2 / 3, -1 / 3, -1 / 3, 0)),
            ((1, 1, -2, 2), (-1 / 3, -1 / 3, 2 / 3, 1)),
        ),
        number=2,
        title="HCP",
        families=_HEXAGONAL,
    ),
    "diamond": Structure(
        slip=_CUBIC_SLIP,
        number=4,
        title="Cubic diamond",
        families=(
            ("1/2<110>", f"{_HALF} {_HALF} 0", "0.2 0.2 1"),
            ("1/6<112>", f"{_SIXTH} {_SIXTH} {_THIRD}", "0 1 0"),
        ),
    ),
    # OVITO finds no lines in hexagonal diamond; its families are the families of hcp.
    "hexagonal diamond": Structure(number=6, title="Hexagonal diamond", families=_HEXAGONAL),
    # A network of an unknown crystal: OVITO shows its lines in one colour.
    "": Structure(number=5, title="unknown"),
}
