"""2.2: a whole Cartan connection; for seed 0 eq. (10) of the paper."""

from geomtorsion.geometry import Frame, cartan, levi_civita
from geomtorsion.teaching.exercises.authoring import (
    CONNECTION,
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    by_hand,
    reordered,
    tex,
)
from geomtorsion.teaching.exercises.families import bodies, frame_of, groups, matrix_of, mixed


def make(draw: Draw, text: Texts) -> Variant:
    """so3 for seed 0; other seeds: other angles, or another group."""
    frame = frame_of(draw.choice(mixed(bodies(), groups())))
    return Variant(
        statement=text("statement", coordinates=tex.symbols(frame), coframe=tex.coframe(frame)),
        questions=(connection_question(text, frame, points=2),),
        hints=text.all("hints", legs=tex.matrix(_rows(frame.legs)), count=_count(frame)),
        worked=lambda: _worked(text, frame),
    )


def connection_question(text: Texts, frame: Frame, points: int = 1) -> Question:
    """A question for all components of the Cartan connection, with its likely mistakes."""
    connection, mistakes = cartan(frame), text.of("cartan_connection")
    return Question(
        name="connection",
        kind="components",
        prompt=text("connection.prompt"),
        domain=Domain.of(frame),
        answer=lambda: connection.coefficients,
        errors=lambda: [
            Mistake("levi-civita", levi_civita(frame).coefficients),
            Mistake(
                "permuted",
                reordered(connection.coefficients, (1, 0, 2)),
                mistakes("connection.permuted"),
            ),
            Mistake("inverse", connection.coefficients.lowered(2), mistakes("connection.inverse")),
        ],
        shape=(frame.dimension,) * 3,
        label="Gamma",
        marks="__^",
        remarks=CONNECTION.of(text.language),
        points=points,
    )


def _rows(tensor):
    return [[tensor[i, j] for j in range(3)] for i in range(3)]


def _count(frame) -> int:
    """How many coordinates occur in the coframe."""
    return len(set().union(*(x.free_symbols for x in frame.coframe.nonzero().values())))


def _worked(text: Texts, frame: Frame) -> tuple[Step, ...]:
    """The legs, the derivatives of the coframe, their products."""
    table, e = by_hand.cartan_table(frame), matrix_of(frame.coframe)
    slopes = [
        f"\\partial_{k} e = {tex.matrix(e.diff(x).tolist())}"
        for k, x in enumerate(frame.coordinates, 1)
        if not e.diff(x).is_zero_matrix
    ]
    return (
        Step(text("worked.1", legs=tex.matrix(by_hand.legs(frame).tolist()))),
        *(Step(text("worked.2", slope=slope)) for slope in slopes),
        Step(text("worked.3", connection=by_hand.listed("Gamma", table)), "connection", table),
    )
