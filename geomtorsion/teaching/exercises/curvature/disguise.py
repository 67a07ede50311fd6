"""3.5: whether a surface is a sphere, a plane or a hyperbolic plane in other coordinates."""

import sympy as sp

from geomtorsion.geometry import Frame, levi_civita
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

SURFACES = {
    "sphere": "a part of a sphere",
    "plane": "a part of a plane",
    "hyperbolic": "a part of a hyperbolic plane",
    "none": "none of these",
}
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


def make(draw: Draw) -> Variant:
    """A sphere of radius 3 in stereographic coordinates for seed 0; other seeds: other surfaces."""
    shape, domain = draw.choice(SHAPES)
    f = draw.choice(SIZES) * shape
    frame = Frame((U, V), [[f, 0], [0, f]], domain=domain)
    curvature = levi_civita(frame).curvature.scalar
    return Variant(
        statement=(
            f"A surface has the one-forms ${tex.forms(frame)}$. Which surface is it? Coordinates "
            "may disguise it, but the curvature scalar of its Levi-Civita connection, positive "
            "for spheres, does not depend on them."
        ),
        questions=(
            Question(
                name="scalar",
                kind="expression",
                prompt="Find the curvature scalar $R$.",
                domain=Domain.of(frame),
                answer=lambda: curvature[()],
                errors=lambda: [
                    Mistake("cartan", 0),
                    Mistake("sign", -curvature[()]),
                    Mistake(
                        "factor",
                        curvature[()] / 2,
                        "That is the Gaussian curvature $K$. In two dimensions $R = 2K$.",
                    ),
                ],
            ),
            Question(
                name="surface",
                kind="choice",
                prompt="Which surface is it, near each of its points?",
                answer=lambda: _surface(curvature[()]),
                errors=lambda: [
                    Mistake("cartan", "plane"),
                    Mistake(
                        "sign",
                        _surface(-curvature[()]),
                        "A sphere has positive curvature, a hyperbolic plane negative curvature.",
                    ),
                ],
                options=SURFACES,
            ),
        ),
        hints=steps(
            r"For $f^2(\mathrm{d}u^2 + \mathrm{d}v^2)$ the Gaussian curvature is "
            r"$K = -(\partial_u^2 + \partial_v^2)\ln f / f^2$.",
            "In two dimensions $R = 2K$, and $K$ is the only invariant without derivatives.",
            "Surfaces with the same constant $K$ are the same near each point (Minding 1839).",
        ),
        worked=lambda: _worked(f),
    )


def _surface(scalar: sp.Expr) -> str:
    """The name of the surface with a curvature scalar."""
    if scalar.free_symbols:
        return "none"
    return "plane" if scalar == 0 else "sphere" if scalar > 0 else "hyperbolic"


def _worked(f: sp.Expr) -> tuple[Step, ...]:
    """Laplacian of the logarithm, the curvature and the surface."""
    laplacian = by_hand.tidy(sp.log(f).diff(U, 2) + sp.log(f).diff(V, 2))
    gauss = by_hand.tidy(-laplacian / f**2)
    name = _surface(gauss)
    if name in ("sphere", "hyperbolic"):
        radius = 1 / sp.sqrt(abs(gauss))
        ending = f"It is constant: {SURFACES[name]} with $|K| = 1/R^2$, $R = {tex.tex(radius)}$."
    else:
        ending = f"It is {'zero' if name == 'plane' else 'not constant'}: {SURFACES[name]}."
    return (
        Step(
            f"With $f = {tex.tex(f)}$ is "
            rf"$(\partial_u^2 + \partial_v^2)\ln f = {tex.tex(laplacian)}$."
        ),
        Step(
            rf"So $K = {tex.tex(gauss)}$ and $R = 2K = {tex.tex(2 * gauss)}$.",
            "scalar",
            2 * gauss,
        ),
        Step(ending, "surface", name),
    )
