"""4.3: the equations of the autoparallels in coordinates."""

import sympy as sp

from geomtorsion.geometry import Frame, cartan
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
from geomtorsion.teaching.exercises.families import circles
from geomtorsion.teaching.exercises.straightest.force import christoffel_terms, quadratic


def make(draw: Draw) -> Variant:
    """Polar legs for seed 0; other seeds: circles of other lengths."""
    frame = draw.choice(circles())
    rates = [sp.Symbol(f"{symbol}_d", real=True) for symbol in frame.coordinates]
    table = cartan(frame).coefficients

    def straight():
        return quadratic(table.nonzero(), rates, -1)

    return Variant(
        statement=(
            f"For the one-forms ${tex.forms(frame)}$, write down the equations of the "
            "autoparallels (**straightest** lines) of the Cartan connection:\n\n"
            r"$$\ddot q^c + \Gamma_{ab}{}^c\,\dot q^a\dot q^b = 0 .$$"
        ),
        questions=(
            Question(
                name="equations",
                kind="equations",
                prompt="Give two equations for `r''` and `phi''`, with `r'` and `phi'` for the "
                "velocities, separated by a semicolon. Any equivalent pair is accepted.",
                domain=Domain.of(frame, *rates),
                answer=straight,
                errors=lambda: [
                    Mistake(
                        "levi-civita",
                        scaled(christoffel_terms(frame, rates), -1),
                        "These are the equations of the geodesics (shortest lines).",
                    ),
                    Mistake(
                        "factor",
                        scaled(straight(), 2),
                        "The product $\\dot r\\dot\\phi$ occurs only once, because the Cartan "
                        "connection is not symmetric.",
                    ),
                ],
                unknowns=("r''", "phi''"),
                points=2,
            ),
        ),
        hints=steps(
            "The connection has only one nonzero component: "
            rf"$\Gamma_{{12}}{{}}^2 = {tex.tex(table[0, 1, 1])}$.",
            "On an autoparallel the frame components of the velocity are constant. Differentiate "
            r"$e^i{}_\mu\dot q^\mu$ with respect to time.",
        ),
        worked=lambda: _worked(frame, rates),
    )


def _worked(frame: Frame, rates: list[sp.Symbol]) -> tuple[Step, ...]:
    """Constant frame components, differentiated."""
    f, r = frame.coframe[1, 1], frame.coordinates[0]
    factor = by_hand.tidy(f.diff(r) / f)
    return (
        Step(
            r"On an autoparallel the frame components of the velocity are constant: $\dot r$ and "
            f"$f\\,\\dot\\phi$ with $f = {tex.tex(f)}$."
        ),
        Step(
            r"Their time derivatives vanish: $\ddot r = 0$ and "
            r"$f\,\ddot\phi + f'\,\dot r\,\dot\phi = 0$ "
            f"with $f' = {tex.tex(f.diff(r))}$."
        ),
        Step(
            rf"Divide by $f$: $\ddot\phi = -\left({tex.tex(factor)}\right)\dot r\,\dot\phi$. "
            r"The product occurs once, because $\Gamma_{12}{}^2 = f'/f$ but $\Gamma_{21}{}^2 = 0$.",
            "equations",
            [sp.S.Zero, -factor * rates[0] * rates[1]],
        ),
    )
