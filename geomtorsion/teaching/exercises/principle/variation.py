"""6.3: what a variation does to the velocities of a frame, eq. (17) of the paper."""

import sympy as sp

from geomtorsion.action import variation
from geomtorsion.geometry import Frame
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    by_hand,
    normal,
    scaled,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import Body, bodies, frame_of, groups, mixed


def make(draw: Draw) -> Variant:
    """so3 for seed 0; other seeds: other angles and other groups."""
    member = draw.choice(mixed(bodies(), groups()))
    frame = frame_of(member)
    images = sp.symbols("dPhi1 dPhi2 dPhi3", real=True)
    u = sp.symbols("u1 u2 u3", real=True)

    def terms(over: Frame, principle: str = "closed_in_coordinates") -> list[sp.Expr]:
        delta = variation(over, principle)
        table = dict(zip((*delta.velocities, *delta.images), (*u, *images), strict=True))
        pairs = zip(delta.changes, delta.image_rates, strict=True)
        return [(change - rate).xreplace(table) for change, rate in pairs]

    def expected() -> list[Mistake]:
        right = normal(terms(frame))
        mistakes = [
            Mistake(
                "sign",
                scaled(right, -1),
                "The sign is wrong: $u$ and $\\delta\\Phi$ have been exchanged.",
            ),
            Mistake(
                "factor", scaled(right, sp.Rational(1, 2)), "The factor 2 before $S$ is missing."
            ),
            Mistake("naive", normal(terms(frame, "naive"))),
        ]
        if isinstance(member, Body):
            mistakes.append(Mistake("axes", terms(member.space_frame)))
        return mistakes

    return Variant(
        statement=(
            f"Consider the one-forms\n\n$${tex.forms(frame)}$$\n\nin the coordinates "
            f"${tex.symbols(frame)}$. "
            r"A path has the frame velocities $u^i = e^i{}_\mu\dot q^\mu$. It is varied by "
            r"$\delta q^\mu$, with the frame components $\delta\Phi^i = e^i{}_\mu\,\delta q^\mu$. "
            r"Because some $\mathrm{d}e^i$ are not zero, the variation $\bar\delta u^i$ of the "
            r"frame velocities has a second term, with the torsion $2S_{kj}{}^i$ in the frame:"
            "\n\n"
            r"$$\bar\delta u^i = \frac{\mathrm{d}}{\mathrm{d}t}\delta\Phi^i + "
            r"2S_{kj}{}^i\,u^j\,\delta\Phi^k.$$"
        ),
        questions=(
            Question(
                name="terms",
                kind="components",
                prompt=r"Find the second term, $2S_{kj}{}^i\,u^j\,\delta\Phi^k$, for $i = 1, 2, "
                r"3$. Write `dPhi1` for $\delta\Phi^1$.",
                domain=Domain((*u, *images)),
                answer=lambda: terms(frame),
                errors=expected,
                shape=(3,),
                label="delta u",
                points=2,
            ),
        ),
        hints=steps(
            r"Compute the second term in the coordinates: "
            r"$\delta(e^i{}_\mu\dot q^\mu) - \frac{\mathrm{d}}{\mathrm{d}t}(e^i{}_\mu\delta q^\mu)"
            r" = (\partial_\nu e^i{}_\mu - \partial_\mu e^i{}_\nu)\,\delta q^\nu\dot q^\mu$.",
            r"Insert $\delta q^\nu = E_k{}^\nu\,\delta\Phi^k$ and $\dot q^\mu = E_j{}^\mu\,u^j$ "
            r"with the legs $E$. The bracket becomes $2S_{kj}{}^i$. Its first index $k$ belongs to "
            r"$\delta\Phi^k$.",
        ),
        worked=lambda: _worked(frame, u, images),
    )


def _worked(
    frame: Frame, u: tuple[sp.Symbol, ...], images: tuple[sp.Symbol, ...]
) -> tuple[Step, ...]:
    """The structure constants, summed over two indices."""
    table = by_hand.anholonomy(frame)
    half = {key: value for key, value in table.items() if key[0] < key[1]}
    terms = [
        by_hand.tidy(
            sum(x * u[j] * images[k] for (k, j, m), x in table.items() if m == i) or sp.S.Zero
        )
        for i in range(3)
    ]
    shown = {d: sp.Symbol(f"Phi{k}") for k, d in enumerate(images, 1)}
    return (
        Step(f"The derivatives of the forms are $${by_hand.differentials(frame)}.$$"),
        Step(
            r"In the frame, $\mathrm{d}e^i = \tfrac12\,2S_{kj}{}^i\,e^k\wedge e^j$ with "
            f"$${by_hand.listed('2S', half)}.$$ Exchanging the lower indices changes the sign."
        ),
        Step(
            r"Sum over $k$ and $j$. With the short notation $\Phi_k$ for $\delta\Phi^k$, the terms "
            r"for $i = 1, 2, 3$ are "
            f"$${tex.matrix([[x.subs(shown)] for x in terms])}.$$",
            "terms",
            terms,
        ),
    )
