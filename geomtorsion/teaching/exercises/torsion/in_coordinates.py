"""2.3: torsion in coordinates, with the half and traced."""

from geomtorsion.geometry import Frame, cartan
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import (
    TORSION,
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    by_hand,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import circles, groups, mixed


def make(draw: Draw) -> Variant:
    """Spherical legs in flat space for seed 0; other seeds: groups and circles."""
    frame = draw.choice((load("flat_spherical").frame, *mixed(circles(), groups())))
    n, torsion = frame.dimension, cartan(frame).torsion
    return Variant(
        statement=(
            f"Consider the one-forms\n\n$${tex.forms(frame)}$$\n\nin the coordinates "
            f"${tex.symbols(frame)}$. The torsion of their Cartan connection is "
            r"$S_{ab}{}^c = \tfrac12(\Gamma_{ab}{}^c - \Gamma_{ba}{}^c)$, **with** the factor "
            r"$\tfrac12$."
        ),
        questions=(
            Question(
                name="torsion",
                kind="components",
                prompt=r"Find the nonzero components $S_{ab}{}^c$ in coordinates. Those with "
                "$a<b$ are enough.",
                domain=Domain.of(frame),
                answer=lambda: torsion.S,
                errors=lambda: [
                    Mistake("factor", torsion.T, "That is $T = 2S$."),
                    Mistake("basis", torsion.S.in_frame()),
                    Mistake(
                        "levi-civita",
                        {},
                        "The Levi-Civita connection has no torsion, but the Cartan connection has.",
                    ),
                ],
                shape=(n, n, n),
                label="S",
                marks="__^",
                remarks=TORSION,
                symmetry="antisymmetric",
                points=2,
            ),
            Question(
                name="vector",
                kind="components",
                prompt=r"Find the torsion vector $v_a = 2\,S_{ab}{}^b$.",
                domain=Domain.of(frame),
                answer=lambda: torsion.vector,
                errors=lambda: [
                    Mistake("basis", torsion.vector.in_frame()),
                    Mistake(
                        "sign",
                        -torsion.vector,
                        "The sign is wrong: the trace is over the second and third index.",
                    ),
                ],
                shape=(n,),
                label="v",
                remarks=TORSION,
            ),
        ),
        hints=steps(
            r"With $\Gamma_{ab}{}^c = E_i{}^c\partial_a e^i{}_b$ the torsion is half the curl of "
            r"the forms, $S_{ab}{}^c = \tfrac12 E_i{}^c(\partial_a e^i{}_b - \partial_b e^i{}_a)$.",
            "A pair $(a, b)$ contributes only if column $b$ of the coframe depends on coordinate "
            "$a$, or column $a$ on coordinate $b$.",
            r"For each $a$, sum $2 S_{ab}{}^b$ over $b$.",
        ),
        worked=lambda: _worked(frame),
    )


def _worked(frame: Frame) -> tuple[Step, ...]:
    """The connection, its antisymmetric part, the trace."""
    table = by_hand.cartan_table(frame)
    keys = {*table, *((b, a, c) for a, b, c in table)}
    torsion = by_hand.nonzero(
        {(a, b, c): (table.get((a, b, c), 0) - table.get((b, a, c), 0)) / 2 for a, b, c in keys}
    )
    half = {key: value for key, value in torsion.items() if key[0] < key[1]}
    vector: dict[tuple[int, ...], object] = {}
    for (a, b, c), value in torsion.items():
        if b == c:
            vector[a,] = vector.get((a,), 0) + 2 * value
    vector = by_hand.nonzero(vector)
    return (
        Step(
            r"The connection $\Gamma_{ab}{}^c = E_i{}^c\,\partial_a e^i{}_b$ has the components "
            rf"$${by_hand.listed('Gamma', table)}.$$"
        ),
        Step(
            r"Half the difference of $\Gamma_{ab}{}^c$ and $\Gamma_{ba}{}^c$ is "
            f"$${by_hand.listed('S', half)}.$$ Exchanging $a$ and $b$ changes the sign.",
            "torsion",
            torsion,
        ),
        Step(
            r"The trace $v_a = 2\,S_{ab}{}^b$, summed over $b$, is "
            f"$${by_hand.listed('v', vector, 0)}.$$ All other components vanish.",
            "vector",
            vector,
        ),
    )
