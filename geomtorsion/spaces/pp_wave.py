"""pp_wave: a plane-fronted gravitational wave of any profile, in null legs."""

from sympy import Function, Rational, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, matrix


def space(name: str) -> Space:
    """Coframe (du, dv + H du/2, dx, dy) with ds^2 = 2 e^0 e^1 + dx^2 + dy^2."""
    u, v, x, y = symbols("u v x y", real=True)
    profile = Function("H")(u, x, y)
    half = Rational(1, 2)
    frame = Frame(
        (u, v, x, y),
        [[1, 0, 0, 0], [profile * half, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
        signature=((0, 1, 0, 0), (1, 0, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)),
        name=name,
    )
    torsion = {(2, 0, 1): profile.diff(x) / 4, (3, 0, 1): profile.diff(y) / 4}
    return Space(
        name,
        story=(
            "A wave with flat fronts and a profile H(u, x, y) left unknown (Brinkmann 1925).\n"
            "It is empty space where H is harmonic in x and y; all its scalar invariants vanish."
        ),
        source="J. Ehlers, W. Kundt, in L. Witten (ed.), Gravitation (1962), chapter 2",
        frame=frame,
        known=(
            KnownAnswer(
                "metric",
                matrix([[profile, 1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
            ),
            KnownAnswer("torsion", antisymmetric(torsion), basis="frame"),
            KnownAnswer("torsion_scalar", 0),
            KnownAnswer("ricci", {(0, 0): -half * (profile.diff(x, 2) + profile.diff(y, 2))}),
            KnownAnswer("scalar_curvature", 0),
            KnownAnswer("kretschmann", 0),
        ),
        # Timelike: 2 u^0 u^1 + (u^2)^2 + (u^3)^2 = -1.
        motion=FirstMotion((0.0, 0.0, 0.5, 0.3), (1.0, -0.545, 0.3, 0.0)),
        group="gravity",
        notes="Signature (-, +, +, +); null legs, eta has 1 at [0, 1] and [1, 0].",
    )
