"""1.4: the angular velocity of a body by its angles, eq. (6) of the paper."""

import sympy as sp

from geomtorsion.geometry import Frame
from geomtorsion.teaching.exercises.authoring import (
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
from geomtorsion.teaching.exercises.families import SHIPPED, Body


def make(draw: Draw) -> Variant:
    """z-y-z as in the paper; the seed chooses the angles and the axes."""
    times = draw.choice(((1, 1, 1), (2, 1, 1), (1, 2, 1), (1, 1, 2)))
    body = Body(draw.choice(tuple(SHIPPED)), times)
    in_space = draw.choice((False, True))
    wanted, other = body.frame, body.space_frame
    if in_space:
        wanted, other = other, wanted
    rates = [sp.Symbol(f"{symbol}_d", real=True) for symbol in body.angles]
    turns = r"\,".join(rf"R_{axis}({tex.tex(n * angle)})" for axis, angle, n in body.turns)
    axes = "space" if in_space else "body"
    said = ", ".join(f"`{symbol}'`" for symbol in body.angles)
    return Variant(
        statement=(
            f"The attitude of a body (from body to space) is $R = {turns}$, with $R_a(\\alpha)$ "
            r"the right-handed turn by $\alpha$ about axis $a$. Its angular velocity is "
            r"$\Omega = (R^T\dot R)^\vee$ along the axes of the body, and "
            r"$\omega = (\dot R\,R^T)^\vee$ along the axes of space, where $\vee$ makes the "
            r"vector of an antisymmetric matrix, $A^\vee = (A_{32}, A_{13}, A_{21})$."
        ),
        questions=(
            Question(
                name="rates",
                kind="components",
                prompt=f"The three components of the angular velocity along the axes of the "
                f"**{axes}**, linear in the rates {said} of the angles.",
                domain=Domain.of(body.frame, *rates),
                answer=lambda: applied(wanted, rates),
                errors=lambda: [
                    Mistake(
                        "axes",
                        applied(other, rates),
                        f"These are components along the axes of the "
                        f"{'body' if in_space else 'space'}; asked are those of the {axes}.",
                    ),
                    Mistake("inverse", applied(wanted, rates, legs=True)),
                ],
                shape=(3,),
                label="Omega" if not in_space else "omega",
                points=2,
            ),
            Question(
                name="lock",
                kind="expression",
                prompt=r"The function of the angles that vanishes where the rates cannot be read "
                r"off the angular velocity (gimbal lock): $\det e$.",
                domain=Domain.of(body.frame),
                answer=lambda: body.frame.determinant[()],
                errors=lambda: [
                    Mistake(
                        "inverse",
                        1 / body.frame.determinant[()],
                        "That is the determinant of the legs.",
                    )
                ],
            ),
        ),
        hints=steps(
            "Each angle turns about one axis; angular velocities of turns one after the other add "
            "up, if all are seen from the same axes.",
            "Seen from the body, the last factor on the right turns about its own axis; each "
            "factor further left is seen through the transposed turns to its right.",
            f"Here, with all matrices: the attitude is $${tex.matrix(body.rotation().tolist())}.$$",
        ),
        worked=lambda: _worked(body, in_space),
    )


def applied(frame: Frame, rates: list[sp.Symbol], legs: bool = False) -> list[sp.Expr]:
    """e^i_mu q'^mu, or the same sum with the legs instead of the coframe."""
    table = frame.legs if legs else frame.coframe
    return [sp.Add(*(table[i, mu] * rate for mu, rate in enumerate(rates))) for i in range(3)]


def _worked(body: Body, in_space: bool) -> tuple[Step, ...]:
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
        Step(f"Multiplied out, the attitude is $$R = {tex.matrix(rotation.tolist())}.$$"),
        Step(
            f"${formula}$ is antisymmetric; from its components 32, 13 and 21, with $v_k$ for the "
            f"rate of the angle $k$ in the order ${tex.symbols(body.frame)}$, "
            f"$${letter} = {tex.matrix([[x] for x in shown])}.$$",
            "rates",
            omega,
        ),
        Step(
            "The rates can be read off unless the determinant of their coefficients vanishes: "
            f"$\\det e = {tex.tex(lock)}$.",
            "lock",
            lock,
        ),
    )
