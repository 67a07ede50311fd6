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
    Texts,
    Variant,
    tex,
)

# The circumference of a circle over 2 pi.
SURFACES = {"hyperbolic": sp.sinh, "sphere": sp.sin, "flat": lambda r: r}


def make(draw: Draw, text: Texts) -> Variant:
    """The hyperbolic plane for seed 0; other seeds: also sphere and plane."""
    others = product((1.0, 1.2, 1.6, 2.0, 2.4), (0.2, 0.3, 0.4, 0.5), sorted(SURFACES))
    last, begin, kind = draw.choice(((3.0, 0.5, "hyperbolic"), *others))
    names, length = text.table("surfaces"), SURFACES[kind]
    r, phi = sp.symbols("r phi", real=True)
    frame = Frame(
        (r, phi),
        [[1, 0], [0, length(r)]],
        domain=(r > 0, r < (sp.pi if kind == "sphere" else 4)),
        name=kind,
    )

    @cache
    def deviation(offset: float = 1.0) -> float:
        line = geodesic(frame, [begin, 0.0], frame_velocity=[1.0, 0.0])
        solution = solve(geodesic_deviation(line, [0.0, offset]), [last], 1e-8)
        return float(solution.transported[-1, 1])

    def factor(f=length) -> float:
        return deviation() * float(f(sp.Float(begin + last)) / f(sp.Float(begin)))

    return Variant(
        statement=text(
            "statement", surface=names[kind], forms=tex.forms(frame), begin=f"{begin:g}"
        ),
        questions=(
            Question(
                name="length",
                kind="number",
                prompt=text("length.prompt", last=f"{last:g}"),
                answer=factor,
                errors=lambda: [
                    Mistake("basis", deviation(), text("length.basis", f=tex.tex(length(r)))),
                    *(
                        Mistake("another", factor(f), text("length.another", other=names[other]))
                        for other, f in SURFACES.items()
                        if other != kind
                    ),
                ],
                tolerance=5e-3,
                generic=("factor",),
            ),
            Question(
                name="twice",
                kind="number",
                prompt=text("twice.prompt"),
                answer=lambda: deviation(2.0) / deviation(),
                errors=lambda: [Mistake("another", 2 * factor(), text("twice.another"))],
                tolerance=1e-3,
                generic=(),
            ),
        ),
        hints=text.all("hints", f=tex.tex(length(r)), begin=f"{begin:g}"),
        worked=lambda: _worked(text, length, begin, last),
    )


def _worked(
    text: Texts, length: Callable[[sp.Expr], sp.Expr], begin: float, last: float
) -> tuple[Step, ...]:
    """The quotient of two circumferences."""
    r = sp.Symbol("r", real=True)
    factor = float(length(sp.Float(begin + last)) / length(sp.Float(begin)))
    return (
        Step(text("worked.1", f=tex.tex(length(r)))),
        Step(
            text("worked.2", begin=f"{begin:g}", end=f"{begin + last:g}", factor=f"{factor:.6g}"),
            "length",
            factor,
        ),
        Step(text("worked.3"), "twice", 2),
    )
