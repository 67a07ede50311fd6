"""5.6: a circuit around a screw dislocation from atom to atom."""

from collections.abc import Sequence
from functools import cache
from itertools import permutations, product

import sympy as sp

from geomtorsion.loops import Cochain
from geomtorsion.teaching.exercises.authoring import (
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    scaled,
    tex,
)

HALF = sp.Rational(1, 2)
# A step of the circuit, and how often it is taken.
Side = tuple[int, sp.Matrix]


def make(draw: Draw, text: Texts) -> Variant:
    """A right-handed screw along [111] for seed 0; other seeds: any of its kind in iron."""
    turn = draw.choice(_rotations())
    wide, tall = draw.choice((6, 3, 5, 7, 8, 9)), draw.choice((4, 3, 5, 6, 7, 8))
    sense = draw.choice((-1, 1))
    across, up, along = (turn * sp.Matrix(v) for v in ((1, -1, 0), (1, 1, -2), (1, 1, 1)))
    last = sense * along * HALF - up
    sides: list[Side] = [
        (wide, across),
        (tall, up),
        (wide, -across),
        (tall - 1, -up),
        (1, last),
    ]
    listed = ", ".join(text("side", count=count, step=_vector(step)) for count, step in sides[:-1])

    @cache
    def closure() -> tuple[sp.Expr, ...]:
        return tuple(HALF * int(x) for x in _around(sides))

    return Variant(
        statement=text("statement", line=_vector(along), listed=listed, last=_vector(last)),
        questions=(
            Question(
                name="burgers",
                kind="components",
                prompt=text("burgers.prompt"),
                answer=closure,
                errors=lambda: [
                    Mistake("direction", scaled(closure(), -1)),
                    Mistake("factor", scaled(closure(), 2), text("burgers.factor")),
                    Mistake("forgotten", list(up), text("burgers.forgotten")),
                ],
                shape=(3,),
                label="b",
                points=2,
            ),
            Question(
                name="length",
                kind="expression",
                prompt=text("length.prompt"),
                answer=lambda: sp.sqrt(sum(x**2 for x in closure())),
                errors=lambda: [
                    Mistake("factor", sp.sqrt(3)),
                    Mistake("forgotten", HALF, text("length.forgotten")),
                ],
            ),
            Question(
                name="handed",
                kind="choice",
                prompt=text("handed.prompt"),
                answer=lambda: "left" if _along(closure(), along) > 0 else "right",
                errors=lambda: [
                    Mistake(
                        "direction",
                        "right" if _along(closure(), along) > 0 else "left",
                        text("handed.direction"),
                    )
                ],
                options=text.table("handed.options"),
            ),
        ),
        hints=text.all("hints", up=_vector(up)),
        worked=lambda: _worked(text, sides, along),
    )


def _rotations() -> list[sp.Matrix]:
    """The 24 rotations of the cube."""
    rotations = []
    for order, signs in product(permutations(range(3)), product((1, -1), repeat=3)):
        matrix = sp.zeros(3, 3)
        for row, (column, sign) in enumerate(zip(order, signs, strict=True)):
            matrix[row, column] = sign
        if matrix.det() == 1:
            rotations.append(matrix)
    return rotations


def _vector(vector: sp.Matrix) -> str:
    """A direction in the crystal, with its half in front."""
    times = 2 if any(x.q == 2 for x in vector) else 1
    inner = r"\,".join(f"{{{tex.tex(x * times)}}}" for x in vector)
    return (r"\tfrac12" if times == 2 else "") + f"[{inner}]"


def _around(sides: Sequence[Side]) -> list[int]:
    """The sum of the steps along a closed path of atoms, in units of a/2, by the library."""
    every = [[int(2 * x) for x in step] for count, step in sides for _ in range(count)]
    nodes = list(range(len(every)))
    pairs = [[k, (k + 1) % len(every)] for k in nodes]
    return Cochain.of_edges(pairs, every).around(nodes).vector.tolist()


def _along(vector: Sequence[sp.Expr], line: sp.Matrix) -> sp.Expr:
    return sum((x * y for x, y in zip(vector, line, strict=True)), sp.S.Zero)


def _worked(text: Texts, sides: Sequence[Side], along: sp.Matrix) -> tuple[Step, ...]:
    """Opposite sides cancel; the last step remains."""
    (_, up), (_, last) = sides[1], sides[-1]
    b = up + last
    climbs = _along(list(b), along) > 0
    size = sp.sqrt(sum(x**2 for x in b))
    return (
        Step(text("worked.1", step=_vector(sides[0][1]), up=_vector(up))),
        Step(
            text("worked.2", up=_vector(up), last=_vector(last), b=_vector(b)), "burgers", list(b)
        ),
        Step(text("worked.3", size=tex.tex(size)), "length", size),
        Step(
            text("worked.4_left") if climbs else text("worked.4_right"),
            "handed",
            "left" if climbs else "right",
        ),
    )
