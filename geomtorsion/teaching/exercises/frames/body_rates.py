"""1.4: the angular velocity of a body by its angles, eq. (6) of the paper."""

import sympy as sp

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
    tex,
)
from geomtorsion.teaching.exercises.families import SHIPPED, Body


def make(draw: Draw, text: Texts) -> Variant:
    """z-y-z as in the paper; the seed chooses the angles and the axes."""
    times = draw.choice(((1, 1, 1), (2, 1, 1), (1, 2, 1), (1, 1, 2)))
    body = Body(draw.choice(tuple(SHIPPED)), times)
    in_space = draw.choice((False, True))
    asked_frame, other_frame = body.frame, body.space_frame
    if in_space:
        asked_frame, other_frame = other_frame, asked_frame
    rates = [sp.Symbol(f"{symbol}_d", real=True) for symbol in body.angles]
    turns = r"\,".join(rf"R_{axis}({tex.tex(n * angle)})" for axis, angle, n in body.turns)
    names = ", ".join(f"`{symbol}'`" for symbol in body.angles)
    return Variant(
        statement=text("statement", turns=turns),
        questions=(
            Question(
                name="rates",
                kind="components",
                prompt=text("rates.prompt_space" if in_space else "rates.prompt_body", names=names),
                domain=Domain.of(body.frame, *rates),
                answer=lambda: applied(asked_frame, rates),
                errors=lambda: [
                    Mistake(
                        "axes",
                        applied(other_frame, rates),
                        text("rates.axes_space" if in_space else "rates.axes_body"),
                    ),
                    Mistake("inverse", applied(asked_frame, rates, legs=True)),
                ],
                shape=(3,),
                label="Omega" if not in_space else "omega",
                points=2,
            ),
            Question(
                name="lock",
                kind="expression",
                prompt=text("lock.prompt", coordinates=tex.symbols(body.frame)),
                domain=Domain.of(body.frame),
                answer=lambda: body.frame.determinant[()],
                errors=lambda: [
                    Mistake("inverse", 1 / body.frame.determinant[()], text("lock.inverse"))
                ],
            ),
        ),
        hints=text.all("hints", attitude=tex.matrix(body.rotation().tolist())),
        worked=lambda: _worked(text, body, in_space),
    )


def applied(frame: Frame, rates: list[sp.Symbol], legs: bool = False) -> list[sp.Expr]:
    """e^i_mu q'^mu, or the same sum with the legs instead of the coframe."""
    table = frame.legs if legs else frame.coframe
    return [sp.Add(*(table[i, mu] * rate for mu, rate in enumerate(rates))) for i in range(3)]


def _worked(text: Texts, body: Body, in_space: bool) -> tuple[Step, ...]:
    """The antisymmetric matrix, its vector, and the determinant of the coefficients."""
    rotation, angles = body.rotation(), body.angles
    rates = [sp.Symbol(f"{symbol}_d", real=True) for symbol in angles]
    change = sum((rotation.diff(x) * v for x, v in zip(angles, rates, strict=True)), sp.zeros(3))
    matrix = change * rotation.T if in_space else rotation.T * change
    omega = [by_hand.tidy(matrix[j, k]) for j, k in ((2, 1), (0, 2), (1, 0))]
    letter, formula = (r"\omega", r"\dot R\,R^T") if in_space else (r"\Omega", r"R^T\dot R")
    dotted = {v: sp.Symbol(f"v{k}") for k, v in enumerate(rates, 1)}
    shown = [by_hand.tidy(x).subs(dotted) for x in omega]
    coefficients = sp.Matrix(omega).jacobian(rates)
    lock = by_hand.tidy(coefficients.det())
    return (
        Step(text("worked.1", attitude=tex.matrix(rotation.tolist()))),
        Step(
            text(
                "worked.2",
                formula=formula,
                coordinates=tex.symbols(body.frame),
                letter=letter,
                velocity=tex.matrix([[x] for x in shown]),
            ),
            "rates",
            omega,
        ),
        Step(text("worked.3", lock=tex.tex(lock)), "lock", lock),
    )
