"""Integration: symmetries without a closed form, as solutions of their linear equations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import sympy as sp

from geomtorsion.errors import SingularPointError
from geomtorsion.exact import Reduced
from geomtorsion.geometry import Frame
from geomtorsion.ode import ODE, solve
from geomtorsion.same.symmetry.symmetry_conditions import Conditions
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True, eq=False, repr=False)
class IntegratedSymmetry:
    """A symmetry without a closed form: numbers at points, by integration from a base point.

    conditions: the linear conditions on the values of symmetries at a point.
    reduced: their form near the generic point, which names the unknowns that are free.
    unknown: the free unknown that is 1 at the base; the other free ones are 0.

    Equation
    --------
    Along the straight line q(s) of the coordinates from the base, with v = dq/ds:
    dxi^a/ds = v^b (F_b^a - Gamma_bc^a xi^c)
    dF_bc/ds = v^a (R_bcad xi^d + Gamma_ab^e F_ec + Gamma_ac^e F_be)
    and further terms for homotheties and conformal vectors (see `Conditions`).

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> from geomtorsion.same import symmetries
    >>> u, v = sp.symbols("u v", positive=True)
    >>> plane = Frame([u, v], sp.eye(2) * 5 * (u**2 + v**2) ** 2)  # x + i y = (u + i v)**5
    >>> shift = symmetries(plane).vectors[2]
    >>> vector, error = shift.with_error({"u": 1, "v": 0.5})
    >>> vector.shape, bool(error < 1e-9)
    ((2,), True)
    """

    conditions: Conditions
    reduced: Reduced
    unknown: int

    @property
    def frame(self) -> Frame:
        """The frame of the metric."""
        return self.conditions.frame

    @property
    def base(self) -> dict[sp.Symbol, sp.Rational]:
        """The point at which the symmetry is stated: the point of its region."""
        point = self.frame.region.point
        return {q: point[q] for q in self.frame.coordinates}

    def at(
        self, point: Mapping[str, object] | Mapping[sp.Symbol, object], accuracy: float = 1e-10
    ) -> np.ndarray:
        """xi^a at a point, shape (n,); the point has values of all coordinates and parameters.

        Raises
        ------
        MissingValueError
            A coordinate or a parameter has no value.
        """
        return self.with_error(point, accuracy)[0]

    def with_error(
        self, point: Mapping[str, object] | Mapping[sp.Symbol, object], accuracy: float = 1e-10
    ) -> tuple[np.ndarray, float]:
        """xi^a at a point, and the largest error of a component (see `solve`)."""
        frame, n = self.frame, self.frame.dimension
        end = frame.vector(frame.coordinates).at(point)
        parameters = {p.name: float(frame.scalar(p).at(point)[()]) for p in frame.parameters}
        start = np.array([float(x) for x in self.base.values()])
        states, rates = self._rates
        values, growth = self._start(parameters)
        numbers = [*start.tolist(), *values]
        given = parameters | {f"velocity_{a}": end[a] - start[a] for a in range(n)}
        rounding = growth * float(np.finfo(float).eps)
        if np.array_equal(start, end):
            return np.array(numbers[n : 2 * n]), rounding
        equations = ODE.of(dict(zip(states, rates, strict=True)), numbers, parameters=given)
        solution = solve(equations, 1.0, accuracy)
        names = states[n : 2 * n]
        # The errors of a solution are relative to the largest size of all values.
        size = max(float(np.abs(solution[name]).max()) for name in states[n:])
        error = size * (rounding + max(solution.error_of(name) for name in names))
        return np.array([solution[name][-1] for name in names]), error

    @cached_property
    def _rates(self) -> tuple[list[str], list[sp.Expr]]:
        """States (coordinates and the values of the symmetry) and their rates along a line."""
        frame, width = self.frame, self.conditions.width
        v = sp.symbols(f"velocity_:{frame.dimension}", real=True)
        values = sp.symbols(f"value_:{width}", real=True)
        rates: list[sp.Expr] = [sp.S.Zero] * width
        for a, speed in enumerate(v):
            for k, row in enumerate(self.conditions.rates(a)):
                for x, value in zip(row, values, strict=True):
                    if x is not frame.field.zero and not x.is_zero:
                        rates[k] += speed * x.sympy * value
        names = [*(q.name for q in frame.coordinates), *(one.name for one in values)]
        return names, [*v, *rates]

    def _start(self, parameters: Mapping[str, float]) -> tuple[list[float], float]:
        """Values at the base, one free unknown 1, and how far roundings of the conditions grow."""
        point = {q.name: value for q, value in self.base.items()} | dict(parameters)
        values = np.zeros(self.reduced.width)
        values[self.unknown] = 1.0
        pivots = list(self.reduced.pivots)
        if not pivots:
            return values.tolist(), 1.0
        rows = np.array(
            [
                [float(self.frame.scalar(x).at(point)[()]) for x in row]
                for row in self.conditions.echelons[1].rows
            ]
        )
        matrix = rows[:, pivots]
        growth = float(np.linalg.cond(matrix))
        if not growth * float(np.finfo(float).eps) < 1:
            given = ", ".join(f"{name} = {value}" for name, value in parameters.items())
            raise SingularPointError(
                f"{self!r}: expected regular conditions at the base, got singular ones for "
                f"{given}. Put special values into the frame first: frame.subs(...)."
            )
        values[pivots] = np.linalg.solve(matrix, -rows[:, self.unknown])
        return values.tolist(), growth

    def __repr__(self) -> str:
        place = ", ".join(f"{q} = {value}" for q, value in self.base.items())
        return f"symmetry integrated from {place}"
