"""Centre: a point where rates have a simple pole, from which a regular solution begins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Centre:
    """The regular solution of equations that start beside a pole, such as r = 0 in a star.

    origin: the value of the variable at the pole, an exact number.
    place: the parameter that is the value of the variable at time zero.
    values: state -> exact number at the pole.
    """

    origin: Any
    place: str
    values: Mapping[str, Any]
