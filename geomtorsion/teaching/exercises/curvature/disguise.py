"""3.5: whether a surface is a sphere, a plane or a hyperbolic plane in other coordinates."""

import sympy as sp

from geomtorsion.geometry import Frame, levi_civita
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

U, V = sp.symbols("u v", real=True)
DISC = (U**2 + V**2 < 1,)
# Length of du and of dv, the domain.
SHAPES: tuple[tuple[sp.Expr, tuple[sp.Basic, ...]], ...] = (
    (2 / (1 + U**2 + V**2), ()),
    (1 / (U**2 + V**2), (U > 0,)),
    (1 / V, (V > 0,)),
    (1 / (1 + U**2), (U > 0, U < 1)),
    (2 / (1 - U**2 - V**2), DISC),
    (sp.exp(U), ()),
    (1 / sp.cosh(U), ()),
    (1 / sp.sinh(U), (U > 0,)),
)
SIZES = (3, 2, 1, 4)


def make(draw: Draw, text: Texts) -> Variant:
    """A sphere of radius 3 in stereographic coordinates for seed 0; other seeds: other surfaces."""
    shape, domain = draw.choice(SHAPES)
    f = draw.choice(SIZES) * shape
    frame = Frame((U, V), [[f, 0], [0, f]], domain=domain)
    curvature = levi_civita(frame).curvature.scalar
    return Variant(
        statement=text("statement", forms=tex.forms(frame)),
        questions=(
            Question(
                name="scalar",
                kind="expression",
                prompt=text("scalar.prompt"),
                domain=Domain.of(frame),
                answer=lambda: curvature[()],
                errors=lambda: [
                    Mistake("cartan", 0),
                    Mistake("sign", -curvature[()]),
                    Mistake("factor", curvature[()] / 2, text("scalar.factor")),
                ],
            ),
            Question(
                name="surface",
                kind="choice",
                prompt=text("surface.prompt"),
                answer=lambda: _surface(curvature[()]),
                errors=lambda: [
                    Mistake("cartan", "plane"),
                    Mistake("sign", _surface(-curvature[()]), text("surface.sign")),
                ],
                options=text.table("surface.options"),
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, f),
    )


def _surface(scalar: sp.Expr) -> str:
    """The name of the surface with a curvature scalar."""
    if scalar.free_symbols:
        return "none"
    return "plane" if scalar == 0 else "sphere" if scalar > 0 else "hyperbolic"


def _worked(text: Texts, f: sp.Expr) -> tuple[Step, ...]:
    """Laplacian of the logarithm, the curvature and the surface."""
    laplacian = by_hand.tidy(sp.log(f).diff(U, 2) + sp.log(f).diff(V, 2))
    gauss = by_hand.tidy(-laplacian / f**2)
    name = _surface(gauss)
    if name in ("sphere", "hyperbolic"):
        radius = tex.tex(1 / sp.sqrt(abs(gauss)))
        ending = text("worked.3_sphere" if gauss > 0 else "worked.3_hyperbolic", radius=radius)
    else:
        ending = text("worked.3_plane" if name == "plane" else "worked.3_none")
    return (
        Step(text("worked.1", f=tex.tex(f), laplacian=tex.tex(laplacian))),
        Step(
            text("worked.2", gauss=tex.tex(gauss), scalar=tex.tex(2 * gauss)), "scalar", 2 * gauss
        ),
        Step(ending, "surface", name),
    )
