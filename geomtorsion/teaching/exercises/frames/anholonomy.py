"""1.3: the object of anholonomy, where forms are not closed."""

from geomtorsion.geometry import Frame, cartan
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
from geomtorsion.teaching.exercises.families import groups


def make(draw: Draw) -> Variant:
    """A left-invariant frame of a small group; the seed chooses group and constants."""
    frame = draw.choice(groups())
    n = frame.dimension
    return Variant(
        statement=(
            f"Consider the one-forms\n\n$${tex.forms(frame)}$$\n\nin the coordinates "
            f"${tex.symbols(frame)}$. Not all of them are closed. Their exterior derivatives, "
            "expressed in the frame, define the object of anholonomy $C_{ij}{}^k$:\n\n"
            r"$$\mathrm{d}e^k = \tfrac{1}{2}\,C_{ij}{}^k\,e^i\wedge e^j,\qquad "
            r"C_{ij}{}^k = -C_{ji}{}^k.$$"
        ),
        questions=(
            Question(
                name="anholonomy",
                kind="components",
                prompt=r"Find the nonzero components $C_{ij}{}^k$ in the frame, with the indices "
                "in the order $i, j, k$. Those with $i<j$ are enough.",
                domain=Domain.of(frame),
                answer=lambda: frame.anholonomy,
                errors=lambda: [
                    Mistake(
                        "sign",
                        -frame.anholonomy,
                        "The sign is wrong: these are $-C_{ij}{}^k$, the structure coefficients of "
                        "the legs, from $[E_i, E_j] = -C_{ij}{}^k E_k$.",
                    ),
                    Mistake(
                        "factor",
                        frame.anholonomy / 2,
                        "That is half of it: $S$ instead of $C = 2S$. The factor $\\tfrac12$ is "
                        "there because the sum $C_{ij}{}^k e^i\\wedge e^j$ contains each pair "
                        "twice.",
                    ),
                    Mistake("basis", cartan(frame).torsion.T),
                ],
                shape=(n, n, n),
                label="C",
                marks="__^",
                remarks=TORSION,
                symmetry="antisymmetric",
            ),
            Question(
                name="closed",
                kind="number",
                prompt="How many of the forms are closed?",
                answer=lambda: closed_forms(frame),
                errors=lambda: [
                    Mistake(
                        "another",
                        frame.dimension - closed_forms(frame),
                        "That is how many are not closed.",
                    )
                ],
                generic=(),
                tolerance=1e-9,
            ),
        ),
        hints=steps(
            r"$\mathrm{d}(f\,\mathrm{d}x) = \partial_\mu f\,\mathrm{d}q^\mu\wedge\mathrm{d}x$.",
            r"Express each $\mathrm{d}q^\mu\wedge\mathrm{d}q^\nu$ in the one-forms $e^i$: "
            r"$\mathrm{d}q^\mu = E_i{}^\mu e^i$.",
            r"The sum $\tfrac12 C_{ij}{}^k e^i\wedge e^j$ contains each pair twice, so the "
            r"coefficient of $e^1\wedge e^2$ is $C_{12}{}^k$.",
        ),
        worked=lambda: _worked(frame),
    )


def closed_forms(frame: Frame) -> int:
    """Number of closed forms."""
    return frame.dimension - len({k for _, _, k in frame.anholonomy.nonzero()})


def _worked(frame: Frame) -> tuple[Step, ...]:
    """The derivatives of the forms, written in the forms."""
    table = by_hand.anholonomy(frame)
    open_forms = {k for _, _, k in by_hand.curls(frame)}
    half = {key: value for key, value in table.items() if key[0] < key[1]}
    closed = frame.dimension - len(open_forms)
    return (
        Step(f"The nonzero exterior derivatives are $${by_hand.differentials(frame)}.$$"),
        Step(f"The number of closed forms is {closed}.", "closed", closed),
        Step(
            r"The differentials, expressed in the forms, are $\mathrm{d}q^\mu = E_i{}^\mu e^i$ "
            f"with $$E = {tex.matrix(by_hand.legs(frame).tolist())},$$ one leg per column."
        ),
        Step(
            r"The coefficient of $e^i\wedge e^j$ with $i<j$ is $C_{ij}{}^k$: "
            f"$${by_hand.listed('C', half)}.$$",
            "anholonomy",
            table,
        ),
    )
