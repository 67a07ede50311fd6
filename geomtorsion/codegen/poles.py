"""Poles: the values in a graph that must not vanish, such as denominators."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from geomtorsion.codegen.steps import Builder, Signed, Step
from geomtorsion.exact.special_values import VALUES


def pole_values(steps: Sequence[Step]) -> tuple[tuple[Step, ...], tuple[Signed, ...]]:
    """Steps and outputs for values at whose zeros some step has no value, each a single factor.

    They are denominators, arguments of logarithms, bases of negative powers, and 1/(1 + f^2)
    of functions f that may be infinite. Values that consist of constants are omitted.
    """
    builder = Builder()
    for step in steps:
        builder.add(step.kind, step.operands, step.detail, signs=step.signs, constant=step.constant)
    places = (place for k, step in enumerate(steps) for place in _of_step(builder, k, step))
    return builder.needed([(1, place) for place in dict.fromkeys(places)])


def _of_step(builder: Builder, place: int, step: Step) -> Iterator[int]:
    """Positions of the values that must not vanish where one step has a value."""
    if step.constant:
        return
    if step.kind == "quotient":
        yield from _factors(builder, step.operands[1])
    if step.kind != "call":
        return
    name, first = step.detail, step.operands[0]
    if name == "log":
        yield from _factors(builder, first)
    elif name == "tan":
        yield builder.add("call", (first,), "cos")
    elif name == "atanh":
        square = builder.product(first, first)
        yield builder.total([(1, builder.number(Fraction(1))), (-1, square)])[1]
    elif name == "atan2":
        yield builder.total([(1, builder.product(x, x)) for x in step.operands])[1]
    elif name == "power" and (exponent := builder.steps[step.operands[1]]).kind == "number":
        yield from _factors(builder, first) if exponent.detail < 0 else ()
    elif name == "power" or name in VALUES:
        # 1/(1 + f^2) vanishes where f is infinite, and has a value where f vanishes.
        one = builder.number(Fraction(1))
        square = builder.product(place, place)
        yield builder.quotient(one, builder.total([(1, one), (1, square)])[1])


def _factors(builder: Builder, place: int) -> Iterator[int]:
    """Positions of factors, one of which vanishes wherever a value does."""
    step = builder.steps[place]
    if step.constant or (step.kind == "call" and step.detail in ("exp", "cosh")):
        return
    if step.kind in ("product", "square"):
        for operand in step.operands:
            yield from _factors(builder, operand)
    elif step.kind in ("root", "quotient") or step.detail == "power":
        yield from _factors(builder, step.operands[0])
    else:
        yield place
