"""Spinning: bodies with spin in a space with torsion, by Mathisson, Papapetrou and Tulczyjew."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, permutations
from typing import Any

import numpy as np
import sympy as sp

from geomtorsion.curves.problem import checked_parameters, checked_start, frame_velocities
from geomtorsion.errors import ArgumentError, ShapeError, StartError
from geomtorsion.geometry import Connection, Frame, levi_civita
from geomtorsion.geometry.connections import ConnectionLike, as_connection
from geomtorsion.ode import ODE
from geomtorsion.ode.numbers import Numbers, Real, checked_numbers
from geomtorsion.support import checks

COUPLINGS = ("orbital", "intrinsic")
EFFECTS = {
    "spin_force": "force of curvature on the spin",
    "hidden_momentum": "part of the momentum across the velocity",
    "torsion": "torsion in the force and in the transport of momentum and spin",
}
Matrix = list[list[sp.Expr]]


def spinning(
    connection: ConnectionLike,
    start: Numbers,
    velocity: Numbers,
    spin: object,
    *,
    coupling: str = "intrinsic",
    parameters: Mapping[Any, Any] | None = None,
) -> ODE:
    """Motion of a body with spin: momentum p_i and spin S^ij along its worldline.

    Equation
    --------
    D_u p_i = T_in^j u^n p_j + R_inkj u^n S^kj / 2,  D_u S^ij = p^i u^j - p^j u^i,  S^ij p_j = 0
    u = (p + S M p / (k (1 - tr(S M) / (2 k)))) / sqrt|k|,  M_in = T_in^j p_j + R_inkj S^kj / 2,
    k = p_i p^i                              [Papapetrou1951], [Tulczyjew1959], [YasskinStoeger1980]

    The velocity u follows from the condition S^ij p_j = 0, which the motion then keeps, as it keeps
    p_i p^i and S_ij S^ij. Without spin this is a geodesic, for any torsion.

    Parameters
    ----------
    connection
        A metric connection in two to four dimensions.
    start
        q^mu, shape (n,).
    velocity
        Direction of the momentum p^mu, shape (n,), coordinates; it is scaled to length one, so that
        all is per unit of mass, and a body without spin moves at the rate of its proper time.
    spin
        S^ij in the frame per unit of mass, shape (n, n), antisymmetric; in four dimensions also
        the vector s^i, shape (4,), with S^12 = s^3 at rest. The part that is not orthogonal to the
        momentum is dropped.
    coupling
        "intrinsic": spin of the matter itself, which feels torsion: D and R belong to the given
        connection. "orbital": rotation of a body made of spinless matter, which does not: D and R
        belong to the metric. Without torsion both are the same.

    Returns
    -------
    ODE with the coordinates, p1, p2, ... (frame components, lower) and S12, S13, ... as states, and
    the velocity q'^mu as output; to be given to `solve`. Its effects, which `without` and
    `gt.called_for` omit, are: spin_force, R S in D_u p; hidden_momentum, the part of p that is not
    along u; torsion, which acts on intrinsic spin.

    Raises
    ------
    ArgumentError
        The coupling has another name, or the connection is not metric.
    ShapeError
        The spin has another shape, is not antisymmetric, or the space has more dimensions.
    StartError
        The start is singular or incomplete, or the velocity is null.

    Examples
    --------
    >>> from geomtorsion.geometry import levi_civita
    >>> from geomtorsion.ode import solve
    >>> from geomtorsion.spaces import load
    >>> hole = levi_civita(load("schwarzschild").frame)
    >>> top = spinning(hole, [0, 10, 1.5707963267948966, 0], [1.2, 0, 0, 0.04], [0, 0, -0.1, 0],
    ...                coupling="orbital", parameters={"M": 1})
    >>> solution = solve(top, 50.0)
    >>> round(float(solution["phi"][-1]), 6)
    1.822146
    """
    connection = as_connection(connection)
    frame = connection.frame
    name = checks.choice(coupling, COUPLINGS, "coupling", ArgumentError)
    if connection.metric_compatible is not True:
        raise ArgumentError(
            f"connection: expected a metric connection, got {connection.name}, which changes "
            "lengths. Use its metric part: from_torsion(frame, connection.torsion)."
        )
    if not 2 <= frame.dimension <= 4:
        raise ShapeError(
            f"expected a space of two to four dimensions, got {frame.dimension}: with more the "
            "velocity of a body with spin has no closed form."
        )
    numbers = checked_parameters(frame, parameters)
    place = checked_start(frame, start, numbers)
    speeds, _ = frame_velocities(frame, place, velocity, None, numbers)
    felt = levi_civita(frame) if name == "orbital" else connection
    maker = _Maker(felt, f"body with {name} spin")
    momentum = _unit(frame, [float(x) for x in speeds])
    tensor = _orthogonal(frame, _spin_tensor(frame, spin, momentum), momentum)
    lower = _eta(frame) @ momentum
    pairs = combinations(range(frame.dimension), 2)
    first = [*place, *lower.tolist(), *(float(tensor[i, j]) for i, j in pairs)]
    return maker.ode(first, numbers)


@dataclass(frozen=True)
class _Maker:
    """Equations of a body with spin, with some effects omitted.

    connection: of D and R, before the torsion is omitted. title: name of the equations.
    omitted: keys of effects.
    """

    connection: Connection
    title: str
    omitted: frozenset[str] = frozenset()

    @property
    def effects(self) -> Mapping[str, str]:
        """The effects that are not omitted."""
        whole = dict(EFFECTS)
        if self.connection.torsion.S.is_zero:
            del whole["torsion"]
        return {key: title for key, title in whole.items() if key not in self.omitted}

    @property
    def watch(self) -> tuple[str, ...]:
        """The coordinates."""
        return tuple(map(str, self.connection.frame.coordinates))

    def without(self, ode: ODE, effects: frozenset[str]) -> ODE:
        """The equations without more effects, from the same start."""
        maker = replace(self, omitted=self.omitted | effects)
        return maker.ode(ode.start, ode.parameters)

    def moved(self, ode: ODE, part: float) -> ODE:
        """Another place and momentum, with the part of the spin that is orthogonal to it."""
        frame, n = self.connection.frame, self.connection.frame.dimension
        values = np.array([float(x) for x in ode.start])
        signs = (-1.0) ** np.arange(n)
        place = values[:n] + part * signs * np.abs(values[:n]).max()
        eta = _eta(frame)
        momentum = np.linalg.inv(eta) @ (values[n : 2 * n] * (1 + part * signs))
        momentum *= np.sqrt(self._square(values[n : 2 * n]) / self._square(eta @ momentum))
        spin = np.zeros((n, n))
        for (i, j), value in zip(combinations(range(n), 2), values[2 * n :], strict=True):
            spin[i, j], spin[j, i] = value, -value
        tensor = _orthogonal(frame, spin, momentum)
        pairs = (tensor[pair] for pair in combinations(range(n), 2))
        return ode.with_start([*place.tolist(), *(eta @ momentum).tolist(), *map(float, pairs)])

    def _square(self, lower: np.ndarray) -> float:
        """p_i p^i."""
        return float(lower @ np.linalg.inv(_eta(self.connection.frame)) @ lower)

    def ode(self, first: Sequence[Real], numbers: Mapping[str, Real]) -> ODE:
        """The equations with numbers."""
        frame, connection = self.connection.frame, self.connection
        if "torsion" in self.omitted:
            connection = levi_civita(frame)
        motion = _Motion(connection, self.omitted)
        states = [*self.watch, *motion.momenta, *motion.spins]
        ode = ODE.of(
            dict(zip(states, motion.rates(), strict=True)),
            dict(zip(states, first, strict=True)),
            parameters={str(key): value for key, value in numbers.items()},
            invariants=motion.invariants(),
            outputs={"velocity": motion.velocity()},
            time=_free_name("tau", [*states, *map(str, frame.parameters)]),
            norm_groups=[motion.momenta, motion.spins],
            name=self.title,
        )
        return replace(ode, maker=self)


class _Motion:
    """The equations of a connection, in momenta p_i and spins S^ij of the frame."""

    def __init__(self, connection: Connection, omitted: Collection[str] = ()) -> None:
        self.omitted = omitted
        self.frame = frame = connection.frame
        n = self.n = frame.dimension
        self.pairs = list(combinations(range(n), 2))
        taken = [str(one) for one in (*frame.coordinates, *frame.parameters)]
        self.momenta = [_free_name(f"p{i + 1}", taken) for i in range(n)]
        self.spins = [_free_name(f"S{i + 1}{j + 1}", taken) for i, j in self.pairs]
        self.p = [sp.Symbol(one, real=True) for one in self.momenta]
        self.S: Matrix = [[sp.S.Zero] * n for _ in range(n)]
        for (i, j), one in zip(self.pairs, self.spins, strict=True):
            self.S[i][j] = sp.Symbol(one, real=True)
            self.S[j][i] = -self.S[i][j]
        self.omega = connection.spin_connection.in_frame().nonzero()
        self.torsion = connection.torsion.T.in_frame().nonzero()
        self.riemann = connection.curvature.lower.in_frame().nonzero()
        self.eta = [[frame.eta[i, j] for j in range(n)] for i in range(n)]
        self.inverse = [[frame.inverse_eta[i, j] for j in range(n)] for i in range(n)]
        self.upper = self._raised(self.p)
        self.force = self._force()
        self.u = self._velocity()

    def _raised(self, lower: list[sp.Expr]) -> list[sp.Expr]:
        return [sp.Add(*(x * y for x, y in zip(row, lower, strict=True))) for row in self.inverse]

    def _force(self) -> Matrix:
        """M_in = T_in^j p_j + R_inkj S^kj / 2."""
        terms: list[list[list[sp.Expr]]] = [[[] for _ in range(self.n)] for _ in range(self.n)]
        for (i, n, j), value in self.torsion.items():
            terms[i][n].append(value * self.p[j])
        if "spin_force" not in self.omitted:
            for (i, n, k, j), value in self.riemann.items():
                terms[i][n].append(value * self.S[k][j] / 2)
        return [[sp.Add(*cell) for cell in row] for row in terms]

    def _velocity(self) -> list[sp.Expr]:
        """u^i of the frame."""
        square = self.square = sp.Add(*(x * y for x, y in zip(self.p, self.upper, strict=True)))
        if "hidden_momentum" in self.omitted:
            size = sp.sqrt(square * self._sign())
            return [one / size for one in self.upper]
        span = range(self.n)
        pushed = [sp.Add(*(self.force[i][k] * self.upper[k] for k in span)) for i in span]
        trace = sp.Add(*(self.S[i][j] * self.force[j][i] for i in span for j in span))
        below = square - trace / 2
        size = sp.sqrt(square * self._sign())
        turned = [sp.Add(*(self.S[i][j] * pushed[j] for j in span)) for i in span]
        return [(self.upper[i] + turned[i] / below) / size for i in span]

    def _sign(self) -> int:
        """The sign of p_i p^i for momenta of bodies: the sign of the first leg."""
        return 1 if self.eta[0][0].is_positive else -1

    def velocity(self) -> list[sp.Expr]:
        """q'^mu."""
        legs, n = self.frame.legs, self.n
        return [sp.Add(*(legs[mu, i] * self.u[i] for i in range(n))) for mu in range(n)]

    def rates(self) -> list[sp.Expr]:
        """Rates of all states, in their order."""
        momenta: list[list[sp.Expr]] = [
            [x * y for x, y in zip(row, self.u, strict=True)] for row in self.force
        ]
        turning: Matrix = [[sp.S.Zero] * self.n for _ in range(self.n)]
        for (a, i, j), value in self.omega.items():
            momenta[i].append(value * self.u[a] * self.p[j])
            turning[i][j] += value * self.u[a]
        spins = []
        for i, j in self.pairs:
            terms = [self.upper[i] * self.u[j], -self.upper[j] * self.u[i]]
            for k in range(self.n):
                terms.append(-turning[k][i] * self.S[k][j])
                terms.append(-turning[k][j] * self.S[i][k])
            spins.append(sp.Add(*terms))
        return [*self.velocity(), *(sp.Add(*terms) for terms in momenta), *spins]

    def invariants(self) -> dict[str, object]:
        """Mass, size of the spin, and the condition on it."""
        span = range(self.n)
        lowered = sp.Matrix(self.eta) * sp.Matrix(self.S) * sp.Matrix(self.eta)
        size = sp.Add(*(self.S[i][j] * lowered[i, j] for i in span for j in span))
        along = [sp.Add(*(self.S[i][j] * self.p[j] for j in span)) for i in span]
        kept = {"mass": self.square, "spin": size}
        # The condition holds only together with the velocity that follows from it.
        return kept if "hidden_momentum" in self.omitted else {**kept, "condition": along}


