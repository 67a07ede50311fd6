"""Term sizes: steps for the sums of the absolute sizes of all terms of outputs."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from geomtorsion.codegen.steps import Builder, Signed, Step

# A value that is smaller than so many roundings of its terms has no sign of its own.
ROUNDINGS = 8


def term_sizes(
    steps: Sequence[Step], outputs: Sequence[Signed]
) -> tuple[tuple[Step, ...], tuple[Signed, ...]]:
    """Steps and outputs for the sizes, which are what roundings of terms are measured by."""
    builder, sizes = _with_sizes(steps)
    return builder.needed([(1, sizes[place]) for _, place in outputs])


def above_rounding(
    steps: Sequence[Step], outputs: Sequence[Signed]
) -> tuple[tuple[Step, ...], tuple[Signed, ...]]:
    """Steps and outputs that are positive only where rounding in doubles leaves no doubt of it.

    Of roots what is under them stands here: it has the same sign as long as there is a root.
    """
    builder, sizes = _with_sizes(steps)
    share = builder.number(Fraction(ROUNDINGS, 2**52))
    found = []
    for sign, place in outputs:
        inner = steps[place].operands[0] if steps[place].kind == "root" else place
        doubt = builder.product(share, sizes[inner])
        found.append(builder.total([(sign, inner), (-1, doubt)]))
    return builder.needed(found)


def _with_sizes(steps: Sequence[Step]) -> tuple[Builder, list[int]]:
    """All steps, and for each the place of its size."""
    builder = Builder()
    sizes: list[int] = []
    # First all old steps, so that their places stay.
    for step in steps:
        builder.add(step.kind, step.operands, step.detail, signs=step.signs, constant=step.constant)
    for place, step in enumerate(steps):
        inner = [sizes[operand] for operand in step.operands]
        if step.kind == "sum":
            size = builder.total([(1, operand) for operand in inner])[1]
        elif step.kind in ("product", "square"):
            size = builder.product(inner[0], inner[-1])
        elif step.kind == "quotient":
            size = builder.quotient(inner[0], builder.add("call", step.operands[1:], "Abs"))
        else:
            size = builder.add("call", (place,), "Abs")
        sizes.append(size)
    return builder, sizes
