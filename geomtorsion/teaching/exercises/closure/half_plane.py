"""5.7: an edge dislocation and its extra half plane, counted in atoms."""

from collections.abc import Sequence
from functools import cache

from geomtorsion.loops import Cochain
from geomtorsion.teaching.exercises.authoring import (
    Draw,
    Mistake,
    Question,
    Step,
    Texts,
    Variant,
    scaled,
)

OPPOSITE = {"above": "below", "below": "above", "left": "right", "right": "left"}
STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))


def make(draw: Draw, text: Texts) -> Variant:
    """One half plane above for seed 0; other seeds: one to three, on any side."""
    place = draw.choice(tuple(OPPOSITE))
    planes = draw.choice((1, 2, 3))
    wide, tall = draw.choice((7, 6, 9, 12)), draw.choice((5, 8, 10, 11))
    counts = _counts(place, planes, wide, tall)
    # The two sides that differ; first the side that is given in the larger circuit.
    flat = place in ("above", "below")
    side, asked = (0, 2) if flat else (1, 3)
    larger = 10 * counts[side]
    right, up, left, down = counts

    @cache
    def closure() -> tuple[int, ...]:
        return tuple(_around(counts))

    def needed() -> int:
        # b is the excess of the first side over the side that leads back.
        return larger - closure()[0 if flat else 1]

    return Variant(
        statement=text("statement", right=right, up=up, left=left, down=down),
        questions=(
            Question(
                name="burgers",
                kind="components",
                prompt=text("burgers.prompt"),
                answer=closure,
                errors=lambda: [
                    Mistake("direction", scaled(closure(), -1)),
                    Mistake("permuted", closure()[::-1], text("burgers.permuted")),
                ],
                shape=(2,),
                label="b",
                points=2,
            ),
            Question(
                name="place",
                kind="choice",
                prompt=text("place.prompt"),
                answer=lambda: place,
                errors=lambda: [Mistake("direction", OPPOSITE[place], text("place.direction"))],
                options=text.table("place.options"),
            ),
            Question(
                name="larger",
                kind="number",
                prompt=text("larger.prompt_right" if flat else "larger.prompt_up", larger=larger),
                answer=needed,
                errors=lambda: [
                    Mistake("forgotten", 10 * counts[asked], text("larger.forgotten")),
                    Mistake("forgotten", larger, text("larger.forgotten_excess")),
                    Mistake("sign", 2 * larger - needed()),
                ],
                tolerance=1e-3,
                generic=(),
            ),
        ),
        hints=text.all("hints"),
        worked=lambda: _worked(text, place, planes, counts, larger),
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
    text: Texts, place: str, planes: int, counts: Sequence[int], larger: int
) -> tuple[Step, ...]:
    """Steps that cancel, the longer side, and the same excess anywhere."""
    right, up, left, down = counts
    excess = planes if place in ("above", "left") else -planes
    return (
        Step(
            text("worked.1", right=right, left=left, x=right - left, up=up, down=down, y=up - down),
            "burgers",
            [right - left, up - down],
        ),
        Step(text("worked.2")),
        Step(
            text.table("worked.3")[place],
            "place",
            place,
        ),
        Step(
            text(
                "worked.4_left" if place in ("above", "below") else "worked.4_down",
                planes=planes,
                sum=f"{larger} {'+' if excess > 0 else '-'} {planes}",
                steps=larger + excess,
            ),
            "larger",
            larger + excess,
        ),
    )
