"""kustaanheimo_stiefel: the map from four dimensions to three that makes Kepler an oscillator."""

from sympy import Matrix, Rational, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, diagonal


def space(name: str, title: str) -> Space:
    """Coframe 2 A(u) du with A A^T = u^2: dx, dy, dz and a fourth form that is not closed."""
    u1, u2, u3, u4 = u = symbols("u1 u2 u3 u4", real=True)
    rows = Matrix([[u3, u4, u1, u2], [u4, -u3, -u2, u1], [u1, u2, -u3, -u4], [u2, -u1, u4, -u3]])
    square = u1**2 + u2**2 + u3**2 + u4**2
    frame = Frame(u, (2 * rows).tolist(), domain=square > 0, name=name)
    fourth = rows.row(3)
    torsion = {(*pair, c): -fourth[c] / square for pair in ((0, 1), (2, 3)) for c in range(4)}
    return Space(
        name,
        title,
        story=(
            "A point in space with an angle: three forms are dx, dy, dz, the fourth is not closed.\n"
            "In pseudo-time s, dt = r ds, an orbit around the sun is an oscillation of u."
        ),
        source="P. Kustaanheimo, E. Stiefel, J. reine angew. Math. 218 (1965) 204; "
        "I. H. Duru, H. Kleinert, Phys. Lett. B 84 (1979) 185",
        frame=frame,
        known=(
            KnownAnswer("metric", diagonal([4 * square] * 4)),
            KnownAnswer("torsion", antisymmetric(torsion)),
            KnownAnswer("torsion_vector", {(a,): 2 * x / square for a, x in enumerate(u)}),
            KnownAnswer("cartan_curvature", {}),
            # Conformally flat: -6 (lap phi + |grad phi|^2) exp(-2 phi), phi = log(2 |u|), n = 4.
            KnownAnswer("scalar_curvature", -Rational(9, 2) / square**2),
        ),
        motion=FirstMotion((1.0, 0.0, 0.4, 0.3), (-0.6, 0.3, -0.8, 0.0), 3.0),
        embedding=_place,
        group="mechanics",
        notes="x = 2 (u1 u3 + u2 u4), y = 2 (u1 u4 - u2 u3), z = u1^2 + u2^2 - u3^2 - u4^2, and "
        "r = u^2. A motion of the point alone has frame velocity u^4 = 0, which the autoparallels "
        "keep. At the origin u = 0 the coframe is singular; the oscillator is not.",
    )


def _place(frame: Frame) -> Embedding:
    """The point in ordinary space."""
    u1, u2, u3, u4 = u = frame.coordinates
    place = (
        2 * (u1 * u3 + u2 * u4),
        2 * (u1 * u4 - u2 * u3),
        u1**2 + u2**2 - u3**2 - u4**2,
    )
    return Embedding(u, place=place, isometric=False, title="the point in space")
