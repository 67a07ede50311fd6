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
    Variant,
    by_hand,
    scaled,
    steps,
    tex,
)


def make(draw: Draw) -> Variant:
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
        statement=(
            f"Consider the one-forms\n\n$${tex.forms(frame)}.$$\n\nA circle of radius $R$ about "
            f"$(x, y, z) = ({centre}, 0, 0)$ in the coordinate plane $x, y$ is traversed once, "
            "from $x$ towards $y$."
        ),
        questions=(
            Question(
                name="burgers",
                kind="components",
                prompt=r"Find its Burgers vector $b^k = \oint e^k{}_\mu\,\mathrm{d}q^\mu$ exactly, "
                "with `R` for the radius.",
                domain=domain,
                answer=vector,
                errors=lambda: [
                    Mistake("direction", scaled(vector(), -1)),
                    Mistake("factor", scaled(vector(), sp.Rational(1, 2))),
                    Mistake(
                        "forgotten",
                        from_centre(),
                        "That is the torsion at the centre times the area. But the torsion varies "
                        "over the disk.",
                    ),
                ],
                shape=(3,),
                label="b",
                points=2,
            ),
        ),
        hints=steps(
            r"Only $\mathrm{d}e^3$ is not zero.",
            r"By Stokes' theorem $b^3 = \oint e^3$ is the integral of "
            f"${tex.tex(cartan(frame).torsion.T.in_frame()[0, 1, 2])}$ over the area of the disk.",
            r"Substitute $x = x_0 + \rho\cos\alpha$, where $x_0$ is the $x$ of the centre. Over a "
            r"full turn, odd powers of the cosine average to zero, and $\cos^2\alpha$ averages to "
            r"$\tfrac12$.",
        ),
        worked=lambda: _worked(frame, centre, radius),
    )


def _worked(frame: Frame, centre: int, radius: sp.Symbol) -> tuple[Step, ...]:
    """The flux of the one curl through the disk, in polar coordinates."""
    x = frame.coordinates[0]
    rho, alpha = sp.symbols("rho alpha", positive=True)
    density = by_hand.curls(frame)[0, 1, 2]
    inner = sp.expand(density.subs(x, centre + rho * sp.cos(alpha)) * rho)
    ring = sp.integrate(inner, (alpha, 0, 2 * sp.pi))
    flux = sp.expand(sp.integrate(ring, (rho, 0, radius)))
    return (
        Step(f"Only $\\mathrm{{d}}e^3$ is not zero: $${by_hand.differentials(frame)}.$$"),
        Step(
            f"On the disk $x = {f'{centre} + ' if centre else ''}\\rho\\cos\\alpha$. Replace "
            r"$\mathrm{d}x\wedge\mathrm{d}y$ by the area element "
            r"$\rho\,\mathrm{d}\rho\,\mathrm{d}\alpha$. The integral over $\alpha$ from $0$ to "
            f"$2\\pi$ gives ${tex.tex(ring)}$."
        ),
        Step(
            f"The integral over $\\rho$ from $0$ to $R$ gives $b^3 = {tex.tex(flux)}$. The other "
            "components vanish.",
            "burgers",
            {(2,): flux},
        ),
    )
