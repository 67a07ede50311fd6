"""5.4: loops around a dislocation, once and several times."""

from functools import cache

import sympy as sp

from geomtorsion.loops import Loop, exact_burgers_vector
from geomtorsion.spaces import load
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    scaled,
    steps,
    tex,
)


def make(draw: Draw) -> Variant:
    """A screw along z; the seed chooses how often the loop winds around it, and in which sense."""
    frame = load("screw_dislocation").frame
    b = frame.parameters[0]
    turns = draw.choice((2, -3, 3, -1, 1, -2, 4, -4))
    radius = draw.choice((1, 2, 3, 4))
    away = radius + draw.choice((1, 2))
    around = Loop.circle([0, 0, 0], radius, plane=(0, 1))
    winding = around.times(turns)
    next_to_it = Loop.circle([away, 0, 0], sp.Rational(radius, 2), plane=(0, 1))

    @cache
    def vector(loop: Loop) -> dict[tuple[int, ...], sp.Expr]:
        components = exact_burgers_vector(frame, loop).vector
        return {(k,): value for k, value in enumerate(components)}

    return Variant(
        statement=(
            "A crystal has a screw dislocation along the $z$ axis. Its coframe is\n\n"
            r"$$e^1 = \mathrm{d}x,\quad e^2 = \mathrm{d}y,\quad e^3 = \mathrm{d}z + "
            r"\frac{b}{2\pi}\,\frac{x\,\mathrm{d}y - y\,\mathrm{d}x}{x^2+y^2}.$$"
            "\n\nHere $b$ is a constant. The torsion vanishes everywhere except on the axis."
        ),
        questions=(
            Question(
                name="around",
                kind="components",
                prompt=f"Find the Burgers vector of a circle of radius ${radius}$ in the plane "
                f"$z = 0$ with its centre on the axis, traversed {_turning(turns)}.",
                domain=Domain((b,)),
                answer=lambda: vector(winding),
                errors=lambda: [
                    Mistake("direction", scaled(vector(winding), -1)),
                    Mistake(
                        "forgotten",
                        scaled(vector(around), 1 if turns > 0 else -1),
                        "How many times does the loop wind around the axis?",
                    ),
                    Mistake(
                        "forgotten",
                        {},
                        "The torsion vanishes on the loop. But the loop encloses the axis, where "
                        "the torsion does not vanish.",
                    ),
                ],
                shape=(3,),
                label="b",
            ),
            Question(
                name="beside",
                kind="components",
                prompt="Find the Burgers vector of a circle of half that radius in the same plane, "
                f"with the centre $({away}, 0, 0)$, traversed once.",
                domain=Domain((b,)),
                answer=lambda: vector(next_to_it),
                errors=lambda: [
                    Mistake(
                        "another",
                        vector(around),
                        "That is the Burgers vector of a circle around the axis. Does this circle "
                        "enclose the axis?",
                    )
                ],
                shape=(3,),
                label="b",
            ),
        ),
        hints=steps(
            r"Use the polar angle $\phi$ around the axis: "
            r"$x\,\mathrm{d}y - y\,\mathrm{d}x = (x^2+y^2)\,\mathrm{d}\phi$.",
            r"So $e^3 = \mathrm{d}(z + b\phi/2\pi)$. By how much does $\phi$ change along the "
            "loop?",
        ),
        worked=lambda: _worked(turns, b),
    )


def _turning(turns: int) -> str:
    """How often and in which sense the loop winds around the axis."""
    times = "once" if abs(turns) == 1 else f"{abs(turns)} times"
    return f"{times} from " + ("$x$ towards $y$" if turns > 0 else "$y$ towards $x$")


def _worked(turns: int, b: sp.Symbol) -> tuple[Step, ...]:
    """A closed form whose integral counts turns."""
    return (
        Step(
            r"With $x = \rho\cos\phi$ and $y = \rho\sin\phi$ the last form is "
            r"$e^3 = \mathrm{d}z + \frac{b}{2\pi}\,\mathrm{d}\phi$. So "
            r"$\mathrm{d}e^3 = 0$ except on the axis, but $\phi$ changes by $2\pi$ on each turn "
            r"around the axis."
        ),
        Step(
            f"The loop winds around the axis {_turning(turns)}: "
            rf"$\phi$ changes by ${2 * turns}\,\pi$ and $z$ does not change, so $b^3 = "
            f"{tex.tex(turns * b)}$.",
            "around",
            {(2,): turns * b},
        ),
        Step(
            r"The other circle does not enclose the axis: $\phi$ returns to its initial value, and "
            "the Burgers vector vanishes.",
            "beside",
            {},
        ),
    )
