"""5.7: an edge dislocation and its extra half plane, counted in atoms."""

from collections.abc import Sequence
from functools import cache

from geomtorsion.loops import Cochain
from geomtorsion.teaching.exercises.authoring import (
    Draw,
    Mistake,
    Question,
    Step,
    Variant,
    scaled,
    steps,
)

SIDES = {
    "above": "above the line",
    "below": "below the line",
    "left": "to the left of the line",
    "right": "to the right of the line",
}
OPPOSITE = {"above": "below", "below": "above", "left": "right", "right": "left"}
STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))
WAYS = ("to the right", "up", "to the left", "down")


def make(draw: Draw) -> Variant:
    """One half plane above for seed 0; other seeds: one to three, on any side."""
    place = draw.choice(tuple(SIDES))
    planes = draw.choice((1, 2, 3))
    wide, tall = draw.choice((7, 6, 9, 12)), draw.choice((5, 8, 10, 11))
    counts = _counts(place, planes, wide, tall)
    # The two sides that differ; first the side that is given in the larger circuit.
    flat = place in ("above", "below")
    side, asked = (0, 2) if flat else (1, 3)
    larger = 10 * counts[side]
    sides = ", ".join(f"${n}$ steps {way}" for n, way in zip(counts, WAYS, strict=True))

    @cache
    def closure() -> tuple[int, ...]:
        return tuple(_around(counts))

    def needed() -> int:
        # b is the excess of the first side over the side that leads back.
        return larger - closure()[0 if flat else 1]

    return Variant(
        statement=(
            "A square lattice is viewed along an edge dislocation, with $x$ to the right and $y$ "
            f"up. A circuit from atom to atom takes {sides}. It returns to the atom from which it "
            "started, and it encloses the dislocation line."
        ),
        questions=(
            Question(
                name="burgers",
                kind="components",
                prompt="Find the Burgers vector $b$ in lattice constants: the sum of these steps, "
                "taken in the perfect lattice from start to finish.",
                answer=closure,
                errors=lambda: [
                    Mistake("direction", scaled(closure(), -1)),
                    Mistake("permuted", closure()[::-1], "The component along $x$ comes first."),
                ],
                shape=(2,),
                label="b",
                points=2,
            ),
            Question(
                name="place",
                kind="choice",
                prompt="The dislocation line is the edge of one or more extra half planes of "
                "atoms. On which side of the line are they?",
                answer=lambda: place,
                errors=lambda: [
                    Mistake(
                        "direction",
                        OPPOSITE[place],
                        "Which of the two opposite sides of the circuit is longer?",
                    )
                ],
                options=SIDES,
            ),
            Question(
                name="larger",
                kind="number",
                prompt=f"A larger circuit around the same line has ${larger}$ steps "
                f"{WAYS[side]}. How many steps {WAYS[asked]} does it need to return to its start?",
                answer=needed,
                errors=lambda: [
                    Mistake(
                        "forgotten",
                        10 * counts[asked],
                        "The difference does not grow with the circuit: it is the number of half "
                        "planes.",
                    ),
                    Mistake(
                        "forgotten",
                        larger,
                        "With this number the circuit would close in the perfect lattice.",
                    ),
                    Mistake("sign", 2 * larger - needed()),
                ],
                tolerance=1e-3,
                generic=(),
            ),
        ),
        hints=steps(
            "Add the steps: opposite steps cancel.",
            "The side of the circuit that crosses the half planes has one more step for each half "
            "plane.",
            "A larger circuit crosses the same half planes.",
        ),
        worked=lambda: _worked(place, planes, counts, larger, asked),
    )


def _counts(place: str, planes: int, wide: int, tall: int) -> tuple[int, int, int, int]:
    """Steps to the right (below the line), up (to its right), left (above) and down."""
    more = {"below": 0, "right": 1, "above": 2, "left": 3}[place]
    counts = [wide, tall, wide, tall]
    counts[more] += planes
    return counts[0], counts[1], counts[2], counts[3]


def _around(counts: Sequence[int]) -> list[int]:
    """The sum of the steps along a closed path of atoms, by the library."""
    every = [step for count, step in zip(counts, STEPS, strict=True) for _ in range(count)]
    nodes = list(range(len(every)))
    pairs = [[k, (k + 1) % len(every)] for k in nodes]
    return Cochain.of_edges(pairs, every).around(nodes).vector.tolist()


def _worked(
    place: str, planes: int, counts: Sequence[int], larger: int, asked: int
) -> tuple[Step, ...]:
    """Steps that cancel, the longer side, and the same excess anywhere."""
    right, up, left, down = counts
    longer = {"above": "upper", "below": "lower", "left": "left", "right": "right"}
    excess = planes if place in ("above", "left") else -planes
    return (
        Step(
            f"Along $x$ the steps add up to ${right} - {left} = {right - left}$, along $y$ to "
            f"${up} - {down} = {up - down}$.",
            "burgers",
            [right - left, up - down],
        ),
        Step("Without the dislocation, opposite sides would have the same number of steps."),
        Step(
            f"The {longer[place]} side of the circuit has more steps: the half planes are there.",
            "place",
            place,
        ),
        Step(
            f"The larger circuit crosses the same half planes. Their number is ${planes}$: "
            f"${larger} {'+' if excess > 0 else '-'} {planes} = {larger + excess}$ steps "
            f"{WAYS[asked]}.",
            "larger",
            larger + excess,
        ),
    )
