"""embeddings: where the points of a shipped space lie in ordinary space, to be drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion import checks
from geomtorsion.checks import expression
from geomtorsion.codegen import numpy_function
from geomtorsion.errors import UnknownNameError
from geomtorsion.exact import Field
from geomtorsion.geometry import Frame
from geomtorsion.spaces.atlases import EULER, from_angles, rotation, spherical
from geomtorsion.spaces.registry import load

Symbols = tuple[sp.Symbol, ...]


@dataclass(frozen=True, eq=False)
class Embedding:
    """Exact functions of the coordinates that say where a point is, or how a body is turned.

    coordinates, parameters: symbols on which the functions may depend.
    place: two or three expressions, a point of the plane or of space; empty if there is none.
    axes: names of the axes in which the place is drawn.
    attitude: rotation matrix, body to space, columns are the body's axes; None if there is none.
    isometric: whether lengths in the picture are lengths in the metric.
    title: what the picture shows.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> sphere = embedding_of(load("s2").frame)
    >>> sphere.place
    (R*sin(theta)*cos(phi), R*sin(phi)*sin(theta), R*cos(theta))
    """

    coordinates: Symbols
    parameters: Symbols = ()
    place: tuple[sp.Expr, ...] = ()
    axes: tuple[str, ...] = ()
    attitude: sp.Matrix | None = None
    isometric: bool = True
    title: str = ""

    def places(self, coordinates: Any, parameters: Mapping[str, float]) -> Any:
        """Places of many points: coordinates (m, n) give an array (m, 2) or (m, 3)."""
        return self._many(self._place, coordinates, parameters)

    def attitudes(self, coordinates: Any, parameters: Mapping[str, float]) -> Any:
        """Attitudes of many points: coordinates (m, n) give an array (m, 3, 3)."""
        return self._many(self._attitude, coordinates, parameters).reshape(-1, 3, 3)

    def _many(self, function: Callable[..., Any], points: Any, parameters: Mapping) -> Any:
        columns = np.asarray(points, dtype=float).T
        for parameter in self.parameters:
            checks.check_declared(parameter, parameters[parameter.name])
        return function(*columns, *(float(parameters[p.name]) for p in self.parameters)).T

    @cached_property
    def _place(self) -> Callable[..., Any]:
        return self._compiled(self.place)

    @cached_property
    def _attitude(self) -> Callable[..., Any]:
        assert self.attitude is not None
        return self._compiled(tuple(self.attitude))

    def _compiled(self, expressions: Sequence[sp.Expr]) -> Callable[..., Any]:
        symbols = (*self.coordinates, *self.parameters)
        elements = Field(symbols).read_all([("embedding", expression(x)) for x in expressions])
        return numpy_function(elements, symbols, check=False)


def embedding_of(frame: Frame) -> Embedding | None:
    """The embedding of a shipped space, or None; a file is known by its coframe, not its name.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> embedding_of(load("so3").frame).attitude.shape
    (3, 3)
    >>> embedding_of(load("heisenberg").frame) is None
    True
    """
    maker = EMBEDDINGS.get(frame.name or "")
    if maker is None:
        return None
    try:
        shipped = load(frame.name or "").frame
    except UnknownNameError:
        return None
    return maker(frame) if _same(frame, shipped) else None


def _same(one: Frame, two: Frame) -> bool:
    """Whether two frames have the same coframe in coordinates of the same names."""
    n = one.dimension
    names = [symbol.name for symbol in one.coordinates]
    if names != [symbol.name for symbol in two.coordinates]:
        return False
    return all(str(one.coframe[i, k]) == str(two.coframe[i, k]) for i in range(n) for k in range(n))


# -- attitudes ----------------------------------------------------------------------------------


def _euler(frame: Frame) -> Embedding:
    """Three angles about named axes; what comes after them is the place."""
    axes, order, _ = EULER[frame.name or ""]
    angles, place = frame.coordinates[:3], frame.coordinates[3:]
    turn = rotation(from_angles(axes, [angles[k] for k in order]))
    return Embedding(
        frame.coordinates,
        place=place,
        axes=tuple(symbol.name for symbol in place),
        attitude=turn,
        title="path of the body in space" if place else "",
    )


def _quaternion(frame: Frame) -> Embedding:
    q = frame.coordinates
    return Embedding(q, attitude=rotation([sp.sqrt(1 - sum(x**2 for x in q)), *q]))


def _rodrigues(frame: Frame) -> Embedding:
    g = frame.coordinates
    return Embedding(g, attitude=rotation([sp.S.One, *g]) / (1 + sum(x**2 for x in g)))


def _axis_angle(frame: Frame) -> Embedding:
    chi, theta, phi = frame.coordinates
    axis = spherical(sp.sin(chi / 2), theta, phi)
    return Embedding(frame.coordinates, attitude=rotation([sp.cos(chi / 2), *axis]))


# -- places -------------------------------------------------------------------------------------


def _polar(frame: Frame) -> Embedding:
    r, phi = frame.coordinates
    return Embedding(
        (r, phi), place=(r * sp.cos(phi), r * sp.sin(phi)), axes=("x", "y"), title="in the plane"
    )


def _cylindrical(frame: Frame) -> Embedding:
    r, phi, z = frame.coordinates
    place = (r * sp.cos(phi), r * sp.sin(phi), z)
    return Embedding((r, phi, z), place=place, axes=("x", "y", "z"), title="in space")


def _cut(frame: Frame) -> Embedding:
    """As if nothing had been cut out or put in: angles are right, circles are too long or short."""
    return replace(_cylindrical(frame), isometric=False, title="r, φ, z drawn as in flat space")


def _spherical(frame: Frame) -> Embedding:
    place = spherical(*frame.coordinates)
    return Embedding(frame.coordinates, place=place, axes=("x", "y", "z"), title="in space")


def _sphere(frame: Frame) -> Embedding:
    theta, phi = frame.coordinates
    (radius,) = frame.parameters
    return Embedding(
        (theta, phi),
        (radius,),
        spherical(radius, theta, phi),
        ("x", "y", "z"),
        title="on the sphere",
    )


def _hopf(frame: Frame) -> Embedding:
    """Stereographic projection of cos(eta) exp(i xi1), sin(eta) exp(i xi2) from the last axis."""
    eta, xi1, xi2 = frame.coordinates
    c, s = sp.cos(eta), sp.sin(eta)
    scale = 1 / (1 - s * sp.sin(xi2))
    place = (c * sp.cos(xi1) * scale, c * sp.sin(xi1) * scale, s * sp.cos(xi2) * scale)
    return Embedding(
        frame.coordinates,
        place=place,
        axes=("X", "Y", "Z"),
        isometric=False,
        title="in stereographic projection",
    )


def _orbit(frame: Frame) -> Embedding:
    """Positions at all times in one picture: r, theta, phi as in flat space."""
    _, r, theta, phi = frame.coordinates
    return Embedding(
        frame.coordinates,
        place=spherical(r, theta, phi),
        axes=("x", "y", "z"),
        isometric=False,
        title="r, θ, φ drawn as in flat space",
    )


EMBEDDINGS: dict[str, Callable[[Frame], Embedding]] = {
    **dict.fromkeys(EULER, _euler),
    "so3_quaternion": _quaternion,
    "so3_rodrigues": _rodrigues,
    "so3_axis_angle": _axis_angle,
    "flat_polar": _polar,
    "flat_cylindrical": _cylindrical,
    "flat_spherical": _spherical,
    **dict.fromkeys(("wedge_disclination", "wedge_disclination_periodic"), _cut),
    "s2": _sphere,
    "s3": _hopf,
    **dict.fromkeys(("schwarzschild", "kerr", "frw", "de_sitter"), _orbit),
}