def _free_name(name: str, taken: list[str]) -> str:
    """A unique name."""
    while name in taken:
        name += "_"
    return name


def _eta(frame: Frame) -> np.ndarray:
    n = frame.dimension
    return np.array([[float(frame.eta[i, j]) for j in range(n)] for i in range(n)])


def _unit(frame: Frame, speeds: list[float]) -> np.ndarray:
    """p^i of length one."""
    momentum = np.array(speeds)
    square = float(momentum @ _eta(frame) @ momentum)
    sign = 1 if frame.eta[0, 0].is_positive else -1
    if not square * sign > 0:
        raise StartError(
            "velocity: expected the velocity of a body, with a square of the sign of the first "
            f"leg, got the square {square:.6g}. Give a timelike velocity."
        )
    return momentum / np.sqrt(abs(square))


def _spin_tensor(frame: Frame, spin: object, momentum: np.ndarray) -> np.ndarray:
    """S^ij from a matrix or a vector."""
    n = frame.dimension
    kind = f"{n} rows of S^ij{', or the four numbers s^i' if n == 4 else ''}"
    rows = checks.entries(spin, "spin", ShapeError, n, expected=kind)
    if any(isinstance(row, list | tuple) for row in rows):
        table = [[float(x) for x in checked_numbers(row, n, "spin")] for row in rows]
        tensor = np.array(table)
        if (tensor != -tensor.T).any():
            raise ShapeError(
                "spin: expected an antisymmetric S^ij, got components that do not cancel. Give "
                "S[j, i] = -S[i, j]."
            )
        return tensor
    if n != 4:
        raise ShapeError(
            f"spin: expected {n} rows of S^ij, got one row. A spin vector needs four dimensions."
        )
    eta = _eta(frame)
    lower_p, lower_s = eta @ momentum, eta @ [float(x) for x in checked_numbers(rows, n, "spin")]
    # S^ij = epsilon^ijkl p_k s_l with epsilon_0123 > 0 on the legs.
    tensor, scale = np.zeros((n, n)), -1 / np.sqrt(abs(np.linalg.det(eta)))
    for order in permutations(range(n)):
        i, j, k, m = order
        sign = round(np.linalg.det(np.eye(n)[list(order)]))
        tensor[i, j] += scale * sign * lower_p[k] * lower_s[m]
    return tensor


def _orthogonal(frame: Frame, spin: np.ndarray, momentum: np.ndarray) -> np.ndarray:
    """The part of S^ij with S^ij p_j = 0."""
    lower = _eta(frame) @ momentum
    away = np.eye(len(momentum)) - np.outer(momentum, lower) / float(momentum @ lower)
    return away @ spin @ away.T
