"""element keys: controls of a new case take no value from the controls of the previous case.

marimo numbers the elements of a cell from zero and redraws an element with the same number. A text
field waits a moment before it sends its text. A late text, or a text that the browser stores under
the same number, would then enter a field of the next case, which has another tetrad.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from types import ModuleType

from geomtorsion.teaching.lab.settings import PAGE


def skip_numbers(mo: ModuleType, cases: Sequence[object], chosen: object, most: int) -> None:
    """Skip element numbers, so that at most `most` fields of this case get numbers of their own.

    Fields in a dictionary take two numbers, the dictionary itself one.
    """
    for _ in range(cases.index(chosen) % PAGE.apart * (2 * most + 1)):
        mo.ui.checkbox()


def keyed(html: str, *case: object) -> str:
    """HTML that a browser draws completely whenever the case changes.

    The name of the tag depends on the case: a browser replaces an element with another tag, but
    keeps an element whose attributes change.

    Examples
    --------
    >>> keyed("<p>r</p>", "so3", 3) == keyed("<p>r</p>", "so3", 3)
    True
    >>> keyed("", "so3") == keyed("", "s2")
    False
    """
    tag = f"case-{zlib.crc32(repr(case).encode()):x}"
    return f"<{tag}>{html}</{tag}>"
