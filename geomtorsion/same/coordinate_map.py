"""Coordinate map: the point of one geometry that corresponds to a point of another, with error."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
import sympy as sp

from geomtorsion.errors import ArgumentError, CoordinateError, UnknownNameError
from geomtorsion.geometry import Frame, levi_civita
from geomtorsion.ode import ODE, solve
from geomtorsion.same.invariant_values import Evaluation
from geomtorsion.same.invariants import Invariants
from geomtorsion.same.matching import WORKING, Match
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property


@dataclass(frozen=True)
class MappedPoint:
    """A point of the second geometry.

    coordinates: name -> number.
    error: largest error of a coordinate, as the solver estimates it.
    """

    coordinates: Mapping[str, float]
    error: float

    def __getitem__(self, name: str | sp.Symbol) -> float:
        key = checks.known_name(name, self.coordinates, "coordinate", UnknownNameError)
        return self.coordinates[key]


@dataclass(frozen=True, eq=False, repr=False)
class CoordinateMap:
    """Map from the coordinates of one geometry to coordinates of another, near matched points.

    one, two: the invariants of both geometries.
    match: points that correspond to each other, and the turn of the legs between them.

    Equation
    --------
    dq = E_b Lambda_a^b e^a(dp), dLambda_a^c = omega_a^d Lambda_d^c - Lambda_a^b omega_b^c

    along the straight line from the matched point to the goal, in coordinates of the first. Where
    symmetries leave a choice, the map is the one that takes the matched points into each other.

    Examples
    --------
    >>> import sympy as sp
    >>> from geomtorsion.geometry import Frame
    >>> from geomtorsion.same import same_geometry
    >>> x = sp.Symbol("x", positive=True)
    >>> one, two = Frame([x], [[1]]), Frame([x], [[2 * x]])
    >>> line = same_geometry(one, two).map
    >>> near, far = line({"x": 1}), line({"x": 2})
    >>> round(far["x"] ** 2 - near["x"] ** 2, 9)
    1.0
    """

    one: Invariants
    two: Invariants
    match: Match

    def __call__(self, point: Mapping[Any, object], accuracy: float = 1e-10) -> MappedPoint:
        """The point of the second geometry that corresponds to a point of the first.

        Parameters
        ----------
        point
            name or symbol -> number, for each coordinate of the first geometry.
        accuracy
            as in `solve`.
        """
        frame = self.one.frame
        values = checks.by_name(point, "point")
        names = [str(q) for q in frame.coordinates]
        if set(values) != set(names):
            raise CoordinateError(
                f"point: expected numbers for {', '.join(names)}, got "
                f"{', '.join(values) or 'none'}. Give each coordinate once."
            )
        goal = [checks.number(values[name], name, CoordinateError) for name in names]
        start = [_float(self.match.start[q]) for q in frame.coordinates]
        ends = {f"d{k}": sp.Float(x) - p for k, (x, p) in enumerate(zip(goal, start, strict=True))}
        starts = {f"p{k}": p for k, p in enumerate(start)}
        rates, beginning = self._equations
        problem = ODE.of(rates, beginning, parameters={**ends, **starts}, time="s")
        solution = solve(problem, 1.0, accuracy)
        coordinates = {
            str(q): float(solution[f"q{k}"][-1]) for k, q in enumerate(self.two.frame.coordinates)
        }
        return MappedPoint(coordinates, float(np.max(solution.error)))

    def __repr__(self) -> str:
        names = (", ".join(map(str, x.frame.coordinates)) for x in (self.one, self.two))
        return "map from {} to {}".format(*names)

    @cached_property
    def _equations(self) -> tuple[dict[str, sp.Expr], dict[str, sp.Float]]:
        """Rates and start of the coordinates and of the turn along the line p + s d."""
        one, two = (_real_frame(x) for x in (self.one, self.two))
        n = one.dimension
        s = sp.Symbol("s")
        line = [sp.Symbol(f"p{k}") + s * sp.Symbol(f"d{k}") for k in range(n)]
        shift = sp.Matrix([sp.Symbol(f"d{k}") for k in range(n)])
        first = dict(zip(one.coordinates, line, strict=True))
        second = {q: sp.Symbol(f"q{k}") for k, q in enumerate(two.coordinates)}

        def at(tensor: Any, values: dict) -> sp.MutableDenseNDimArray:
            return sp.Array(tensor.to_sympy()).subs(values, simultaneous=True)

        start = {f"q{k}": _float(self.match.goal[q]) for k, q in enumerate(two.coordinates)}
        turn: sp.Matrix = sp.eye(n)
        moving = self.match.turn is not None and self.one.keep != "teleparallel"
        if self.match.turn is not None:
            numbers = self._turn(one, two)
            if moving:
                turn = sp.Matrix(n, n, lambda a, b: sp.Symbol(f"turn{a}_{b}"))
                start |= {f"turn{a}_{b}": _float(numbers[a, b]) for a in range(n) for b in range(n)}
            else:
                turn = sp.Matrix(n, n, lambda a, b: _float(numbers[a, b]))
        forms = at(one.coframe, first).tomatrix() * shift
        speed = at(two.legs, second).tomatrix() * turn.T * forms
        rates = {f"q{k}": speed[k] for k in range(n)}
        if moving:
            spin = [at(levi_civita(f).spin_connection, v) for f, v in ((one, first), (two, second))]
            along = [
                sp.Matrix(n, n, lambda i, j, w=w, v=v: sum(w[m, i, j] * v[m] for m in range(n)))
                for w, v in zip(spin, (shift, speed), strict=True)
            ]
            change = along[0] * turn - turn * along[1]
            rates |= {f"turn{a}_{b}": change[a, b] for a in range(n) for b in range(n)}
        return rates, start

    def _turn(self, one: Frame, two: Frame) -> np.ndarray:
        """The turn in terms of the legs of both frames."""
        sides = (self.one, one, self.match.start), (self.two, two, self.match.goal)
        bases, signs = [], ()
        for invariants, frame, point in sides:
            values = Evaluation(invariants, 0).at(point, WORKING)
            assert values is not None
            signs = values.signs
            bases.append(frame.coframe.at(point, digits=WORKING) @ values.legs)
        first, second = bases
        # L_a = E_i bases[i, a] for both, and L_a of the first goes to turn[a, b] L_b.
        squares = np.array(signs, dtype=object)
        eta = one.eta.at({}, digits=WORKING)
        inverse = (squares[:, None] * first.T) @ eta
        return inverse.T @ self.match.turn @ second.T


def _real_frame(invariants: Invariants) -> Frame:
    """The frame, or one with real legs for its metric."""
    frame = invariants.frame
    if not frame.complex:
        return frame
    if invariants.keep in ("legs", "teleparallel"):
        raise ArgumentError(
            "expected a frame with real legs, got a complex one. A map that keeps complex legs is "
            "not computed; compare the metrics with keep='metric'."
        )
    rows = [[frame.metric[i, j] for j in range(frame.dimension)] for i in range(frame.dimension)]
    return Frame.from_metric(
        frame.coordinates, rows, parameters=frame.parameters, domain=frame.domain
    )


def _float(value: sp.Rational | mpmath.mpf) -> sp.Float:
    return sp.Float(value, WORKING)
