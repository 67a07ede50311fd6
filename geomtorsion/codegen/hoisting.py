"""Hoisting: what is made of constant arguments alone becomes an argument itself.

An engine of series takes any value that is made in the equations for a series, and a product with
it for one of two series; a number that is given to it costs one multiplication at each order.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from geomtorsion.codegen.steps import Builder, Signed, Step

# What costs an engine nothing: it stays where it is.
_GIVEN = ("argument", "number", "digits")
Part = tuple[tuple[Step, ...], tuple[Signed, ...]]


def hoisted(
    steps: Sequence[Step], outputs: Sequence[Signed], width: int, first: int
) -> tuple[Part, Part]:
    """Steps that read constants as further arguments, and steps that make these.

    Quotients by constants become products with their inverses.

    width: how many arguments there are; first: position of the first that is constant, as all
    after it are, which are the arguments of what makes the constants.
    """
    made, found = Builder(), list[Signed]()
    rest, places, own = Builder(), list[int](), list[int]()
    positions: dict[int, int] = {}

    def further(place: int) -> int:
        """An argument for a constant, by its place in `made`."""
        if place not in positions:
            positions[place] = width + len(found)
            found.append((1, place))
        return rest.argument(positions[place], constant=True)

    def read(place: int) -> int:
        step = steps[place]
        return further(own[place]) if step.constant and step.kind not in _GIVEN else places[place]

    for step in steps:
        if step.constant:
            detail = step.detail - first if step.kind == "argument" else step.detail
            operands = tuple(own[place] for place in step.operands)
            own.append(made.add(step.kind, operands, detail, signs=step.signs, constant=True))
            given = step.kind in _GIVEN
            places.append(rest.add(step.kind, (), step.detail, constant=True) if given else -1)
            continue
        own.append(-1)
        below = steps[step.operands[1]] if step.kind == "quotient" else None
        if below is not None and below.constant and below.kind != "number":
            one = made.number(Fraction(1))
            inverse = further(made.quotient(one, own[step.operands[1]]))
            places.append(rest.product(read(step.operands[0]), inverse))
            continue
        operands = tuple(map(read, step.operands))
        places.append(rest.add(step.kind, operands, step.detail, signs=step.signs, constant=False))
    results = [(sign, read(place)) for sign, place in outputs]
    return rest.needed(results), made.needed(found)
