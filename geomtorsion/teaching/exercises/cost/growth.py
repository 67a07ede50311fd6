"""7.3: how an error grows along a geodesic."""

from collections.abc import Callable
from functools import cache
from itertools import product

import sympy as sp

from geomtorsion.curves import geodesic, geodesic_deviation
from geomtorsion.geometry import Frame
from geomtorsion.ode import solve
from geomtorsion.teaching.exercises.authoring import (
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    steps,
    tex,
)

SURFACES = {
    "hyperbolic": ("the hyperbolic plane", sp.sinh),
    "sphere": ("the unit sphere", sp.sin),
    "flat": ("the plane", lambda r: r),
}


def make(draw: Draw) -> Variant:
    """The hyperbolic plane for seed 0; other seeds: also sphere and plane."""
    others = product((1.0, 1.2, 1.6, 2.0, 2.4), (0.2, 0.3, 0.4, 0.5), sorted(SURFACES))
    last, begin, kind = draw.choice(((3.0, 0.5, "hyperbolic"), *others))
    name, length = SURFACES[kind]
    r, phi = sp.symbols("r phi", real=True)
    frame = Frame(
        (r, phi),
        [[1, 0], [0, length(r)]],
        domain=(r > 0, r < (sp.pi if kind == "sphere" else 4)),
        name=name,
    )

    @cache
    def deviation(offset: float = 1.0) -> float:
        line = geodesic(frame, [begin, 0.0], frame_velocity=[1.0, 0.0])
        solution = solve(geodesic_deviation(line, [0.0, offset]), [last], 1e-8)
        return float(solution.transported[-1, 1])

    def factor(f=length) -> float:
        return deviation() * float(f(sp.Float(begin + last)) / f(sp.Float(begin)))

    return Variant(
        statement=(
            f"On {name} in polar coordinates, with ${tex.forms(frame)}$, a geodesic starts at "
            f"$r = {begin:g}$ and runs radially outwards with speed 1. A computer makes a small "
            r"error $\delta\phi$ in the initial coordinate $\phi$ and no error afterwards. So it "
            "follows a neighbouring geodesic, which also comes from the origin."
        ),
        questions=(
            Question(
                name="length",
                kind="number",
                prompt="Measure the error as the **distance** between the two geodesics at the "
                "same "
                f"$t$. By which factor has it grown at $t = {last:g}$?",
                answer=factor,
                errors=lambda: [
                    Mistake(
                        "basis",
                        deviation(),
                        r"That is the factor for the coordinate error $\delta\phi$, which is "
                        f"constant. The distance is ${tex.tex(length(r))}\\,\\delta\\phi$.",
                    ),
                    *(
                        Mistake("another", factor(f), f"That is the factor on {other}.")
                        for other, f in SURFACES.values()
                        if other != name
                    ),
                ],
                tolerance=5e-3,
                generic=("factor",),
            ),
            Question(
                name="twice",
                kind="number",
                prompt="Compare two such errors. At the start the first is twice as large as the "
                "second. How many times as large as the second is it at the end?",
                answer=lambda: deviation(2.0) / deviation(),
                errors=lambda: [
                    Mistake(
                        "another",
                        2 * factor(),
                        "Both errors grow by the same factor, which cancels in the ratio.",
                    )
                ],
                tolerance=1e-3,
                generic=(),
            ),
        ),
        hints=steps(
            r"The neighbouring geodesic is another ray from the origin: $\delta\phi$ is constant.",
            r"Between points with the same $r$ the one-form $e^2$ gives the distance "
            f"${tex.tex(length(r))}\\,\\delta\\phi$. Here $r = {begin:g} + t$.",
            "The error grows like $e^t$ in the hyperbolic plane and like $t$ in the plane, and it "
            "is bounded on a sphere. Motions with exponential growth are expensive to compute.",
        ),
        worked=lambda: _worked(length, begin, last),
    )


def _worked(length: Callable[[sp.Expr], sp.Expr], begin: float, last: float) -> tuple[Step, ...]:
    """The quotient of two circumferences."""
    r = sp.Symbol("r", real=True)
    factor = float(length(sp.Float(begin + last)) / length(sp.Float(begin)))
    return (
        Step(
            r"The neighbouring geodesic is another ray from the origin: $\delta\phi$ is constant, "
            f"and the distance is $f(r)\\,\\delta\\phi$ with $f = {tex.tex(length(r))}$."
        ),
        Step(
            f"The geodesic runs from $r = {begin:g}$ to $r = {begin + last:g}$: the error grows by "
            f"the factor $f({begin + last:g})/f({begin:g}) = {factor:.6g}$.",
            "length",
            factor,
        ),
        Step(
            "The deviation obeys a linear equation, so an error that is twice as large stays twice "
            "as large.",
            "twice",
            2,
        ),
    )
