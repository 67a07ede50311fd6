"""Maker: what made equations of several effects, and makes them again without some of these."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from geomtorsion.ode.problem import ODE


class Maker(Protocol):
    """Source of equations that contain effects, such as the force on a spin.

    title: its name. effects: key -> description of each effect that can be omitted.
    watch: names of the states and outputs of first interest.
    """

    @property
    def title(self) -> str:
        """Its name."""
        ...

    @property
    def effects(self) -> Mapping[str, str]:
        """Key -> description of each effect that can be omitted."""
        ...

    @property
    def watch(self) -> tuple[str, ...]:
        """Names of the states and outputs of first interest."""
        ...

    def without(self, ode: ODE, effects: frozenset[str]) -> ODE:
        """The equations without some effects, with the numbers of an ODE of this maker."""
        ...

    def moved(self, ode: ODE, part: float) -> ODE:
        """The equations from a start that is moved by a part of its size, within constraints."""
        ...
