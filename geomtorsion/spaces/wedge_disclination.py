"""wedge_disclination: a wedge of angle 2 pi (1 - alpha) cut out and the faces joined: a cone."""

from sympy import Symbol, cos, oo, pi, sin, symbols

from geomtorsion.geometry import Frame
from geomtorsion.spaces.embedding import Embedding
from geomtorsion.spaces.space import FirstMotion, KnownAnswer, Space, antisymmetric, box, diagonal

SOURCE = "M. O. Katanaev, Geometric theory of defects, Phys. Usp. 48 (2005) 675"


def space(name: str) -> Space:
    """d(r cos(alpha phi)), d(r sin(alpha phi)), dz; or the same legs turned back to be periodic."""
    r, phi, z = symbols("r phi z", real=True)
    alpha = Symbol("alpha", positive=True)
    closed = name == "wedge_disclination"
    angle = alpha * phi if closed else phi
    c, s = cos(angle), sin(angle)
    frame = Frame(
        (r, phi, z),
        [[c, -alpha * r * s, 0], [s, alpha * r * c, 0], [0, 0, 1]],
        parameters=(alpha,),
        # Where the legs do not come back, phi counts the turns: it has no end.
        domain=box({r: (0, oo)} if closed else {r: (0, oo), phi: (0, 2 * pi)}),
        name=name,
    )
    shared = (
        KnownAnswer("metric", diagonal([1, alpha**2 * r**2, 1])),
        KnownAnswer("determinant", alpha * r),
        KnownAnswer("cartan_curvature", {}),
        KnownAnswer("riemann", {}),
    )
    if closed:
        return Space(
            name,
            story=(
                "Cut out a wedge and glue: a cone, flat except for its tip, a cosmic string.\n"
                "The lattice has neither torsion nor curvature but comes back turned by 2 pi alpha."
            ),
            source=SOURCE,
            frame=frame,
            known=(*shared, KnownAnswer("torsion", {})),
            embedding=_embedding,
            motion=FirstMotion(
                (1.66, 4.57, -1.07), (0.802, 0.535, 0.267), parameters={"alpha": 0.48}
            ),
            group="defects in crystals",
            notes="The coframe is multivalued: after phi -> phi + 2 pi it is turned by "
            "2 pi alpha, so loops around the axis have no Burgers vector free of a base point.",
        )
    excess = (1 - alpha) / (alpha * r)
    return Space(
        name,
        story=(
            "The cone of the wedge disclination with legs that come back to themselves.\n"
            "The price is torsion: the disclination appears as a cloud of dislocations about it."
        ),
        source=SOURCE,
        frame=frame,
        known=(
            *shared,
            KnownAnswer(
                "torsion",
                antisymmetric({(0, 1, 0): excess * s / 2, (0, 1, 1): -excess * c / 2}),
                basis="frame",
            ),
            KnownAnswer("torsion_axial", {}),
            KnownAnswer("torsion_scalar", 0),
        ),
        embedding=_embedding,
        group="defects in crystals",
        notes="Single-valued; singular on the axis only.",
    )


def _embedding(frame: Frame) -> Embedding:
    """As if nothing were cut out or put in: angles are right, circles are too long or too short."""
    r, phi, z = frame.coordinates
    return Embedding(
        frame.coordinates,
        place=(r * cos(phi), r * sin(phi), z),
        axes=("x", "y", "z"),
        isometric=False,
        title="r, φ, z drawn as in flat space",
    )
