"""3.1: which connection is flat, and which has torsion."""

from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import (
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    by_hand,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import (
    bodies,
    circles,
    frame_of,
    groups,
    matrix_of,
    mixed,
)

ZERO = {"zero": "it vanishes", "not zero": "it does not vanish"}
SPACES = ("flat_spherical", "s3")


def make(draw: Draw) -> Variant:
    """so3 for seed 0; other seeds: spheres, groups, flat space, circles."""
    shipped = [load(name).frame for name in SPACES]
    frame = frame_of(draw.choice(mixed(bodies(), circles(), groups(), shipped)))
    straight, short = cartan(frame), levi_civita(frame)
    return Variant(
        statement=(
            f"Two connections belong to the one-forms\n\n$${tex.forms(frame)}$$\n\n"
            f"in the coordinates ${tex.symbols(frame)}$: the Cartan connection, in which the legs "
            "are parallel, and the Levi-Civita connection of the metric in which the legs are "
            "orthonormal."
        ),
        questions=(
            _question(
                "cartan",
                "Does the curvature of the **Cartan** connection vanish?",
                lambda: straight.curvature.is_zero,
                lambda: short.curvature.is_zero,
                "levi-civita",
            ),
            _question(
                "riemann",
                "Does the curvature of the **Levi-Civita** connection vanish?",
                lambda: short.curvature.is_zero,
                lambda: straight.curvature.is_zero,
                "cartan",
            ),
            _question(
                "torsion",
                "Does the torsion of the **Cartan** connection vanish?",
                lambda: straight.torsion.S.is_zero,
                lambda: short.torsion.S.is_zero,
                "levi-civita",
            ),
        ),
        hints=steps(
            "If there is curvature, a vector that is parallel transported around a loop returns "
            "rotated.",
            "Does a connection have a basis of vector fields that are parallel everywhere? Then "
            "every vector returns unchanged.",
            "Is the metric a metric of flat space in curvilinear coordinates?",
        ),
        worked=lambda: _worked(frame),
    )


def _question(name, prompt, answer, other, code) -> Question:
    """Zero or not, with the answer for the other connection as the mistake."""
    key = {True: "zero", False: "not zero"}
    return Question(
        name=name,
        kind="choice",
        prompt=prompt,
        answer=lambda: key[answer()],
        errors=lambda: [Mistake(code, key[other()])],
        options=ZERO,
    )


def _worked(frame: Frame) -> tuple[Step, ...]:
    """Parallel legs; the metric; closed forms."""
    flat, twisted = by_hand.is_flat(frame), bool(by_hand.curls(frame))
    e = matrix_of(frame.coframe)
    metric = (e.T * e).applyfunc(by_hand.tidy).tolist()
    sentence = f"Not all forms are closed: $${by_hand.differentials(frame)}.$$"
    return (
        Step(
            "The legs are parallel everywhere, so every vector that is transported around a loop "
            "returns unchanged: the curvature of the Cartan connection vanishes.",
            "cartan",
            "zero",
        ),
        Step(
            f"The metric is $$g = {tex.matrix(metric)}.$$ Its Ricci tensor, computed from the "
            f"Christoffel symbols, {'vanishes. ' if flat else 'does not vanish: '}"
            + (
                "In at most three dimensions the whole curvature then vanishes."
                if flat
                else "the metric is curved."
            ),
            "riemann",
            "zero" if flat else "not zero",
        ),
        Step(
            (sentence if twisted else "All forms are closed. ")
            + r" Since $\mathrm{d}e^k = S_{ij}{}^k\,e^i\wedge e^j$, the torsion "
            + ("does not vanish." if twisted else "vanishes."),
            "torsion",
            "not zero" if twisted else "zero",
        ),
    )
