"""1.4: the angular velocity of a body by its angles, eq. (6) of the paper."""

from random import Random

import sympy as sp

from geomtorsion.exercises.authoring import Domain, Mistake, Question, Variant, steps, tex
from geomtorsion.exercises.families import ANGLES, attitude, seen_from_space
from geomtorsion.geometry import Frame
from geomtorsion.spaces import load


def make(draw: Random, seed: int) -> Variant:
    """z-y-z as in the paper; the seed chooses the angles and which axes."""
    name = "so3" if seed == 0 else draw.choice(sorted(ANGLES))
    in_space = seed != 0 and draw.random() < 0.5
    body = load(name).frame
    wanted, other = body, seen_from_space(name)
    if in_space:
        wanted, other = other, body
    rates = [sp.Symbol(f"{symbol}_d", real=True) for symbol in body.coordinates]
    turns = r"\,".join(rf"R_{axis}({tex.tex(body.coordinates[k])})" for axis, k in ANGLES[name])
    axes = "space" if in_space else "body"
    said = ", ".join(f"`{symbol}'`" for symbol in body.coordinates)
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
                domain=Domain.of(body, *rates),
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
                domain=Domain.of(body),
                answer=lambda: body.determinant[()],
                errors=lambda: [
                    Mistake(
                        "inverse",
                        1 / body.determinant[()],
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
            f"Here, with all matrices: the attitude is $${tex.matrix(attitude(name).tolist())}.$$",
        ),
    )


def applied(frame: Frame, rates: list[sp.Symbol], legs: bool = False) -> list[sp.Expr]:
    """e^i_mu q'^mu, or the same with the legs in place of the coframe."""
    table = frame.legs if legs else frame.coframe
    return [sp.Add(*(table[i, mu] * rate for mu, rate in enumerate(rates))) for i in range(3)]
