"""Reduced form: the way from the states of a full system to those of a smaller one, and back."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from geomtorsion.motion.engines.protocol import Engine
from geomtorsion.motion.engines.taylor import Taylor, heyoka, is_available
from geomtorsion.motion.reduced.confined import Confined
from geomtorsion.motion.reduced.constants import SPARE, Constants
from geomtorsion.motion.reduced.split import Written
from geomtorsion.motion.system import System, floats, mpf

# Velocities that come back from their momenta more roundings off than this are not reduced.
ROUNDINGS = 64
# Engines that measure steps block by block need to see velocities near the size of the largest.
SEEN = 1e-3


@dataclass(frozen=True, eq=False)
class Opening:
    """A start of the smaller system.

    start, values: of its states and parameters.
    numbers: old parameters, momenta that are constants, and constants of single coordinates.
    confined: whether it is one of the system for confined motions.
    """

    start: Any
    values: Any
    numbers: Any
    confined: bool = False


@dataclass(frozen=True, eq=False)
class Reduction:
    """A smaller system in the place of a full one.

    full_system: what it stands for; written: the smaller system, and how both hang together.

    Examples
    --------
    >>> from geomtorsion.motion import geodesic
    >>> from geomtorsion.spaces import load
    >>> frame = load("schwarzschild").frame
    >>> circle = geodesic(frame, [0, 8, 1.5, 0], [1, 0, 0, 0.04], parameters={"M": 1})
    >>> circle.equations("schwarzschild").reduction.system.states
    ('t', 'r', 'theta', 'phi', 'v_r', 'v_theta')
    """

    full_system: System
    written: Written

    @property
    def system(self) -> System:
        """The smaller system: states that are left, in the old order; more parameters."""
        return self.written.system

    @cached_property
    def confined(self) -> Confined:
        """The system for motions that cannot reach an edge."""
        return Confined(self.full_system, self.written)

    def watching(self, system: System, confined: bool = False) -> System:
        """The smaller system with the edge that a variant of the full one has.

        confined: as the opening says.
        """
        if confined:
            return self.confined.system
        if system.edge is None:
            return self.system.without_edge
        return self.system.to_the_end if len(system.edge) == 1 else self.system

    # -- in --------------------------------------------------------------------------------------

    @cached_property
    def worked_out(self) -> Constants:
        """How constants follow from a start."""
        return Constants(self.full_system, self.written)

    @property
    def names(self) -> tuple[str, ...]:
        """What `constants` gives: momenta, those of single coordinates, sums of products."""
        return self.worked_out.names

    def constants(
        self, start: Sequence[Any], parameters: Sequence[Any], precision: int = 53
    ) -> tuple[Any, ...]:
        """Values of `names` for a full start: floats, or mpmath numbers above 53 bits."""
        return self.worked_out.entered(start, parameters, precision)[1]

    def opening(self, start: Sequence[Any], parameters: Sequence[Any], precision: int) -> Opening:
        """The start of the smaller system for a full start."""
        import numpy as np

        momenta, constants = self.worked_out.entered(start, parameters, precision)
        begun = [*start[: self.written.width], *momenta]
        values = [*parameters, *(constants[k] for k in self.places)]
        numbers = (*parameters, *constants)[: len(self.out.parameters)]
        if precision == 53:
            begun, values = np.array(begun, dtype=float), np.array(values, dtype=float)
            return Opening(begun, values, np.array(numbers, dtype=float))
        return Opening(begun, values, Taylor(precision).array(numbers))

    @cached_property
    def places(self) -> tuple[int, ...]:
        """Places in `names` of the parameters that the smaller system has more."""
        extra = self.system.parameters[len(self.full_system.parameters) :]
        return tuple(self.names.index(name) for name in extra)

    # -- out -------------------------------------------------------------------------------------

    @cached_property
    def out(self) -> System:
        """The velocities that are no states here."""
        written = self.written
        numbers = (*self.full_system.parameters, *written.constants, *written.separators)
        return System(self.system.states, numbers, written.velocities, ())

    @cached_property
    def _functions(self) -> dict[tuple[int, bool], Callable[[Any], Any]]:
        return {}

    def function(self, bits: int, confined: bool) -> tuple[Callable[[Any], Any], float]:
        """Angles behind cosines, then velocities, as a function of rows of numbers.

        With the seconds that it takes to compile it.
        """
        known = self._functions.get((bits, confined))
        if known is not None:
            return known, 0.0
        began = time.perf_counter()
        cosines = self._cosines(confined)
        made = self._by_heyoka(bits, cosines) if is_available() else self._by_numpy(cosines)
        self._functions[bits, confined] = made
        return made, time.perf_counter() - began

    def _cosines(self, confined: bool) -> tuple[int, ...]:
        """Places of the states that are cosines of coordinates."""
        return self.confined.cosines if confined else ()

    def _by_heyoka(self, bits: int, cosines: Sequence[int]) -> Callable[[Any], Any]:
        hy, number = heyoka(), Taylor(bits).number
        names = (*self.out.states, *self.out.parameters)
        variables = hy.make_vars(*(f"s{k}" for k in range(len(names))))
        inputs = list(variables)
        for place in cosines:
            inputs[place] = hy.acos(variables[place])
        known = dict(zip(names, inputs, strict=True))
        rows, _ = self.out.written(known, lambda p, q: hy.expression(number(Fraction(p, q))))
        rows = [*(inputs[place] for place in cosines), *rows]
        options: dict[str, Any] = {"prec": bits} if bits > 113 else {}
        return hy.cfunc(rows, variables, fp_type=type(number(0)), **options)

    def _by_numpy(self, cosines: Sequence[int]) -> Callable[[Any], Any]:
        import numpy as np

        def function(rows: Any) -> Any:
            inputs = list(rows)
            with np.errstate(all="ignore"):
                for place in cosines:
                    inputs[place] = np.arccos(rows[place])
                found = self.out.array_rates(*inputs)
            angles = [inputs[place] for place in cosines]
            return np.array([np.broadcast_to(row, rows.shape[1]) for row in (*angles, *found)])

        return function

    def widened(self, states: Any, opening: Opening, bits: int) -> Any:
        """Full states, shape (m, full size), of shape (m, size) of the opened system."""
        import numpy as np

        (count, size), numbers = states.shape, opening.numbers
        rows = np.empty((size + len(numbers), count), dtype=states.dtype)
        rows[:size] = states.T
        rows[size:] = numbers[:, None]
        out = np.empty((self.full_system.size, count), dtype=states.dtype)
        self._fill(out, rows, bits, opening.confined)
        return out.T

    def _fill(self, out: Any, rows: Any, bits: int, confined: bool) -> None:
        """Coordinates and velocities of rows of smaller states and numbers."""
        width, cosines = self.written.width, self._cosines(confined)
        found = self.function(bits, confined)[0](rows.reshape(len(rows), -1))
        found = found.reshape(-1, *out.shape[1:])
        out[:width] = rows[:width]
        out[width:] = found[len(cosines) :]
        for angle, place in zip(found, cosines, strict=False):
            out[place] = angle

    def abreast(self, states: Any, numbers: Any, confined: bool) -> Any:
        """Full states of lanes, shape (m, full size, lanes), of shape (m, size, lanes).

        numbers: those of the openings of all lanes, shape (numbers, lanes).
        confined: as the openings say.
        """
        import numpy as np

        count, size, lanes = states.shape
        rows = np.empty((size + len(numbers), count, lanes))
        rows[:size] = states.swapaxes(0, 1)
        rows[size:] = numbers[:, None]
        out = np.empty((self.full_system.size, count, lanes))
        self._fill(out, rows, 53, confined)
        return out.swapaxes(0, 1)

    # -- whether ---------------------------------------------------------------------------------

    def lost(self, size: Any) -> Any:
        """By how much velocities of a size may come back changed."""
        return ROUNDINGS * 2.0**-53 * size

    def serves(self, engine: Engine, opening: Opening, start: Sequence[Any]) -> bool:
        """Whether this start loses no digits, and leaves the engine something to measure."""
        whole = floats(start)
        try:
            found = self.out.scalar_function(*floats(opening.start), *floats(opening.numbers))
        except (ArithmeticError, ValueError):
            return False
        own = whole[self.written.width :]
        size = max(map(abs, own))
        gap = max([abs(x - y) for x, y in zip(own, found, strict=True)])
        if not gap <= self.lost(size):
            return False
        # Others than Taylor series measure steps block by block.
        left = [abs(x) for k, x in enumerate(own) if k not in self.written.along]
        return isinstance(engine, Taylor) or max(left) >= SEEN * size

    def opened(
        self,
        engine: Engine,
        start: Sequence[Any],
        parameters: Sequence[Any],
        like: Opening | None = None,
    ) -> Opening | None:
        """The start of the smaller system, or None where it does not serve.

        like: that of a start nearby, which is confined or not as this one is.
        One problem starts many runs from the same read-only arrays: the last is remembered.
        """
        flags = getattr(start, "flags", None)
        lasting = flags is not None and not flags.writeable
        kind = isinstance(engine, Taylor)
        last = self.__dict__.get("_last")
        if lasting and last and last[0] is start and last[1] is parameters and last[2] is kind:
            return last[3]
        try:
            found = self.opening(start, parameters, engine.precision)
        except (ArithmeticError, ValueError):
            return None
        result = found if self.serves(engine, found, start) else None
        if result is not None:
            result = self._within(result, start, engine.precision, like)
        if lasting:
            self.__dict__["_last"] = (start, parameters, kind, result)
        return result

    def _within(
        self, opening: Opening, start: Sequence[Any], bits: int, like: Opening | None
    ) -> Opening:
        """The opening of the system for confined motions where this is one."""
        import numpy as np

        if not self.written.singles:
            return opening
        if like is not None:
            confined = like.confined
        else:
            rows = ([np.array([x]) for x in floats(row)] for row in (start, opening.numbers))
            confined = bool(self.confined.holds(*rows)[0])
        if not confined:
            return opening
        begun = [*opening.start]
        for place in self.confined.cosines:
            begun[place] = cosine(start[place], bits)
        if bits == 53:
            return replace(opening, start=np.array(begun), confined=True)
        return replace(opening, start=begun, confined=True)


def cosine(angle: Any, bits: int) -> Any:
    """A float, or an mpmath number above 53 bits."""
    if bits == 53:
        return math.cos(angle)
    import mpmath

    with mpmath.workprec(bits + SPARE):
        return mpmath.cos(mpf(angle, bits + SPARE))
