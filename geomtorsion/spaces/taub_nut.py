"""taub_nut: the vacuum with a gravitational magnetic charge."""

from sympy import Rational, cos, oo, pi, sin, sqrt, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, box


def space(name: str) -> Space:
    """Coframe (f (dt + 2l cos(theta) dphi), dr/f, s dtheta, s sin(theta) dphi), s^2 = r^2 + l^2."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    mass, nut = symbols("M l", positive=True)
    size = r**2 + nut**2
    delta = r**2 - 2 * mass * r - nut**2
    f, s = sqrt(delta) / sqrt(size), sqrt(size)
    frame = Frame(
        (t, r, theta, phi),
        [
            [f, 0, 0, 2 * nut * f * cos(theta)],
            [0, 1 / f, 0, 0],
            [0, 0, s, 0],
            [0, 0, 0, s * sin(theta)],
        ],
        signature=(-1, 1, 1, 1),
        parameters=(mass, nut),
        domain=[delta > 0, *box({r: (mass, oo), theta: (0, pi), phi: (0, 2 * pi)})],
        name=name,
    )
    half = Rational(1, 2)
    slope = (mass * (r**2 - nut**2) + 2 * nut**2 * r) / (size**2 * f)
    torsion = {
        (1, 0, 0): half * slope,
        (2, 3, 0): -nut * f / size,
        (1, 2, 2): half * r * f / size,
        (1, 3, 3): half * r * f / size,
        (2, 3, 3): half * cos(theta) / (s * sin(theta)),
    }
    return Space(
        name,
        story=(
            "A mass with a gravitational magnetic charge l: space turns around every direction.\n"
            "The charge is the axial torsion of the static legs: T_23^0 is proportional to it."
        ),
        source="E. Newman, L. Tamburino, T. Unti, J. Math. Phys. 4 (1963) 915",
        frame=frame,
        known=(
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("determinant", size * sin(theta)),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", {}),
        ),
        motion=FirstMotion(
            (0.0, 8.0, 1.2, 0.3), (1.25, 0.5, 0.25, 0.5), parameters={"M": 1.0, "l": 0.5}
        ),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1. The half axes theta = 0 and pi are singular "
        "(Misner's strings), unless t has the period 8 pi l.",
    )
