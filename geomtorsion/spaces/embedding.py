"""embedding: positions in ordinary space of the points of a shipped space, for figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.codegen import numpy_function
from geomtorsion.exact import Field
from geomtorsion.geometry import Frame
from geomtorsion.spaces.coordinates import spherical
from geomtorsion.support import checks
from geomtorsion.support.caching import cached_property
from geomtorsion.support.checks import expression

Symbols = tuple[sp.Symbol, ...]


@dataclass(frozen=True, eq=False)
class Embedding:
    """Exact functions of the coordinates for the position of a point, or the attitude of a body.

    coordinates, parameters: symbols on which the functions may depend.
    place: two or three expressions, a point of the plane or of space; empty if there is none.
    axes: names of the axes in which the place is drawn.
    attitude: rotation matrix, body to space, columns are the body's axes; None if there is none.
    heading: two expressions, the direction in the plane of a blade or a wheel; empty if none.
    isometric: whether lengths in the picture are lengths in the metric.
    title: what the picture shows.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> sphere = load("s2")
    >>> sphere.embedding(sphere.frame).place
    (R*sin(theta)*cos(phi), R*sin(phi)*sin(theta), R*cos(theta))
    """

    coordinates: Symbols
    parameters: Symbols = ()
    place: tuple[sp.Expr, ...] = ()
    axes: tuple[str, ...] = ()
    attitude: sp.Matrix | None = None
    heading: tuple[sp.Expr, ...] = ()
    isometric: bool = True
    title: str = ""

    def places(self, coordinates: Any, parameters: Mapping[str, float]) -> Any:
        """Places of many points: coordinates (m, n) give an array (m, 2) or (m, 3)."""
        return self._many(self._place, coordinates, parameters)

    def attitudes(self, coordinates: Any, parameters: Mapping[str, float]) -> Any:
        """Attitudes of many points: coordinates (m, n) give an array (m, 3, 3)."""
        return self._many(self._attitude, coordinates, parameters).reshape(-1, 3, 3)

    def headings(self, coordinates: Any, parameters: Mapping[str, float]) -> Any:
        """Directions of the blade at many points: coordinates (m, n) give an array (m, 2)."""
        return self._many(self._heading, coordinates, parameters)

    def _many(self, function: Callable[..., Any], points: Any, parameters: Mapping) -> Any:
        columns = np.asarray(points, dtype=float).T
        for parameter in self.parameters:
            checks.check_declared(parameter, parameters[parameter.name])
        return function(*columns, *(float(parameters[p.name]) for p in self.parameters)).T

    @cached_property
    def _place(self) -> Callable[..., Any]:
        return self._compiled(self.place)

    @cached_property
    def _heading(self) -> Callable[..., Any]:
        return self._compiled(self.heading)

    @cached_property
    def _attitude(self) -> Callable[..., Any]:
        assert self.attitude is not None
        return self._compiled(tuple(self.attitude))

    def _compiled(self, expressions: Sequence[sp.Expr]) -> Callable[..., Any]:
        symbols = (*self.coordinates, *self.parameters)
        elements = Field(symbols).read_all([("embedding", expression(x)) for x in expressions])
        return numpy_function(elements, symbols, check=False)


def orbit_embedding(frame: Frame) -> Embedding:
    """Positions at all times in one figure: r, theta, phi as in flat space."""
    _, r, theta, phi = frame.coordinates
    return Embedding(
        frame.coordinates,
        place=spherical(r, theta, phi),
        axes=("x", "y", "z"),
        isometric=False,
        title="r, θ, φ drawn as in flat space",
    )
