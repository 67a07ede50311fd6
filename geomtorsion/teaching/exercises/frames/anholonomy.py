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
            f"Given are, in the coordinates ${tex.symbols(frame)}$, the one-forms"
            f"\n\n$${tex.forms(frame)}.$$\n\n"
            "They are not all closed. How much each fails to be is written in the frame itself:"
            "\n\n"
            r"$$\mathrm{d}e^k = \tfrac{1}{2}\,C_{ij}{}^k\,e^i\wedge e^j,\qquad "
            r"C_{ij}{}^k = -C_{ji}{}^k.$$"
        ),
        questions=(
            Question(
                name="anholonomy",
                kind="components",
                prompt=r"All components $C_{ij}{}^k$ that do not vanish, those with $i<j$ at "
                "least, indices in the frame, in the order $i, j, k$.",
                domain=Domain.of(frame),
                answer=lambda: frame.anholonomy,
                errors=lambda: [
                    Mistake(
                        "sign",
                        -frame.anholonomy,
                        "The sign is wrong: these are the structure constants of the legs, "
                        "$[E_i, E_j] = -C_{ij}{}^k E_k$.",
                    ),
                    Mistake(
                        "factor",
                        frame.anholonomy / 2,
                        "That is half of it: $S$ rather than $C = 2S$. The half in "
                        "$\\tfrac12 C_{ij}{}^k e^i\\wedge e^j$ only counts each pair once.",
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
                        "That is how many are not.",
                    )
                ],
                generic=(),
                tolerance=1e-9,
            ),
        ),
        hints=steps(
            r"$\mathrm{d}(f\,\mathrm{d}x) = \partial_\mu f\,\mathrm{d}q^\mu\wedge\mathrm{d}x$.",
            r"Write each $\mathrm{d}q^\mu\wedge\mathrm{d}q^\nu$ by the forms: "
            r"$\mathrm{d}q^\mu = E_i{}^\mu e^i$.",
            r"In $\tfrac12 C_{ij}{}^k e^i\wedge e^j$ each pair occurs twice: what stands before "
            r"$e^1\wedge e^2$ is $C_{12}{}^k$.",
        ),
        worked=lambda: _worked(frame),
    )


def closed_forms(frame: Frame) -> int:
    """How many forms have no derivative."""
    return frame.dimension - len({k for _, _, k in frame.anholonomy.nonzero()})


def _worked(frame: Frame) -> tuple[Step, ...]:
    """The derivatives of the forms, written in the forms."""
    table = by_hand.anholonomy(frame)
    open_forms = {k for _, _, k in by_hand.curls(frame)}
    half = {key: value for key, value in table.items() if key[0] < key[1]}
    closed = frame.dimension - len(open_forms)
    return (
        Step(f"The derivatives that do not vanish are $${by_hand.differentials(frame)}.$$"),
        Step(f"All others vanish: {closed} of the forms are closed.", "closed", closed),
        Step(
            r"The coordinates are written by the forms, $\mathrm{d}q^\mu = E_i{}^\mu e^i$ with "
            f"$$E = {tex.matrix(by_hand.legs(frame).tolist())},$$ one leg per column."
        ),
        Step(
            r"What stands before $e^i\wedge e^j$ with $i<j$ is $C_{ij}{}^k$: "
            f"$${by_hand.listed('C', half)}.$$",
            "anholonomy",
            table,
        ),
    )
