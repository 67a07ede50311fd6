"""5.1: the Burgers vector of a small loop."""

import sympy as sp

from geomtorsion.geometry import Frame, cartan
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    by_hand,
    scaled,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import bodies, frame_of, groups, mixed


def make(draw: Draw) -> Variant:
    """so3 and the plane of its first two legs for seed 0."""
    frame = frame_of(draw.choice(mixed(bodies(), groups())))
    area = sp.Symbol("A", positive=True)
    torsion = cartan(frame).torsion.T.in_frame()
    planes = sorted({(i, j) for i, j, _ in torsion.nonzero() if i < j})
    i, j = draw.choice(planes)

    def burgers() -> dict[tuple[int, ...], sp.Expr]:
        return {(k,): torsion[i, j, k] * area for k in range(3)}

    return Variant(
        statement=(
            f"Consider the one-forms\n\n$${tex.forms(frame)}$$\n\nin the coordinates "
            f"${tex.symbols(frame)}$. The legs $E_i$ are dual to the one-forms. A very small "
            f"loop in the plane of the legs $E_{i + 1}$ and $E_{j + 1}$ turns from the first leg "
            "towards the second. It encloses the area $A$, measured with unit length for each leg. "
            "Its closure failure is the Burgers vector "
            r"$b^k = \oint e^k{}_\mu\,\mathrm{d}q^\mu$."
        ),
        questions=(
            Question(
                name="burgers",
                kind="components",
                prompt="Find the three components $b^k$ to leading order in `A`.",
                domain=Domain((area,)),
                answer=burgers,
                errors=lambda: [
                    Mistake("direction", scaled(burgers(), -1)),
                    Mistake(
                        "factor",
                        scaled(burgers(), sp.Rational(1, 2)),
                        r"A factor 2 is missing: the sum $\mathrm{d}e^k = S_{ij}{}^k\,e^i\wedge "
                        r"e^j$ contains each pair of indices in both orders, so "
                        f"$b^k = 2S_{{{i + 1}{j + 1}}}{{}}^k A$.",
                    ),
                ],
                shape=(3,),
                label="b",
            ),
        ),
        hints=steps(
            r"Stokes' theorem: $\oint e^k = \int \mathrm{d}e^k$.",
            r"$\mathrm{d}e^k = \tfrac12\,(2S_{ij}{}^k)\,e^i\wedge e^j$, where $2S_{ij}{}^k$ is the "
            "torsion of the Cartan connection in the frame. In the plane of this loop only "
            f"$e^{{{i + 1}}}\\wedge e^{{{j + 1}}}$ counts, and its integral is the area $A$.",
        ),
        worked=lambda: _worked(frame, i, j, area),
    )


def _worked(frame: Frame, i: int, j: int, area: sp.Symbol) -> tuple[Step, ...]:
    """Stokes over a small area in the plane of two legs."""
    table = by_hand.anholonomy(frame)
    vector = [table.get((i, j, k), sp.S.Zero) * area for k in range(3)]
    pairs = {(i, j, k): table.get((i, j, k), sp.S.Zero) for k in range(3)}
    return (
        Step(
            r"By Stokes' theorem $b^k = \oint e^k = \int\mathrm{d}e^k$, and "
            f"$${by_hand.differentials(frame)}.$$"
        ),
        Step(
            f"In the plane of $E_{i + 1}$ and $E_{j + 1}$ only "
            f"$e^{{{i + 1}}}\\wedge e^{{{j + 1}}}$ counts. Its integral is the area $A$. So "
            f"$b^k = 2S_{{{i + 1}{j + 1}}}{{}}^k A$ with the torsion in the frame "
            f"$${by_hand.listed('2S', pairs)}.$$"
        ),
        Step(f"So $b = ({', '.join(map(tex.tex, vector))})$.", "burgers", vector),
    )
