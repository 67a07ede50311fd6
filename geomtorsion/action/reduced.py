"""Reduced: equations for the velocities alone, where no coordinate occurs in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from geomtorsion.action import writing
from geomtorsion.errors import LagrangianError


@dataclass(frozen=True)
class Reduced:
    """Rates of u^k in u, t and parameters, as on a Lie group, and what they keep.

    rates: name of a velocity -> its rate.
    invariants: name -> f(u, t).
    """

    rates: Mapping[str, sp.Expr]
    invariants: Mapping[str, sp.Expr]

    @property
    def text(self) -> str:
        """One line for each rate."""
        return writing.rate_text(self.rates)

    @property
    def latex(self) -> str:
        """The rates as aligned LaTeX."""
        return writing.rate_latex(self.rates)

    def _repr_latex_(self) -> str:
        return f"$${self.latex}$$"

    def __str__(self) -> str:
        return self.text


def reduced(
    rates: Mapping[str, sp.Expr],
    invariants: Mapping[str, sp.Expr],
    coordinates: tuple[sp.Symbol, ...],
) -> Reduced:
    """Leave out the coordinates.

    Raises
    ------
    LagrangianError
        A coordinate occurs in the rate of a velocity; the message names both.
    """
    inside = {symbol.name: symbol for symbol in coordinates}
    kept = {name: rate for name, rate in rates.items() if name not in inside}
    for name, rate in kept.items():
        met = sorted(symbol.name for symbol in rate.free_symbols & set(coordinates))
        if met:
            raise LagrangianError(
                f"the rate of {name} depends on {', '.join(met)}, so the velocities do not stand "
                "alone. Use the equations with their coordinates."
            )
    still = {k: v for k, v in invariants.items() if not v.free_symbols & set(coordinates)}
    return Reduced(kept, still)
