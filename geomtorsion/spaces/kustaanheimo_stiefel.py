"""kustaanheimo_stiefel: the map from four dimensions to three that makes Kepler an oscillator."""

from sympy import Matrix, Rational, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, diagonal


def space(name: str) -> Space:
    """Coframe 2 A(q) dq with A A^T = q^2: dx, dy, dz and a fourth form that is not closed."""
    q1, q2, q3, q4 = q = symbols("q1 q2 q3 q4", real=True)
    rows = Matrix([[q3, q4, q1, q2], [q4, -q3, -q2, q1], [q1, q2, -q3, -q4], [q2, -q1, q4, -q3]])
    square = q1**2 + q2**2 + q3**2 + q4**2
    frame = Frame(q, (2 * rows).tolist(), domain=square > 0, name=name)
    fourth = rows.row(3)
    torsion = {(*pair, c): -fourth[c] / square for pair in ((0, 1), (2, 3)) for c in range(4)}
    return Space(
        name,
        story=(
            "A point and an angle: three forms are dx, dy and dz, and the fourth is not closed.\n"
            "In pseudo-time s, dt = r ds, an orbit around the sun is an oscillation of q."
        ),
        source="P. Kustaanheimo, E. Stiefel, J. reine angew. Math. 218 (1965) 204; "
        "I. H. Duru, H. Kleinert, Phys. Lett. B 84 (1979) 185",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([4 * square] * 4)),
            KnownAnswer("torsion", antisymmetric(torsion)),
            KnownAnswer("torsion_vector", {(a,): 2 * x / square for a, x in enumerate(q)}),
            KnownAnswer("cartan_curvature", {}),
            # Conformally flat: -6 (lap phi + |grad phi|^2) exp(-2 phi), phi = log(2 |q|), n = 4.
            KnownAnswer("scalar_curvature", -Rational(9, 2) / square**2),
        ),
        motion=FirstMotion((1.0, 0.0, 0.4, 0.3), (-0.6, 0.3, -0.8, 0.0), 3.0),
        embedding=_place,
        group="mechanics",
        notes="x = 2 (q1 q3 + q2 q4), y = 2 (q1 q4 - q2 q3), z = q1^2 + q2^2 - q3^2 - q4^2, and "
        "r = q^2. A motion only of the point has frame velocity u^4 = 0, which the autoparallels "
        "keep. At the origin q = 0 the coframe is singular; the oscillator is not.",
    )


def _place(frame: Frame) -> Embedding:
    """The point in ordinary space."""
    q1, q2, q3, q4 = q = frame.coordinates
    place = (
        2 * (q1 * q3 + q2 * q4),
        2 * (q1 * q4 - q2 * q3),
        q1**2 + q2**2 - q3**2 - q4**2,
    )
    axes = ("x", "y", "z")
    return Embedding(q, place=place, axes=axes, isometric=False, title="the point in space")
