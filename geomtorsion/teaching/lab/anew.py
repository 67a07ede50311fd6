"""anew: fields of one case that take nothing over from those of the case before.

marimo numbers what a cell makes from nought on and draws over what stands there. A field into which
somebody types waits a moment before it tells; what it tells late, or what the browser still holds
under its number, would come into the field of the next case, whose tetrad is another one.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from types import ModuleType

from geomtorsion.teaching.lab.settings import PAGE


def numbers_apart(mo: ModuleType, cases: Sequence[object], chosen: object, most: int) -> None:
    """Leave numbers out, so that at most so many fields of this case have others than before.

    Fields in a dictionary take two numbers, the dictionary itself one.
    """
    for _ in range(cases.index(chosen) % PAGE.apart * (2 * most + 1)):
        mo.ui.checkbox()


def drawn_anew(html: str, *case: object) -> str:
    """HTML that a browser draws from nothing as soon as the case is another one.

    A tag of another name is another thing to it, where attributes are only changed.

    Examples
    --------
    >>> drawn_anew("<p>r</p>", "so3", 3) == drawn_anew("<p>r</p>", "so3", 3)
    True
    >>> drawn_anew("", "so3") == drawn_anew("", "s2")
    False
    """
    tag = f"case-{zlib.crc32(repr(case).encode()):x}"
    return f"<{tag}>{html}</{tag}>"
