"""Problem: a law of motion with a start, and everything that can be said before solving."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import StartError
from geomtorsion.motion.charts import Atlas, Change
from geomtorsion.motion.equations import Equations, velocity_names, written
from geomtorsion.motion.laws import Law
from geomtorsion.motion.passengers import Passengers, boarded
from geomtorsion.motion.system import evaluated

if TYPE_CHECKING:
    import numpy as np

    from geomtorsion.geometry import Frame
    from geomtorsion.motion.system import Numbers


@dataclass(frozen=True, eq=False)
class Problem:
    """A motion to be solved: law, frame, start.

    name: what the curve is called.
    frame: its coordinates and legs are those in which start and answer are given.
    law: how the frame velocities change.
    start: coordinates q^mu at t = 0; None where only velocities are asked for.
    frame_velocity: u^i = e^i_mu q'^mu at t = 0.
    parameters: name -> number.
    atlas: charts of the space.
    passengers: what rides along: a transported vector or a separation.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> from geomtorsion.geometry import cartan
    >>> from geomtorsion.motion import autoparallel
    >>> so3 = load("so3").frame
    >>> print(autoparallel(cartan(so3), [0.3, 1.0, 0.2], frame_velocity=[1, 0, 0]))
    autoparallel on so3: q'^mu = E_i^mu u^i, u'^k = 0
    """

    name: str
    frame: Frame
    law: Law
    start: tuple[Any, ...] | None
    frame_velocity: tuple[Any, ...]
    parameters: Mapping[str, Any]
    atlas: Atlas
    passengers: Passengers | None = None
    _written: dict[str, Equations] = field(default_factory=dict, repr=False)

    # -- what is to be solved -------------------------------------------------------------------

    def equations(self, chart: str | None = None) -> Equations:
        """The equations in a chart (the home chart if none is named), worked out once."""
        name = "" if self.start is None else chart or self.atlas.home
        if name not in self._written:
            place = self.atlas.chart(name) if name else None
            plain = written(self.frame, self.law, place)
            self._written[name] = boarded(plain, self) if self.passengers else plain
        return self._written[name]

    @cached_property
    def charts(self) -> tuple[str, ...]:
        """Names of the charts in which this motion can be followed, by preference."""
        if self.start is None:
            return ("",)
        found = []
        for name in self.atlas.names:
            if name != self.atlas.home and self.passengers and not self.passengers.any_chart:
                continue
            chart = self.atlas.chart(name)
            if name == self.atlas.home or not self.law.keeps_frame or chart.keeps_frame:
                found.append(name)
        return tuple(found) or (self.atlas.home,)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return tuple(symbol.name for symbol in self.frame.coordinates)

    @cached_property
    def speed(self) -> float:
        """A power of two near the largest frame velocity: time is measured in its inverse."""
        size = max((abs(float(u)) for u in self.frame_velocity), default=0.0)
        return 2.0 ** round(math.log2(size)) if size else 1.0

    def kept(self, key: Any, maker: Callable[[], Any]) -> Any:
        """A thing that follows from this problem: made on first use, then kept."""
        table = self.__dict__.setdefault("_kept", {})
        if key not in table:
            table[key] = maker()
        return table[key]

    @cached_property
    def velocity(self) -> np.ndarray:
        """Coordinate velocities q'^mu at the start."""
        import numpy as np

        if self.start is None:
            raise StartError("this problem has no coordinates; give it a start")
        chart = self.atlas.chart(self.atlas.home)
        names = velocity_names(self.frame)
        rows = [tuple((value, (names[i],)) for i, value in row) for row in chart.legs]
        values = self.floats() | {
            name: float(u) for name, u in zip(names, self.frame_velocity, strict=True)
        }
        return np.array(evaluated(rows, values), dtype=float)

    def floats(self) -> dict[str, float]:
        """Coordinates at the start and parameters, by name, as floats."""
        values = {name: float(value) for name, value in self.parameters.items()}
        if self.start is not None:
            values |= {n: float(x) for n, x in zip(self.coordinates, self.start, strict=True)}
        return values

    def route(self, source: str, target: str) -> list[Change]:
        """The maps from one chart to another."""
        return self.atlas.route(source, target)

    # -- variants -------------------------------------------------------------------------------

    def moved(
        self,
        start: Numbers | None = None,
        velocity: Numbers | None = None,
        frame_velocity: Numbers | None = None,
    ) -> Problem:
        """The same law from another start; nothing is compiled anew.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> from geomtorsion.motion import geodesic
        >>> p = geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1})
        >>> p.moved(velocity=[1.0, 0.0]).frame_velocity
        (1.0, 0.0)
        """
        from geomtorsion.motion.start import checked_start, frame_velocities

        place = self.start if start is None else checked_start(self.frame, start, self.parameters)
        if velocity is None and frame_velocity is None:
            return replace(self, start=place)
        speeds = frame_velocities(self.frame, place, velocity, frame_velocity, self.parameters)
        return replace(self, start=place, frame_velocity=speeds)

    def with_charts(self, *names: str) -> Problem:
        """The same motion, followed in these charts only, in this order of preference."""
        return replace(self, atlas=self.atlas.only(*names), _written={})

    # -- showing --------------------------------------------------------------------------------

    @property
    def text(self) -> str:
        """The equations of motion, written out line by line."""
        equations = self.equations()
        lines = []
        for name, rate in zip(equations.system.states, equations.system.rates, strict=True):
            terms = " + ".join("*".join([f"({c.sympy})", *names]) for c, names in rate)
            lines.append(f"{name}' = {terms or '0'}")
        if not equations.moves:
            lines += [f"{name}' = 0" for name in equations.velocities]
        return "\n".join(lines)

    @property
    def latex(self) -> str:
        """The equations of motion in LaTeX."""
        import sympy as sp

        equations = self.equations()
        lines = []
        for name, rate in zip(equations.system.states, equations.system.rates, strict=True):
            total = sp.Add(*(sp.Mul(c.sympy, *(sp.Symbol(n) for n in names)) for c, names in rate))
            lines.append(f"\\dot{{{sp.latex(sp.Symbol(name))}}} &= {sp.latex(total)}")
        if not equations.moves:
            lines += [f"\\dot{{{sp.latex(sp.Symbol(n))}}} &= 0" for n in equations.velocities]
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"

    def _repr_latex_(self) -> str:
        return f"$${self.latex}$$"

    def __str__(self) -> str:
        where = f" on {self.frame.name}" if self.frame.name else ""
        if self.start is None:
            return f"{self.name}{where}: {self.law.text}"
        return f"{self.name}{where}: q'^mu = E_i^mu u^i, {self.law.text}"

    def __repr__(self) -> str:
        return str(self)

    def check_parameters(self) -> None:
        """Refuse to start without a value for each parameter that occurs."""
        equations = self.equations(self.charts[0])
        needed = [
            name
            for name in equations.system.parameters
            if name not in equations.velocities and name not in equations.constants
        ]
        missing = [name for name in needed if name not in self.parameters]
        if missing:
            example = ", ".join(f"{name!r}: 1.0" for name in missing)
            raise StartError(
                f"{', '.join(missing)} has no value. Give parameters={{{example}}}, for example."
            )
