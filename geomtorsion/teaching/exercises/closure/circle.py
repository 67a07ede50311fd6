"""5.2: the Burgers vector of a circle in closed form."""

from functools import cache
from itertools import product

import sympy as sp

from geomtorsion.geometry import Frame, cartan
from geomtorsion.loops import exact_circle
from geomtorsion.teaching.exercises.authoring import (
    Domain,
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    by_hand,
    scaled,
    tex,
)


def make(draw: Draw, text: Texts) -> Variant:
    """Heisenberg's frame for seed 0; other seeds: torsion that varies with position."""
    x, y, z = q = sp.symbols("x y z", real=True)
    radius = sp.Symbol("R", positive=True)
    varying = product((-2, -1, 1, 2), (0, 1, -1), (1, 2, 3, -1), (2, 3))
    factor, across, centre, power = draw.choice(((-1, 0, 0, 1), *varying))
    frame = Frame(q, [[1, 0, 0], [0, 1, 0], [across * y, factor * x**power, 1]], name="a frame")
    domain = Domain((radius,))

    @cache
    def vector() -> tuple[sp.Expr, ...]:
        return tuple(sp.expand(x) for x in exact_circle(frame, (centre, 0, 0), radius))

    def from_centre() -> list[sp.Expr]:
        torsion, here = cartan(frame).torsion.T.in_frame(), {x: centre, y: 0, z: 0}
        return [torsion[0, 1, k].subs(here) * sp.pi * radius**2 for k in range(3)]

    return Variant(
        statement=text("statement", forms=tex.forms(frame), centre=centre),
        questions=(
            Question(
                name="burgers",
                kind="components",
                prompt=text("burgers.prompt"),
                domain=domain,
                answer=vector,
                errors=lambda: [
                    Mistake("direction", scaled(vector(), -1)),
                    Mistake("factor", scaled(vector(), sp.Rational(1, 2))),
                    Mistake("forgotten", from_centre(), text("burgers.forgotten")),
                ],
                shape=(3,),
                label="b",
                points=2,
            ),
        ),
        hints=text.all("hints", torsion=tex.tex(cartan(frame).torsion.T.in_frame()[0, 1, 2])),
        worked=lambda: _worked(text, frame, centre, radius),
    )


def _worked(text: Texts, frame: Frame, centre: int, radius: sp.Symbol) -> tuple[Step, ...]:
    """The flux of the one curl through the disk, in polar coordinates."""
    x = frame.coordinates[0]
    rho, alpha = sp.symbols("rho alpha", positive=True)
    density = by_hand.curls(frame)[0, 1, 2]
    inner = sp.expand(density.subs(x, centre + rho * sp.cos(alpha)) * rho)
    ring = sp.integrate(inner, (alpha, 0, 2 * sp.pi))
    flux = sp.expand(sp.integrate(ring, (rho, 0, radius)))
    return (
        Step(text("worked.1", differentials=by_hand.differentials(frame))),
        Step(
            text(
                "worked.2",
                x=(f"{centre} + " if centre else "") + r"\rho\cos\alpha",
                ring=tex.tex(ring),
            )
        ),
        Step(text("worked.3", flux=tex.tex(flux)), "burgers", {(2,): flux}),
    )
