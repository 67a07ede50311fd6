"""Integrability: whether constraints belong to surfaces, and a trace to a parallel volume."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import sympy as sp

from geomtorsion.errors import UndecidedError
from geomtorsion.exact import Element
from geomtorsion.exact.integration import antiderivative
from geomtorsion.geometry.components import Index
from geomtorsion.geometry.tensor import Tensor
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, repr=False)
class Integrability:
    """Whether constraints are integrable (holonomic), with the torsion that prevents it.

    holds: True if they are, None if zero cannot be decided.
    obstructions: (i, j, k) -> T_ij^k in the frame, with permitted legs i < j and a forbidden leg k,
        for all components that do not vanish; legs count from 0.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, constrained
    >>> x, y, theta = sp.symbols("x y theta", real=True)
    >>> plane = Frame([x, y, theta], [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> constrained(plane, ["cos(theta)*dy - sin(theta)*dx"]).integrable
    not integrable: T_12^3 = 1
    >>> bool(constrained(plane, ["dy - dx"]).integrable)
    True
    """

    holds: bool | None
    obstructions: Mapping[Index, sp.Expr]

    def __bool__(self) -> bool:
        if self.holds is None:
            raise UndecidedError(
                "whether the constraints are integrable cannot be decided exactly: functions occur "
                "whose relations are not known. Read the components in `obstructions`."
            )
        return self.holds

    def __repr__(self) -> str:
        if self.holds:
            return "integrable: no torsion along the forbidden legs"
        components = "; ".join(
            f"T_{i + 1}{j + 1}^{k + 1} = {value}" for (i, j, k), value in self.obstructions.items()
        )
        return f"{'undecided' if self.holds is None else 'not integrable'}: {components}"


def integrability(torsion: Tensor, allowed: Collection[int]) -> Integrability:
    """Verdict of Frobenius on the span of permitted legs, from T_ab^c of a constrained connection.

    Along a forbidden leg k the torsion of two permitted legs is minus the bracket of the two, so
    that all brackets stay permitted exactly where these components vanish.
    """
    verdicts: list[bool | None] = []
    obstructions: dict[Index, sp.Expr] = {}
    for (i, j, k), value in sorted(torsion.in_frame().components.nonzero.items()):
        if i < j and i in allowed and j in allowed and k not in allowed:
            verdicts.append(value.is_zero)
            if value.is_zero is not True:
                obstructions[i, j, k] = value.sympy
    holds = False if False in verdicts else None if None in verdicts else True
    return Integrability(holds, obstructions)


@dataclass(frozen=True, eq=False, repr=False)
class ParallelVolume:
    """The density f sqrt|g| with D_a (f sqrt|g|) = 0, up to a constant factor, or what prevents it.

    gradient: d_a log f as the connection requires it, slots d: Gamma_ab^b - d_a log sqrt|g|.
    holds: True if there is such a volume, that is, if the gradient is closed; None if undecided.
    obstructions: (a, b) -> d_a W_b - d_b W_a of the gradient W, a < b, where it does not vanish.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame, from_torsion
    >>> x, y = sp.symbols("x y", positive=True)
    >>> plane = Frame([x, y], [[1, 0], [0, 1]])
    >>> mixed = from_torsion(plane, [[[0, 0], [1 / x, 0]], [[-1 / x, 0], [0, 0]]])
    >>> mixed.torsion.vector.nonzero(), mixed.transposed.volume
    ({(1,): -2/x}, no parallel volume: d_x W_y - d_y W_x = -2/x**2)
    >>> pure = from_torsion(plane, [[[0, 0], [0, 1 / x]], [[0, -1 / x], [0, 0]]])
    >>> pure.torsion.vector.nonzero(), pure.transposed.volume
    ({(0,): 2/x}, parallel volume: x**(-2))
    """

    gradient: Tensor
    holds: bool | None
    obstructions: Mapping[tuple[int, int], sp.Expr]

    def __bool__(self) -> bool:
        if self.holds is None:
            raise UndecidedError(
                "whether this connection has a parallel volume cannot be decided exactly: functions"
                " occur whose relations are not known. Read the components in `obstructions`."
            )
        return self.holds

    @cached_property
    def factor(self) -> sp.Expr:
        """f, the ratio of the parallel volume to sqrt|g|, up to a constant factor.

        Raises
        ------
        UndecidedError
            There is no parallel volume, or no closed form of the integral is found.
        """
        if not self:
            raise UndecidedError(f"expected a connection with a parallel volume, got {self!r}.")
        potential = _potential(self.gradient)
        if potential is None:
            raise UndecidedError(
                "the parallel volume exists, but no closed form of its integral was found. Use "
                "`gradient`, the derivative of the logarithm of the factor."
            )
        return self.gradient.frame.read([("factor", sp.exp(potential))])[0].sympy

    @cached_property
    def density(self) -> sp.Expr:
        """f sqrt|g|, up to a constant factor (see `factor`)."""
        return (self.gradient.frame.volume * self.factor)[()]

    def __repr__(self) -> str:
        q = self.gradient.frame.coordinates
        if not self.obstructions:
            try:
                return f"parallel volume: {self.density}"
            except UndecidedError:
                return f"parallel volume with d log f = {self.gradient!r}"
        parts = "; ".join(
            f"d_{q[a]} W_{q[b]} - d_{q[b]} W_{q[a]} = {value}"
            for (a, b), value in self.obstructions.items()
        )
        return f"{'undecided' if self.holds is None else 'no parallel volume'}: {parts}"


def parallel_volume(coefficients: Tensor, metric: bool) -> ParallelVolume:
    """The verdict on coefficients Gamma_ab^c, slots ddu; a metric connection keeps sqrt|g|."""
    frame = coefficients.frame
    get, n, field = coefficients.components.get, frame.dimension, frame.field

    def rule(index: Index) -> Element:
        (a,) = index
        volume = frame.volume.element()
        slope = volume.diff(frame.coordinates[a]) * volume.inverse()
        return field.sum([(-1, slope), *((1, get((a, b, b))) for b in range(n))])

    return volume_of(
        Tensor(frame, "d", {} if metric else rule, (), "W", "gradient of the volume factor")
    )


def volume_of(gradient: Tensor) -> ParallelVolume:
    """The volume f sqrt|g| with d_a log f equal to a given covector, slots d."""
    n, q, W = gradient.frame.dimension, gradient.frame.coordinates, gradient.components.get
    curls = {
        (a, b): W((b,)).diff(q[a]) - W((a,)).diff(q[b]) for a in range(n) for b in range(a + 1, n)
    }
    verdicts = {index: curl.is_zero for index, curl in curls.items()}
    holds = False if False in verdicts.values() else None if None in verdicts.values() else True
    obstructions = {
        index: curls[index].sympy for index, verdict in verdicts.items() if verdict is not True
    }
    return ParallelVolume(gradient, holds, obstructions)


def _potential(gradient: Tensor) -> sp.Expr | None:
    """A function with this gradient, coordinate after coordinate; checked by exact zero."""
    frame, get = gradient.frame, gradient.components.get
    total: sp.Expr = sp.S.Zero
    for a, q in enumerate(frame.coordinates):
        (slope,) = frame.read([("potential", total.diff(q))])
        rest = get((a,)) - slope
        if rest.is_zero:
            continue
        part = antiderivative(rest.sympy, q)
        if part is None:
            return None
        total += part
    slopes = frame.read([("potential", total.diff(q)) for q in frame.coordinates])
    exact = all((get((a,)) - slope).is_zero for a, slope in enumerate(slopes))
    return total if exact else None
