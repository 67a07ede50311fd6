"""4.2: the torsion force, which distinguishes autoparallels from geodesics."""

from collections.abc import Mapping

import sympy as sp

from geomtorsion.geometry import Frame, cartan
from geomtorsion.teaching.exercises.authoring import (
    TORSION,
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
from geomtorsion.teaching.exercises.families import circles, groups, mixed


def make(draw: Draw, text: Texts) -> Variant:
    """Polar legs for seed 0; other seeds: circles and groups."""
    frame = draw.choice(mixed(circles(), groups()))
    n, torsion = frame.dimension, cartan(frame).torsion
    rates = [sp.Symbol(f"{symbol}_d", real=True) for symbol in frame.coordinates]
    names = ", ".join(f"`{symbol}'`" for symbol in frame.coordinates)
    return Variant(
        statement=text("statement", forms=tex.forms(frame), coordinates=tex.symbols(frame)),
        questions=(
            Question(
                name="force",
                kind="components",
                prompt=text("force.prompt", names=names),
                domain=Domain.of(frame, *rates),
                answer=lambda: torsion.force(rates),
                errors=lambda: [
                    Mistake("factor", torsion.force(rates) / 2, text("force.factor")),
                    Mistake("basis", torsion.force(rates).in_frame()),
                    Mistake("inverse", torsion.force(rates).lowered(), text("force.inverse")),
                    Mistake(
                        "levi-civita", christoffel_terms(frame, rates), text("force.levi-civita")
                    ),
                ],
                shape=(n,),
                label="f",
                remarks=TORSION.of(text.language),
                points=2,
            ),
            Question(
                name="same",
                kind="choice",
                prompt=text("same.prompt"),
                answer=lambda: "yes" if torsion.force_coefficients.is_zero else "no",
                options=text.table("same.options"),
            ),
        ),
        hints=text.all("hints", components=_listed(torsion.S)),
        worked=lambda: _worked(text, frame, rates),
    )


def christoffel_terms(frame: Frame, rates: list[sp.Symbol]) -> dict[tuple[int, ...], sp.Expr]:
    """Gamma_bar_ab^c q'^a q'^b."""
    return quadratic(frame.quantity("christoffel").nonzero(), rates)


def quadratic(
    table: Mapping[tuple[int, ...], sp.Expr], rates: list[sp.Symbol], sign: int = 1
) -> dict[tuple[int, ...], sp.Expr]:
    """sign * t_ab^c q'^a q'^b for each c."""
    sums: dict[tuple[int, ...], sp.Expr] = {}
    for (a, b, c), value in table.items():
        sums[c,] = sums.get((c,), sp.S.Zero) + sign * value * rates[a] * rates[b]
    return sums


def _listed(tensor) -> str:
    """Components with first index below second, in LaTeX."""
    return r",\ ".join(
        rf"S_{{{a + 1}{b + 1}}}{{}}^{{{c + 1}}} = {tex.tex(value)}"
        for (a, b, c), value in tensor.nonzero().items()
        if a < b
    )


def _worked(text: Texts, frame: Frame, rates: list[sp.Symbol]) -> tuple[Step, ...]:
    """The force as the difference of two connections."""
    straight, short = by_hand.cartan_table(frame), by_hand.christoffel(frame)
    keys = {*straight, *short}
    gap = by_hand.nonzero({key: short.get(key, 0) - straight.get(key, 0) for key in keys})
    force = by_hand.nonzero(by_hand.quadratic_form(gap, rates))
    dotted = {v: sp.Symbol(f"v{k}") for k, v in enumerate(rates, 1)}
    shown = {key: value.subs(dotted) for key, value in force.items()}
    return (
        Step(
            text(
                "worked.1",
                cartan=by_hand.listed("Gamma", straight),
                levi_civita=by_hand.listed("Gamma_bar", short),
            )
        ),
        Step(text("worked.2", force=by_hand.listed("f", shown)), "force", force),
        Step(
            text("worked.3_different") if force else text("worked.3_same"),
            "same",
            "no" if force else "yes",
        ),
    )
