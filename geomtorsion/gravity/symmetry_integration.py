"""Integration: symmetries without a closed form, as solutions of their linear equations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import mpmath
import numpy as np
import sympy as sp

from geomtorsion.caching import cached_property
from geomtorsion.exact import Echelon, Reduced
from geomtorsion.geometry import Frame, levi_civita
from geomtorsion.ode import ODE, solve

# Digits of the values at the base, far below the errors of floats.
DIGITS = 40


@dataclass(frozen=True, eq=False, repr=False)
class IntegratedSymmetry:
    """A symmetry without a closed form: numbers at points, by integration from a base point.

    frame: the frame of the metric.
    conditions: the linear conditions on (xi^a, F_bc = D_b xi_c), b < c.
    echelon: their form near the generic point, which names the unknowns that are free.
    unknown: the free unknown that is 1 at the base; the other free ones are 0.

    Equation
    --------
    Along the straight line q(s) of the coordinates from the base, with v = dq/ds:
    dxi^a/ds = v^b (F_b^a - Gamma_bc^a xi^c)
    dF_bc/ds = v^a (R_bcad xi^d + Gamma_ab^e F_ec + Gamma_ac^e F_be)

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> from geomtorsion.gravity import symmetries
    >>> u, v = sp.symbols("u v", positive=True)
    >>> plane = Frame([u, v], sp.eye(2) * 5 * (u**2 + v**2) ** 2)  # x + i y = (u + i v)**5
    >>> shift = symmetries(plane).vectors[2]
    >>> vector, error = shift.with_error({"u": 1, "v": 0.5})
    >>> vector.shape, bool(error < 1e-9)
    ((2,), True)
    """

    frame: Frame
    conditions: Echelon
    echelon: Reduced
    unknown: int

    @property
    def base(self) -> dict[sp.Symbol, sp.Rational]:
        """The point at which the symmetry is stated: the sample point of the frame."""
        point = self.frame.sample_point
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
        numbers = [*start.tolist(), *self._start(parameters)]
        given = parameters | {f"velocity_{a}": end[a] - start[a] for a in range(n)}
        if np.array_equal(start, end):
            return np.array(numbers[n : 2 * n]), 0.0
        equations = ODE.of(dict(zip(states, rates, strict=True)), numbers, parameters=given)
        solution = solve(equations, 1.0, accuracy)
        names = states[n : 2 * n]
        # The errors of a solution are relative to the largest size of these states.
        size = max(float(np.abs(solution[name]).max()) for name in names)
        error = size * max(solution.error_of(name) for name in names)
        return np.array([solution[name][-1] for name in names]), error

    @cached_property
    def _rates(self) -> tuple[list[str], list[sp.Expr]]:
        """States (coordinates, xi, F) and their rates along a line."""
        frame, n = self.frame, self.frame.dimension
        bar = levi_civita(frame)
        turns = list(combinations(range(n), 2))
        v = sp.symbols(f"velocity_:{n}", real=True)
        xi = sp.symbols(f"xi_:{n}", real=True)
        F = sp.zeros(n, n)
        for b, c in turns:
            F[b, c] = sp.Symbol(f"F_{b}_{c}", real=True)
            F[c, b] = -F[b, c]
        inverse = frame.inverse_metric.nonzero()
        gamma = bar.coefficients.nonzero()
        rates = [*v]
        for a in range(n):
            rate = sum(
                (v[b] * F[b, c] * g for (c, m), g in inverse.items() for b in range(n) if m == a),
                sp.S.Zero,
            )
            rate -= sum((v[b] * x * xi[c] for (b, c, m), x in gamma.items() if m == a), sp.S.Zero)
            rates.append(rate)
        riemann = bar.curvature.lower.nonzero() if n > 1 else {}
        for b, c in turns:
            rate = sum(
                (v[a] * R * xi[d] for (i, j, a, d), R in riemann.items() if (i, j) == (b, c)),
                sp.S.Zero,
            )
            for (a, i, e), x in gamma.items():
                if i == b:
                    rate += v[a] * x * F[e, c]
                if i == c:
                    rate += v[a] * x * F[b, e]
            rates.append(rate)
        names = [q.name for q in frame.coordinates] + [one.name for one in xi]
        return [*names, *(f"F_{b}_{c}" for b, c in turns)], rates

    def _start(self, parameters: Mapping[str, float]) -> list[float]:
        """xi and F at the base: one free unknown is 1, the others follow from the conditions."""
        point = {q.name: value for q, value in self.base.items()} | dict(parameters)
        values = [0.0] * self.echelon.width
        values[self.unknown] = 1.0
        pivots = self.echelon.pivots
        if pivots:
            with mpmath.workdps(DIGITS):
                rows = [
                    [self.frame.scalar(x).at(point, digits=DIGITS)[()] for x in row]
                    for row in self.conditions.rows
                ]
                matrix = mpmath.matrix([[row[k] for k in pivots] for row in rows])
                right = mpmath.matrix([-row[self.unknown] for row in rows])
                solution = mpmath.lu_solve(matrix, right)
            for k, x in zip(pivots, solution, strict=True):
                values[k] = float(x)
        return values

    def __repr__(self) -> str:
        place = ", ".join(f"{q} = {value}" for q, value in self.base.items())
        return f"symmetry integrated from {place}"
