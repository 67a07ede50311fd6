"""Outcome: what a contestant hands back, and how it says how far it came."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

Reached = Callable[[str], None]


@dataclass(frozen=True)
class Outcome:
    """kretschmann: the scalar; ricci: all components, as the contestant left them."""

    kretschmann: sp.Expr
    ricci: tuple[sp.Expr, ...]

    @property
    def ricci_is_zero(self) -> bool:
        """Every component came out as 0 itself: nothing is left to a reader to simplify."""
        return all(component == 0 for component in self.ricci)
