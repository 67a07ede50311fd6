"""Requests: what a solution of reduced equations holds, and how it is solved; read once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from geomtorsion.errors import GravityError
from geomtorsion.ode import ODE, At, Engine, Solution, When, solve
from geomtorsion.ode.numbers import event_list
from geomtorsion.ode.solve import ACCURACY
from geomtorsion.support import checks
from geomtorsion.support.arguments import Times


@dataclass(frozen=True, eq=False)
class Request:
    """What a solution holds besides its states, what ends it, and how it is solved.

    outputs, events, accuracy, engine: as for `gt.ODE.of` and `gt.solve`.
    """

    outputs: Mapping[str, object]
    events: tuple[At | When, ...] = ()
    accuracy: float = ACCURACY
    engine: Engine | None = None

    @classmethod
    def of(
        cls,
        outputs: Mapping[str, object] | None,
        events: Iterable[At | When],
        accuracy: float = ACCURACY,
        engine: Engine | None = None,
    ) -> Request:
        """A request of a user; GravityError, TimeError where outputs or events are none."""
        named = checks.by_name(outputs or {}, "outputs", GravityError)
        return cls(named, tuple(event_list(events)), accuracy, engine)

    def solved(self, ode: ODE, times: Times) -> Solution:
        """The solution of equations with a start."""
        return solve(ode, times, self.accuracy, self.engine)
