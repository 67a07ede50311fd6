"""r3xso3: rotations and translations of a rigid body, both in the body's own frame."""

from functools import partial
from itertools import permutations

from sympy import LeviCivita, Matrix, Rational, cos, diag, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.rotations import ZYZ, angle_atlas, angle_embedding
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, box, diagonal


def space(name: str) -> Space:
    """Coordinates (phi, x); coframe (dPhi, dX) with dX = R^T dx, R = Rz(phi3) Ry(phi2) Rz(phi1)."""
    phi1, phi2, phi3 = phi = symbols("phi1 phi2 phi3", real=True)
    x = symbols("x1 x2 x3", real=True)
    c1, s1, c2, s2, c3, s3 = cos(phi1), sin(phi1), cos(phi2), sin(phi2), cos(phi3), sin(phi3)
    turning = Matrix([[0, s1, -c1 * s2], [0, c1, s1 * s2], [1, 0, c2]])
    body_space = Matrix(
        [
            [c1 * c2 * c3 - s1 * s3, c1 * c2 * s3 + s1 * c3, -c1 * s2],
            [-s1 * c2 * c3 - c1 * s3, -s1 * c2 * s3 + c1 * c3, s1 * s2],
            [s2 * c3, s2 * s3, c2],
        ]
    )
    frame = Frame(
        (*phi, *x),
        diag(turning, body_space).tolist(),
        domain=box({phi1: (0, 2 * pi), phi2: (0, pi), phi3: (0, 2 * pi)}),
        name=name,
    )
    half = Rational(1, 2)
    turns = {(0, 1, 2): -half, (1, 2, 0): -half, (2, 0, 1): -half}
    # A velocity rotates with the body: [J_k, P_j] = eps_kji P_i.
    carries = {(k, 3 + j, 3 + i): -half * LeviCivita(k, j, i) for k, j, i in permutations(range(3))}
    return Space(
        name,
        story=(
            "A free rigid body: angular velocity and velocity, both read off in the body.\n"
            "Autoparallels are screws, geodesics are flights: here the torsion force is real."
        ),
        source="P. Fiziev, H. Kleinert, FUB-HEP/94-5 (1994), sections 3 and 4, eq. (21), "
        "with the order (phi, x)",
        frame=frame,
        known=(
            KnownAnswer("determinant", s2),
            KnownAnswer("torsion", antisymmetric(turns | carries), basis="frame"),
            KnownAnswer("torsion_vector", {}),
            KnownAnswer("torsion_scalar", -3 * half),
            KnownAnswer("cartan_curvature", {}),
            KnownAnswer("ricci", diagonal([half, half, half, 0, 0, 0]), basis="frame"),
            KnownAnswer("scalar_curvature", 3 * half),
            KnownAnswer("kretschmann", 3 * half**2),
        ),
        atlas=partial(angle_atlas, ZYZ),
        embedding=partial(angle_embedding, ZYZ),
        motion=FirstMotion((0.4, 1.0, 0.5, 0.0, 0.0, 0.0), (0.0, 0.6, 2.0, 0.8, 0.2, 0.8), 10.0),
        group="rotations",
        notes="Coordinates run (phi, x), not (x, phi) as the list below eq. (21) of the paper has.",
    )
