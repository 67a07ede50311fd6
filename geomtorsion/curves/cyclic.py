"""Cyclic: geodesics with the momenta of coordinates that do not occur as constants.

Optional: without it the same curves are followed by their frame velocities, some of them slower.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

from geomtorsion.codegen import Graph, Products, graph
from geomtorsion.copies import only_fields
from geomtorsion.curves.laws import Momenta, inverted
from geomtorsion.ode.system import System

if TYPE_CHECKING:
    from geomtorsion.curves.atlas import Chart
    from geomtorsion.exact import Element

# Kinds of steps in a graph that cost little.
_CHEAP = ("argument", "number", "sum")
# Velocities that come back from their momenta more roundings off than this lose digits on the way,
# for large parts cancel: such starts keep the full equations.
ROUNDINGS = 64


class Full(Protocol):
    """What a reduction has to know of the equations of frame velocities (`Equations`).

    Not the class itself: that imports this file, and files are not to need each other.
    """

    @property
    def chart(self) -> Chart | None:
        """The chart in which they are written."""
        ...

    @property
    def states(self) -> tuple[str, ...]:
        """Names of all states, coordinates first."""
        ...

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of all parameters."""
        ...

    @property
    def velocities(self) -> tuple[str, ...]:
        """Names of the frame velocities."""
        ...

    @property
    def groups(self) -> tuple[tuple[int, ...], ...]:
        """States that are measured by a common size."""
        ...

    @property
    def width(self) -> int:
        """Number of coordinates."""
        ...

    def guards(
        self, arguments: Sequence[str], parameters: Sequence[str]
    ) -> tuple[Graph | None, Graph | None]:
        """What falls through zero at the margin of the chart, and at its very end."""
        ...


