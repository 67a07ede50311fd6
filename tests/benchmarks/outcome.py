"""Outcome: the result of a contestant, and the type of its progress reports."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

Reached = Callable[[str], None]


@dataclass(frozen=True)
class Outcome:
    """kretschmann: the scalar; ricci: all components, as the contestant returned them."""

    kretschmann: sp.Expr
    ricci: tuple[sp.Expr, ...]

    @property
    def ricci_is_zero(self) -> bool:
        """Whether each component is literally 0, with nothing left to simplify."""
        return all(component == 0 for component in self.ricci)
