"""Horizon: radius, temperature, entropy and more of one horizon."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import sympy as sp

from geomtorsion.support.displays import drawn_by
from geomtorsion.support.outgoing import number_text


@dataclass(frozen=True, repr=False)
class Horizon:
    """A Killing horizon where g^rr vanishes.

    radius: its coordinate. relation: the parameter that is expressed by the radius, with its value;
        empty for numbers.
    area, angular_velocity, surface_gravity, temperature, entropy: expressions in the radius and
        the other parameters, or floats; G = c = hbar = k = 1. An expression of surface gravity is
        positive at the outer horizon of a hole and negative at inner and cosmological ones, a
        float is its size.
    error: bound on the relative errors of floats; 0 for expressions.
    lagrangian: the theory of the entropy. assumed: assumptions, in words.
    """

    radius: sp.Expr | float
    relation: Mapping[sp.Symbol, sp.Expr]
    area: sp.Expr | float
    angular_velocity: sp.Expr | float
    surface_gravity: sp.Expr | float
    temperature: sp.Expr | float
    entropy: sp.Expr | float
    error: float
    lagrangian: str
    assumed: tuple[str, ...] = ()

    _repr_html_ = drawn_by("charges", "horizon_html")
    quantities: ClassVar[tuple[str, ...]] = (
        "radius", "area", "angular_velocity", "surface_gravity", "temperature", "entropy",
    )  # fmt: skip

    def to_json(self) -> dict[str, Any]:
        """The horizon as plain data; expressions as text."""
        values = {name: getattr(self, name) for name in self.quantities}
        plain = {k: x if isinstance(x, float) else str(x) for k, x in values.items()}
        relation = {str(x): str(value) for x, value in self.relation.items()}
        return {
            **plain,
            "relation": relation,
            "error": self.error,
            "lagrangian": self.lagrangian,
            "assumed": list(self.assumed),
        }

    def __str__(self) -> str:
        lines = [f"horizon at {self._shown(self.radius)}, entropy of L = {self.lagrangian}"]
        lines += [f"  with {x} = {value}" for x, value in self.relation.items()]
        lines += [
            f"  {name.replace('_', ' ')} = {self._shown(getattr(self, name))}"
            for name in self.quantities[1:]
        ]
        lines += [f"  assumed: {one}" for one in self.assumed]
        return "\n".join(lines)

    __repr__ = __str__

    def _shown(self, value: sp.Expr | float) -> str:
        if isinstance(value, float):
            return number_text(value, abs(value) * self.error)
        return str(value)
