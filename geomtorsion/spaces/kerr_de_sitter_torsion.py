"""kerr_de_sitter_torsion: the rotating black hole of Poincare gauge theory."""

from sympy import Expr, cos, oo, pi, sin, sqrt, symbols

from geomtorsion.geometry import Frame, Tensor, from_torsion
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, box


def space(name: str) -> Space:
    """Carter's tetrad of Kerr-de Sitter, and its metric connection with torsion."""
    t, r, theta, phi = symbols("t r theta phi", real=True)
    mass, spin = symbols("m j", positive=True)
    curved = symbols("Lambda", real=True)
    z, J = sin(theta), spin * cos(theta)
    S, f = r**2 + J**2, 1 + curved * J**2 / 3
    delta = r**2 + spin**2 - 2 * mass * r - curved * r**2 * (r**2 + spin**2) / 3
    radial, polar = sqrt(delta) / sqrt(S), sqrt(f) / sqrt(S)
    frame = Frame(
        (t, r, theta, phi),
        [
            [radial, 0, 0, radial * spin * z**2],
            [0, 1 / radial, 0, 0],
            [0, 0, 1 / polar, 0],
            [polar * z * spin, 0, 0, polar * z * (r**2 + spin**2)],
        ],
        signature=(-1, 1, 1, 1),
        parameters=(mass, spin, curved),
        domain=[delta > 0, f > 0, *box({r: (0, oo), theta: (0, pi), phi: (0, 2 * pi)})],
        name=name,
    )
    k, h = 1 / radial, polar * spin * z
    # Coefficients of e^01, e^23, n_2, n_3 in S^2 T^i, n_k = (e^0 - e^1) ^ e^k.
    even, odd = k * mass * (r**2 - J**2), 2 * k * mass * r * J
    along = (even, odd, k**2 * h * mass * r * J, -(k**2) * h * mass * r**2)
    forms: dict[int, tuple[Expr | int, ...]] = {
        0: along,
        1: along,
        2: (0, 0, -k * mass * r**2, -k * mass * r * J),
        3: (0, 0, k * mass * r * J, -k * mass * r**2),
    }
    halves = {}
    for i, (first, second, two, three) in forms.items():
        entries = {(0, 1): first, (2, 3): second, (0, 2): two, (1, 2): -two}
        entries |= {(0, 3): three, (1, 3): -three}
        halves |= {(*pair, i): x / (2 * S**2) for pair, x in entries.items() if x != 0}
    torsion = Tensor(frame, "DDU", antisymmetric(halves))
    return Space(
        name,
        story=(
            "Kerr-de Sitter space with torsion that the mass makes: it solves the equations\n"
            "of gauge theories of the Poincare group, for a family of quadratic Lagrangians."
        ),
        source="J. D. McCrea, P. Baekler, M. Guerses, Nuovo Cimento B 99 (1987) 171",
        frame=frame,
        known=(
            KnownAnswer("determinant", S * z),
            KnownAnswer("scalar_curvature", 4 * curved),
            KnownAnswer("connection_torsion", antisymmetric(halves), basis="frame"),
        ),
        motion=FirstMotion(
            (0.0, 8.0, 1.2, 0.3),
            (1.25, 0.5, 0.25, 0.5),
            parameters={"m": 1.0, "j": 0.5, "Lambda": 0.001},
        ),
        group="gravity",
        notes="Signature (-, +, +, +), G = c = 1. `space.connection` solves E = C = 0 for "
        "a (R - 2 Lambda) + b (tensor2 - 2 vector2) + w (P1 - P2 - P4) + p P6 where "
        "a + 2 b = 4 Lambda (w - p)/3.",
        connection=from_torsion(frame, torsion),
    )
