"""heyoka code: steps as expressions of heyoka."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from importlib import import_module
from typing import Protocol

from mpmath.libmp import prec_to_dps

from geomtorsion.codegen.functions import FUNCTIONS
from geomtorsion.codegen.steps import Signed, Step, is_one
from geomtorsion.errors import ExpressionError
from geomtorsion.precision import EXACT_BITS


class Expression(Protocol):
    """An expression of heyoka, which does not tell its types."""

    def __neg__(self) -> Expression:
        """Its opposite."""
        ...

    def __truediv__(self, other: Expression) -> Expression:
        """A quotient."""
        ...

    def __pow__(self, other: Expression | float) -> Expression:
        """A power."""
        ...


# p, q -> p/q, rounded at the precision in use.
Number = Callable[[int, int], Expression]


def heyoka_expressions(
    steps: Sequence[Step],
    outputs: Sequence[Signed],
    arguments: Sequence[Expression | None],
    number: Number,
) -> list[Expression]:
    """Outputs as expressions of those that stand for the arguments."""
    writer = _Writer(steps, arguments, number)
    return [writer.made[place] if sign > 0 else -writer.made[place] for sign, place in outputs]


class _Writer:
    """Writes steps as expressions, in order."""

    def __init__(
        self, steps: Sequence[Step], arguments: Sequence[Expression | None], number: Number
    ) -> None:
        # heyoka is an extra: it is loaded only where it is used.
        self.heyoka = import_module("heyoka")
        self.steps = steps
        self.arguments = arguments
        self.number = number
        self.made: list[Expression] = []
        for step in steps:
            self.made.append(self._step(step))

    def _step(self, step: Step) -> Expression:
        kind, detail = step.kind, step.detail
        if kind == "argument":
            found = self.arguments[detail]
            assert found is not None
            return found
        if kind == "number":
            return self.number(detail.numerator, detail.denominator)
        if kind == "digits":
            digits = Fraction(str(detail.evalf(prec_to_dps(EXACT_BITS))))
            return self.number(digits.numerator, digits.denominator)
        inner = [self.made[place] for place in step.operands]
        if kind == "sum":
            parts = zip(step.signs, inner, strict=True)
            return self.heyoka.sum([value if sign > 0 else -value for sign, value in parts])
        if kind == "product":
            return self.heyoka.prod(inner)
        if kind == "square":
            return inner[0] ** 2.0
        if kind == "quotient":
            return self._quotient(step, *inner)
        if kind == "root":
            return self.heyoka.sqrt(inner[0]) if detail == 2 else inner[0] ** self.number(1, detail)
        if detail == "power":
            return inner[0] ** inner[1]
        name = FUNCTIONS[detail].heyoka if kind == "call" else ""
        if not name:
            raise ExpressionError(
                f"{detail} has no Taylor series in these equations; replace it by an expression in "
                "other functions, or take another engine"
            )
        return getattr(self.heyoka, name)(*inner)

    def _quotient(self, step: Step, above: Expression, below: Expression) -> Expression:
        first = self.steps[step.operands[0]]
        if is_one(first):
            # Of 1/x heyoka makes the power -1, of -1/x a quotient, which costs two thirds.
            return -self.heyoka.prod([self.number(-1, 1), below**-1.0])
        return above / below
