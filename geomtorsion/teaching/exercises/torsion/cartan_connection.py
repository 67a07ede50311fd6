"""2.2: a whole Cartan connection; for seed 0 eq. (10) of the paper."""

from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.teaching.exercises.authoring import (
    CONNECTION,
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    by_hand,
    reordered,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import bodies, frame_of, groups, matrix_of, mixed


def make(draw: Draw) -> Variant:
    """so3 for seed 0; other seeds: other angles, or another group."""
    frame = frame_of(draw.choice(mixed(bodies(), groups())))
    return Variant(
        statement=(
            f"In the coordinates ${tex.symbols(frame)}$, the coframe is"
            f"\n\n$$e = {tex.coframe(frame)}.$$\n\n"
            r"Its Cartan connection is $\Gamma_{ab}{}^c = E_i{}^c\,\partial_a e^i{}_b$."
        ),
        questions=(
            connection_question(
                frame,
                r"Find all nonzero components $\Gamma_{ab}{}^c$, with the indices in the order "
                "$a, b, c$: the direction of differentiation comes first.",
                points=2,
            ),
        ),
        hints=steps(
            r"For each coordinate $a$ the matrix of $\Gamma_{ab}{}^c$ (row $b$, column $c$) is "
            r"$(E\,\partial_a e)^T$, with the legs as columns of $E$.",
            f"The legs are $${tex.matrix(_rows(frame.legs))}.$$",
            f"The coframe depends on {_count(frame)} of the coordinates.",
        ),
        worked=lambda: _worked(frame),
    )


def connection_question(frame: Frame, prompt: str, points: int = 1) -> Question:
    """A question for all components of the Cartan connection, with its likely mistakes."""
    connection = cartan(frame)
    return Question(
        name="connection",
        kind="components",
        prompt=prompt,
        domain=Domain.of(frame),
        answer=lambda: connection.coefficients,
        errors=lambda: [
            Mistake("levi-civita", levi_civita(frame).coefficients),
            Mistake(
                "permuted",
                reordered(connection.coefficients, (1, 0, 2)),
                "In your answer the second index is the direction of differentiation. Here it is "
                "the first.",
            ),
            Mistake(
                "inverse",
                connection.coefficients.lowered(2),
                r"That is $e^i{}_c\,\partial_a e^i{}_b$, with all indices lowered. Multiply by "
                "the legs, the inverse of the coframe, not by the coframe.",
            ),
        ],
        shape=(frame.dimension,) * 3,
        label="Gamma",
        marks="__^",
        remarks=CONNECTION,
        points=points,
    )


def _rows(tensor):
    return [[tensor[i, j] for j in range(3)] for i in range(3)]


def _count(frame) -> int:
    """How many coordinates occur in the coframe."""
    return len(set().union(*(x.free_symbols for x in frame.coframe.nonzero().values())))


def _worked(frame: Frame) -> tuple[Step, ...]:
    """The legs, the derivatives of the coframe, their products."""
    table, e = by_hand.cartan_table(frame), matrix_of(frame.coframe)
    slopes = [
        f"\\partial_{k} e = {tex.matrix(e.diff(x).tolist())}"
        for k, x in enumerate(frame.coordinates, 1)
        if not e.diff(x).is_zero_matrix
    ]
    return (
        Step(
            "The legs are the columns of the inverse: "
            f"$$E = {tex.matrix(by_hand.legs(frame).tolist())}.$$"
        ),
        *(Step(f"The coframe has the derivative $${slope}.$$") for slope in slopes),
        Step(
            r"$\Gamma_{ab}{}^c$ is in row $c$ and column $b$ of $E\,\partial_a e$. The nonzero "
            rf"components are $${by_hand.listed('Gamma', table)}.$$",
            "connection",
            table,
        ),
    )
