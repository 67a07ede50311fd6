"""Frame vectors: vectors in the frame with a bound on their error, their sums and multiples."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np

from geomtorsion.conventions import Signed
from geomtorsion.errors import LoopError
from geomtorsion.loops import validation
from geomtorsion.loops.arcs import Number, Parameters
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.copies import ByContent
from geomtorsion.support.exclusive import exclusive
from geomtorsion.support.outgoing import size_text
from geomtorsion.support.precision import EPS

if TYPE_CHECKING:
    from numpy.typing import DTypeLike

    from geomtorsion.geometry import Frame


@exclusive
class FrameVector:
    """Common properties of a Burgers vector and of a sum of such vectors."""

    frame: Frame
    reduced: np.ndarray
    reduced_error: float
    size: float
    power: int
    parameters: Mapping[str, Number]

    # Numbers and arrays of NumPy leave sums and products to the vector.
    __array_priority__ = 1000

    @cached_property
    def vector(self) -> np.ndarray:
        """b^i in the frame, shape (n,)."""
        with np.errstate(over="ignore"):
            result = self.reduced * self.size
            if self.power == 2:
                result = result * self.size
        result.setflags(write=False)
        return result

    @property
    def error(self) -> float:
        """Bound on the error of the largest component of `vector`."""
        return self.reduced_error * self.size * (self.size if self.power == 2 else 1.0)

    @property
    def relative_error(self) -> float:
        """Error over largest component: 0 for an exact zero, infinite for a zero that is not."""
        largest = float(np.abs(self.reduced).max())
        if largest:
            return self.reduced_error / largest
        return math.inf if self.reduced_error else 0.0

    @property
    def vanishes(self) -> bool:
        """Whether the vector is zero within its error."""
        return self.relative_error >= 1 or not self.reduced.any()

    @property
    def numbers(self) -> tuple[mpmath.mpf | mpmath.mpc, ...]:
        """b^i as mpmath numbers, which do not underflow: for loops of size 1e-300."""
        unit = mpmath.mpf(self.size) ** self.power
        return tuple(mpmath.mpmathify(x) * unit for x in self.reduced.tolist())

    @cached_property
    def _eta(self) -> np.ndarray:
        """The metric of the frame as numbers."""
        return self.frame.eta.at(self._named({}))

    def _named(self, point: Parameters) -> dict[Any, Any]:
        """A point with the parameters."""
        return {**self.parameters, **point}

    @property
    def square(self) -> float | complex:
        """eta_ij b^i b^j."""
        return (self.vector @ self._eta @ self.vector).item()

    @property
    def magnitude(self) -> float:
        """Length of the vector, sqrt|eta_ij b^i b^j|."""
        scale = self.size**self.power
        return math.sqrt(abs((self.reduced @ self._eta @ self.reduced).item())) * scale

    def screw(self, direction: Sequence[float]) -> np.ndarray:
        """The part of b along a direction (frame components), as of a screw dislocation.

        Raises
        ------
        LoopError
            The direction has no length in the metric of the frame.
        """
        along = np.array(validation.vector(direction, "direction", self.frame.dimension))
        square = along @ self._eta @ along
        if not abs(square) > 1e-15 * np.abs(along).max() ** 2:
            raise LoopError(f"direction {direction!r} has no length in the metric of the frame.")
        return along * ((along @ self._eta @ self.vector) / square)

    def edge(self, direction: Sequence[float]) -> np.ndarray:
        """The part of b across a direction (frame components), as of an edge dislocation."""
        return self.vector - self.screw(direction)

    # -- as an array -----------------------------------------------------------------------------

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> np.ndarray:
        """The components of `vector`."""
        return np.array(self.vector, dtype=dtype)

    def __format__(self, how: str) -> str:
        """The components, each in a format of numbers; without one the whole text."""
        return f"[{', '.join(format(x, how) for x in self.vector)}]" if how else str(self)

    def __len__(self) -> int:
        return len(self.vector)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.vector)

    def __getitem__(self, index: Any) -> Any:
        return self.vector[index]

    def __abs__(self) -> float:
        return self.magnitude

    # -- sums and multiples ----------------------------------------------------------------------

    def __neg__(self) -> FrameVector:
        return self._with(0.0 - self.reduced, self.reduced_error, self.size, self.power)

    def __mul__(self, factor: object) -> VectorSum:
        """The vector times a real number; its error grows by the same factor."""
        number = checks.real(factor)
        if number is None or not math.isfinite(number):
            return NotImplemented
        return self._with(
            self.reduced * number, self.reduced_error * abs(number), self.size, self.power
        )

    __rmul__ = __mul__

    def __truediv__(self, divisor: object) -> VectorSum:
        number = checks.real(divisor)
        if number is None or not math.isfinite(number):
            return NotImplemented
        if not number:
            raise ZeroDivisionError("Burgers vector / 0: expected a divisor that is not zero.")
        return self * (1 / number)

    def __add__(self, other: object) -> VectorSum:
        """The sum with another vector of the frame; errors add.

        An array of n numbers counts as a vector without error.

        Raises
        ------
        LoopError
            The other vector has another frame or other parameters.
        """
        return self._plus(other, 1.0)

    def __radd__(self, other: object) -> VectorSum:
        return self._plus(other, 1.0)

    def __sub__(self, other: object) -> VectorSum:
        return self._plus(other, -1.0)

    def __rsub__(self, other: object) -> VectorSum:
        return (-self)._plus(other, 1.0)

    def _plus(self, other: object, sign: float) -> VectorSum:
        if isinstance(other, FrameVector):
            if (other.frame, other.parameters) != (self.frame, self.parameters):
                raise LoopError(
                    "sum of Burgers vectors: expected vectors of one frame with equal parameters, "
                    "got two frames or other parameters. Compute both over one frame."
                )
            row, error, size, power = other.reduced, other.reduced_error, other.size, other.power
        else:
            # `sum` begins with the number 0.
            is_zero = isinstance(other, int) and other == 0
            row = np.zeros(len(self)) if is_zero else np.asarray(other)
            error, size, power = 0.0, 1.0, 1
            if row.shape != self.vector.shape or row.dtype.kind not in "iufc":
                return NotImplemented
        units = [mpmath.mpf(self.size) ** self.power, mpmath.mpf(size) ** power]
        # In the larger unit nothing overflows.
        if units[0] < units[1]:
            factors = float(units[0] / units[1]), 1.0
        else:
            factors = 1.0, float(units[1] / units[0])
            size, power = self.size, self.power
        total = self.reduced * factors[0] + sign * row * factors[1]
        return self._with(total, self.reduced_error * factors[0] + error * factors[1], size, power)

    def _with(self, reduced: np.ndarray, error: float, size: float, power: int) -> VectorSum:
        """A vector of the same frame; the rounding of the last operation is added to its error."""
        rounding = EPS * float(np.abs(reduced).max())
        return VectorSum(self.frame, reduced, error + rounding, size, power, self.parameters)


@exclusive
@dataclass(frozen=True, eq=False, repr=False)
class VectorSum(ByContent, Signed, FrameVector):
    """A sum of multiples of Burgers vectors, frame components.

    frame: the frame of its components.
    reduced: b^i / size**power, shape (n,).
    reduced_error: bound on the error of its largest component, in the same unit.
    size, power: the unit.
    parameters: the values of the frame's parameters, by name.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> frame = gt.spaces.load("screw_dislocation").frame
    >>> around = gt.Loop.circle([0, 0, 0], 1.0)
    >>> b = gt.burgers_vector(frame, around, parameters={"b": 1})
    >>> np.allclose(2 * b - b, b), (b + b).error >= 2 * b.error
    (True, True)
    """

    frame: Frame
    reduced: np.ndarray
    reduced_error: float
    size: float
    power: int
    parameters: Mapping[str, Number]

    def __repr__(self) -> str:
        parts = ", ".join(f"{x:.12g}" for x in self.vector.tolist())
        return f"VectorSum([{parts}], error={size_text(self.error)})"
