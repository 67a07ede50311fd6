"""Affine: coframe and connection as one form along paths, curvature and torsion over areas."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from geomtorsion.codegen import numpy_function
from geomtorsion.exact import Element
from geomtorsion.geometry import contract
from geomtorsion.loops.arcs import Parameters
from geomtorsion.loops.forms import Forms, Poles, forms, parameter_values, poles_of

if TYPE_CHECKING:
    from geomtorsion.geometry import Connection, Tensor

Entries = tuple[tuple[tuple[int, ...], Element], ...]


@dataclass(frozen=True, eq=False)
class AffineForm:
    """A connection with its coframe: A = [[omega, e], [0, 0]] and its curvature, as numbers.

    connection: any connection.
    parameters: a number for each parameter that occurs, keys symbols or names.
    """

    connection: Connection
    parameters: Parameters | None = None

    @property
    def dimension(self) -> int:
        """Number of coordinates and of legs."""
        return self.connection.frame.dimension

    def along(self, points: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """omega_ai^j q'^a as matrix (row j, column i) and e^i_mu q'^mu, shapes (k, n, n), (k, n).

        points, slopes: shape (n, k).
        """
        if self._plain is not None:
            form = self._plain.coframe
            theta = form.gather @ (form.at(points) * slopes[form.columns])
            return self._no_turn(theta), theta.T
        turn, step, _ = _compiled(self.connection, "line")
        values = self._values(turn.function, points)
        n, k = points.shape
        omega = np.zeros((k, n, n), dtype=values.dtype)
        theta = np.zeros((k, n), dtype=values.dtype)
        for value, (a, i, j) in zip(values[: len(turn.indices)], turn.indices, strict=True):
            omega[:, j, i] += value * slopes[a]
        for value, (i, a) in zip(values[len(turn.indices) :], step.indices, strict=True):
            theta[:, i] += value * slopes[a]
        return omega, theta

    def over(
        self, points: np.ndarray, x: np.ndarray, v: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Curvature and torsion on the area x ^ v: R_abi^j x^a v^b and T_ab^j x^a v^b.

        points, x, v: shape (n, k); results (k, n, n) with row j, column i, and (k, n).
        """
        if self._plain is not None:
            form, (a, b) = self._plain.curl, self._plain.pairs
            if form is None:
                return self._no_turn(points), np.zeros(points.T.shape)
            area = (x[a] * v[b] - x[b] * v[a])[form.columns]
            tau = form.gather @ (form.at(points) * area)
            return self._no_turn(tau), tau.T
        turn, step, _ = _compiled(self.connection, "area")
        values = self._values(turn.function, points)
        n, k = points.shape
        rho = np.zeros((k, n, n), dtype=values.dtype)
        tau = np.zeros((k, n), dtype=values.dtype)
        for value, (a, b, i, j) in zip(values[: len(turn.indices)], turn.indices, strict=True):
            rho[:, j, i] += value * (x[a] * v[b] - x[b] * v[a])
        for value, (a, b, j) in zip(values[len(turn.indices) :], step.indices, strict=True):
            tau[:, j] += value * (x[a] * v[b] - x[b] * v[a])
        return rho, tau

    @cached_property
    def _plain(self) -> Forms | None:
        """Coframe and curl, where legs are parallel and nothing else is needed."""
        if self.connection.kind != "cartan":
            return None
        return forms(self.connection.frame, self.parameters)

    def _no_turn(self, like: np.ndarray) -> np.ndarray:
        """No rotation at any of the points of an array of shape (n, k)."""
        n, k = like.shape
        return np.zeros((k, n, n), dtype=like.dtype)

    @cached_property
    def poles(self) -> Poles | None:
        """What may vanish in a denominator of coframe or connection."""
        if self._plain is not None:
            return self._plain.poles
        found = _compiled(self.connection, "line")[2]
        if found is None:
            return None
        frame, extra = self.connection.frame, _compiled(self.connection, "line")[0].function.extra
        return replace(found, numbers=parameter_values(frame, extra, self.parameters))

    @cached_property
    def turns(self) -> bool:
        """Whether parallel transport turns the legs at all."""
        return self._plain is None and bool(_compiled(self.connection, "line")[0].indices)

    def coframe(self, point: np.ndarray) -> np.ndarray:
        """e^i_mu at one point, shape (n, n)."""
        n = self.dimension
        rows = [self.along(point[:, None], np.eye(n)[:, [a]])[1][0] for a in range(n)]
        return np.array(rows).T

    def _values(self, function: _Function, points: np.ndarray) -> np.ndarray:
        """All components at the points, with the parameters filled in."""
        frame = self.connection.frame
        numbers = parameter_values(frame, function.extra, self.parameters)
        return function.call(*points, *numbers)


@dataclass(frozen=True, eq=False)
class _Function:
    """A compiled list of components and the parameters that it takes after the coordinates."""

    call: Callable[..., np.ndarray]
    extra: tuple[sp.Symbol, ...]


@dataclass(frozen=True, eq=False)
class _Block:
    """Which components stand where in the compiled list."""

    indices: tuple[tuple[int, ...], ...]
    function: _Function


def _compiled(connection: Connection, kind: str) -> tuple[_Block, _Block, Poles | None]:
    """The compiled form or its curvature, kept with the frame."""
    # The connection is kept with the result, so that no other can come to have its id.
    key = f"affine {kind} {id(connection)}"
    return connection.frame.derived(key, lambda: (connection, _compile(connection, kind)))[1]


def _compile(connection: Connection, kind: str) -> tuple[_Block, _Block, Poles | None]:
    """Exact components, chosen and compiled together."""
    frame = connection.frame
    if kind == "line":
        turn = _entries(connection.spin_connection)
        step = _entries(frame.coframe)
    else:
        legs, coframe = frame.legs, frame.coframe
        riemann = connection.curvature.riemann
        turn = _upper(_entries(contract("mnlk,li,jk->mnij", riemann, legs, coframe)))
        step = _upper(_entries(contract("abc,jc->abj", connection.torsion.T, coframe)))
    elements = [element for _, element in (*turn, *step)]
    found = {symbol for element in elements for symbol in element.symbols}
    extra = tuple(sorted(found - set(frame.coordinates), key=str))
    function = _Function(numpy_function(elements, (*frame.coordinates, *extra)), extra)
    owner = "connection" if turn else "coframe"
    poles = poles_of(frame, elements, (*frame.coordinates, *extra), owner)
    return (
        _Block(tuple(index for index, _ in turn), function),
        _Block(tuple(index for index, _ in step), function),
        poles,
    )


def _entries(tensor: Tensor) -> Entries:
    """Components that do not vanish."""
    return tuple(tensor.components.nonzero.items())


def _upper(entries: Entries) -> Entries:
    """Components with the first index below the second: the others follow by antisymmetry."""
    return tuple((index, element) for index, element in entries if index[0] < index[1])
