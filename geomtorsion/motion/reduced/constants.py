"""Reduced constants: what does not change on a motion, worked out from its start."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from geomtorsion.motion.reduced.split import Written
from geomtorsion.motion.system import System, floats, mpf

# Bits on top of the precision asked for, and bits that numbers of the machine must have to serve.
SPARE, ENOUGH = 20, 63


@dataclass(frozen=True, eq=False)
class Constants:
    """Constants of a smaller system, each kind made of those before it.

    full_system: of which they are functions; written: the smaller system.
    """

    full_system: System
    written: Written

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of momenta, of constants of single coordinates, and of sums of products."""
        written = self.written
        return (*written.constants, *written.separators, *written.mixtures)

    @cached_property
    def _door(self) -> System:
        """Momenta that are states, then constants, as functions of the full states."""
        sums = (*self.written.momenta, *self.written.constants.values())
        return System(self.full_system.states, self.full_system.parameters, sums, ())

    @cached_property
    def _separator(self) -> System | None:
        """Constants of single coordinates, as functions of those, their momenta, and constants."""
        written = self.written
        if not written.separators:
            return None
        states = (*written.system.states, *written.constants)
        sums = tuple(written.separators.values())
        return System(states, self.full_system.parameters, sums, ())

    @cached_property
    def _mixer(self) -> System:
        """Sums of products of constants."""
        names = (*self.written.constants, *self.written.separators)
        mixtures = tuple(self.written.mixtures.values())
        return System(names, self.full_system.parameters, mixtures, ())

    def entered(
        self, start: Sequence[Any], parameters: Sequence[Any], bits: int
    ) -> tuple[Sequence[Any], tuple[Any, ...]]:
        """Momenta that are states, and values of `names`; mpmath numbers above 53 bits."""
        if bits == 53 and self._separator is None:
            numbers = floats(parameters)
            return self._stages(lambda s, x: s.scalar_function(*x, *numbers), floats(start))
        if bits == 53:
            return _rounded(*self._longer(start, parameters))
        import mpmath

        with mpmath.workprec(bits + SPARE):
            return self._stages(
                lambda s, x: _precisely(s, (*x, *parameters), bits + SPARE), tuple(start)
            )

    def _stages(
        self, worked_out: Callable[[System, Sequence[Any]], Sequence[Any]], start: Sequence[Any]
    ) -> tuple[Sequence[Any], tuple[Any, ...]]:
        """Momenta, and constants of which each kind is made of those before it."""
        count = len(self.written.momenta)
        found = tuple(worked_out(self._door, start))
        momenta, plain = found[:count], found[count:]
        if self._separator is not None:
            place = start[: self.written.width]
            own = worked_out(self._separator, (*place, *momenta, *plain))
            plain = (*plain, *own)
        return momenta, (*plain, *worked_out(self._mixer, plain))

    def _longer(
        self, start: Sequence[Any], parameters: Sequence[Any]
    ) -> tuple[Sequence[Any], tuple[Any, ...]]:
        """The same with digits to spare: constants are differences of what may be much larger."""
        import numpy as np

        if not is_longer():
            return self.entered(start, parameters, 53 + SPARE)
        numbers = [np.longdouble(x) for x in floats(parameters)]
        return self._of_arrays([np.longdouble(x) for x in floats(start)], numbers)

    def of_many(self, start: Any, parameters: Any) -> tuple[list[Any], list[Any]] | None:
        """The same of many starts, shapes (size, n) and (parameters, n), as lists of arrays.

        None where the machine has no numbers that are long enough.
        """
        import numpy as np

        kind = np.float64 if self._separator is None else np.longdouble
        if self._separator is not None and not is_longer():
            return None
        count = start.shape[1]
        found = self._of_arrays(list(start.astype(kind)), list(parameters.astype(kind)))
        momenta, constants = (
            [np.broadcast_to(np.asarray(x, dtype=float), count) for x in row] for row in found
        )
        return momenta, constants

    def _of_arrays(self, start: list[Any], numbers: list[Any]) -> tuple[Sequence[Any], Any]:
        """Momenta and constants of numbers of the machine."""
        import numpy as np

        with np.errstate(all="ignore"):
            return self._stages(lambda s, x: s.array_rates(*x, *numbers), start)


def is_longer() -> bool:
    """Whether the machine's long numbers have digits to spare."""
    import numpy as np

    return np.finfo(np.longdouble).nmant >= ENOUGH


def _rounded(momenta: Sequence[Any], constants: Sequence[Any]) -> Any:
    """Floats of numbers that have more digits."""
    found = floats(momenta), tuple(floats(constants))
    if not all(math.isfinite(x) for row in found for x in row):
        raise ArithmeticError("a constant of this start has no value")
    return found


def _precisely(system: System, values: Sequence[Any], bits: int) -> list[Any]:
    """The rates of a system as mpmath numbers."""
    import mpmath

    names = (*system.states, *system.parameters)
    table = {name: mpf(x, bits) for name, x in zip(names, values, strict=True)}
    found = []
    for sums in system.rates:
        total = mpmath.mpf(0)
        for element, factors in sums:
            factor = mpmath.mpmathify(element.evaluate(table, bits))
            total += factor * math.prod([table[name] for name in factors])
        found.append(total)
    return found
