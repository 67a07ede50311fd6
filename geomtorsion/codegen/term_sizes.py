"""Term sizes: steps for the sums of the absolute sizes of all terms of outputs."""

from __future__ import annotations

from collections.abc import Sequence

from geomtorsion.codegen.steps import Builder, Signed, Step


def term_sizes(
    steps: Sequence[Step], outputs: Sequence[Signed]
) -> tuple[tuple[Step, ...], tuple[Signed, ...]]:
    """Steps and outputs for the sizes, which are what roundings of terms are measured by."""
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
    return builder.needed([(1, sizes[place]) for _, place in outputs])
