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
    Variant,
    scaled,
    steps,
    tex,
)

HALF = sp.Rational(1, 2)
HANDED = {"right": "a right-handed screw", "left": "a left-handed screw"}
# A step of the circuit, and how often it is taken.
Side = tuple[int, sp.Matrix]


def make(draw: Draw) -> Variant:
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
    listed = ", ".join(f"${count}$ times ${_vector(step)}$" for count, step in sides[:-1])

    @cache
    def closure() -> tuple[sp.Expr, ...]:
        return tuple(HALF * int(x) for x in _around(sides))

    return Variant(
        statement=(
            f"In a crystal of iron (bcc, lattice constant $a$) a dislocation line runs along "
            f"${_vector(along)}$. A circuit from atom to atom encloses this line and is "
            "right-handed about it. It returns to the atom from which it started. Each step is "
            "replaced by the nearest vector of the perfect lattice. In units of $a$ these vectors "
            "are "
            f"{listed}, and finally once ${_vector(last)}$."
        ),
        questions=(
            Question(
                name="burgers",
                kind="components",
                prompt="Find the Burgers vector $b$ in units of $a$: the sum of all steps, from "
                "start to finish.",
                answer=closure,
                errors=lambda: [
                    Mistake("direction", scaled(closure(), -1)),
                    Mistake(
                        "factor",
                        scaled(closure(), 2),
                        "Is $b$ a vector of the type $[111]$, or half of one?",
                    ),
                    Mistake(
                        "forgotten",
                        list(up),
                        "The last step differs from the other steps of its side, and must be added "
                        "as well.",
                    ),
                ],
                shape=(3,),
                label="b",
                points=2,
            ),
            Question(
                name="length",
                kind="expression",
                prompt="Find the exact length of $b$ in units of $a$.",
                answer=lambda: sp.sqrt(sum(x**2 for x in closure())),
                errors=lambda: [
                    Mistake("factor", sp.sqrt(3)),
                    Mistake(
                        "forgotten",
                        HALF,
                        "Add the squares of the three components, then take the root.",
                    ),
                ],
            ),
            Question(
                name="handed",
                kind="choice",
                prompt="Around a right-handed screw dislocation, a path along the lattice planes "
                "advances along the line when it makes one right-handed turn. A step against the "
                "line then leads back to the starting atom. Which screw does the circuit above "
                "enclose?",
                answer=lambda: "left" if _along(closure(), along) > 0 else "right",
                errors=lambda: [
                    Mistake(
                        "direction",
                        "right" if _along(closure(), along) > 0 else "left",
                        "Does $b$, the step back to the start, point along the line or against it?",
                    )
                ],
                options=HANDED,
            ),
        ),
        hints=steps(
            "Opposite steps cancel, however many there are.",
            f"Two steps remain: ${_vector(up)}$ and the last step.",
            "In Python: `gt.Cochain.of_edges(pairs, steps).around(nodes)` adds whole numbers, "
            "so use units of $a/2$.",
        ),
        worked=lambda: _worked(sides, along),
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


def _worked(sides: Sequence[Side], along: sp.Matrix) -> tuple[Step, ...]:
    """Opposite sides cancel; the last step remains."""
    (_, up), (_, last) = sides[1], sides[-1]
    b = up + last
    climbs = _along(list(b), along) > 0
    size = sp.sqrt(sum(x**2 for x in b))
    return (
        Step(
            f"The steps ${_vector(sides[0][1])}$ and their opposites cancel. One of the steps "
            f"${_vector(up)}$ remains."
        ),
        Step(
            f"Together with the last step, $b = {_vector(up)} + {_vector(last)} = {_vector(b)}$.",
            "burgers",
            list(b),
        ),
        Step(f"Its length is ${tex.tex(size)}$ lattice constants.", "length", size),
        Step(
            f"$b$ is the step back to the start, and it points {'along' if climbs else 'against'} "
            f"the line. This is {HANDED['left' if climbs else 'right']}.",
            "handed",
            "left" if climbs else "right",
        ),
    )