@dataclass(frozen=True, eq=False)
class CyclicReduction:
    """Hamilton's equations, the momenta of cyclic coordinates being parameters.

    Equation
    --------
    q'^mu = g^mu nu p_nu,  p_mu = e^i_mu G_ij u^j,
    p'_mu = (N d_mu D - d_mu (D g^nu rho) p_nu p_rho) / (2 D)   with N = g^mu nu p_mu p_nu

    for any function D: N is constant, and a D that clears the denominators of the inverse metric
    makes the rates short (for Kerr they fall apart into functions of r and of theta).

    equations: those of the frame velocities, in whose place these stand.
    momenta: what the momenta are made of.

    Examples
    --------
    >>> from geomtorsion.curves import geodesic
    >>> from geomtorsion.spaces import load
    >>> orbit = geodesic(load("kerr").frame, [0, 8, 1.5, 0], [1.3, 0, 0, 0.05],
    ...                  parameters={"M": 1, "a": 0.9})
    >>> orbit.equations("kerr").reductions[1].system.states
    ('t', 'r', 'theta', 'phi', 'p_r', 'p_theta')
    """

    equations: Full
    momenta: Momenta

    def __getstate__(self) -> Mapping[str, object]:
        # The graph goes with it, so that a copy gives the same bits.
        return only_fields(self) | {"_to_velocities": self._to_velocities}

    @property
    def _coordinates(self) -> tuple[str, ...]:
        return self.equations.states[: self.equations.width]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the momenta, coordinate by coordinate."""
        taken = (*self.equations.states, *self.equations.parameters)
        letters = ("p_", "momentum_", "P_", "Momentum_")
        letter = next(x for x in letters if not any(name.startswith(x) for name in taken))
        return tuple(letter + name for name in self._coordinates)

    @cached_property
    def moving(self) -> tuple[int, ...]:
        """Places of the coordinates whose momenta change."""
        return tuple(k for k in range(self.equations.width) if k not in self.momenta.cyclic)

    @cached_property
    def _states(self) -> tuple[str, ...]:
        return (*self._coordinates, *(self.names[k] for k in self.moving))

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters: those of the equations, the constant momenta, and N."""
        constant = (self.names[k] for k in self.momenta.cyclic)
        return (*self.equations.parameters, *constant, self._norm)

    @cached_property
    def _norm(self) -> str:
        """Name of the constant N."""
        taken = (*self.equations.states, *self.equations.parameters, *self.names)
        return next(x for x in ("norm", "squared_norm", "norm_of_p") if x not in taken)

    # -- exact matrices --------------------------------------------------------------------------

    @cached_property
    def _lowered(self) -> Mapping[tuple[int, int], Element]:
        """e^i_mu G_ij by (mu, j)."""
        pairs: dict[tuple[int, int], list[Element]] = {}
        for (i, mu), value in self.momenta.frame.coframe.components.nonzero.items():
            for j, weight in self.momenta.lower[i]:
                pairs.setdefault((mu, j), []).append(value * weight)
        return _summed(pairs)

    @cached_property
    def _raised(self) -> Mapping[tuple[int, int], Element]:
        """G^ij E_j^mu by (i, mu)."""
        weights = _inverse(self.momenta.lower)
        chart = self.equations.chart
        assert chart is not None
        pairs: dict[tuple[int, int], list[Element]] = {}
        for mu, row in enumerate(chart.legs):
            for j, value in row:
                for i, weight in enumerate(weights[j]):
                    if weight:
                        pairs.setdefault((i, mu), []).append(value * weight)
        return _summed(pairs)

    @cached_property
    def inverse_metric(self) -> Mapping[tuple[int, int], Element]:
        """g^mu nu by (mu, nu), mu <= nu."""
        chart = self.equations.chart
        assert chart is not None
        pairs: dict[tuple[int, int], list[Element]] = {}
        for mu, row in enumerate(chart.legs):
            for i, value in row:
                for (j, nu), other in self._raised.items():
                    if j == i and mu <= nu:
                        pairs.setdefault((mu, nu), []).append(value * other)
        return _summed(pairs)

    # -- the smaller system ----------------------------------------------------------------------

    @cached_property
    def system(self) -> System:
        """All coordinates, and the momenta that change, with the divisor that costs the least."""
        field = self.momenta.frame.field
        own = [self.inverse_metric.get((k, k)) for k in self.moving]
        divisors = [field.one, *(field.one / x for x in own if x is not None)]
        arguments = (*self._states, *self.parameters)
        made = [graph(arguments, self._rates(x), self.parameters) for x in divisors]
        rates = min(made, key=cost)
        guard, end = self.equations.guards(arguments, self.parameters)
        width = self.equations.width
        places = (group for group in self.equations.groups if group[-1] < width)
        groups = (*places, tuple(range(width, len(self._states))))
        return System(self._states, self.parameters, rates, groups, guard, end)

    def _rates(self, divisor: Element) -> list[Products]:
        """Rates of coordinates and momenta, by D g^mu nu for a divisor D."""
        rates: list[Products] = [()] * self.equations.width
        for (mu, nu), value in self.inverse_metric.items():
            rates[mu] += ((value, (self.names[nu],)),)
            if mu != nu:
                rates[nu] += ((value, (self.names[mu],)),)
        symbols, inverse = self.momenta.frame.coordinates, divisor.field.one / divisor
        for k in self.moving:
            terms: list[tuple[Element, tuple[str, ...]]] = []
            for (mu, nu), value in self.inverse_metric.items():
                slope = (value * divisor).diff(symbols[k])
                if not slope.is_zero:
                    weight = Fraction(-1, 2) if mu == nu else Fraction(-1)
                    terms.append((slope * inverse * weight, (self.names[mu], self.names[nu])))
            slope = divisor.diff(symbols[k])
            if not slope.is_zero:
                terms.append((slope * inverse * Fraction(1, 2), (self._norm,)))
            rates.append(tuple(terms))
        return rates

    @cached_property
    def _to_momenta(self) -> Graph:
        """All momenta, and the constant N, over full states and parameters."""
        velocities = self.equations.velocities
        rows: list[Products] = [()] * self.equations.width
        for (mu, j), value in self._lowered.items():
            rows[mu] += ((value, (velocities[j],)),)
        norm = tuple(
            (x, (velocities[i], velocities[j]))
            for i, row in enumerate(self.momenta.lower)
            for j, x in row
        )
        arguments = (*self.equations.states, *self.equations.parameters)
        return graph(arguments, [*rows, norm], factor=False)

    @cached_property
    def _to_velocities(self) -> Graph:
        """Frame velocities over states and parameters of the smaller system."""
        rows: list[Products] = [()] * len(self.equations.velocities)
        for (i, mu), value in self._raised.items():
            rows[i] += ((value, (self.names[mu],)),)
        return graph((*self._states, *self.parameters), rows, factor=False)

    # -- there and back --------------------------------------------------------------------------

    def reduced(
        self, states: np.ndarray, parameters: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Starts of the smaller system, their parameters, and for which no digits are lost.

        states, parameters: full ones in double precision, shapes (number, size).
        """
        width = self.equations.width
        momenta = self._to_momenta.numpy()(*states.T, *parameters.T).T
        start = np.concatenate((states[:, :width], momenta[:, list(self.moving)]), axis=1)
        constant = [*self.momenta.cyclic, width]
        numbers = np.concatenate((parameters, momenta[:, constant]), axis=1)
        back = self.lifted(numbers, start[:, None, :])[:, 0, width:]
        own = states[:, width:]
        gap = np.abs(back - own).max(axis=1)
        kept = gap <= ROUNDINGS * 2.0**-53 * np.abs(own).max(axis=1)
        return start, numbers, kept & np.isfinite(start).all(axis=1)

    def lifted(self, parameters: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Full states, shape (number, m, size), of states (number, m, smaller size)."""
        number, m, size = states.shape
        columns = states.reshape(-1, size).T
        numbers = parameters[0] if number == 1 else np.repeat(parameters, m, axis=0).T
        width = self.equations.width
        found = np.empty((width + len(self.equations.velocities), number * m))
        found[:width] = columns[:width]
        found[width:] = self._to_velocities.numpy()(*columns, *numbers)
        return found.T.reshape(number, m, len(found))


def cost(rates: Graph) -> int:
    """Products, quotients and functions in a step, those of parameters alone left out."""
    return sum(not step.constant and step.kind not in _CHEAP for step in rates.steps)


def _summed(
    pairs: Mapping[tuple[int, int], Sequence[Element]],
) -> dict[tuple[int, int], Element]:
    """Sums of elements, those that vanish left out."""
    found = {}
    for key, values in pairs.items():
        total = values[0].field.sum([(1, value) for value in values])
        if not total.is_zero:
            found[key] = total
    return found


def _inverse(lower: Sequence[Sequence[tuple[int, Element]]]) -> list[list[Fraction]]:
    """The inverse of G_ij, whose entries are numbers."""
    n = len(lower)
    matrix = [[Fraction(0)] * n for _ in range(n)]
    for i, row in enumerate(lower):
        for j, value in row:
            matrix[i][j] = value.as_fraction()
    return inverted(matrix)
