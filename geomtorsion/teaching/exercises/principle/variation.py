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
    Texts,
    Variant,
    by_hand,
    normal,
    scaled,
    tex,
)
from geomtorsion.teaching.exercises.families import Body, bodies, frame_of, groups, mixed


def make(draw: Draw, text: Texts) -> Variant:
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
            Mistake("sign", scaled(right, -1), text("terms.sign")),
            Mistake("factor", scaled(right, sp.Rational(1, 2)), text("terms.factor")),
            Mistake("naive", normal(terms(frame, "naive"))),
        ]
        if isinstance(member, Body):
            mistakes.append(Mistake("axes", terms(member.space_frame)))
        return mistakes

    return Variant(
        statement=text("statement", forms=tex.forms(frame), coordinates=tex.symbols(frame)),
        questions=(
            Question(
                name="terms",
                kind="components",
                prompt=text("terms.prompt"),
                domain=Domain((*u, *images)),
                answer=lambda: terms(frame),
                errors=expected,
                shape=(3,),
                label="delta u",
                points=2,
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, frame, u, images),
    )


def _worked(
    text: Texts, frame: Frame, u: tuple[sp.Symbol, ...], images: tuple[sp.Symbol, ...]
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
        Step(text("worked.1", differentials=by_hand.differentials(frame))),
        Step(text("worked.2", components=by_hand.listed("2S", half))),
        Step(text("worked.3", terms=tex.matrix([[x.subs(shown)] for x in terms])), "terms", terms),
    )
