"""Affine form: coframe and connection as one form along paths, curvature over cones on loops."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from geomtorsion.codegen import numpy_function
from geomtorsion.errors import LoopError, SingularPointError
from geomtorsion.exact import Element
from geomtorsion.geometry import contract
from geomtorsion.geometry.derived import derived
from geomtorsion.loops.affine_map import AffineMap
from geomtorsion.loops.arcs import Parameters, Part, Segment
from geomtorsion.loops.forms import Forms, Poles, forms, parameter_values, perturbed, poles_of
from geomtorsion.loops.integrals import probes
from geomtorsion.loops.quadrature import ROUNDING, ray_rule
from geomtorsion.loops.transport import (
    Integrand,
    Transported,
    collocation,
    inner_turns,
    transported,
)
from geomtorsion.support.caching import cached_property

if TYPE_CHECKING:
    from geomtorsion.geometry import Connection, Frame, Tensor


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
            theta = form.along(form.at(points), slopes)
            return self._no_turn(theta), theta.T
        compiled, numbers = self._line
        values, count = compiled.function(*points, *numbers), len(compiled.turn)
        n, k = points.shape
        omega = np.zeros((k, n, n), dtype=values.dtype)
        theta = np.zeros((k, n), dtype=values.dtype)
        for value, (a, i, j) in zip(values[:count], compiled.turn, strict=True):
            omega[:, j, i] += value * slopes[a]
        for value, (i, a) in zip(values[count:], compiled.step, strict=True):
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
        compiled, numbers = self._area
        values, count = compiled.function(*points, *numbers), len(compiled.turn)
        n, k = points.shape
        rho = np.zeros((k, n, n), dtype=values.dtype)
        tau = np.zeros((k, n), dtype=values.dtype)
        for value, (a, b, i, j) in zip(values[:count], compiled.turn, strict=True):
            rho[:, j, i] += value * (x[a] * v[b] - x[b] * v[a])
        for value, (a, b, j) in zip(values[count:], compiled.step, strict=True):
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
        """Factors of denominators of coframe or connection that may vanish."""
        if self._plain is not None:
            return self._plain.poles
        compiled, numbers = self._line
        return compiled.poles and replace(compiled.poles, numbers=numbers)

    @cached_property
    def turns(self) -> bool:
        """Whether parallel transport turns the legs at all."""
        return self._plain is None and bool(
            _compiled(self.connection.frame, self.connection, "line").turn
        )

    def coframe(self, point: np.ndarray) -> np.ndarray:
        """e^i_mu at one point, shape (n, n)."""
        n = self.dimension
        rows = [self.along(point[:, None], np.eye(n)[:, [a]])[1][0] for a in range(n)]
        return np.array(rows).T

    @cached_property
    def _line(self) -> tuple[_Compiled, tuple[float | complex, ...]]:
        """The form along a line, and the values of the parameters that it takes."""
        return self._with_numbers("line")

    @cached_property
    def _area(self) -> tuple[_Compiled, tuple[float | complex, ...]]:
        """The form's curvature, and the values of the parameters that it takes."""
        return self._with_numbers("area")

    def _with_numbers(self, kind: str) -> tuple[_Compiled, tuple[float | complex, ...]]:
        """Compiled components, and values for their parameters, checked once."""
        frame, compiled = (
            self.connection.frame,
            _compiled(self.connection.frame, self.connection, kind),
        )
        return compiled, parameter_values(frame, compiled.parameters, self.parameters)


@dataclass(frozen=True, eq=False)
class _Compiled:
    """Components that do not vanish as one NumPy function of coordinates, then of parameters.

    turn, step: indices of the first of them (omega or R) and of the others (e or T), in order.
    poles: factors of their denominators that may vanish; only for the form along a line.
    """

    turn: tuple[tuple[int, ...], ...]
    step: tuple[tuple[int, ...], ...]
    function: Callable[..., np.ndarray]
    parameters: tuple[sp.Symbol, ...]
    poles: Poles | None


@derived
def _compiled(frame: Frame, connection: Connection, kind: str) -> _Compiled:
    """The form or its curvature: exact components, chosen and compiled together."""
    if kind == "line":
        turn = _entries(connection.spin_connection)
        step = _entries(frame.coframe)
    else:
        legs, coframe = frame.legs, frame.coframe
        riemann = connection.curvature.riemann
        turn = _upper(_entries(contract("mnlk,li,jk->mnij", riemann, legs, coframe)))
        step = _upper(_entries(contract("abc,jc->abj", connection.torsion.T, coframe)))
    elements = [element for _, element in (*turn, *step)]
    symbols = {symbol for element in elements for symbol in element.symbols}
    extra = tuple(sorted(symbols - set(frame.coordinates), key=str))
    arguments = (*frame.coordinates, *extra)
    function = numpy_function(elements, arguments)
    owner = "connection" if turn else "coframe"
    poles = poles_of(frame, elements, arguments, owner) if kind == "line" else None
    indices = [tuple(index for index, _ in entries) for entries in (turn, step)]
    return _Compiled(indices[0], indices[1], function, extra, poles)


def _entries(tensor: Tensor) -> Entries:
    """Components that do not vanish."""
    return tuple(tensor.components.nonzero.items())


def _upper(entries: Entries) -> Entries:
    """Components with the first index below the second: the others follow by antisymmetry."""
    return tuple((index, element) for index, element in entries if index[0] < index[1])


# Gauss points along the rays: pairs that are compared, the next if they disagree.
LEVELS = ((6, 10), (10, 16), (16, 26))
# Loops with a smaller area lose digits to underflow; only the line integral is used for them.
SMALLEST_AREA = float(np.finfo(float).tiny / np.finfo(float).eps)


