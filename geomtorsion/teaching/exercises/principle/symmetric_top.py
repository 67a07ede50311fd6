"""6.4: the free symmetric top, seen from the body and from space."""

from itertools import permutations

import sympy as sp

from geomtorsion.action import equations_of_motion
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.principle.euler import omegas, turning


def make(draw: Draw) -> Variant:
    """Letters for seed 0; other seeds: moments as numbers."""
    w, v = sp.symbols("w v", positive=True)
    letters = sp.symbols("A C", positive=True)
    across, along = draw.choice((letters, *permutations(map(sp.Integer, range(1, 10)), 2)))
    letters = tuple(x for x in (across, along) if x.is_Symbol)
    domain = Domain((*letters, w, v))
    turns = omegas()

    def in_body() -> sp.Expr:
        first = turning(load("so3").frame, (across, across, along))[0]
        return -first.diff(turns[1]).subs(turns[2], w)

    def in_space() -> sp.Expr:
        u = sp.symbols("u1 u2 u3")
        energy = (across * (u[0] ** 2 + u[1] ** 2) + along * u[2] ** 2) / 2
        momenta = equations_of_motion(load("so3").frame, energy).momenta
        square = sp.Add(*(p**2 for p in momenta)).subs({u[0]: v, u[1]: 0, u[2]: w})
        return sp.sqrt(square) / across

    return Variant(
        statement=(
            f"A free top has the moments of inertia $I_1 = I_2 = {tex.tex(across)}$ and "
            f"$I_3 = {tex.tex(along)}$. Its initial angular velocity along the axes of the body is "
            r"$\Omega = (v, 0, w)$, with $v, w > 0$."
        ),
        questions=(
            Question(
                name="body",
                kind="expression",
                prompt=r"Seen from the **body**, the angular velocity rotates about the third "
                r"axis: $\dot\Omega_1 = -\lambda\,\Omega_2$, $\dot\Omega_2 = \lambda\,\Omega_1$. "
                r"What is $\lambda$?",
                domain=domain,
                answer=in_body,
                errors=lambda: [
                    Mistake(
                        "axes", in_space(), "That is the angular velocity of the axis in space."
                    )
                ],
            ),
            Question(
                name="space",
                kind="expression",
                prompt="Seen from **space**, the third axis of the body rotates about the angular "
                "momentum. With which angular velocity?",
                domain=domain,
                answer=in_space,
                errors=lambda: [
                    Mistake(
                        "axes",
                        in_body(),
                        "That is $\\lambda$, the angular velocity as seen from the body.",
                    ),
                    Mistake(
                        "forgotten",
                        along * w / across,
                        "That contains only the component of the angular momentum along the third "
                        "axis. Use the length of the whole vector.",
                    ),
                ],
                points=2,
            ),
        ),
        hints=steps(
            r"$\Omega_3$ is constant, so the other two of Euler's equations are linear in "
            r"$\Omega_1$ and $\Omega_2$.",
            r"In space the angular momentum $L$ is constant. Let $n$ be the unit vector along the "
            r"third axis. Then $\Omega = L/I_1 + (1 - I_3/I_1)\,\Omega_3\,n$. The second term is a "
            r"rotation about $n$, so it does not move $n$. Only the first term moves $n$.",
            r"At the start $L = (I_1 v, 0, I_3 w)$ along the axes of the body. So "
            r"$|L|^2 = I_1^2 v^2 + I_3^2 w^2$.",
        ),
        worked=lambda: _worked(across, along, w, v),
    )


def _worked(across: sp.Expr, along: sp.Expr, w: sp.Symbol, v: sp.Symbol) -> tuple[Step, ...]:
    """A linear equation in the body, a constant vector in space."""
    inside = (along - across) * w / across
    outside = sp.sqrt(across**2 * v**2 + along**2 * w**2) / across
    return (
        Step(
            r"Euler's third equation is $I_3\dot\Omega_3 = (I_1 - I_2)\,\Omega_1\Omega_2 = 0$, so "
            r"$\Omega_3 = w$ is constant."
        ),
        Step(
            r"Euler's first equation is $I_1\dot\Omega_1 = (I_1 - I_3)\,w\,\Omega_2$, that is "
            r"$\dot\Omega_1 = -\lambda\,\Omega_2$ with $\lambda = (I_3 - I_1)\,w/I_1 = "
            f"{tex.tex(inside)}$.",
            "body",
            inside,
        ),
        Step(
            r"In space $\Omega = L/I_1 + (1 - I_3/I_1)\,w\,n$, where $L$ is the constant angular "
            r"momentum and $n$ the unit vector along the third axis. A rotation about $n$ does not "
            r"move $n$, so $n$ rotates about $L$ with the angular velocity $|L|/I_1$."
        ),
        Step(
            r"With $|L| = \sqrt{I_1^2 v^2 + I_3^2 w^2}$, the angular velocity is "
            f"${tex.tex(outside)}$.",
            "space",
            outside,
        ),
    )
