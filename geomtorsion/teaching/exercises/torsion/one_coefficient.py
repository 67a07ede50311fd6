"""2.1: the one coefficient of the Cartan connection of circles."""

from geomtorsion.geometry import Frame
from geomtorsion.teaching.exercises.authoring import (
    Draw,
    Step,
    Variant,
    by_hand,
    steps,
    tex,
)
from geomtorsion.teaching.exercises.families import circles
from geomtorsion.teaching.exercises.torsion.cartan_connection import connection_question


def make(draw: Draw) -> Variant:
    """Polar legs for seed 0; other seeds: circles of other lengths."""
    frame = draw.choice(circles())
    return Variant(
        statement=(
            f"In the coordinates ${tex.symbols(frame)}$ let ${tex.forms(frame)}$. "
            "In the Cartan connection the legs are parallel:\n\n"
            r"$$\Gamma_{ab}{}^c = E_i{}^c\,\partial_a e^i{}_b,$$"
            "\n\nwhere the **first** lower index is the direction of differentiation."
        ),
        questions=(
            connection_question(
                frame,
                r"Find the nonzero component $\Gamma_{ab}{}^c$ (there is only one), with the "
                "indices in the order $a, b, c$.",
            ),
        ),
        hints=steps(
            "Only one entry of the coframe depends on a coordinate.",
            r"So $a = 1$ and $i = b = 2$: the only term is $E_2{}^2\,\partial_1 e^2{}_2$.",
        ),
        worked=lambda: _worked(frame),
    )


def _worked(frame: Frame) -> tuple[Step, ...]:
    """The only entry that depends on a coordinate."""
    f = frame.coframe[1, 1]
    slope = f.diff(frame.coordinates[0])
    value = by_hand.tidy(slope / f)
    return (
        Step(
            f"Only $e^2{{}}_2 = {tex.tex(f)}$ depends on a coordinate, the first one: "
            f"$\\partial_1 e^2{{}}_2 = {tex.tex(slope)}$."
        ),
        Step(f"The coframe is diagonal, so $E_2{{}}^2 = 1/e^2{{}}_2 = {tex.tex(1 / f)}$."),
        Step(
            r"$\Gamma_{12}{}^2 = E_2{}^2\,\partial_1 e^2{}_2 = " + tex.tex(value) + "$. All "
            r"others vanish, also $\Gamma_{21}{}^2$: the connection is not symmetric.",
            "connection",
            {(0, 1, 1): value},
        ),
    )