def around_cone(form: AffineForm, part: Part, accuracy: float) -> Transported | None:
    """The development of one part, once around, from its base point; None if the cone is singular.

    Equation
    --------
    With g(u) the development along the ray from the centre to a point x(s) of the loop,
    H' = H integral_0^1 u g F(x, x') g^-1 du, F = (R, T) curvature and torsion: Stokes for
    path-ordered products. G = g^-1 H g at the base point. F is exact and x is the offset itself,
    so that nothing cancels, however small the loop.
    """
    if part.size * part.size < SMALLEST_AREA:
        return None
    try:
        levels = _levels(form, part, accuracy)
        if levels is None:
            return None
        count, missed, turn_missed = levels
        circuit = transported(part.arcs, lambda x, v: cone_rate(form, part, x, v, count), accuracy)
        # Without turns a motion is a plain sum, the same from everywhere.
        ray = from_centre(form, part) if form.turns else None
    except (SingularPointError, LoopError):
        return None
    turn_error = circuit.turn_error + turn_missed * len(part.arcs)
    error = circuit.error + missed * len(part.arcs)
    motion = circuit.motion
    if ray is not None:
        motion = motion.seen_from(ray)
        error += float(np.linalg.norm(ray.burgers)) * turn_error
    error += ROUNDING * float(np.abs(motion.burgers).max())
    return Transported(motion, error, turn_error, circuit.scale, circuit.points * count)


def _levels(form: AffineForm, part: Part, accuracy: float) -> tuple[int, float, float] | None:
    """How many points the rays need; what they and rounding miss of translation and rotation."""
    x, v, _ = probes(part.arcs)
    centre = tuple(perturbed(np.array(part.centre)).tolist())
    moved = replace(part, centre=centre)
    rates: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    for few, many in LEVELS:
        for count in (few, many):
            if count not in rates:
                rates[count] = cone_rate(form, part, x, v, count)
        shifted_rates = cone_rate(form, moved, x, v, many)
        errors, good = [], True
        for coarse, fine, after in zip(rates[few], rates[many], shifted_rates, strict=True):
            size = float(np.abs(fine).max(initial=0.0))
            noise = float(np.abs(after - fine).max(initial=0.0)) + ROUNDING * size
            missed = float(np.abs(coarse - fine).max(initial=0.0))
            good &= missed <= max(accuracy * size, 2 * noise)
            errors.append(missed + noise)
        if good:
            return many, errors[1], errors[0]
    return None


def cone_rate(
    form: AffineForm, part: Part, offsets: np.ndarray, slopes: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    """The rate of H at points of the loop, seen from the centre, shapes (k, n, n) and (k, n)."""
    n, k = offsets.shape
    u, weights = ray_rule(count)
    centre = np.array(part.centre)[:, None]
    x, v = np.repeat(offsets, count, axis=1), np.repeat(slopes, count, axis=1)
    inner = np.tile(u, k)
    rho, tau = form.over(centre + part.size * (inner * x), part.size * x, part.size * v)
    rho, tau = rho.reshape(k, count, n, n), tau.reshape(k, count, n)
    if form.turns:
        turn, shift = _along_rays(form, part, offsets, u)
        turned = turn @ rho @ np.linalg.inv(turn)
        tau = (turn @ tau[..., None] - turned @ shift[..., None])[..., 0]
        rho = turned
    return np.einsum("u,kuij->kij", weights, rho), np.einsum("u,kui->ki", weights, tau)


def _along_rays(
    form: AffineForm, part: Part, offsets: np.ndarray, stops: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Rotation and translation along each ray up to the stops, shapes (k, u, n, n), (k, u, n)."""
    n, k = offsets.shape
    nodes, _, integrals = collocation(len(stops))
    centre = np.array(part.centre)[:, None]
    x = np.repeat(offsets, len(nodes), axis=1)
    places = centre + part.size * (np.tile(nodes, k) * x)
    omega, theta = form.along(places, part.size * x)
    omega, theta = omega.reshape(k, -1, n, n), theta.reshape(k, -1, n)
    inner = inner_turns(omega, integrals)
    rates = theta + (inner @ theta[..., None])[..., 0]
    turn_rates = omega + inner @ omega
    # The polynomials through the nodes, integrated up to the stops.
    upto = integrals_up_to(stops, len(nodes))
    turn = np.eye(n) + (upto @ turn_rates.reshape(k, -1, n * n)).reshape(k, -1, n, n)
    return turn, upto @ rates


def integrals_up_to(stops: np.ndarray, stages: int) -> np.ndarray:
    """Integrals of the node polynomials from 0 to each stop, shape (stops, stages)."""
    x, w = np.polynomial.legendre.leggauss(stages)
    values = np.polynomial.legendre.legvander(2 * stops - 1, stages)
    k = np.arange(stages)
    basis = np.polynomial.legendre.legvander(x, stages - 1)
    expansion = basis.T * w * (2 * k[:, None] + 1) / 2
    upto = np.empty((len(stops), stages))
    upto[:, 0] = 2 * stops
    upto[:, 1:] = (values[:, 2:] - values[:, :-2]) / (2 * k[1:] + 1)
    return upto @ expansion / 2


def from_centre(form: AffineForm, part: Part) -> AffineMap:
    """Development from the centre of a part straight to its base point."""
    base = tuple(part.base_offset.tolist())
    ray = Segment((0.0,) * len(base), base)
    return transported([ray], line_rate(form, part), 1e-14).motion


def line_rate(form: AffineForm, part: Part) -> Integrand:
    """The form along an arc of a part, from offsets and slopes."""
    centre = np.array(part.centre)[:, None]

    def rate(offsets: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return form.along(centre + part.size * offsets, part.size * slopes)

    return rate
