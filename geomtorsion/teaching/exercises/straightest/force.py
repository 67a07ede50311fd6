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
    Variant,
    by_hand,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import circles, groups, mixed


def make(draw: Draw) -> Variant:
    """Polar legs for seed 0; other seeds: circles and groups."""
    frame = draw.choice(mixed(circles(), groups()))
    n, torsion = frame.dimension, cartan(frame).torsion
    rates = [sp.Symbol(f"{symbol}_d", real=True) for symbol in frame.coordinates]
    names = ", ".join(f"`{symbol}'`" for symbol in frame.coordinates)
    return Variant(
        statement=(
            f"Consider the one-forms\n\n$${tex.forms(frame)}$$\n\nin the coordinates "
            f"${tex.symbols(frame)}$. Let $S$ be the torsion of their Cartan connection (with the "
            r"factor $\tfrac12$). An autoparallel obeys"
            "\n\n"
            r"$$\ddot q^c + \bar\Gamma_{ab}{}^c\,\dot q^a\dot q^b = f^c,\qquad "
            r"f^c = 2\,S_a{}^c{}_b\,\dot q^a\dot q^b,$$"
            "\n\nwhere "
            r"$\bar\Gamma$ is the Levi-Civita connection. The torsion force $f$ bends the "
            "autoparallel (straightest line) away from the geodesic (shortest line)."
        ),
        questions=(
            Question(
                name="force",
                kind="components",
                prompt=f"Find the components $f^c$ in coordinates, with the velocities {names}.",
                domain=Domain.of(frame, *rates),
                answer=lambda: torsion.force(rates),
                errors=lambda: [
                    Mistake(
                        "factor", torsion.force(rates) / 2, "The factor 2 before $S$ is missing."
                    ),
                    Mistake("basis", torsion.force(rates).in_frame()),
                    Mistake(
                        "inverse",
                        torsion.force(rates).lowered(),
                        "That is $f_c$. Raise its index with the inverse metric.",
                    ),
                    Mistake(
                        "levi-civita",
                        christoffel_terms(frame, rates),
                        r"That is $\bar\Gamma_{ab}{}^c\dot q^a\dot q^b$, the term in the equation "
                        "of geodesics, not the force.",
                    ),
                ],
                shape=(n,),
                label="f",
                remarks=TORSION,
                points=2,
            ),
            Question(
                name="same",
                kind="choice",
                prompt="Are the autoparallels and the geodesics the same curves here?",
                answer=lambda: "yes" if torsion.force_coefficients.is_zero else "no",
                options={"yes": "for every velocity", "no": "not for every velocity"},
            ),
        ),
        hints=steps(
            r"In $S_a{}^c{}_b$ the middle index is raised: "
            r"$S_a{}^c{}_b = g^{cd}S_{ad}{}^e g_{eb}$.",
            "If $S_{abc}$ is totally antisymmetric, the force vanishes. Is it so here?",
            f"The torsion has the components ${_listed(torsion.S)}$.",
        ),
        worked=lambda: _worked(frame, rates),
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


def _worked(frame: Frame, rates: list[sp.Symbol]) -> tuple[Step, ...]:
    """The force as the difference of two connections."""
    straight, short = by_hand.cartan_table(frame), by_hand.christoffel(frame)
    keys = {*straight, *short}
    gap = by_hand.nonzero({key: short.get(key, 0) - straight.get(key, 0) for key in keys})
    force = by_hand.nonzero(by_hand.quadratic_form(gap, rates))
    dotted = {v: sp.Symbol(f"v{k}") for k, v in enumerate(rates, 1)}
    shown = {key: value.subs(dotted) for key, value in force.items()}
    return (
        Step(
            "The Cartan connection has the components "
            f"$${by_hand.listed('Gamma', straight)},$$ the Levi-Civita connection "
            f"$${by_hand.listed('Gamma_bar', short)}.$$"
        ),
        Step(
            r"On an autoparallel $\ddot q^c = -\Gamma_{ab}{}^c\dot q^a\dot q^b$, so "
            r"$f^c = (\bar\Gamma_{ab}{}^c - \Gamma_{ab}{}^c)\,\dot q^a\dot q^b$, which is "
            r"$2\,S_a{}^c{}_b\,\dot q^a\dot q^b$. With $v_k$ for the velocity of coordinate "
            f"$k$: $${by_hand.listed('f', shown)}.$$ All other components vanish.",
            "force",
            force,
        ),
        Step(
            "The force is not zero, so the autoparallels and the geodesics are different curves."
            if force
            else "The force is zero for every velocity, so the curves are the same.",
            "same",
            "no" if force else "yes",
        ),
    )
