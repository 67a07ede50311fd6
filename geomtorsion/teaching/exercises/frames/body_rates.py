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
    asked_frame, other_frame = body.frame, body.space_frame
    if in_space:
        asked_frame, other_frame = other_frame, asked_frame
    rates = [sp.Symbol(f"{symbol}_d", real=True) for symbol in body.angles]
    turns = r"\,".join(rf"R_{axis}({tex.tex(n * angle)})" for axis, angle, n in body.turns)
    axes, confused = ("space", "body") if in_space else ("body", "space")
    names = ", ".join(f"`{symbol}'`" for symbol in body.angles)
    return Variant(
        statement=(
            f"The rotation matrix $R = {turns}$ is the attitude of a body: it maps body components "
            r"to space components. $R_a(\alpha)$ is the right-handed rotation by $\alpha$ about "
            r"axis $a$. The angular velocity is $\Omega = (R^T\dot R)^\vee$ along the body axes "
            r"and $\omega = (\dot R\,R^T)^\vee$ along the space axes, where $\vee$ maps an "
            r"antisymmetric matrix to its vector, $A^\vee = (A_{32}, A_{13}, A_{21})$."
        ),
        questions=(
            Question(
                name="rates",
                kind="components",
                prompt="Find the three components of the angular velocity along the "
                f"**{axes}** axes, linear in the rates {names} of the angles.",
                domain=Domain.of(body.frame, *rates),
                answer=lambda: applied(asked_frame, rates),
                errors=lambda: [
                    Mistake(
                        "axes",
                        applied(other_frame, rates),
                        f"These are components along the {confused} axes. The question is about "
                        f"the {axes} axes.",
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
                prompt=r"Find $\det e$, the determinant of the coefficients of the rates, with "
                f"the angles in the order ${tex.symbols(body.frame)}$. It vanishes where the "
                "angular velocity does not determine the rates (gimbal lock).",
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
            "Each angle rotates the body about one axis. The angular velocities of successive "
            "rotations add, if all have components along the same axes.",
            "Along the body axes: the last factor on the right rotates about its own axis. The "
            "axis of a factor further left is multiplied by the transposed rotations to its right.",
            f"Multiplied out, the attitude is $${tex.matrix(body.rotation().tolist())}.$$",
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
            f"${formula}$ is antisymmetric. Let $v_k$ be the rate of the $k$-th angle in the order "
            f"${tex.symbols(body.frame)}$. The components 32, 13 and 21 give "
            f"$${letter} = {tex.matrix([[x] for x in shown])}.$$",
            "rates",
            omega,
        ),
        Step(
            "The angular velocity determines the rates unless their coefficients have the "
            "determinant zero: "
            f"$\\det e = {tex.tex(lock)}$.",
            "lock",
            lock,
        ),
    )
