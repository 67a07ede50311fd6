"""Cases: the spaces on which each contestant is timed, in plain sympy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import sympy as sp
from sympy import cos, exp, sin, sqrt

t, r, theta, phi, psi = sp.symbols("t r theta phi psi")
x, y, z = sp.symbols("x y z")
phi1, phi2, phi3, x1, x2, x3 = sp.symbols("phi1 phi2 phi3 x1 x2 x3")
mass, spin, spin2, mu = sp.symbols("M a b mu")

LORENTZ4 = (-1, 1, 1, 1)


@dataclass(frozen=True)
class Case:
    """One space, given by a coframe or by a metric.

    name, title      its name on the command line and in a table
    coordinates      sympy symbols
    coframe          rows i, columns mu; None where the space is given by its metric
    line_element     metric g[mu, nu]; None where it follows from the coframe
    signature        diagonal of eta
    vacuum           Ricci vanishes identically, which a contestant has to find
    """

    name: str
    title: str
    coordinates: tuple[sp.Symbol, ...]
    signature: tuple[int, ...]
    coframe: sp.ImmutableMatrix | None = None
    line_element: sp.ImmutableMatrix | None = None
    vacuum: bool = False

    @property
    def dimension(self) -> int:
        return len(self.coordinates)

    @cached_property
    def metric(self) -> sp.ImmutableMatrix:
        """Metric in the form of a textbook; simplified here, before any timing."""
        if self.line_element is not None:
            return self.line_element
        assert self.coframe is not None
        product = self.coframe.T * sp.diag(*self.signature) * self.coframe
        return product.applyfunc(sp.simplify).as_immutable()


def _matrix(rows: object) -> sp.ImmutableMatrix:
    return sp.ImmutableMatrix(rows)


def sphere() -> Case:
    """The unit 2-sphere, which warms a process up and is never reported."""
    return Case("sphere", "S^2", (theta, phi), (1, 1), _matrix(sp.diag(1, sin(theta))))


def _euler_coframe() -> sp.Matrix:
    """Left-invariant coframe of SO(3), z-y-z, [FizievKleinert1994] eq. (6)."""
    s1, c1, s2, c2 = sin(phi1), cos(phi1), sin(phi2), cos(phi2)
    return sp.Matrix([[0, s1, -c1 * s2], [0, c1, s1 * s2], [1, 0, c2]])


def so3() -> Case:
    return Case(
        "so3",
        "SO(3), Euler angles",
        (phi1, phi2, phi3),
        (1, 1, 1),
        _matrix(_euler_coframe()),
    )


def schwarzschild() -> Case:
    f = 1 - 2 * mass / r
    return Case(
        "schwarzschild",
        "Schwarzschild",
        (t, r, theta, phi),
        LORENTZ4,
        _matrix(sp.diag(sqrt(f), 1 / sqrt(f), r, r * sin(theta))),
        vacuum=True,
    )


def goedel() -> Case:
    """ds^2 = -(dt + e^(a x) dy)^2 + dx^2 + e^(2 a x) dy^2 / 2 + dz^2."""
    w = exp(spin * x)
    rows = [[1, 0, w, 0], [0, 1, 0, 0], [0, 0, w / sqrt(2), 0], [0, 0, 0, 1]]
    return Case(
        "goedel",
        "Goedel",
        (t, x, y, z),
        LORENTZ4,
        _matrix(rows),
    )


def kerr_carter() -> Case:
    """Kerr, the orthonormal tetrad of Carter in Boyer-Lindquist coordinates."""
    sigma = r**2 + spin**2 * cos(theta) ** 2
    delta = r**2 - 2 * mass * r + spin**2
    rows = [
        [sqrt(delta / sigma), 0, 0, -spin * sin(theta) ** 2 * sqrt(delta / sigma)],
        [0, sqrt(sigma / delta), 0, 0],
        [0, 0, sqrt(sigma), 0],
        [-spin * sin(theta) / sqrt(sigma), 0, 0, (r**2 + spin**2) * sin(theta) / sqrt(sigma)],
    ]
    return Case(
        "kerr_carter",
        "Kerr, Carter tetrad",
        (t, r, theta, phi),
        LORENTZ4,
        _matrix(rows),
        _kerr_metric(),
        vacuum=True,
    )


def _kerr_metric() -> sp.ImmutableMatrix:
    sigma = r**2 + spin**2 * cos(theta) ** 2
    delta = r**2 - 2 * mass * r + spin**2
    s2 = sin(theta) ** 2
    cross = -2 * mass * spin * r * s2 / sigma
    last = (r**2 + spin**2 + 2 * mass * spin**2 * r * s2 / sigma) * s2
    rows = [
        [-(1 - 2 * mass * r / sigma), 0, 0, cross],
        [0, sigma / delta, 0, 0],
        [0, 0, sigma, 0],
        [cross, 0, 0, last],
    ]
    return _matrix(rows)


def kerr_metric() -> Case:
    return Case(
        "kerr_metric",
        "Kerr, Boyer-Lindquist metric",
        (t, r, theta, phi),
        LORENTZ4,
        line_element=_kerr_metric(),
        vacuum=True,
    )


def generic() -> Case:
    """diag(A, B, C, D sin(theta)) with four unknown functions of (t, r)."""
    a, b, c, d = (sp.Function(name)(t, r) for name in "ABCD")
    return Case(
        "generic",
        "generic, 4 functions of (t, r)",
        (t, r, theta, phi),
        LORENTZ4,
        _matrix(sp.diag(a, b, c, d * sin(theta))),
    )


def generic_full() -> Case:
    """diag(A, B, C, D) with four unknown functions of all four coordinates."""
    a, b, c, d = (sp.Function(name)(t, x, y, z) for name in "ABCD")
    return Case(
        "generic_full",
        "generic, 4 functions of (t, x, y, z)",
        (t, x, y, z),
        LORENTZ4,
        _matrix(sp.diag(a, b, c, d)),
    )


def r3xso3() -> Case:
    """SE(3): dPhi = e dphi and dX = R^T dx, R = Rz(phi3) Ry(phi2) Rz(phi1)."""

    def about_z(angle: sp.Symbol) -> sp.Matrix:
        return sp.Matrix([[cos(angle), -sin(angle), 0], [sin(angle), cos(angle), 0], [0, 0, 1]])

    about_y = sp.Matrix([[cos(phi2), 0, sin(phi2)], [0, 1, 0], [-sin(phi2), 0, cos(phi2)]])
    attitude = about_z(phi3) * about_y * about_z(phi1)
    return Case(
        "r3xso3",
        "R^3 x SO(3), 6-d",
        (phi1, phi2, phi3, x1, x2, x3),
        (1,) * 6,
        _matrix(sp.diag(_euler_coframe(), attitude.T)),
    )


def myers_perry_equal() -> Case:
    """Five dimensions, equal rotation a = b, orthonormal pentad; mu is the mass parameter."""
    s, c = sin(theta), cos(theta)
    rho2 = r**2 + spin**2
    twist = rho2 + mu * spin**2 / rho2
    lapse = sqrt((rho2**2 - mu * r**2) / (rho2 * twist))
    shift = mu * spin / (rho2 * twist)
    root = sqrt(twist)
    rows = [
        [lapse, 0, 0, 0, 0],
        [0, r * sqrt(rho2) / sqrt(rho2**2 - mu * r**2), 0, 0, 0],
        [0, 0, sqrt(rho2), 0, 0],
        [0, 0, 0, sqrt(rho2) * s * c, -sqrt(rho2) * s * c],
        [-root * shift, 0, 0, root * s**2, root * c**2],
    ]
    return Case(
        "myers_perry_equal",
        "Myers-Perry 5-d, a = b, pentad",
        (t, r, theta, phi, psi),
        (-1, 1, 1, 1, 1),
        _matrix(rows),
        _myers_perry_metric(spin),
        vacuum=True,
    )


def _myers_perry_metric(other: sp.Symbol) -> sp.ImmutableMatrix:
    s2, c2 = sin(theta) ** 2, cos(theta) ** 2
    rho2 = r**2 + spin**2 * c2 + other**2 * s2 if other != spin else r**2 + spin**2
    delta = (r**2 + spin**2) * (r**2 + other**2) - mu * r**2
    one_form = sp.Matrix([1, 0, 0, -spin * s2, -other * c2])
    rest = sp.diag(-1, rho2 * r**2 / delta, rho2, (r**2 + spin**2) * s2, (r**2 + other**2) * c2)
    return _matrix(rest + one_form * one_form.T * mu / rho2)


def myers_perry() -> Case:
    """Five dimensions, two rotation parameters a and b, from the metric."""
    return Case(
        "myers_perry",
        "Myers-Perry 5-d, a and b, metric",
        (t, r, theta, phi, psi),
        (-1, 1, 1, 1, 1),
        line_element=_myers_perry_metric(spin2),
        vacuum=True,
    )


MAKERS: tuple[Callable[[], Case], ...] = (
    so3,
    schwarzschild,
    goedel,
    kerr_carter,
    kerr_metric,
    generic,
    generic_full,
    r3xso3,
    myers_perry_equal,
    myers_perry,
)
NAMES = tuple(maker.__name__ for maker in MAKERS)


def load(name: str) -> Case:
    """The case with the given name (`sphere` included)."""
    for maker in (*MAKERS, sphere):
        if maker.__name__ == name:
            return maker()
    raise LookupError(f"no benchmark case {name!r}; there are {', '.join(NAMES)}")
