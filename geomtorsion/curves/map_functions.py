"""Map functions: the functions in which a map between charts is written as it is worked out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np


@dataclass(frozen=True)
class MapFunctions:
    """Functions of double precision arrays, or of mpmath numbers at the precision that is set.

    choose: (condition, value where it holds, value where it does not).

    Examples
    --------
    >>> float(FLOATS.sqrt(2.0)) == float(DIGITS.sqrt(2.0))
    True
    """

    sqrt: Callable[[Any], Any]
    log: Callable[[Any], Any]
    atanh: Callable[[Any], Any]
    atan2: Callable[[Any, Any], Any]
    hypot: Callable[[Any, Any], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    choose: Callable[[Any, Any, Any], Any]


FLOATS = MapFunctions(
    np.sqrt, np.log, np.arctanh, np.arctan2, np.hypot, np.sin, np.cos, np.where
)  # fmt: skip
DIGITS = MapFunctions(
    mpmath.sqrt, mpmath.log, mpmath.atanh, mpmath.atan2, mpmath.hypot, mpmath.sin, mpmath.cos,
    lambda condition, one, other: one if condition else other,
)  # fmt: skip
